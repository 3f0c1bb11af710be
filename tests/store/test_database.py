"""What a unit of work sees, and what becomes of connections that died while nobody used them."""

from __future__ import annotations

import contextlib
import time
import uuid
from pathlib import Path

import pytest
from sqlalchemy import create_engine, event, select, text

from store import migrations
from store.database import IDLE_SECONDS, Database
from store.models import DataSet, Team
from store.repositories import DataSetRepository, RunRepository, TaskRepository
from store.scope import Scope
from store.sources import PinnedSource

from .test_isolation import BARGE
from .test_lifecycle import make, taken

__all__ = ["make"]
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
on_sqlite = pytest.mark.parametrize("empty", ["sqlite"], indirect=True)
on_postgresql = pytest.mark.parametrize(
    "empty", [pytest.param("postgresql", marks=pytest.mark.services)], indirect=True
)


def add_team(database: Database, name: str) -> None:
    with database.write() as session:
        session.add(Team(name=name))


def count_teams(session) -> int:  # type: ignore[no-untyped-def]
    return int(session.execute(text("SELECT count(*) FROM teams")).scalar_one())


def test_a_snapshot_stays_at_one_moment(database: Database) -> None:
    with database.snapshot() as session:
        before = count_teams(session)
        add_team(database, "meanwhile")
        assert count_teams(session) == before
    with database.read() as session:
        assert count_teams(session) == before + 1


def test_a_snapshot_streams_rows(database: Database) -> None:
    names = [f"team {number}" for number in range(7)]
    for name in names:
        add_team(database, name)
    with database.snapshot() as session:
        rows = session.scalars(select(Team.name).order_by(Team.created_at).execution_options(yield_per=2))
        assert [name for name in rows if name in names] == names


@on_postgresql
def test_a_read_leaves_no_transaction_behind(database: Database) -> None:
    """On PostgreSQL it never opens one, so that a long read holds up nothing."""
    with database.read() as session:
        before = count_teams(session)
        add_team(database, "meanwhile")
        assert count_teams(session) == before + 1


def test_a_unit_of_work_after_a_read_is_a_transaction_again(database: Database) -> None:
    """Both take their connection out of one pool."""
    for _ in range(3):
        with database.read() as session:
            before = count_teams(session)
        with contextlib.suppress(RuntimeError), database.write() as session:
            session.add(Team(name="never"))
            session.flush()
            raise RuntimeError("on purpose")
        with database.read() as session:
            assert count_teams(session) == before


@on_postgresql
def test_connections_that_died_idle_are_made_anew(database: Database) -> None:
    with database.read() as one, database.read() as other:
        before = count_teams(one)
        assert count_teams(other) == before
    killer = create_engine(database.url, isolation_level="AUTOCOMMIT")
    with killer.connect() as connection:
        mine = "datname = current_database() AND pid <> pg_backend_pid()"
        ended = connection.execute(text(f"SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE {mine}"))
        assert ended.scalars().all() == [True, True]
    killer.dispose()
    time.sleep(IDLE_SECONDS + 0.1)
    with database.read() as one, database.write() as other:
        assert count_teams(one) == count_teams(other) == before


def kept(database: Database, run_id: str, value: object) -> object:
    with database.write() as session:
        RunRepository(session, Scope()).get(run_id).overrides = {"/x": value}
    with database.read() as session:
        return (RunRepository(session, Scope()).get(run_id).overrides or {})["/x"]


@pytest.mark.parametrize("value", [1.5, 2**70, "Ω\n", {"a": [None, True]}])
def test_json_comes_back_as_it_was(database: Database, make, value) -> None:  # type: ignore[no-untyped-def]
    assert kept(database, make()[0], value) == value


@on_sqlite
def test_json_that_only_the_standard_library_takes_comes_back(database: Database, make) -> None:  # type: ignore[no-untyped-def]
    assert kept(database, make()[0], "half a pair: \ud83d") == "half a pair: \ud83d"


def test_the_clock_of_a_statement_made_once_goes_on(database: Database, make) -> None:  # type: ignore[no-untyped-def]
    """The estimate of the time left: half done, so as much is left as was spent by the database's clock."""
    run_id, tasks = make()
    began = time.monotonic()
    ticket = taken(database, tasks[0])
    with database.write() as session:
        assert TaskRepository(session).beat(ticket, 60.0, 0.5, "half") is not None

    def left() -> float:
        with database.read() as session:
            found = RunRepository(session, Scope()).view(run_id).seconds_left
        assert found is not None
        return found

    time.sleep(0.2)
    first = left()
    time.sleep(0.6)
    assert 0.2 <= first < 0.4 + (time.monotonic() - began - 0.6)
    assert left() >= first + 0.5


def test_the_files_are_their_owners_alone(tmp_path: Path) -> None:
    path = tmp_path / "new" / "slowdrift.db"
    database = Database(f"sqlite:///{path}")
    migrations.upgrade(database)
    with database.write() as session:
        session.execute(text("CREATE TABLE something (x INTEGER)"))
    files = sorted(path.parent.glob("slowdrift.db*"))
    assert len(files) >= 2  # and the write-ahead log
    assert {file.stat().st_mode & 0o777 for file in files} == {0o600}
    database.close()
    path.chmod(0o644)  # one that an older version made
    database = Database(f"sqlite:///{path}")
    database.ping()
    database.close()
    assert path.stat().st_mode & 0o777 == 0o600


def test_a_set_that_was_read_is_not_fetched_again(database: Database) -> None:
    """Of 1 600 runs with a set of 50 MB each would fetch it anew."""
    payload, scope = BARGE.read_bytes(), Scope()
    asked: list[str] = []
    event.listen(database.engine, "before_cursor_execute", lambda *given: asked.append(given[2]))
    with database.write() as session:
        row, _ = DataSetRepository(session, scope).save("barge", "barge.nc", 2 * uuid.uuid4().hex, payload, {})
    for stated, fetched in ((False, 1), (False, 0), (True, 1)):
        asked.clear()
        with database.read() as session:
            source = PinnedSource(session.get(DataSet, row.id), stated=stated)
        assert source.open("barge").nbytes > 0
        assert sum("payload" in statement for statement in asked) == fetched


def test_a_case_that_states_no_conventions_is_known_by_its_text() -> None:
    from solver.case import load_case
    from store.repositories.tasks import STATED

    text = (EXAMPLES / "fpso-2000m.yaml").read_text()
    assert STATED not in load_case(text).canonical()
