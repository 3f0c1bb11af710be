"""`slowdrift migrate`: the database's schema, and the bundled data sets."""

from __future__ import annotations

import argparse

from .options import RefusedError, add_data_dir, read_settings, refuse, say


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("migrate", help="bring the database to this version's schema")
    add_data_dir(parser)
    parser.set_defaults(func=migrate)


def migrate(options: argparse.Namespace) -> int:
    from store.bundled import register_bundled
    from store.database import Database
    from store.migrations import upgrade

    try:
        database = Database(read_settings(options.data_dir).database)
    except RefusedError as error:
        return refuse(error)
    upgrade(database)
    added = register_bundled(database)
    say("The database is at this version's schema." + (f" Added: {', '.join(added)}." if added else ""))
    return 0
