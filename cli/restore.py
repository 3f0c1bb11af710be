"""`slowdrift restore FILE`."""

from __future__ import annotations

import argparse
from pathlib import Path

from .options import RefusedError, add_data_dir, read_settings, refuse, say


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("restore", help="put a saved database back")
    parser.add_argument("file", type=Path, help="made by `slowdrift backup`")
    add_data_dir(parser)
    parser.add_argument("--replace", action="store_true", help="though there is a database: it is lost")
    parser.set_defaults(func=put_back)


def put_back(options: argparse.Namespace) -> int:
    from store.backup import BackupError, restore

    try:
        restore(read_settings(options.data_dir).database, options.file, options.replace)
    except (RefusedError, BackupError) as error:
        return refuse(error)
    say("The database is back, at this version's schema.")
    return 0
