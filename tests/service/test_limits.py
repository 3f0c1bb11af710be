"""A task that takes too much: asked to stop, then ended with its process; always with the reason."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from worker import keeper
from worker.execute import Worker, execute
from worker.keeper import Limits
from worker.process import memory_mb

from . import fake_solver
from .test_execute import insert, look, worker

__all__ = ["worker"]


def test_time_beyond_the_limit(worker: Worker) -> None:
    brief = worker.settings.model_copy(update={"task_timeout_seconds": 0.3, "timeout_factor": 1})
    run_id, (task,) = insert(worker, seconds=60)
    began = time.monotonic()
    # its weight is 1, nothing was seen before: 30 s would be allowed, so the estimate is made small
    with worker.database.write() as session:
        from sqlalchemy import update

        from store.models import Task

        session.execute(update(Task).values(weight=1e-3))
    assert execute(replace(worker, settings=brief), task) == "failed"
    assert time.monotonic() - began < 10
    view = look(worker, run_id)
    assert (view.run.state, view.attempt) == ("failed", 1)
    assert "longer than 0 s" in str(view.run.reason)
    assert "SLOWDRIFT_TASK_TIMEOUT_SECONDS" in str(view.run.reason)


def test_memory_beyond_the_limit(worker: Worker) -> None:
    used = int(memory_mb() / 1.1)  # over it, but not so far that nothing is waited for
    small = worker.settings.model_copy(update={"task_memory_mb": used})
    run_id, (task,) = insert(worker, seconds=60)
    assert execute(replace(worker, settings=small), task) == "failed"
    assert f"more than {used} MB of memory" in str(look(worker, run_id).run.reason)


def test_one_that_does_not_heed_ends_with_its_process(worker: Worker, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a single progress call; the row has its reason before the process goes."""
    monkeypatch.setattr(keeper, "GRACE_SECONDS", 0.2)
    monkeypatch.setattr(fake_solver, "_misbehave", lambda *_: time.sleep(3))
    left: list[int] = []
    small = worker.settings.model_copy(update={"task_memory_mb": 100})
    run_id, (task,) = insert(worker)
    execute(replace(worker, settings=small, leave=left.append), task)
    assert left == [keeper.EXIT_STATUS]
    view = look(worker, run_id)
    assert view.run.state == "failed"
    assert "memory" in str(view.run.reason)


def test_the_reasons() -> None:
    limits = Limits(seconds=900, memory_mb=4000)
    assert limits.passed(899, 3999) is None
    assert "900 s" in str(limits.passed(901, 1))
    assert "4000 MB" in str(limits.passed(1, 4001))
