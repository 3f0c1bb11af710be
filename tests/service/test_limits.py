"""A task that takes too much: asked to stop, then ended with its process; always with the reason."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest
from sqlalchemy import update

from store import estimate
from store.models import Task
from store.repositories import TaskRepository
from store.repositories.hydrodynamics import HydrodynamicsRepository, NewJob
from store.repositories.tasks import Ticket
from worker import keeper
from worker.execute import Worker, _limits, execute
from worker.keeper import Limits
from worker.process import memory_mb

from . import fake_solver
from .test_execute import SCOPE, insert, look, worker

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


def test_a_hydrodynamic_job_may_take_many_times_its_own_estimate(worker: Worker) -> None:
    """Its weight is in seconds already: how fast runs of cases went here says nothing of it."""
    estimate._kept.clear()
    _, (task,) = insert(worker)
    with worker.database.write() as session:
        session.execute(update(Task).where(Task.id == task).values(state="succeeded", seconds=0.01, weight=1.0))
    runs = _limits(worker, Ticket("task", "run", 1, weight=3000.0)).seconds
    assert runs == worker.settings.task_timeout_seconds  # 20 x 3000 x 0.01 s is less
    job = _limits(worker, Ticket("task", "run", 1, weight=3000.0, queue="hydrodynamics")).seconds
    assert job == worker.settings.timeout_factor * 3000.0
    with worker.database.write() as session:
        new = NewJob("barge", {}, "h" * 64, {}, weight=7.0)
        run, _ = HydrodynamicsRepository(session, SCOPE).start(new)
    insert(worker)
    estimate._kept.clear()
    with worker.database.read() as session:
        assert HydrodynamicsRepository(session, SCOPE).job(run.id).view.seconds_left == 7.0
        assert estimate.snapshot(session).before[-1] == 1.0  # of cases only
    with worker.database.write() as session:
        ticket = TaskRepository(session).claim_next("hydrodynamics", "host/1/2", 60, 3)
        assert ticket is not None
        assert (ticket.run_id, ticket.weight, ticket.queue) == (run.id, 7.0, "hydrodynamics")


def test_the_reasons() -> None:
    limits = Limits(seconds=900, memory_mb=4000)
    assert limits.passed(899, 3999) is None
    assert "900 s" in str(limits.passed(901, 1))
    assert "4000 MB" in str(limits.passed(1, 4001))
