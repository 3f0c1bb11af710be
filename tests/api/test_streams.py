"""Event streams: one look at the database serves all who listen; how many may listen."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import pytest
from sqlalchemy import event

from api.services import runs as service
from api.streams import Streams, caller_of
from api.watcher import Listener, Watcher, event_of
from solver.results.part import Chunk
from store.database import Database
from store.errors import QuotaError, UnavailableError
from store.models import Project
from store.people import User
from store.repositories import CaseRepository, RunRepository, TaskRepository
from store.repositories.accounts import AccountRepository
from store.repositories.cases import NewCase
from store.scope import Scope
from store.settings import Settings
from tests.awaiting import awaited

HERE = Scope()


def queued(database: Database, scope: Scope = HERE) -> str:
    with database.write() as session:
        version, _ = CaseRepository(session, scope).save(NewCase("a case", "h" * 64, "{}", "x: 1"))
        return RunRepository(session, scope).create(version, ["statics"], [Chunk("whole", None, 1.0)])[0].id


def shown(database: Database, run_id: str, scope: Scope = HERE) -> bytes:
    with database.read() as session:
        return event_of(service.info(RunRepository(session, scope).view(run_id)).model_dump_json())


def change(database: Database, run_id: str, do: Callable[[RunRepository], None]) -> None:
    with database.write() as session:
        do(RunRepository(session, HERE))
    assert run_id


def rename(database: Database, run_id: str, name: str) -> None:
    change(database, run_id, lambda runs: runs.label(run_id, name, None, None))


def runs_in(events: bytes) -> list[dict[str, Any]]:
    return [json.loads(line.removeprefix("data: ")) for line in events.decode().splitlines() if line.startswith("data")]


async def until(listener: Listener, true: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """The first run that is so; what comes before is passed over."""
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        for run in runs_in(await listener.take(1.0) or b""):
            if true(run):
                return run
    raise AssertionError("no such event")


def test_a_run_is_followed_to_its_end(database: Database) -> None:
    run_id = queued(database)

    async def follow() -> None:
        watcher = Watcher(database)
        with watcher.run(HERE, run_id, shown(database, run_id)) as listener:
            await asyncio.to_thread(rename, database, run_id, "new")
            first = await until(listener, lambda run: True)
            assert first["name"] == "new"  # what it was told at first is not told again
            with database.write() as session:
                assert TaskRepository(session).claim_next("runs", "one", 60.0, 3)
            assert (await until(listener, lambda run: run["state"] == "running"))["attempt"] == 1
            await asyncio.to_thread(change, database, run_id, lambda runs: runs.cancel(run_id))
            await until(listener, lambda run: run["state"] == "cancelling")
            assert not listener.ended
            with database.write() as session:
                ticket = _held(session)
                TaskRepository(session).give_up(ticket)
            await until(listener, lambda run: run["state"] == "cancelled")
            assert listener.ended
        assert watcher._task is None  # nobody listens, nobody looks

    awaited(follow())


def _held(session: Any) -> Any:
    from store.models import Task
    from store.repositories.tasks import Ticket

    task = session.query(Task).filter_by(state="running").one()
    return Ticket(task.id, task.run_id, task.attempt)


def test_a_project_is_followed(database: Database) -> None:
    before = queued(database)

    async def follow() -> None:
        watcher = Watcher(database)
        with watcher.project(HERE) as one:
            assert runs_in(await one.take(20.0) or b"")[0]["id"] == before
            later = await asyncio.to_thread(queued, database)
            await until(one, lambda run: run["id"] == later)
            with watcher.project(HERE) as two:  # hears what the other knows, without a look of its own
                assert {run["id"] for run in runs_in(await two.take(0.0) or b"")} == {before, later}
                await asyncio.to_thread(change, database, before, lambda runs: runs.cancel(before))
                for each in (one, two):
                    assert (await until(each, lambda run: run["id"] == before))["state"] == "cancelled"
                await asyncio.to_thread(change, database, before, lambda runs: runs.delete(before))
                await asyncio.to_thread(rename, database, later, "still followed")
                await until(one, lambda run: run["name"] == "still followed")

    awaited(follow())


def test_projects_do_not_mix(database: Database) -> None:
    with database.write() as session:
        session.add(Project(id="p" * 32, team_id=HERE.team_id, name="other"))
    other = Scope(HERE.team_id, "p" * 32)
    mine, theirs = queued(database), queued(database, other)

    async def follow() -> None:
        watcher = Watcher(database)
        with watcher.project(HERE) as one, watcher.project(other) as two:
            assert [run["id"] for run in runs_in(await one.take(20.0) or b"")] == [mine]
            assert [run["id"] for run in runs_in(await two.take(20.0) or b"")] == [theirs]

    awaited(follow())


def test_nobody_is_named_behind_a_link(database: Database) -> None:
    with database.write() as session:
        user: User = AccountRepository(session).add("ada@example.org", "Ada", "no password", False)
    run_id = queued(database, Scope(user_id=user.id))
    linked = Scope(run_ids=(run_id,))

    async def follow() -> None:
        watcher = Watcher(database)
        with watcher.run(HERE, run_id, b"") as member, watcher.run(linked, run_id, b"") as stranger:
            assert (await until(member, lambda run: True))["created_by"] == "Ada"
            assert (await until(stranger, lambda run: True))["created_by"] is None

    awaited(follow())


def test_a_deleted_run_ends_its_streams(database: Database) -> None:
    run_id = queued(database)
    change(database, run_id, lambda runs: runs.cancel(run_id))

    async def follow() -> None:
        watcher = Watcher(database)
        with watcher.run(HERE, "nobody", b"") as listener:
            assert await listener.take(20.0) is None
            assert listener.ended

    awaited(follow())


def test_many_listeners_cost_what_one_costs(database: Database) -> None:
    run_ids = [queued(database) for _ in range(20)]

    def statements(listeners: int) -> float:
        """Statements of one look."""
        asked: list[str] = []

        async def follow() -> None:
            watcher = Watcher(database)
            with ExitStack() as stack:
                first = stack.enter_context(watcher.project(HERE))
                for number in range(listeners):
                    run_id = run_ids[number % len(run_ids)]
                    stack.enter_context(watcher.run(HERE, run_id, b""))
                    stack.enter_context(watcher.project(HERE))
                await first.take(20.0)
                number = watcher._number
                event.listen(database.engine, "before_cursor_execute", lambda *a: asked.append(a[2]))
                while watcher._number < number + 5:
                    await asyncio.sleep(0.05)

        awaited(follow())
        return len(asked) / 5

    assert statements(1000) < 2 * statements(1)


def test_a_slow_listener_gets_the_newest() -> None:
    async def listen() -> None:
        listener = Listener()
        for number in range(1000):
            listener.offer({"a": b"a%d" % number, "b": b"b"})
        assert await listener.take(1.0) == b"a999b"
        assert await listener.take(0.01) is None

    awaited(listen())


def test_the_database_may_go_and_come_back(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    from api import watcher as module

    monkeypatch.setattr(module, "LONGEST", 0.05)
    run_id = queued(database)
    calls, look = [0], module._look

    def failing(*arguments: Any) -> Any:
        calls[0] += 1
        if calls[0] < 3:
            raise OSError("gone")
        return look(*arguments)

    monkeypatch.setattr(module, "_look", failing)

    async def follow() -> None:
        with Watcher(database).run(HERE, run_id, b"") as listener:
            await until(listener, lambda run: run["id"] == run_id)

    awaited(follow())


# -- limits


def settings(**values: Any) -> Settings:
    return Settings.model_validate(values)


def test_limits_of_a_caller_a_team_and_the_process() -> None:
    streams = Streams(settings(max_streams=6, max_streams_per_caller=2, quota_streams=3))
    with ExitStack() as stack:
        for caller in ("ada", "ada"):
            stack.enter_context(streams.place(caller, "team"))
        with pytest.raises(QuotaError, match=r"2 event streams open of at most 2.*SLOWDRIFT_MAX_STREAMS_PER_CALLER"):
            stack.enter_context(streams.place("ada", "team"))
        stack.enter_context(streams.place("bob", "team"))
        with pytest.raises(QuotaError, match=r"3 event streams of at most 3.*SLOWDRIFT_QUOTA_STREAMS"):
            stack.enter_context(streams.place("eve", "team"))
        for _ in range(3):
            stack.enter_context(streams.place(None, None))
        with pytest.raises(UnavailableError, match=r"6 event streams.*SLOWDRIFT_MAX_STREAMS"):
            stack.enter_context(streams.place(None, None))
        assert (streams.open, streams.of_team("team"), streams.refused) == (6, 3, 3)
    assert (streams.open, streams.of_team("team")) == (0, 0)
    with streams.place("ada", "team"):
        assert streams.open == 1


def test_streams_leave_half_of_the_connections() -> None:
    assert Streams(settings(max_streams=2500, max_connections=1000)).most == 500


def test_whose_streams_are_counted_together() -> None:
    from api.access import Principal

    user = User(id="u", email="a@x.org", name="A", password_hash="")
    assert caller_of(Principal("local", "this machine"), "127.0.0.1") is None
    for kind in ("key", "session"):
        assert caller_of(Principal(kind, "a", user, "c"), "10.0.0.1") == "user u"
    assert caller_of(None, "10.0.0.1") == "address 10.0.0.1"
