"""The database in one file, taken while the service runs, and put back.

SQLite: its own online copy. PostgreSQL: pg_dump and pg_restore of the server's version. Both hold everything: cases,
data sets, runs with their results, accounts. A task that was at work when the copy was taken is done again after it is
put back, since its lease is over by then.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import sqlite3
import subprocess
from pathlib import Path
from typing import Any

from sqlalchemy.engine import URL, make_url

from solver.outcome import SlowdriftError

from .database import Database
from .migrations import is_current, upgrade

SQLITE_MAGIC, POSTGRES_MAGIC = b"SQLite format 3\0", b"PGDMP"


class BackupError(SlowdriftError):
    """The copy cannot be made or put back; nothing was changed."""


def backup(url: str, target: Path) -> int:
    """Write the copy, complete or not at all; gives its size in bytes."""
    if target.exists():
        raise BackupError(f"{target} is there already; give a new name, or remove it.")
    part = target.with_name(target.name + ".part")
    part.unlink(missing_ok=True)
    try:
        if make_url(url).get_backend_name() == "sqlite":
            _copy_sqlite(_sqlite_path(url), part)
        else:
            _run("pg_dump", ["--format=custom", "--no-owner", f"--file={part}"], make_url(url))
        with part.open("rb") as file:
            os.fsync(file.fileno())
        part.replace(target)
    except OSError as error:
        raise BackupError(f"{target} cannot be written: {error.strerror}") from None
    finally:
        part.unlink(missing_ok=True)
    return target.stat().st_size


def restore(url: str, source: Path, replace: bool = False) -> None:
    """Put a copy into the place of the database, then bring it to this version's schema. The service must not run.

    Raises BackupError, before anything is changed, where the copy is not one, or there is a database and not `replace`.
    """
    try:
        with source.open("rb") as file:
            start = file.read(16)
    except OSError as error:
        raise BackupError(f"{source} cannot be read: {error.strerror}") from None
    sqlite = make_url(url).get_backend_name() == "sqlite"
    if not start.startswith(SQLITE_MAGIC if sqlite else POSTGRES_MAGIC):
        kind = "SQLite" if sqlite else "PostgreSQL"
        raise BackupError(f"{source} is no copy of a {kind} database made by `slowdrift backup`.")
    if not replace and _holds_rows(url):
        raise BackupError("There is a database here already; stop the service, then say --replace to lose it.")
    if sqlite:
        _put_sqlite(source, _sqlite_path(url))
    else:
        options = ["--clean", "--if-exists", "--no-owner", "--single-transaction", "--exit-on-error"]
        _run("pg_restore", [*options, f"--dbname={make_url(url).database}", str(source)], make_url(url))
    database = Database(url)
    try:
        upgrade(database)
    finally:
        database.close()


def _sqlite_path(url: str) -> Path:
    path = make_url(url).database
    if not path or path == ":memory:":
        raise BackupError("A database in memory has no file.")
    return Path(path)


def _copy_sqlite(source: Path, target: Path) -> None:
    if not source.is_file():
        raise BackupError(f"There is no database at {source}.")
    with contextlib.closing(sqlite3.connect(source)) as old, contextlib.closing(sqlite3.connect(target)) as new:
        try:
            old.backup(new, pages=1024)
            answer = new.execute("PRAGMA integrity_check").fetchone()[0]
        except sqlite3.Error as error:
            raise BackupError(f"The database could not be copied: {error}") from None
    if answer != "ok":
        raise BackupError(f"The database is damaged: {answer}")


def _put_sqlite(source: Path, target: Path) -> None:
    """Checked beside its place, then put there by a rename; the log of the old one goes with it."""
    fresh = target.with_name(target.name + ".new")
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        shutil.copyfile(source, fresh)
        with contextlib.closing(sqlite3.connect(fresh)) as copy:
            if copy.execute("PRAGMA integrity_check").fetchone()[0] != "ok":
                raise BackupError(f"{source} is damaged.")
            copy.execute("SELECT version_num FROM alembic_version")
        for ending in ("-wal", "-shm"):
            target.with_name(target.name + ending).unlink(missing_ok=True)
            fresh.with_name(fresh.name + ending).unlink(missing_ok=True)
        fresh.replace(target)
    except sqlite3.Error as error:
        raise BackupError(f"{source} is damaged or not ours: {error}") from None
    except OSError as error:
        raise BackupError(f"{target} cannot be written: {error.strerror}") from None
    finally:
        fresh.unlink(missing_ok=True)


def _holds_rows(url: str) -> bool:
    if make_url(url).get_backend_name() == "sqlite":
        return _sqlite_path(url).is_file()
    database = Database(url)
    try:
        return is_current(database)
    finally:
        database.close()


def _run(program: str, arguments: list[str], url: URL) -> None:
    """A PostgreSQL program with the connection in its environment, so that no password stands in a list of processes."""
    environment: dict[str, Any] = {
        "PGHOST": url.host, "PGPORT": url.port, "PGUSER": url.username, "PGPASSWORD": url.password,
        "PGDATABASE": url.database,
    }  # fmt: skip
    known = {name: str(value) for name, value in environment.items() if value}
    try:
        done = subprocess.run(
            [program, *arguments], env=os.environ | known, capture_output=True, text=True, check=False
        )
    except FileNotFoundError:
        raise BackupError(f"{program} is not installed here; it comes with PostgreSQL's client programs.") from None
    if done.returncode:
        raise BackupError(f"{program} failed: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else '?'}")
