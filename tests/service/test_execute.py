"""One task, in this process: how each way to end is written down."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from solver.case import parse_case
from solver.results.part import Chunk
from store import migrations
from store.database import Database
from store.errors import ConflictError
from store.reconcile import reconcile
from store.repositories import CaseRepository, RecoveryRepository, RunRepository
from store.repositories.cases import NewCase
from store.repositories.runs import RunView
from store.scope import Scope
from store.settings import Settings
from worker.execute import Worker, execute

from . import fake_solver
from .running import a_case

SCOPE = Scope()


@pytest.fixture
def worker(tmp_path: Path) -> Iterator[Worker]:
    settings = Settings(data_dir=tmp_path, heartbeat_seconds=0.05, lease_seconds=5, checkpoint_seconds=0.05)
    database = Database(settings.database)
    migrations.upgrade(database)
    yield Worker(database, fake_solver, settings, "host/1/2")  # type: ignore[arg-type]
    database.close()


def insert(worker: Worker, chunks: int = 1, **orders: Any) -> tuple[str, list[str]]:
    case = parse_case(a_case("a case", **orders))
    with worker.database.write() as session:
        new = NewCase(case.name, case.content_hash(), case.canonical(), "")
        version, _ = CaseRepository(session, SCOPE).save(new)
        plan = [Chunk("time", (k, k + 1)) for k in range(chunks)]
        run, tasks = RunRepository(session, SCOPE).create(version, ["statics"], plan)
        tasks = [task for task, door in tasks if door == "runs"]
        return run.id, tasks


def look(worker: Worker, run_id: str) -> RunView:
    with worker.database.read() as session:
        return RunRepository(session, SCOPE).view(run_id)


def in_thread(worker: Worker, task: str) -> tuple[threading.Thread, list[str]]:
    words: list[str] = []
    thread = threading.Thread(target=lambda: words.append(execute(worker, task)))
    thread.start()
    return thread, words


def test_chunks_are_merged_in_the_order_of_the_plan(worker: Worker) -> None:
    run_id, tasks = insert(worker, chunks=4)
    assert [execute(worker, task) for task in (tasks[2], tasks[0], tasks[3])] == ["handed in"] * 3
    assert look(worker, run_id).progress == pytest.approx(0.75)
    assert execute(worker, tasks[1]) == "succeeded"
    with worker.database.read() as session:
        assert json.loads(RunRepository(session, SCOPE).summary(run_id))["numbers"] == [0.0, 1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("case", "lines: this is wrong"),
        ("diverge", "It went on and on. Use a shorter line."),
        ("memory", "out of memory"),
        ("bug", "An error inside Slowdrift (ZeroDivisionError)"),
    ],
)
def test_a_failure_has_its_reason_and_is_not_tried_again(worker: Worker, fault: str, reason: str) -> None:
    run_id, (task,) = insert(worker, fault=fault)
    assert execute(worker, task) == "failed"
    view = look(worker, run_id)
    assert (view.run.state, view.attempt) == ("failed", 1)
    assert reason in str(view.run.reason)
    assert execute(worker, task) == "not to be had"


def test_nan_in_a_summary_is_a_failure(worker: Worker, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = fake_solver.merge

    def merge(case: Any, parts: Any) -> Any:
        result = whole(case, parts)
        return replace(result, summary=result.summary | {"sigma": float("nan")})

    monkeypatch.setattr(fake_solver, "merge", merge)
    run_id, (task,) = insert(worker)
    assert execute(worker, task) == "failed"
    assert "not finite" in str(look(worker, run_id).run.reason)


def test_cancel_takes_effect_between_progress_calls(worker: Worker) -> None:
    run_id, (task,) = insert(worker, seconds=30)
    thread, words = in_thread(worker, task)
    while look(worker, run_id).run.state != "running":
        time.sleep(0.01)
    with worker.database.write() as session:
        RunRepository(session, SCOPE).cancel(run_id)
    thread.join(2)
    assert words == ["cancelled"]
    assert look(worker, run_id).run.state == "cancelled"


def test_a_worker_whose_task_was_taken_stops_and_writes_nothing(worker: Worker) -> None:
    run_id, (task,) = insert(worker, seconds=2)
    thread, words = in_thread(worker, task)
    while look(worker, run_id).run.state != "running":
        time.sleep(0.01)
    with worker.database.write() as session:
        RecoveryRepository(session).expire([task], ["host/1/2"])
    other = replace(worker, name="host/3/4")
    assert execute(other, task) == "succeeded"
    thread.join(3)
    assert words == ["lost"]
    view = look(worker, run_id)
    assert (view.run.state, view.attempt) == ("succeeded", 2)


def test_shutdown_gives_the_task_back_with_its_checkpoint(worker: Worker) -> None:
    run_id, (task,) = insert(worker, seconds=2)
    stopping = threading.Event()
    thread, words = in_thread(replace(worker, shutting_down=stopping.is_set), task)
    while look(worker, run_id).progress < 0.2:
        time.sleep(0.01)
    stopping.set()
    thread.join(2)
    assert words == ["released"]
    assert look(worker, run_id).run.state == "running"
    assert execute(worker, task) == "succeeded"
    with worker.database.read() as session:
        assert json.loads(RunRepository(session, SCOPE).summary(run_id))["resumed_from"] > 10


def test_the_reconciler_rings_for_what_was_forgotten(worker: Worker) -> None:
    class Bell:
        rung: list[tuple[str, str]] = []  # noqa: RUF012

        def ring(self, tasks: list[tuple[str, str]]) -> None:
            self.rung += tasks

    run_id, (task,) = insert(worker)
    bell: Any = Bell()
    assert reconcile(worker.database, bell, worker.settings) == 0  # it was rung for a moment ago
    settings = worker.settings.model_copy(update={"stale_seconds": 1e-6})
    assert reconcile(worker.database, bell, settings) == 1
    assert bell.rung == [(task, "runs"), (task, "quick")]
    with worker.database.read() as session, pytest.raises(ConflictError):
        RunRepository(session, SCOPE).summary(run_id)
