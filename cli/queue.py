"""`slowdrift queue`: for whoever runs the service; `--failed` shows dead jobs with their reason."""

from __future__ import annotations

import argparse
import json

from .options import RefusedError, add_data_dir, read_settings, refuse, say


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("queue", help="what waits, what is at work, what failed and why")
    add_data_dir(parser)
    parser.add_argument("--failed", type=int, metavar="N", nargs="?", const=20, help="the last N failed runs (20)")
    parser.add_argument("--json", action="store_true", help="as JSON")
    parser.set_defaults(func=show)


def show(options: argparse.Namespace) -> int:
    from sqlalchemy.exc import SQLAlchemyError

    from store.database import Database

    try:
        database = Database(read_settings(options.data_dir).database)
        found = _failed(database, options.failed) if options.failed else _queue(database)
    except RefusedError as error:
        return refuse(error)
    except SQLAlchemyError as error:
        return refuse(RefusedError(f"the database cannot be read ({type(error).__name__}); is this its data folder?"))
    if options.json:
        say(json.dumps(found, indent=1))
    else:
        for line in found["lines"] if found["lines"] else ["nothing"]:
            say(line)
    return 0


def _queue(database):  # type: ignore[no-untyped-def]
    from store.priority import name_of
    from store.repositories import QueueRepository

    with database.read() as session:
        queues = QueueRepository(session)
        waiting, workers, states = queues.waiting(), queues.workers(), queues.states()
    rows = [vars(each) | {"priority": name_of(each.priority)} for each in waiting]
    lines = [
        f"{row['queue']:<14}{row['priority']:<12}{row['queued']:>8} queued {row['running']:>5} at work"
        + (f"   oldest {row['oldest_seconds']:.0f} s" if row["oldest_seconds"] is not None else "")
        for row in rows
    ]
    lines += [f"{state:<14}{count:>8}" for state, count in sorted(states.items())]
    lines += [f"at work: {name}" for name in workers]
    return {"queues": rows, "runs": states, "workers": workers, "lines": lines}


def _failed(database, most):  # type: ignore[no-untyped-def]
    from store.repositories import QueueRepository

    with database.read() as session:
        rows = QueueRepository(session).failed(most)
    shown: list[dict[str, str]] = [
        {"id": key, "case": name, "finished_at": str(at), "reason": str(reason)} for key, name, at, reason in rows
    ]
    lines = [f"{row['id']}  {row['finished_at'][:19]}  {row['case']}: {row['reason']}" for row in shown]
    return {"failed": shown, "lines": lines}
