"""Leases are measured by one clock: the database server's where there is one, this machine's with SQLite."""

from __future__ import annotations

import time
from datetime import UTC, datetime
from functools import cache

from sqlalchemy import Float, bindparam, cast, func
from sqlalchemy.orm import Session
from sqlalchemy.sql import ColumnElement


def clock(session: Session) -> ColumnElement[float]:
    """Seconds since 1970 as an SQL expression."""
    return clock_of(session.get_bind().dialect.name)


@cache
def clock_of(dialect: str) -> ColumnElement[float]:
    """The clock in the words of a database, for statements that are made once: it is read when they are executed."""
    if dialect == "postgresql":
        return cast(func.extract("epoch", func.clock_timestamp()), Float(53))
    return bindparam("clock", type_=Float(53), callable_=time.time)


def utc_now() -> datetime:
    return datetime.now(UTC)
