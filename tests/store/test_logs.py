"""Logs stay of bounded size: repeated messages are counted, files are rotated."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from cli.log_files import LogFile
from store.logs import Throttle


def record(text: str, level: int = logging.ERROR, *arguments: object) -> logging.LogRecord:
    return logging.LogRecord("asyncio", level, "", 0, text, arguments, None)


def test_repeated_messages_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("store.logs.time.monotonic", lambda: now[0])
    throttle = Throttle(most=3, seconds=60)
    passed = [throttle.filter(record("no file %d", logging.ERROR, k)) for k in range(1000)]
    assert passed == [True] * 3 + [False] * 997
    assert throttle.filter(record("something else"))
    assert throttle.filter(record("no file %d", logging.WARNING, 1))  # another level is another kind
    now[0] += 61
    again = record("no file %d", logging.ERROR, 5)
    assert throttle.filter(again)
    assert again.getMessage() == "no file 5 (997 more like this were left out)"
    assert [throttle.filter(record("no file %d", logging.ERROR, 6)) for _ in range(4)] == [True, True, False, False]


def test_many_kinds_take_bounded_memory() -> None:
    throttle = Throttle(most=1)
    assert all(throttle.filter(record(f"text {k}")) for k in range(5000))
    assert len(throttle._seen) <= 1001


def test_log_files_are_rotated(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "logs" / "api.log", most=1000, kept=2)
    for k in range(100):
        log.write(f"line {k:04d}".encode().ljust(99, b".") + b"\n")
    files = sorted(path.name for path in (tmp_path / "logs").iterdir())
    assert files == ["api.log", "api.log.1", "api.log.2"]
    assert all(path.stat().st_size <= 1000 for path in (tmp_path / "logs").iterdir())
    assert "line 0099" in (tmp_path / "logs" / "api.log").read_text()
    assert "line 0089" in (tmp_path / "logs" / "api.log.1").read_text()


def test_a_folder_that_cannot_be_written_stops_nobody(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "logs" / "api.log")
    (tmp_path / "logs").rmdir()
    (tmp_path / "logs").write_text("a file in its place")
    log.write(b"lost\n")
