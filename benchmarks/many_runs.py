"""The database at 150 000 runs: `python benchmarks/many_runs.py [--runs 150000] [--explain]`.

Makes a PostgreSQL database as it was before the indexes of migration 0008, fills it with runs of 300 studies that have
ended over a year (and a few that wait and are at work), then measures each query as the service puts it: before the
migration, while it is applied, and after. Times are medians of 15, in milliseconds; `--explain` prints the plans.
Needs the PostgreSQL server of the tests (tests/service/conftest.py).
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
import uuid
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from typing import Any

from sqlalchemy import event, text

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from store import migrations  # noqa: E402
from store.clock import utc_now  # noqa: E402
from store.database import Database  # noqa: E402
from store.estimate import _take  # noqa: E402
from store.filters import RunFilter  # noqa: E402
from store.models import ACTIVE, FINAL  # noqa: E402
from store.repositories import DataSetRepository, QueueRepository, RunRepository  # noqa: E402
from store.scope import Scope  # noqa: E402
from tests.service.conftest import create_database, drop_database  # noqa: E402

BEFORE = "0007"
TIMES = 15
SCOPE = Scope()
FILL = """
INSERT INTO runs (id, project_id, kind, case_version_id, data_set_id, case_name, content_hash, name, tags, pinned,
                  analyses, state, outcomes, warnings, summary, created_at, started_at, finished_at)
SELECT lpad(to_hex(n), 32, '0'), :project, 'case', 'v', 's', 'FPSO ' || n % 300, md5(n::text), 'run ' || md5(n::text),
       CASE WHEN n % 50 = 0 THEN '["basis"]' ELSE '[]' END::json, false, '["statics"]'::json,
       CASE WHEN n > :runs - 200 THEN 'queued' WHEN n > :runs - 204 THEN 'running' WHEN n % 40 = 0 THEN 'failed'
            ELSE 'succeeded' END,
       '{}'::json, '[]'::json, '{"statics": {"converged": true}}',
       now() - (:runs - n) * interval '365 days' / :runs, now() - (:runs - n) * interval '365 days' / :runs,
       CASE WHEN n > :runs - 204 THEN NULL ELSE now() - (:runs - n) * interval '365 days' / :runs END
FROM generate_series(1, :runs) AS n
"""
TASKS = """
INSERT INTO tasks (id, run_id, number, chunk, weight, queue, priority, turn, state, attempt, releases, rung_at, progress,
                   message, seconds, heartbeat_at, lease_until, claimed_at)
SELECT id, id, 0, '{"kind": "frequency"}'::json, 1, 'runs', 20, 0, state, 1, 0, 0, 0.5, '', 1.5,
       extract(epoch FROM now()), extract(epoch FROM now()) + 30, extract(epoch FROM now())
