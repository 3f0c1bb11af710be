"""What is next: by priority, then age, each to one worker only; and clocks that were put back."""

from __future__ import annotations

import threading
import time
from collections import Counter

import pytest
from sqlalchemy import update

from solver.results.part import Chunk
from store.database import Database
from store.models import Task
from store.priority import BATCH, INTERACTIVE, NORMAL, by_size, doors, name_of
from store.repositories import CaseRepository, QueueRepository, RecoveryRepository, RunRepository, TaskRepository
from store.repositories.cases import NewCase
from store.repositories.runs import Labels
from store.repositories.tasks import Ticket
from store.scope import Scope

SCOPE = Scope()


def queue(database: Database, priority: int | None = None, chunks: int = 1, weight: float = 1.0) -> str:
    with database.write() as session:
        version, _ = CaseRepository(session, SCOPE).save(NewCase("a case", "h" * 64, "{}", "x: 1"))
        plan = [Chunk("time", (k, k + 1), weight) for k in range(chunks)]
        run, _ = RunRepository(session, SCOPE).create(version, ["statics"], plan, labels=Labels(priority=priority))
        return run.id


def next_of(database: Database, up_to: int | None = None, lease: float = 60.0) -> Ticket | None:
    with database.write() as session:
        return TaskRepository(session).claim_next("runs", "host/1/2", lease, 3, up_to)


def test_the_most_urgent_first_and_the_oldest_of_equals(database: Database) -> None:
    batch, normal, first, second = (queue(database, each) for each in (BATCH, NORMAL, INTERACTIVE, INTERACTIVE))
    taken = [next_of(database) for _ in range(5)]
    assert [ticket and ticket.run_id for ticket in taken] == [first, second, normal, batch, None]


def test_the_quick_door_takes_nothing_else(database: Database) -> None:
    queue(database, NORMAL)
    assert next_of(database, up_to=INTERACTIVE) is None
    urgent = queue(database, INTERACTIVE)
    ticket = next_of(database, up_to=INTERACTIVE)
    assert ticket is not None
    assert ticket.run_id == urgent


def test_priority_by_size() -> None:
    assert by_size([1.0]) == by_size([1.0, 2.0]) == INTERACTIVE
    assert by_size([1.0, 2.5]) == NORMAL
    assert [name_of(each) for each in (5, 10, 15, 20, 30)] == [
        "interactive",
        "interactive",
        "normal",
        "normal",
        "batch",
    ]
    assert doors("runs", INTERACTIVE) == ("runs", "quick")
    assert doors("runs", NORMAL) == ("runs",)
    assert doors("hydrodynamics", INTERACTIVE) == ("hydrodynamics",)


def test_many_workers_share_without_loss(database: Database) -> None:
    """Several chunks a run, so that workers meet at the lock of one run."""
    for _ in range(6):
        queue(database, chunks=5)
    won: Counter[str] = Counter()
    lock = threading.Lock()

    def work() -> None:
        while (ticket := next_of(database)) is not None:
            with lock:
                won[ticket.task_id] += 1

    threads = [threading.Thread(target=work) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(won) == 30
    assert set(won.values()) == {1}


@pytest.mark.parametrize("ahead", [3600.0, 1e7])
def test_a_lease_from_before_the_clock_was_put_back_is_over(database: Database, ahead: float) -> None:
    queue(database)
    ticket = next_of(database, lease=60.0 + ahead)  # as if it had been given an hour from now
    assert ticket is not None
    with database.write() as session:
        recovery = RecoveryRepository(session)
        assert list(recovery.expired(10, 60.0)) == [ticket.task_id]
        recovery.settle_expired(ticket.task_id, 3, 60.0)
    assert next_of(database) is not None
    with database.read() as session:
        assert list(RecoveryRepository(session).expired(10, 60.0)) == []  # this one is of now


def test_a_message_from_before_the_clock_was_put_back_was_sent_long_ago(database: Database) -> None:
    queue(database)
    with database.write() as session:
        session.execute(update(Task).values(rung_at=time.time() + 3600))
    with database.write() as session:
        assert len(RecoveryRepository(session).ring_stale(15.0, 10)) == 2  # at both doors
    with database.write() as session:
        assert RecoveryRepository(session).ring_stale(15.0, 10) == []


def test_what_operators_see(database: Database) -> None:
    queue(database, NORMAL, chunks=3)
    next_of(database)
    with database.read() as session:
        queues = QueueRepository(session)
        (line,) = queues.waiting()
        assert (line.queue, line.priority, line.queued, line.running) == ("runs", NORMAL, 2, 1)
        assert line.oldest_seconds is not None
        assert 0 <= line.oldest_seconds < 60
        assert (queues.workers(), queues.states()) == (["host/1/2"], {"running": 1})
