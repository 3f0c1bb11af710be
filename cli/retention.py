"""`slowdrift retention`: the service does the same by itself where SLOWDRIFT_RETENTION_DAYS is set."""

from __future__ import annotations

import argparse

from .options import RefusedError, add_data_dir, read_settings, refuse, say


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("retention", help="delete ended runs older than so many days; pinned ones stay")
    add_data_dir(parser)
    parser.add_argument("--days", type=float, metavar="N", help="older than this (default: the setting)")
    parser.add_argument("--dry-run", action="store_true", help="say how many, delete none")
    parser.set_defaults(func=sweep)


def sweep(options: argparse.Namespace) -> int:
    from store import retention
    from store.database import Database

    try:
        settings = read_settings(options.data_dir)
        days = settings.retention_days if options.days is None else options.days
        if not days > 0:
            raise RefusedError("say how old with --days, or set SLOWDRIFT_RETENTION_DAYS; more than 0")
    except RefusedError as error:
        return refuse(error)
    count = retention.sweep(Database(settings.database), days, options.dry_run)
    say(f"{count} ended run(s) older than {days:g} days {'would be deleted' if options.dry_run else 'deleted'}.")
    return 0