FROM runs
"""


def fill(database: Database, runs: int) -> None:
    moment = utc_now()
    with database.write() as session:
        session.execute(
            text("INSERT INTO cases (id, project_id, name, created_at) VALUES ('c', :project, 'FPSO', :now)"),
            {"project": SCOPE.project_id, "now": moment},
        )
        session.execute(
            text(
                "INSERT INTO case_versions (id, project_id, case_id, number, name, content_hash, canonical, yaml, warnings,"
                " created_at) VALUES ('v', :project, 'c', 1, 'FPSO', 'h', '{}', 'x: 1', '[]', :now)"
            ),
            {"project": SCOPE.project_id, "now": moment},
        )
        session.execute(
            text(
                "INSERT INTO data_sets (id, project_id, name, version, filename, content_hash, size, summary, payload,"
                " created_at) VALUES ('s', :project, 'hull', 1, 'hull.nc', 'h', 1, '{}', '', :now),"
                " ('unused', :project, 'hull', 2, 'hull.nc', 'i', 1, '{}', '', :now)"
            ),
            {"project": SCOPE.project_id, "now": moment},
        )
        session.execute(text(FILL), {"project": SCOPE.project_id, "runs": runs})
        session.execute(text(TASKS))
    with database.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.execute(text("VACUUM ANALYZE"))  # as autovacuum does by itself


def rows(session: Any, **which: Any) -> Any:
    return RunRepository(session, SCOPE).page(50, None, RunFilter(**which))


QUERIES: dict[str, Callable[[Any], Any]] = {
    "list": rows,
    "list, active": lambda session: rows(session, states=("queued", "running", "cancelling")),
    "list, of one starter": lambda session: rows(session, who="0" * 32),
    "total": lambda session: RunRepository(session, SCOPE).count(RunFilter()),
    "search, one hit": lambda session: rows(session, text="run c4ca4238a0b9"),  # md5 of 1: the oldest
    "search, many hits": lambda session: rows(session, text="fpso 17"),
    "search, no hit": lambda session: rows(session, text="semi-submersible"),
    "tag": lambda session: rows(session, tag="basis"),
    "tag that nothing has": lambda session: rows(session, tag="nothing has this"),
    "metrics: active runs": lambda session: QueueRepository(session).states(ACTIVE),
    "metrics: ended runs by state, once a minute": lambda session: QueueRepository(session).states(FINAL),
    "metrics: runs that ended of late": lambda session: QueueRepository(session).ended_since(
        utc_now() - timedelta(minutes=10)
    ),
    "metrics: queues": lambda session: QueueRepository(session).waiting(),
    "rates and queue": _take,
    "retention: what is due": lambda session: QueueRepository(session).outdated(364.0, 1000),
    "data set in use?": lambda session: DataSetRepository(session, SCOPE).delete("unused"),
}


def measure(database: Database) -> dict[str, float]:
    found = {}
    for name, ask in QUERIES.items():
        times = []
        for _ in range(TIMES):
            with database.write() as session:
                began = time.perf_counter()
                ask(session)
                session.flush()
                times.append(1e3 * (time.perf_counter() - began))
                session.rollback()
        found[name] = statistics.median(times)
    return found


def explain(database: Database) -> None:
    """The plan of the statement of each query that takes longest."""
    for name, ask in QUERIES.items():
        asked: list[tuple[str, Any, float]] = []

        def before(_c: Any, _cu: Any, statement: str, parameters: Any, context: Any, _m: Any) -> None:
            context.began = time.perf_counter()

        def after(
            _c: Any, _cu: Any, statement: str, parameters: Any, context: Any, _m: Any, asked: list[Any] = asked
        ) -> None:
            asked.append((statement, parameters, time.perf_counter() - context.began))

        event.listen(database.engine, "before_cursor_execute", before)
        event.listen(database.engine, "after_cursor_execute", after)
        with database.write() as session:
            ask(session)
            session.flush()
            session.rollback()
        event.remove(database.engine, "before_cursor_execute", before)
        event.remove(database.engine, "after_cursor_execute", after)
        statement, parameters, _ = max(asked, key=lambda each: each[2])
        with database.read() as session:
            lines = session.connection().exec_driver_sql(f"EXPLAIN (ANALYZE, COSTS OFF) {statement}", parameters)
            print(f"-- {name}")
            print("\n".join(str(line[0])[:160] for line in lines))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--runs", type=int, default=150_000)
    parser.add_argument("--explain", action="store_true")
    options = parser.parse_args()
    name = f"sd_many_{uuid.uuid4().hex[:10]}"
    database = Database(create_database(name))
    try:
        migrations.upgrade(database, BEFORE)
        fill(database, options.runs)
        with database.write() as session:  # a column of the model: nullable, added in no time
            session.execute(text("ALTER TABLE runs ADD COLUMN figures text"))
        before = measure(database)
        began = time.perf_counter()
        migrations.upgrade(database)
        took = time.perf_counter() - began
        with database.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
            connection.execute(text("ANALYZE"))
        after = measure(database)
        print(f"{options.runs} runs; the migration took {took:.1f} s\n")
        print("| what | before [ms] | after [ms] |\n| --- | ---: | ---: |")
        for each, milliseconds in after.items():
            print(f"| {each} | {before[each]:.1f} | {milliseconds:.1f} |")
        if options.explain:
            explain(database)
    finally:
        database.close()
        drop_database(name)


if __name__ == "__main__":
    main()
