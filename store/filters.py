"""Which runs a list shows, and in which order."""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Text, cast, func, or_, select

from .models import Run
from .people import User


@dataclass(frozen=True)
class RunFilter:
    """Every field that is given narrows the list."""

    states: tuple[str, ...] = ()
    text: str | None = None
    """Part of the run's or the case's name, whatever its letters' case."""
    tag: str | None = None
    study_id: str | None = None
    case_id: str | None = None
    pinned: bool | None = None
    who: str | None = None
    """Id, or part of the name, of whoever started it."""
    since: datetime | None = None
    until: datetime | None = None
    oldest_first: bool = False

    def conditions(self) -> list[ColumnElement[bool]]:
        found: list[ColumnElement[bool]] = []
        equal: tuple[tuple[Any, Any], ...] = (
            (Run.study_id, self.study_id), (Run.case_version_id, self.case_id), (Run.pinned, self.pinned),
        )  # fmt: skip
        found += [column == value for column, value in equal if value is not None]
        if self.states:
            found.append(Run.state.in_(self.states))
        if self.text:
            found.append(or_(*(_holds(column, self.text) for column in (Run.name, Run.case_name))))
        if self.tag:
            found.append(cast(Run.tags, Text).contains(json.dumps(self.tag), autoescape=True))
        if self.who:
            meant = or_(User.id == self.who, User.name.icontains(self.who, autoescape=True))
            found.append(Run.created_by.in_(select(User.id).where(meant)))
        if self.since is not None:
            found.append(Run.created_at >= self.since)
        if self.until is not None:
            found.append(Run.created_at <= self.until)
        return found


def _holds(column: Any, text: str) -> ColumnElement[bool]:
    """Whether a part of the text in a column is this, whatever its letters' case: as the index over trigrams has it."""
    pattern = text.lower().replace("/", "//").replace("%", "/%").replace("_", "/_")
    return func.lower(column).like(f"%{pattern}%", escape="/")
