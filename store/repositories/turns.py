"""Shares of teams and users within a priority: start-time fair queueing (docs/decisions/0060-quotas-and-shares.md).

Each task has a turn; within its priority, the smallest is claimed first. The tasks of one user follow each other at
distances of their weights, and a user who comes later begins where the queue is now, not behind all that waits. The
distances are as many times larger as users of the same team wait, so that teams share alike, and users within them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

from sqlalchemy import func, select

from ..models import QUEUED, RUNNING, Project, Run, Task
from ..recent import Recent
from .scoped import Scoped

_recent = Recent()
"""Last turn, and other users of the team: a few seconds old they shift a share a little, and nothing else."""


class TurnRepository(Scoped):
    """Sums over the tasks that wait; nobody learns a row by them."""

    def of(self, weights: Sequence[float], queue: str, priority: int) -> list[float]:
        """Turns of new tasks of this caller, of these weights, in their order."""
        place = (str(self.session.get_bind().engine.url), self.scope.team_id, self.scope.user_id, queue, priority)
        last, others = _recent.get(place) or self._own(queue, priority)
        size = float(others + 1)
        now = self._now(queue, priority)
        start = now if last is None else max(now, last + size * weights[0])
        turns = list(accumulate((size * weight for weight in weights[1:]), initial=start))
        if _recent.get(place) is None:
            _recent.put(place, (turns[-1], others))
        else:
            _recent.change(place, (turns[-1], others))
        return turns

    def _now(self, queue: str, priority: int) -> float:
        """The turn that is next; with nothing waiting, the last that was claimed of those at work."""
        level = (Task.queue == queue) & (Task.priority == priority)
        waiting = self.session.scalar(select(func.min(Task.turn)).where(level, Task.state == QUEUED))
        if waiting is not None:
            return float(waiting)
        working = self.session.scalar(select(func.max(Task.turn)).where(level, Task.state == RUNNING))
        return 0.0 if working is None else float(working)

    def _own(self, queue: str, priority: int) -> tuple[float | None, int]:
        """The last turn of this user's tasks that wait, and how many other users of the team have such."""
        projects = select(Project.id).where(Project.team_id == self.scope.team_id)
        query = (
            select(Run.created_by, func.max(Task.turn))
            .join(Task, Task.run_id == Run.id)
            .where(Run.project_id.in_(projects), Task.queue == queue, Task.priority == priority, Task.state == QUEUED)
            .group_by(Run.created_by)
        )
        found = {user: float(turn) for user, turn in self.session.execute(query)}
        return found.pop(self.scope.user_id, None), len(found)
