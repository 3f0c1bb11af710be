"""A migrated database for each test, on SQLite and on PostgreSQL where there is one."""

from __future__ import annotations

import uuid
from collections.abc import Iterator
from pathlib import Path

import pytest

from store import migrations
from store.database import Database
from tests.service.conftest import create_database, drop_database, need


@pytest.fixture(params=["sqlite", pytest.param("postgresql", marks=pytest.mark.services)])
def empty(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Database]:
    if request.param == "sqlite":
        database = Database(f"sqlite:///{tmp_path / 'test.db'}")
        yield database
        database.close()
        return
    need("PostgreSQL", 5432)
    name = f"sd_test_{uuid.uuid4().hex[:12]}"
    database = Database(create_database(name))
    yield database
    database.close()
    drop_database(name)


@pytest.fixture
def database(empty: Database) -> Database:
    migrations.upgrade(empty)
    return empty
