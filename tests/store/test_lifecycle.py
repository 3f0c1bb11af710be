"""A run's way through its states: claims, leases, fences, cancel, merge, recovery."""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np
import pytest

from solver.results.channel import Axis, Channel
from solver.results.part import Chunk
from store.database import Database
from store.errors import ConflictError, LostLeaseError, NotFoundError
from store.models import Run
from store.repositories import (
    CaseRepository,
    ChannelRepository,
    DataSetRepository,
    RecoveryRepository,
    RunRepository,
    TaskRepository,
)
from store.repositories.cases import NewCase
from store.repositories.tasks import Outcome, Ticket
from store.scope import Scope

SCOPE = Scope()
DONE = Outcome("succeeded", None, {"statics": "succeeded"}, "{}", ("careful",), "1.0")


@pytest.fixture
def make(database: Database) -> Callable[..., tuple[str, list[str]]]:
    def made(chunks: int = 1) -> tuple[str, list[str]]:
        with database.write() as session:
            version, _ = CaseRepository(session, SCOPE).save(NewCase("a case", "h" * 64, "{}", "x: 1"))
            plan = [Chunk("time", (k, k + 1), 1.0 + k) for k in range(chunks)]
            run, tasks = RunRepository(session, SCOPE).create(version, ["statics"], plan)
            tasks = [task for task, door in tasks if door == "runs"]
            return run.id, tasks

    return made


def claim(database: Database, task: str, lease: float = 60.0, most: int = 3) -> Ticket | None:
    with database.write() as session:
        return TaskRepository(session).claim(task, "host/1/2", lease, most)


def taken(database: Database, task: str, lease: float = 60.0) -> Ticket:
    ticket = claim(database, task, lease)
    assert ticket is not None
    return ticket


def state(database: Database, run_id: str) -> str:
    with database.read() as session:
        return RunRepository(session, SCOPE).get(run_id).state


