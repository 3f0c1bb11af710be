"""Services for tests: databases and brokers of their own on a real PostgreSQL, Redis and RabbitMQ, or none at all."""

from __future__ import annotations

import os
import shutil
import socket
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text

from store import migrations
from store.database import Database
from store.settings import Settings

POSTGRES = os.environ.get("SLOWDRIFT_TEST_POSTGRES", "postgresql+psycopg://postgres@127.0.0.1:5432/test")
REDIS = os.environ.get("SLOWDRIFT_TEST_REDIS", "redis://127.0.0.1:6379/0")
RABBITMQ = os.environ.get("SLOWDRIFT_TEST_RABBITMQ", "amqp://guest:guest@127.0.0.1:5672//")
KINDS = ("embedded", "postgres-redis", "postgres-rabbitmq")


def _answers(host: str, port: int) -> bool:
    try:
        socket.create_connection((host, port), 1).close()
    except OSError:
        return False
    return True


def need(name: str, port: int) -> None:
    """Skip, saying so, where the server is missing; fail where SLOWDRIFT_REQUIRE_SERVICES is set."""
    if not _answers("127.0.0.1", port):
        message = f"no {name} on 127.0.0.1:{port}"
        if os.environ.get("SLOWDRIFT_REQUIRE_SERVICES") == "1":
            pytest.fail(message)
        pytest.skip(message)


@dataclass(frozen=True)
class Place:
    """Where one test's service keeps its rows and messages."""

    kind: str
    settings: Settings


def create_database(name: str) -> str:
    engine = create_engine(POSTGRES, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.execute(text(f'CREATE DATABASE "{name}"'))
    engine.dispose()
    return POSTGRES.rpartition("/")[0] + "/" + name


def drop_database(name: str) -> None:
    engine = create_engine(POSTGRES, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.execute(text(f'DROP DATABASE IF EXISTS "{name}" WITH (FORCE)'))
    engine.dispose()


def _forget_messages(settings: Settings) -> None:
    from kombu import Connection

    from store.broker import INTERACTIVE, RUNS, queue_name

    with Connection(settings.broker_url) as connection:
        channel = connection.default_channel
        if settings.broker_url.startswith("redis"):
            for key in channel.client.scan_iter(f"{settings.queue_prefix}:*"):
                channel.client.delete(key)
            return
        for queue in (RUNS, INTERACTIVE):
            channel.queue_delete(queue_name(settings, queue))


@pytest.fixture
def make_place(tmp_path: Path) -> Iterator[Callable[..., Place]]:
    made: list[tuple[str, Settings]] = []

    def make(kind: str, **values: object) -> Place:
        name = f"sd_test_{uuid.uuid4().hex[:12]}"
        given: dict[str, object] = {
            "data_dir": tmp_path / "data",
            "queue_prefix": name,
            "solver": "tests.service.fake_solver",
            "lease_seconds": 3,
            "heartbeat_seconds": 0.3,
            "reconcile_seconds": 0.5,
            "stale_seconds": 2,
            "checkpoint_seconds": 0.2,
        }
        if kind != "embedded":
            need("PostgreSQL", 5432)
            need(*(("Redis", 6379) if kind == "postgres-redis" else ("RabbitMQ", 5672)))
            given["database_url"] = create_database(name)
            given["broker_url"] = REDIS if kind == "postgres-redis" else RABBITMQ
        settings = Settings.model_validate(given | values)
        made.append((name, settings))
        database = Database(settings.database)
        migrations.upgrade(database)
        database.close()
        return Place(kind, settings)

    yield make
    for name, settings in made:
        if settings.database_url:
            drop_database(name)
        if settings.broker_url:
            _forget_messages(settings)
    shutil.rmtree(tmp_path / "data", ignore_errors=True)
