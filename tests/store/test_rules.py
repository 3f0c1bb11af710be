"""Rules of the queue, of retention, of lists and of estimates, each at the place where it stands, at its border."""

from __future__ import annotations

import time
from datetime import timedelta

import pytest
from sqlalchemy import select, update

from store import estimate, retention
from store.clock import utc_now
from store.database import Database
from store.errors import NotFoundError
from store.filters import RunFilter
from store.models import SUCCEEDED, Run, Task
from store.priority import NORMAL
from store.repositories import QueueRepository, RunRepository, TaskRepository
from store.repositories.accounts import AccountRepository
from store.repositories.data_sets import DataSetRepository
from store.repositories.hydrodynamics import MeshRepository
from store.repositories.studies import StudyRepository
from store.repositories.tasks import EARLY
from store.repositories.turns import TurnRepository
from tests.store.test_queue import SCOPE, next_of, queue


def _task(database: Database, run_id: str) -> Task:
    with database.read() as session:
        return session.scalars(select(Task).where(Task.run_id == run_id)).one()


def test_releases_never_count_as_lost_attempts(database: Database) -> None:
    """A worker that hands back a task ten times leaves it all three attempts; then each lease that is lost counts."""
    run_id = queue(database)
    for k in range(10):
        ticket = next_of(database)
        assert ticket is not None
        assert ticket.attempt == k + 1
        with database.write() as session:
            TaskRepository(session).release(ticket, b"checkpoint %d" % k)
        task = _task(database, run_id)
        assert (task.state, task.attempt, task.releases) == ("queued", k + 1, k + 1)
    for _ in range(3):
        ticket = next_of(database, lease=-1.0)
        assert ticket is not None
        with database.write() as session:
            session.execute(update(Task).where(Task.run_id == run_id).values(state="queued"))
    assert next_of(database) is None


@pytest.mark.parametrize("last", [None, b"the newest"])
def test_a_checkpoint_at_shutdown_is_kept_or_replaced(database: Database, last: bytes | None) -> None:
    run_id = queue(database)
    ticket = next_of(database)
    assert ticket is not None
    with database.write() as session:
        TaskRepository(session).beat(ticket, 60.0, 0.5, "half", b"older")
        TaskRepository(session).release(ticket, last)
    again = next_of(database)
    assert again is not None
    assert again.run_id == run_id
    with database.read() as session:
        assert TaskRepository(session).job(again).checkpoint == (last or b"older")


def test_a_lease_lost_early_is_forgiven_a_bounded_number_of_times(database: Database) -> None:
    run_id, most = queue(database), 2
    ticket = next_of(database)
    assert ticket is not None
    with database.write() as session:
        session.execute(update(Task).where(Task.run_id == run_id).values(state="queued", attempt=EARLY * most - 1))
        TaskRepository(session).lost_early(ticket, most)
    assert _task(database, run_id).releases == 1
    with database.write() as session:
        session.execute(update(Task).where(Task.run_id == run_id).values(attempt=EARLY * most))
        TaskRepository(session).lost_early(ticket, most)
    assert _task(database, run_id).releases == 1


def _ended(database: Database, days_ago: float, pinned: bool = False) -> str:
    run_id = queue(database)
    with database.write() as session:
        ended = {"state": SUCCEEDED, "finished_at": utc_now() - timedelta(days=days_ago), "pinned": pinned}
        session.execute(update(Run).where(Run.id == run_id).values(**ended))
    return run_id


def _left(database: Database) -> set[str]:
    with database.read() as session:
        return set(session.scalars(select(Run.id)))


def test_retention_takes_what_is_older_and_not_pinned_and_not_at_work(database: Database) -> None:
    kept = {_ended(database, 10.0, pinned=True), _ended(database, 2.9), queue(database)}
    older, oldest = _ended(database, 3.1), _ended(database, 9.0)
    with database.read() as session:
        assert list(QueueRepository(session).outdated(3.0, 10)) == [oldest, older]
        assert list(QueueRepository(session).outdated(3.0, 1)) == [oldest]
    assert retention.sweep(database, 3.0, dry_run=True) == 2
    assert _left(database) == kept | {older, oldest}
    assert retention.sweep(database, 3.0, most=1) == 1
    assert _left(database) == kept | {older}
    assert retention.sweep(database, 3.0) == 1
    assert _left(database) == kept


def test_a_run_pinned_while_the_sweep_goes_on_stays(database: Database) -> None:
    run_id = _ended(database, 10.0)
    with database.write() as session:
        found = QueueRepository(session).outdated(1.0, 5)
        session.execute(update(Run).where(Run.id == run_id).values(pinned=True))
        assert QueueRepository(session).remove(found) == 0
    assert _left(database) == {run_id}