def test_only_one_of_many_claims_wins(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    _, (task,) = make()
    won: list[Ticket | None] = []
    threads = [threading.Thread(target=lambda: won.append(claim(database, task))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len([ticket for ticket in won if ticket]) == 1


def test_from_queue_to_results(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    run_id, (task,) = make()
    ticket = taken(database, task)
    assert state(database, run_id) == "running"
    with database.write() as session:
        assert TaskRepository(session).beat(ticket, 60, 0.5, "half", b"here") == "running"
    with database.read() as session:
        view = RunRepository(session, SCOPE).view(run_id)
        assert (view.progress, view.message, view.attempt) == (0.5, "half", 1)
        assert TaskRepository(session).job(ticket).checkpoint == b"here"
        with pytest.raises(ConflictError, match="no results"):
            RunRepository(session, SCOPE).summary(run_id)
    channel = Channel("a/b", np.arange(3.0), (Axis("omega", "rad/s", np.arange(3.0)),), "m", "", "wf")
    with database.write() as session:
        assert TaskRepository(session).complete(ticket, DONE)
        ChannelRepository(session).put(run_id, [channel])
    with database.read() as session:
        run = RunRepository(session, SCOPE).get(run_id)
        assert (run.state, run.warnings, run.solver_version) == ("succeeded", ["careful"], "1.0")
        assert run.finished_at is not None
        assert run.finished_at.tzinfo is not None
        assert ChannelRepository(session).names(run_id)[0].dims == ("omega",)
    assert claim(database, task) is None


def test_a_late_worker_writes_nothing(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    run_id, (task,) = make()
    late = taken(database, task, lease=-1)
    now = taken(database, task)
    assert now.attempt == 2
    writes: list[Callable[[TaskRepository], object]] = [
        lambda tasks: tasks.beat(late, 60, 1.0, ""),
        lambda tasks: tasks.complete(late, DONE),
        lambda tasks: tasks.fail(late, "no"),
        lambda tasks: tasks.give_up(late),
        lambda tasks: tasks.release(late, None),
        lambda tasks: tasks.hand_in(late, b"part"),
    ]
    for write in writes:
        with pytest.raises(LostLeaseError), database.write() as session:
            write(TaskRepository(session))
    assert state(database, run_id) == "running"


def test_the_last_of_several_merges(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    run_id, tasks = make(3)
    tickets = [taken(database, task) for task in tasks]
    for ticket, last in zip([tickets[2], tickets[0], tickets[1]], [False, False, True], strict=True):
        with database.write() as session:
            assert TaskRepository(session).hand_in(ticket, str(ticket.task_id).encode()) is last
    with database.read() as session:
        assert [part.decode() for part in TaskRepository(session).parts(run_id)] == tasks
    # the merging worker dies: the next attempt finds its part and has only the merge to do
    with database.write() as session:
        RecoveryRepository(session).expire([tickets[1].task_id], ["host/1/2"])
    again = taken(database, tickets[1].task_id)
    with database.read() as session:
        assert TaskRepository(session).job(again).part is not None
    with database.write() as session:
        assert TaskRepository(session).complete(again, DONE)
    assert state(database, run_id) == "succeeded"
    with database.read() as session:
        assert not TaskRepository(session).parts(run_id)


def test_one_failed_task_ends_the_run(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    run_id, tasks = make(3)
    first, second = (taken(database, task) for task in tasks[:2])
    with database.write() as session:
        TaskRepository(session).fail(first, "because")
    with database.read() as session:
        run = RunRepository(session, SCOPE).get(run_id)
        assert (run.state, run.reason, run.outcomes) == ("failed", "because", {"statics": "failed"})
    assert claim(database, tasks[2]) is None
    with pytest.raises(LostLeaseError), database.write() as session:
        TaskRepository(session).beat(second, 60, 0.1, "")


def test_cancel(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    queued, _ = make()
    with database.write() as session:
        RunRepository(session, SCOPE).cancel(queued)
    assert state(database, queued) == "cancelled"
    running, tasks = make(2)
    ticket = taken(database, tasks[0])
    with database.write() as session:
        RunRepository(session, SCOPE).cancel(running)
    assert state(database, running) == "cancelling"
    assert claim(database, tasks[1]) is None
    with database.write() as session:
        assert TaskRepository(session).beat(ticket, 60, 0.1, "") == "cancelling"
    with database.write() as session:
        assert not TaskRepository(session).complete(ticket, DONE)  # too late: it was cancelled
    assert state(database, running) == "cancelled"
    with pytest.raises(ConflictError, match="already cancelled"), database.write() as session:
        RunRepository(session, SCOPE).cancel(running)


def test_the_last_at_work_hands_in_after_a_cancel(
    database: Database, make: Callable[..., tuple[str, list[str]]]
) -> None:
    """Its block was done before it heard of the cancel: the run ends, since nobody else is left to end it."""
    run_id, tasks = make(2)
    ticket = taken(database, tasks[0])
    with database.write() as session:
        RunRepository(session, SCOPE).cancel(run_id)
    with database.write() as session:
        assert not TaskRepository(session).hand_in(ticket, b"part")
    assert state(database, run_id) == "cancelled"


def test_two_data_sets_of_one_name_at_once_are_two_versions(database: Database) -> None:
    """The result of a long hydrodynamic job is not lost because somebody uploads under its name."""

    def save(content: str) -> None:
        with database.write() as session:
            row, _ = DataSetRepository(session, SCOPE).save("barge", "barge.nc", content * 64, b"", {})
            versions[content] = row.version

    versions: dict[str, int] = {}
    second = threading.Thread(target=save, args=("b",))
    with database.write() as session:
        versions["a"] = DataSetRepository(session, SCOPE).save("barge", "barge.nc", "a" * 64, b"", {})[0].version
        second.start()
        second.join(0.3)
    second.join(10)
    assert versions == {"a": 1, "b": 2}


def test_recovery(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    run_id, (task,) = make()
    with database.write() as session:
        assert RecoveryRepository(session).ring_stale(60, 10) == []
    for attempt in (1, 2):
        assert taken(database, task, lease=-1).attempt == attempt
        with database.write() as session:
            recovery = RecoveryRepository(session)
            assert list(recovery.expired(10, 60)) == [task]
            recovery.settle_expired(task, 2)
    assert state(database, run_id) == "failed"
    with database.read() as session:
        assert "lost 2 times" in str(RunRepository(session, SCOPE).get(run_id).reason)


def test_a_released_attempt_does_not_count(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    _, (task,) = make()
    for _ in range(5):
        ticket = claim(database, task, most=1)
        assert ticket is not None
        with database.write() as session:
            TaskRepository(session).release(ticket, b"so far")
    with database.write() as session:
        assert RecoveryRepository(session).ring_stale(60, 10) == [(task, "runs"), (task, "quick")]


def test_delete_takes_all_with_it(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    run_id, (task,) = make()
    with pytest.raises(ConflictError), database.write() as session:
        RunRepository(session, SCOPE).delete(run_id)
    ticket = taken(database, task)
    with database.write() as session:
        TaskRepository(session).complete(ticket, DONE)
    with database.write() as session:
        version = session.get_one(Run, run_id).case_version_id
        with pytest.raises(ConflictError):
            CaseRepository(session, SCOPE).delete(version)
        RunRepository(session, SCOPE).delete(run_id)
        CaseRepository(session, SCOPE).delete(version)
    assert claim(database, task) is None


def test_nobody_sees_another_projects_rows(database: Database, make: Callable[..., tuple[str, list[str]]]) -> None:
    run_id, _ = make()
    stranger = Scope("t" * 32, "p" * 32)
    with database.read() as session:
        assert RunRepository(session, stranger).page(10, None) == []
        for call in (RunRepository(session, stranger).get, RunRepository(session, stranger).summary):
            with pytest.raises(NotFoundError):
                call(run_id)


def test_pages_and_versions(database: Database) -> None:
    with database.write() as session:
        cases = CaseRepository(session, SCOPE)
        made = [cases.save(NewCase("name", f"{number:064d}", "{}", "")) for number in range(5)]
        assert [version.number for version, _ in made] == [1, 2, 3, 4, 5]
        again, new = cases.save(NewCase("name", f"{2:064d}", "{}", ""))
        assert (again.number, new) == (3, False)
        first = cases.page(3, None)
        rest = cases.page(3, first[-1].id)
    assert [row.number for row in [*first, *rest]] == [5, 4, 3, 2, 1]


def test_a_lease_that_ended_early_is_no_lost_attempt(
    database: Database, make: Callable[..., tuple[str, list[str]]]
) -> None:
    """Three times with three attempts allowed: each worker lived, so the task is still to be had."""
    _, (task,) = make(1)
    for attempt in range(1, 15):
        with database.write() as session:
            ticket = TaskRepository(session).claim(task, f"host/1/{attempt}", 60, 3)
        assert ticket is not None
        assert ticket.attempt == attempt
        with database.write() as session:
            RecoveryRepository(session).expire([task], [f"host/1/{attempt}"])
        with database.write() as session:
            RecoveryRepository(session).settle_expired(task, 3)
        with database.write() as session:
            TaskRepository(session).lost_early(ticket, 3)
    for attempt in (15, 16, 17):  # but not without end
        with database.write() as session:
            found = TaskRepository(session).claim(task, f"host/1/{attempt}", 60, 3)
            assert found is not None
        with database.write() as session:
            RecoveryRepository(session).expire([task], [f"host/1/{attempt}"])
        with database.write() as session:
            RecoveryRepository(session).settle_expired(task, 3)
        with database.write() as session:
            TaskRepository(session).lost_early(found, 3)
    with database.write() as session:
        assert TaskRepository(session).claim(task, "host/1/18", 60, 3) is None


def test_a_worker_that_still_has_its_lease_gains_nothing(
    database: Database, make: Callable[..., tuple[str, list[str]]]
) -> None:
    _, (task,) = make(1)
    with database.write() as session:
        ticket = TaskRepository(session).claim(task, "host/1/1", 60, 1)
        assert ticket is not None
        TaskRepository(session).lost_early(ticket, 1)
    with database.write() as session:
        RecoveryRepository(session).expire([task], ["host/1/1"])
        assert TaskRepository(session).claim(task, "host/1/2", 60, 1) is None
