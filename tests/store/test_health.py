"""Readiness tells the truth within 2 s, whatever hangs, is full or is away."""

from __future__ import annotations

import contextlib
import errno
import shutil
import socket
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from api.routes.health import readyz
from store import health, migrations
from store.database import Database
from store.health import Check, Health
from store.settings import Settings
from tests.awaiting import awaited
from tests.service.conftest import RABBITMQ, REDIS, need
from tests.service.running import free_port


@contextlib.contextmanager
def health_of(settings: Settings) -> Iterator[Health]:
    database = Database(settings.database)
    if settings.database.startswith("sqlite"):
        migrations.upgrade(database)
    made = Health(settings, database)
    try:
        yield made
    finally:
        made.close()
        database.close()


def ask(checks: Health) -> tuple[str, dict[str, str], int, float]:
    """What GET /readyz answers: state, checks, HTTP status, and the seconds it took."""
    request: Any = SimpleNamespace(app=SimpleNamespace(state=SimpleNamespace(health=checks)))
    response: Any = SimpleNamespace(status_code=0)
    began = time.monotonic()
    answer = awaited(readyz(request, response))
    return answer["status"], answer["checks"], response.status_code, time.monotonic() - began


@contextlib.contextmanager
def hanging_server() -> Iterator[int]:
    """A port that takes connections and never says a word."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        held: list[socket.socket] = []

        def take() -> None:
            with contextlib.suppress(OSError):
                while True:
                    held.append(server.accept()[0])

        threading.Thread(target=take, daemon=True).start()
        yield server.getsockname()[1]
    for one in held:
        one.close()


def test_all_is_well(tmp_path: Path) -> None:
    with health_of(Settings(data_dir=tmp_path)) as checks:
        state, texts, status, _ = ask(checks)
    assert (state, status) == ("ok", 200)
    assert set(texts.values()) == {"ok"}


@pytest.mark.parametrize("url", ["redis://127.0.0.1:{}/0", "amqp://guest:guest@127.0.0.1:{}//"])
def test_a_broker_that_is_away_or_hangs_degrades(tmp_path: Path, url: str) -> None:
    with health_of(Settings(data_dir=tmp_path / "a", broker_url=url.format(free_port()))) as checks:
        assert ask(checks)[::2] == ("degraded", 200)
    with hanging_server() as port, health_of(Settings(data_dir=tmp_path / "b", broker_url=url.format(port))) as checks:
        state, texts, status, seconds = ask(checks)
        assert (state, status) == ("degraded", 200)
        assert texts["broker"] != "ok"
        assert texts["database"] == texts["writes"] == "ok"
        assert seconds < 20  # 1.5 s; a busy machine may take longer


def test_a_database_that_hangs_is_not_ready(tmp_path: Path) -> None:
    with hanging_server() as port:
        settings = Settings(data_dir=tmp_path, database_url=f"postgresql://nobody@127.0.0.1:{port}/none")
        with health_of(settings) as checks:
            for _ in range(3):  # and asking again makes no further threads
                state, texts, status, _ = ask(checks)
            assert (state, status) == ("not ready", 503)
            assert texts["broker"] == texts["disk"] == "ok"
            assert texts["database"] != "ok"
            assert len([one for one in threading.enumerate() if one.name == "check-database"]) == 1


@pytest.mark.services
@pytest.mark.parametrize(("url", "name", "port"), [(REDIS, "Redis", 6379), (RABBITMQ, "RabbitMQ", 5672)])
def test_real_brokers_take_what_the_check_writes(tmp_path: Path, url: str, name: str, port: int) -> None:
    need(name, port)
    prefix = f"sd_health_{tmp_path.parent.name}"[:50]
    with health_of(Settings(data_dir=tmp_path, broker_url=url, queue_prefix=prefix)) as checks:
        assert ask(checks)[1]["broker"] == "ok"


@pytest.mark.services
def test_a_full_redis_degrades(tmp_path: Path) -> None:
    if shutil.which("redis-server") is None:
        pytest.skip("no redis-server to start one that is full")
    port = free_port()
    limits = ["--port", str(port), "--maxmemory", "1", "--maxmemory-policy", "noeviction", "--save", ""]
    server = subprocess.Popen(["redis-server", *limits], stdout=subprocess.DEVNULL, cwd=tmp_path)
    try:
        deadline = time.monotonic() + 20
        with health_of(Settings(data_dir=tmp_path, broker_url=f"redis://127.0.0.1:{port}/0")) as checks:
            while "memory" not in (texts := ask(checks)[1])["broker"] and time.monotonic() < deadline:
                time.sleep(0.3)
            assert "memory" in texts["broker"]  # the server's word: OOM command not allowed
            assert ask(checks)[0] == "degraded"
    finally:
        server.terminate()
        server.wait()


def test_a_full_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with health_of(Settings(data_dir=tmp_path)) as checks:
        monkeypatch.setattr(
            health.shutil, "disk_usage", lambda _: SimpleNamespace(total=10**12, used=10**12, free=5_000_000)
        )
        state, texts, status, _ = ask(checks)
        assert (state, status) == ("degraded", 200)
        assert "5 MB are free" in texts["disk"]

        def full(**_: Any) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(tempfile, "NamedTemporaryFile", full)
        monkeypatch.setattr(health, "FRESH_SECONDS", 0.0)
        state, texts, _, _ = ask(checks)
        assert state == "degraded"
        assert "No space left" in texts["disk"]


def test_a_database_that_takes_no_writes_is_not_ready(tmp_path: Path) -> None:
    """Readable, full: SQLite says so at the first page that it has not got."""
    settings = Settings(data_dir=tmp_path)
    with health_of(settings) as checks:
        engine = checks._engine
        path = tmp_path / "slowdrift.db"
        with engine.connect() as connection:
            connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
        read_only = health.probe_engine(f"sqlite:///file:{path}?mode=ro&uri=true")
        for check in checks.checks:
            if check.name == "writes":
                check.probe = lambda: health.write_row(read_only)
        state, texts, status, _ = ask(checks)
        assert (state, status) == ("not ready", 503)
        assert texts["database"] == "ok"
        assert "readonly" in texts["writes"]


def test_others_that_write_for_long_only_degrade(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(health, "ANSWER_SECONDS", 30.0)
    with health_of(Settings(data_dir=tmp_path)) as checks, checks._engine.connect() as other:
        other.exec_driver_sql("BEGIN IMMEDIATE")
        state, texts, status, _ = ask(checks)
        other.rollback()
    assert (state, status) == ("degraded", 200)
    assert texts["writes"] == "others have been writing for more than 1 s"


def test_a_schema_of_another_version_is_not_ready(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path)
    database = Database(settings.database)
    checks = Health(settings, database)
    state, texts, status, _ = ask(checks)
    assert (state, status) == ("not ready", 503)
    assert "slowdrift migrate" in texts["migrations"]
    checks.close()
    database.close()


def test_a_fresh_result_is_given_again() -> None:
    calls: list[int] = []
    check = Check("one", lambda: calls.append(1))
    for _ in range(20):
        check.start()
        while check.pending:
            time.sleep(0.001)
    assert len(calls) < 20
    assert check.answer() == ("ok", "ok")
