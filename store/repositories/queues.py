"""What waits, what is at work, what has ended: for whoever runs the service. Of all projects together, in numbers only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import case, delete, func, select
from sqlalchemy.orm import Session

from ..clock import clock, utc_now
from ..estimate import snapshot
from ..models import FAILED, FINAL, QUEUED, RUNNING, STATES, Run, Study, Task


@dataclass(frozen=True)
class Waiting:
    """The tasks of one queue and priority; `oldest_seconds` since the oldest of the queued was made or given back."""

    queue: str
    priority: int
    queued: int
    running: int
    oldest_seconds: float | None


@dataclass(frozen=True)
class Ended:
    run_id: str
    kind: str
    state: str
    seconds: float


class QueueRepository:
    """For operators: it looks across projects, so no route gives its rows away."""

    def __init__(self, session: Session):
        self.session = session

    def waiting(self) -> list[Waiting]:
        queued, running = Task.state == QUEUED, Task.state == RUNNING
        query = (
            select(
                Task.queue,
                Task.priority,
                func.sum(case((queued, 1), else_=0)),
                func.sum(case((running, 1), else_=0)),
                func.min(case((queued, Run.created_at))),
            )
            .join(Run, Run.id == Task.run_id)
            .where(Task.state.in_((QUEUED, RUNNING)))
            .group_by(Task.queue, Task.priority)
            .order_by(Task.queue, Task.priority)
        )
        now = utc_now()
        return [
            Waiting(queue, priority, waits, works, None if first is None else max(0.0, (now - first).total_seconds()))
            for queue, priority, waits, works, first in self.session.execute(query)
        ]

    def workers(self) -> list[str]:
        """Names of the processes that have a task in hand and gave a sign of late."""
        fresh = Task.heartbeat_at > clock(self.session) - 60.0
        names = self.session.scalars(select(Task.worker).where(Task.state == RUNNING, fresh).distinct())
        return sorted(name for name in names if name)

    def seconds_left(self) -> float | None:
        """An estimate for all that waits."""
        queue = snapshot(self.session)
        rate = queue.rates.get(None)
        return None if rate is None else queue.before[-1] * rate / queue.workers

    def states(self, among: Sequence[str] = STATES) -> dict[str, int]:
        """Runs by state. Those that have ended may be very many, and take as long to count."""
        rows = self.session.execute(select(Run.state, func.count()).where(Run.state.in_(among)).group_by(Run.state))
        return {row[0]: row[1] for row in rows}

    def failed(self, most: int) -> list[tuple[str, str, datetime | None, str | None]]:
        """Id, case, time and reason of the last that failed."""
        query = select(Run.id, Run.case_name, Run.finished_at, Run.reason).where(Run.state == FAILED)
        rows = self.session.execute(query.order_by(Run.id.desc()).limit(most))
        return [(row[0], row[1], row[2], row[3]) for row in rows]

    def ended_since(self, moment: datetime, limit: int = 20_000) -> list[Ended]:
        query = select(Run.id, Run.kind, Run.state, Run.started_at, Run.finished_at).where(Run.finished_at >= moment)
        found = []
        for run_id, kind, state, started, finished in self.session.execute(query.limit(limit)):
            seconds = (finished - started).total_seconds() if started and finished else 0.0
            found.append(Ended(run_id, kind, state, max(0.0, seconds)))
        return found

    def outdated(self, days: float, limit: int) -> Sequence[str]:
        """Ended runs older than so many days that nobody has pinned, the oldest first."""
        before = utc_now() - timedelta(days=days)
        query = select(Run.id).where(Run.state.in_(FINAL), Run.pinned.is_(False), Run.finished_at < before)
        return self.session.scalars(query.order_by(Run.finished_at).limit(limit)).all()

    def remove(self, run_ids: Sequence[str]) -> int:
        """These runs, unless they were pinned meanwhile; gives how many went."""
        gone = self.session.execute(delete(Run).where(Run.id.in_(run_ids), Run.pinned.is_(False)))
        return int(gone.rowcount)  # type: ignore[attr-defined]

    def remove_empty_studies(self) -> None:
        """Those that have no run left."""
        held = select(Run.id).where(Run.study_id == Study.id).exists()
        self.session.execute(delete(Study).where(~held).execution_options(synchronize_session=False))
