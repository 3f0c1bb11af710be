"""`slowdrift backup FILE`."""

from __future__ import annotations

import argparse
from pathlib import Path

from .options import RefusedError, add_data_dir, read_settings, refuse, say


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("backup", help="save the database into one file, while the service runs")
    parser.add_argument("file", type=Path, help="a new file")
    add_data_dir(parser)
    parser.set_defaults(func=save)


def save(options: argparse.Namespace) -> int:
    from store.backup import BackupError, backup

    try:
        size = backup(read_settings(options.data_dir).database, options.file)
    except (RefusedError, BackupError) as error:
        return refuse(error)
    say(f"{options.file}: {size / 1e6:.1f} MB")
    return 0
