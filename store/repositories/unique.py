"""Rows of which there can be one: whoever comes second, even at the same moment, is refused in words."""

from __future__ import annotations

from typing import TypeVar

from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from ..errors import ConflictError

Row = TypeVar("Row")


def add_unique(session: Session, row: Row, refusal: str) -> Row:
    """Insert or update the row. ConflictError with `refusal` where another one has its name."""
    try:
        with session.begin_nested():
            session.add(row)
            session.flush()
    except IntegrityError:
        raise ConflictError(refusal) from None
    return row
