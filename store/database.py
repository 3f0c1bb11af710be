"""Engine and units of work: SQLite (embedded) or PostgreSQL behind the same door."""

from __future__ import annotations

import contextlib
import json
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pydantic_core import from_json
from sqlalchemy import Connection, Engine, create_engine, event, text
from sqlalchemy.engine import make_url
from sqlalchemy.exc import DisconnectionError
from sqlalchemy.orm import Session, sessionmaker

BUSY_SECONDS = 30
IDLE_SECONDS = 0.25
"""A connection that was used so short a time ago is not asked whether it still lives: no server starts again sooner."""
_WRITE = "slowdrift_write"


class Database:
    """Opens sessions. One session is one unit of work: committed at its end, rolled back on any error."""

    def __init__(self, url: str):
        self.url = url
        self.engine = make_engine(url)
        self._sessions = sessionmaker(self.engine, expire_on_commit=False)
        apart = self.engine.dialect.name != "sqlite"
        single = self.engine.execution_options(isolation_level="AUTOCOMMIT") if apart else self.engine
        still = self.engine.execution_options(isolation_level="REPEATABLE READ") if apart else self.engine
        self._reading = sessionmaker(single, autoflush=False)  # never writes, whatever is done to what was read
        self._looking = sessionmaker(still, autoflush=False)

    @contextmanager
    def write(self) -> Iterator[Session]:
        """A unit of work that may change rows. SQLite takes its write lock at the start, so it never has to upgrade."""
        with self._sessions() as session, session.begin():
            session.connection(execution_options={_WRITE: True})
            yield session

    @contextmanager
    def read(self) -> Iterator[Session]:
        """A unit of work that only looks. On PostgreSQL each of its statements sees what is committed by then: a
        transaction would cost two more journeys to the server, and show the same."""
        with self._reading() as session:
            yield session

    @contextmanager
    def snapshot(self) -> Iterator[Session]:
        """A unit of work that looks at one moment, however many statements it takes; rows can be streamed."""
        with self._looking() as session:
            yield session

    def ping(self) -> None:
        """Raises SQLAlchemyError where the database cannot be reached."""
        with self.read() as session:
            session.execute(text("SELECT 1"))

    def close(self) -> None:
        self.engine.dispose()


def make_engine(url: str) -> Engine:
    parsed = make_url(url)
    if parsed.get_backend_name() == "sqlite":
        engine = create_engine(parsed, connect_args={"timeout": BUSY_SECONDS}, json_deserializer=from_text)
        if parsed.database and parsed.database != ":memory:":
            path = Path(parsed.database)
            path.parent.mkdir(parents=True, exist_ok=True)
            event.listen(engine, "do_connect", lambda *_: _private(path))
        event.listen(engine, "connect", _sqlite_connect)
        event.listen(engine, "begin", _sqlite_begin)
        return engine
    engine = create_engine(
        parsed, pool_size=10, max_overflow=30, connect_args={"connect_timeout": 5}, json_deserializer=from_text
    )
    _ask_idle(engine)
    return engine


def _private(path: Path) -> None:
    """Have the file there, for its owner alone: SQLite gives the files beside it (-wal, -shm) the same permissions."""
    with contextlib.suppress(FileExistsError):
        os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o600))
        return
    for each in (path, path.with_name(f"{path.name}-wal"), path.with_name(f"{path.name}-shm")):
        with contextlib.suppress(OSError):  # another user's, or a file system without permissions
            if each.stat().st_mode & 0o077:
                each.chmod(0o600)


def from_text(text: str | bytes) -> Any:
    """In a third of the standard library's time, which still takes what this one does not (half a surrogate pair)."""
    try:
        return from_json(text)
    except ValueError:
        return json.loads(text)


def _ask_idle(engine: Engine) -> None:
    """A connection that has lain idle is asked whether it lives before it is used, and made anew if not."""

    def used(_: Any, record: Any) -> None:
        record.info["used_at"] = time.monotonic()

    def ask(connection: Any, record: Any, _: Any) -> None:
        if time.monotonic() - record.info.get("used_at", 0.0) < IDLE_SECONDS:
            return
        try:
            engine.dialect.do_ping(connection)
        except engine.dialect.loaded_dbapi.Error as error:
            raise DisconnectionError(str(error)) from error

    event.listen(engine, "connect", used)
    event.listen(engine, "checkin", used)
    event.listen(engine, "checkout", ask)


def _sqlite_connect(connection: Any, _record: Any) -> None:
    connection.isolation_level = None  # the driver starts no transactions of its own: `_sqlite_begin` does
    for pragma in ("journal_mode=WAL", "synchronous=NORMAL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {pragma}")


def _sqlite_begin(connection: Connection) -> None:
    write = connection.get_execution_options().get(_WRITE, False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if write else "BEGIN")
