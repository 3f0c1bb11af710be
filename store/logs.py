"""Logs that say which run and request they are about; as JSON, one object a line, where SLOWDRIFT_LOG_JSON is set."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

_about: ContextVar[dict[str, Any] | None] = ContextVar("about", default=None)
TEXT = "%(asctime)s %(levelname)s %(name)s: %(message)s%(about)s"


@contextmanager
def about(**what: Any) -> Iterator[None]:
    """Everything logged inside names these: run_id, task_id, attempt, request_id …"""
    token = _about.set((_about.get() or {}) | what)
    try:
        yield
    finally:
        _about.reset(token)


class _Names(logging.Filter):
    """Puts what the record is about on it: as text, or as fields of its own."""

    def __init__(self, as_fields: bool):
        super().__init__()
        self._as_fields = as_fields

    def filter(self, record: logging.LogRecord) -> bool:
        known = _about.get() or {}
        if self._as_fields:
            for name, value in known.items():
                setattr(record, name, value)
        else:
            record.about = "".join(f" {name}={value}" for name, value in known.items())
        return True


class Throttle(logging.Filter):
    """Lets `most` messages of one kind pass in `seconds`, and tells how many were left out at the next that passes."""

    def __init__(self, most: int = 20, seconds: float = 60.0):
        super().__init__()
        self._most, self._seconds = most, seconds
        self._seen: dict[tuple[str, int, str, str], list[float]] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        error = record.exc_info[0].__name__ if record.exc_info and record.exc_info[0] else ""
        key = (record.name, record.levelno, str(record.msg)[:200], error)
        now = time.monotonic()
        began, count = self._seen.get(key, (now, 0.0))
        if now - began >= self._seconds:
            left_out = int(count) - self._most
            if left_out > 0:
                record.msg = f"{record.msg} ({left_out} more like this were left out)"
            began, count = now, 0.0
        if len(self._seen) > KINDS:
            self._seen.clear()
        self._seen[key] = [began, count + 1]
        return count < self._most


KINDS = 1000
"""Of messages that are remembered."""


def configure(level: str, as_json: bool) -> None:
    """Send everything to standard error, so formatted."""
    handler = logging.StreamHandler()
    handler.addFilter(_Names(as_json))
    handler.addFilter(Throttle())
    if as_json:
        from pythonjsonlogger.json import JsonFormatter

        renamed = {"asctime": "time", "levelname": "level", "name": "logger"}
        handler.setFormatter(JsonFormatter("%(asctime)s %(levelname)s %(name)s %(message)s", rename_fields=renamed))
    else:
        handler.setFormatter(logging.Formatter(TEXT))
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
