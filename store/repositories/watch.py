"""What differs between two looks at a run if anything about it has changed: cheap to ask for, many runs at once."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from itertools import islice
from typing import Any

from sqlalchemy import Text, bindparam, cast, func, select
from sqlalchemy.orm import Session

from ..models import ACTIVE, RUNNING, Run, Task

TOGETHER = 2000
"""Runs asked for by one statement."""
Mark = tuple[Any, ...]
"""Of a run: its state, what may be changed by hand, and how far its tasks at work are. The state comes first."""

_MARK = (Run.state, Run.name, cast(Run.tags, Text), Run.pinned)
_BY_ID = select(Run.id, *_MARK).where(Run.id.in_(bindparam("runs", expanding=True)))


class WatchRepository:
    """Looks across projects, since one look serves all listeners of a process. It gives marks, which say only that
    something has changed; what changed is asked of RunRepository, with the scope of whoever listens."""

    def __init__(self, session: Session):
        self.session = session

    def marks(self, run_ids: Collection[str]) -> dict[str, Mark]:
        """Of those of these runs that exist."""
        found: dict[str, Mark] = {}
        left = iter(run_ids)
        while part := list(islice(left, TOGETHER)):
            found |= _marks(self.session.execute(_BY_ID, {"runs": part}))
        return found

    def of_project(self, project_id: str, newest: int, most_active: int) -> dict[str, Mark]:
        """Of its newest runs and of its active ones."""
        query = select(Run.id, *_MARK).where(Run.project_id == project_id).order_by(Run.id.desc())
        active = query.where(Run.state.in_(ACTIVE)).limit(most_active)
        return _marks(self.session.execute(query.limit(newest))) | _marks(self.session.execute(active))

    def at_work(self) -> dict[str, Mark]:
        """Of every run with tasks at work, what those say."""
        done, message = func.sum(Task.weight * Task.progress), func.max(Task.message)
        query = select(Task.run_id, done, message, func.max(Task.attempt), func.count()).where(Task.state == RUNNING)
        return _marks(self.session.execute(query.group_by(Task.run_id)))


def _marks(rows: Iterable[Any]) -> dict[str, Mark]:
    return {row[0]: tuple(row[1:]) for row in rows}
