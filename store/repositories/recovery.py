"""What is left behind when messages or workers get lost, found and put right."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sqlalchemy import func, or_, select, update
from sqlalchemy.sql import ColumnElement

from ..clock import clock
from ..models import CANCELLED, CANCELLING, FAILED, QUEUED, RUNNING, Task
from ..priority import doors
from .tasks import TaskRepository

SKEW = 30.0
"""Seconds by which a time of our own clock may lie ahead before the clock must have been put back."""


class RecoveryRepository(TaskRepository):
    def ring_stale(self, older_than: float, limit: int) -> list[tuple[str, str]]:
        """(id, queue) of the most urgent tasks that have waited since their last message; marked as rung now.

        A time in the future counts as long ago: the clock has been put back since.
        """
        now = clock(self.session)
        forgotten = or_(Task.rung_at < now - older_than, Task.rung_at > now + SKEW)
        due = select(Task.id).where(Task.state == QUEUED, forgotten)
        rows = self.session.execute(
            update(Task)
            .where(Task.id.in_(due.order_by(Task.priority, Task.rung_at).limit(limit)), Task.state == QUEUED)
            .values(rung_at=now)
            .returning(Task.id, Task.queue, Task.priority)
            .execution_options(synchronize_session=False)
        )
        return [(row.id, door) for row in rows for door in doors(row.queue, row.priority)]

    def waiting(self) -> Sequence[str]:
        """The doors at which something waits."""
        rows = self.session.execute(
            select(Task.queue, func.min(Task.priority)).where(Task.state == QUEUED).group_by(Task.queue)
        )
        return [door for queue, most_urgent in rows for door in doors(queue, most_urgent)]

    def at_work(self) -> bool:
        """Whether any worker has given a sign of late."""
        fresh = Task.heartbeat_at > clock(self.session) - SKEW
        return self.session.scalar(select(Task.id).where(Task.state == RUNNING, fresh).limit(1)) is not None

    def expired(self, limit: int, lease: float) -> Sequence[str]:
        """Tasks whose worker has been silent beyond its lease."""
        query = select(Task.id).where(Task.state == RUNNING, self._over(lease))
        return self.session.scalars(query.limit(limit)).all()

    def _over(self, lease: float) -> ColumnElement[bool]:
        """A lease that ends later than any lease can was given before the clock was put back: it is over too.

        A worker that lives renews it within a heartbeat; at worst its task is done twice and written once.
        """
        now = clock(self.session)
        return or_(Task.lease_until < now, Task.lease_until > now + lease + SKEW)

    def settle_expired(self, task_id: str, max_attempts: int, lease: float = 60.0) -> None:
        """Put an expired task back to the queue, or end it when its run is cancelled or its attempts are used."""
        run = self._lock_run_of(task_id)
        task = self.session.scalars(
            select(Task).where(Task.id == task_id, Task.state == RUNNING, self._over(lease))
        ).one_or_none()
        if run is None or task is None:
            return
        task.lease_until = None
        if run.state == CANCELLING:
            task.state = CANCELLED
            self.session.flush()
            self._cancelled(run)
        elif task.attempt - task.releases >= max_attempts:
            task.state, task.reason = FAILED, _lost(task, max_attempts)
            self.session.flush()
            self._end(run, FAILED, task.reason)
        else:
            task.state, task.rung_at = QUEUED, 0.0

    def held(self) -> list[tuple[str, str]]:
        """(id, worker) of all running tasks."""
        query = select(Task.id, Task.worker).where(Task.state == RUNNING)
        return [(row.id, row.worker or "") for row in self.session.execute(query)]

    def expire(self, task_ids: Iterable[str], workers: Iterable[str]) -> None:
        """End the leases of these workers, known to be dead, at once."""
        held = Task.id.in_(list(task_ids)) & Task.worker.in_(list(workers)) & (Task.state == RUNNING)
        past = clock(self.session) - 1.0
        self.session.execute(update(Task).where(held).values(lease_until=past))


def _lost(task: Task, max_attempts: int) -> str:
    times = "once" if max_attempts == 1 else f"{max_attempts} times"
    return (
        f"The worker was lost {times} while computing this (last {task.worker or 'unknown'}), so it was given up. "
        "A worker is lost when its process or machine ends, most often for want of memory; "
        "give it more memory, or make the case smaller, and run it again."
    )