def test_runs_are_listed_newest_first_from_below_the_cursor(database: Database) -> None:
    ids = [queue(database) for _ in range(5)]
    with database.read() as session:
        runs = RunRepository(session, SCOPE)
        newest, older, total = runs.page(2, None), runs.page(2, ids[3]), runs.count(RunFilter())
    assert total == 5
    assert [view.run.id for view in newest + older] == [ids[4], ids[3], ids[2], ids[1]]


def test_accounts_are_listed_newest_first_and_missing_ones_are_said(database: Database) -> None:
    with database.write() as session:
        accounts = AccountRepository(session)
        ids = [accounts.add(f"{k}@example.org", f"P{k}", None, k == 0).id for k in range(3)]
    with database.read() as session:
        accounts = AccountRepository(session)
        known = [one.id for one in accounts.page(10, None) if one.id in ids]
        assert known == ids[::-1]
        assert [one.id for one in accounts.page(1, ids[2])] == [ids[1]]
        assert accounts.get(ids[0]).email == "0@example.org"
        with pytest.raises(NotFoundError):
            accounts.get("nobody")


def test_a_data_set_is_found_by_id_hash_or_newest_of_its_name(database: Database) -> None:
    with database.write() as session:
        sets = DataSetRepository(session, SCOPE)
        one, _ = sets.save("hull", "hull.nc", "a" * 64, b"first", {})
        two, _ = sets.save("hull", "hull.nc", "b" * 64, b"second", {})
        other, _ = sets.save("else", "else.nc", "c" * 64, b"third", {})
        ids = [one.id, two.id, other.id]
    with database.read() as session:
        sets = DataSetRepository(session, SCOPE)
        assert [sets.find(each).id for each in ("hull", "a" * 64, ids[0])] == [ids[1], ids[0], ids[0]]
        assert [sets.payload(each) for each in ids] == [b"first", b"second", b"third"]
        assert [row.id for row in sets.page(10, None)] == ids[::-1]
        assert [row.id for row in sets.page(10, ids[1])] == [ids[0]]
        assert list(sets.names()) == ["else", "hull"]
        for wrong in ("no such", "a\x00b"):
            with pytest.raises(NotFoundError):
                sets.find(wrong)


def test_a_mesh_is_found_by_its_name_and_not_by_what_no_database_stores(database: Database) -> None:
    with database.read() as session:
        meshes = MeshRepository(session, SCOPE)
        for wrong in ("no such", "a\x00b"):
            with pytest.raises(NotFoundError):
                meshes.find(wrong)
        assert list(meshes.page(5, None)) == []


def test_turns_of_one_user_go_on_behind_one_another(database: Database) -> None:
    """Alone in the queue: turns rise by the weights of what was there before."""
    with database.write() as session:
        turns = TurnRepository(session, SCOPE).of([2.0, 3.0, 5.0], "rules", NORMAL)
        later = TurnRepository(session, SCOPE).of([4.0, 1.0], "rules", NORMAL)
    assert turns == [turns[0], turns[0] + 3.0, turns[0] + 8.0]
    assert later == [turns[-1] + 4.0, turns[-1] + 5.0]


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(0.0, 0.0), (-1.0, 0.0), (123.0, 130.0), (120.0, 120.0), (0.0123, 0.013), (9.91, 10.0), (1234567.0, 1300000.0)],
)
def test_estimates_are_rounded_up_to_two_digits(seconds: float, said: float) -> None:
    assert estimate._two_digits(seconds) == pytest.approx(said, rel=1e-9)


def test_an_estimate_counts_what_is_ahead_and_what_is_left(database: Database) -> None:
    """Rate 2 s per unit of weight by what was done; 3 units ahead, 4 of its own, one worker."""
    done, ahead, own = queue(database, weight=5.0), queue(database, weight=3.0), queue(database, weight=4.0)
    with database.write() as session:
        session.execute(update(Task).where(Task.run_id == done).values(state=SUCCEEDED, seconds=10.0))
        session.execute(update(Run).where(Run.id == done).values(state=SUCCEEDED))
    estimate._kept.clear()
    with database.read() as session:
        made = estimate.snapshot(session)
        assert made.rates[None] == pytest.approx(2.0)
        assert made.before == [0.0, 3.0, 7.0]
        assert made.workers == 1
        assert QueueRepository(session).seconds_left() == pytest.approx(14.0)
        assert estimate.snapshot(session) is made
    assert {ahead, own} <= _left(database)
    with database.write() as session:
        for run_id in (ahead, own):
            values = {"state": "running", "heartbeat_at": time.time(), "worker": run_id}
            session.execute(update(Task).where(Task.run_id == run_id).values(**values))
    estimate._kept.clear()
    with database.read() as session:
        assert estimate.snapshot(session).workers == 2
        assert QueueRepository(session).workers() == sorted([ahead, own])


def test_a_study_that_is_not_there_is_said(database: Database) -> None:
    with database.read() as session, pytest.raises(NotFoundError):
        StudyRepository(session, SCOPE).get("none")
