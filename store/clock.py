"""Leases are measured by one clock: the database server's where there is one, this machine's with SQLite."""

from __future__ import annotations

import time
from datetime import UTC, datetime

from sqlalchemy import Float, cast, func, literal
from sqlalchemy.orm import Session
from sqlalchemy.sql import ColumnElement


def clock(session: Session) -> ColumnElement[float]:
    """Seconds since 1970 as an SQL expression."""
    if session.get_bind().dialect.name == "postgresql":
        return cast(func.extract("epoch", func.clock_timestamp()), Float(53))
    return literal(time.time(), Float(53))


def utc_now() -> datetime:
    return datetime.now(UTC)
