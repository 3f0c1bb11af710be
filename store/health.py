"""Whether the parts of the service work: each checked in a thread of its own, so that one that hangs delays no other.

A check that has given no answer within ANSWER_SECONDS is an answer too. The checks write, since a full disk or a full
broker still answers reads.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sqlalchemy import create_engine, delete
from sqlalchemy.engine import Engine, make_url
from sqlalchemy.orm import Session
from sqlalchemy.pool import NullPool

from . import migrations
from .broker import celery_config
from .database import Database
from .models import Probe
from .settings import Settings

OK, DEGRADED, NOT_READY = "ok", "degraded", "not ready"
ANSWER_SECONDS = 1.5
FRESH_SECONDS = 1.0
"""A result so old is given again instead of checking anew."""
WAIT_FOR_A_LOCK = 1.0
"""SQLite: a check that writes waits so long for others that write, and counts as slow beyond it."""
LEAST_FREE = 200 * 2**20
LIMIT = 300
PROBE_BYTES = 65_536


class SlowError(Exception):
    """It works, but not as it should: degraded."""


@dataclass
class Check:
    """One part. `vital`: without it nothing can be answered; another one's failure only degrades the service."""

    name: str
    probe: Callable[[], None]
    vital: bool = True
    result: str = "not checked yet"
    failed: bool = True
    slow: bool = False
    began_at: float = 0.0
    done_at: float = 0.0
    _running: threading.Event = field(default_factory=threading.Event)

    def start(self) -> None:
        """Begin a check unless one is under way or has just been done."""
        now = time.monotonic()
        if self._running.is_set() or now - self.done_at < FRESH_SECONDS:
            return
        self._running.set()
        self.began_at = now
        threading.Thread(target=self._run, name=f"check-{self.name}", daemon=True).start()

    def _run(self) -> None:
        result, failed, slow = OK, False, False
        try:
            self.probe()
        except SlowError as error:
            result, slow = str(error)[:LIMIT], True
        except Exception as error:  # whatever a driver raises: it is the answer
            result, failed = f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}"[:LIMIT], True
        self.result, self.failed, self.slow = result, failed, slow
        self.done_at = time.monotonic()
        self._running.clear()

    @property
    def pending(self) -> bool:
        return self._running.is_set()

    def answer(self) -> tuple[str, str]:
        """State and text, of a check that is still under way: how long it has been so."""
        waited = time.monotonic() - self.began_at
        if self.pending and waited >= ANSWER_SECONDS:
            return (NOT_READY if self.vital else DEGRADED), f"no answer for {waited:.0f} s"
        if self.failed:
            return (NOT_READY if self.vital else DEGRADED), self.result
        return (DEGRADED if self.slow else OK), self.result


class Health:
    """The checks of one process."""

    def __init__(self, settings: Settings, database: Database):
        self._engine = probe_engine(settings.database)
        writes = lambda: write_row(self._engine)  # noqa: E731
        self.checks = [
            Check("database", lambda: read(self._engine)),
            Check("writes", writes),
            Check("migrations", lambda: schema(database)),
            Check("broker", broker_probe(settings), vital=False),
            Check("disk", lambda: disk(settings.data_dir), vital=False),
        ]

    def start(self) -> None:
        for check in self.checks:
            check.start()

    def pending(self) -> bool:
        """Whether a check is under way that may still answer in time."""
        now = time.monotonic()
        return any(check.pending and now - check.began_at < ANSWER_SECONDS for check in self.checks)

    def report(self) -> tuple[str, dict[str, str]]:
        """The worst state, and a text for each part."""
        answers = {check.name: check.answer() for check in self.checks}
        states = [state for state, _ in answers.values()]
        worst = next((state for state in (NOT_READY, DEGRADED) if state in states), OK)
        return worst, {name: text for name, (_, text) in answers.items()}

    def close(self) -> None:
        self._engine.dispose()


def probe_engine(url: str) -> Engine:
    """Connections apart from those of requests, which give up soon where a server hangs."""
    parsed = make_url(url)
    if parsed.get_backend_name() == "sqlite":
        return create_engine(parsed, poolclass=NullPool, connect_args={"timeout": WAIT_FOR_A_LOCK})
    options = {"connect_timeout": 2, "tcp_user_timeout": 5000, "application_name": "slowdrift health"}
    return create_engine(parsed, poolclass=NullPool, connect_args=options)


def read(engine: Engine) -> None:
    with engine.connect() as connection:
        connection.exec_driver_sql("SELECT 1")


def write_row(engine: Engine) -> None:
    """A row of this check's own, committed."""
    try:
        with Session(engine) as session, session.begin():
            session.execute(delete(Probe).where(Probe.name == "api"))
            session.add(Probe(name="api", written_at=time.time()))
    except Exception as error:
        if "database is locked" in str(error):
            raise SlowError("others have been writing for more than 1 s") from None
        if "UNIQUE" in str(error) or "duplicate key" in str(error):
            return  # another process wrote it at the same moment
        raise


def schema(database: Database) -> None:
    if not migrations.is_current(database):
        raise RuntimeError("the database is not at this version's schema; run slowdrift migrate")


def disk(data_dir: Path) -> None:
    """Files can be written into the data folder and where uploads are kept while they are read."""
    for folder in (data_dir, Path(tempfile.gettempdir())):
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".probe-") as file:
            file.write(bytes(PROBE_BYTES))
            file.flush()
            os.fsync(file.fileno())
        free = shutil.disk_usage(folder).free
        if free < LEAST_FREE:
            raise SlowError(f"{free / 2**20:.0f} MB are free in {folder}; at least {LEAST_FREE // 2**20} MB are wanted")


def broker_probe(settings: Settings) -> Callable[[], None]:
    if settings.broker_url.startswith(("redis", "valkey")):
        return lambda: _write_redis(settings)
    if settings.broker_url:
        return lambda: _publish(settings)
    return lambda: disk(Path(celery_config(settings)["broker_transport_options"]["data_folder_out"]).parent)


def _write_redis(settings: Settings) -> None:
    """A key that goes by itself: a Redis at its memory limit refuses it."""
    from redis import Redis

    seconds = {"socket_connect_timeout": ANSWER_SECONDS, "socket_timeout": ANSWER_SECONDS}
    url = settings.broker_url.replace("valkey", "redis", 1)
    with Redis.from_url(url, **seconds) as client:
        client.set(f"{settings.queue_prefix}:health", "x" * 1000, ex=60)


def _publish(settings: Settings) -> None:
    """A message that the broker confirms: one in a memory or disk alarm does not."""
    from kombu import Connection, Producer, Queue

    options: dict[str, Any] = {"confirm_publish": True}
    arguments = {"x-max-length": 1, "x-expires": 60_000}
    with Connection(settings.broker_url, connect_timeout=ANSWER_SECONDS, transport_options=options) as connection:
        queue = Queue(f"{settings.queue_prefix}-health", durable=False, queue_arguments=arguments)
        producer = Producer(connection.channel())
        producer.publish("x", routing_key=queue.name, declare=[queue], retry=False, timeout=ANSWER_SECONDS)
