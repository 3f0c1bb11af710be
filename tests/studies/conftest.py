"""The API of tests/api, and a worker that computes in this process with the fake solver."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from store.database import Database
from store.settings import Settings
from tests.api.conftest import client, database, migrated, service_settings
from tests.service import fake_solver
from worker.execute import Worker, execute_next

__all__ = ["client", "database", "migrated", "service_settings"]


@pytest.fixture
def work(database: Database, service_settings: Settings) -> Callable[[], list[str]]:
    """Does everything that is queued; gives the ids of the tasks in the order in which they were done."""
    worker = Worker(database, fake_solver, service_settings, "host/1/2")  # type: ignore[arg-type]

    def all_of_it() -> list[str]:
        done = []
        while (next_one := execute_next(worker, "runs")) is not None:
            done.append(next_one[0])
        return done

    return all_of_it
