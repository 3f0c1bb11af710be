"""`slowdrift worker`: one Celery worker."""

from __future__ import annotations

import argparse
import os

from store.settings import Settings

from .lifeline import Pulse, hold_on
from .options import RefusedError, add_data_dir, read_settings, refuse


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("worker", help="start one worker")
    parser.add_argument(
        "--queue", choices=("runs", "interactive", "hydrodynamics"), default="runs", help="default: %(default)s"
    )
    parser.add_argument("--concurrency", type=int, default=1, metavar="N", help="tasks at a time (default: 1)")
    add_data_dir(parser)
    parser.add_argument(
        "--check", action="store_true", help="start nothing; status 0 if database and broker can be reached"
    )
    parser.set_defaults(func=work)


def work(options: argparse.Namespace) -> int:
    try:
        settings = read_settings(options.data_dir)
    except RefusedError as error:
        return refuse(error)
    if options.check:
        return check(settings)
    os.environ.update(settings.as_env())  # the Celery app reads them when it is imported
    hold_on()
    Pulse().keep_beating()
    from worker.main import run_worker

    run_worker(options.queue, max(1, options.concurrency))
    return 0


def check(settings: Settings) -> int:
    """For a container's health check."""
    from sqlalchemy.exc import SQLAlchemyError

    from store import migrations
    from store.database import Database
    from store.doorbell import Doorbell

    database = Database(settings.database)
    try:
        database.ping()
    except SQLAlchemyError as error:
        return refuse(RefusedError(f"the database cannot be reached ({type(error).__name__})"))
    reason = Doorbell(settings).reachable()
    if reason is not None:
        return refuse(RefusedError(f"the broker cannot be reached ({reason})"))
    if not migrations.is_current(database):
        return refuse(RefusedError("the database is not at this version's schema; run slowdrift migrate"))
    return 0
