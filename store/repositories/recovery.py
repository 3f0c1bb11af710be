"""What is left behind when messages or workers get lost, found and put right."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sqlalchemy import select, update

from ..clock import clock
from ..models import CANCELLED, CANCELLING, FAILED, QUEUED, RUNNING, Task
from .tasks import TaskRepository


class RecoveryRepository(TaskRepository):
    def ring_stale(self, older_than: float, limit: int) -> list[tuple[str, str]]:
        """(id, queue) of tasks that have waited since their last message; marked as rung now."""
        now = clock(self.session)
        due = select(Task.id).where(Task.state == QUEUED, Task.rung_at < now - older_than)
        rows = self.session.execute(
            update(Task)
            .where(Task.id.in_(due.order_by(Task.rung_at).limit(limit)), Task.rung_at < now - older_than)
            .values(rung_at=now)
            .returning(Task.id, Task.queue)
            .execution_options(synchronize_session=False)
        )
        return [(row.id, row.queue) for row in rows]

    def expired(self, limit: int) -> Sequence[str]:
        """Tasks whose worker has been silent beyond its lease."""
        query = select(Task.id).where(Task.state == RUNNING, Task.lease_until < clock(self.session))
        return self.session.scalars(query.limit(limit)).all()

    def settle_expired(self, task_id: str, max_attempts: int) -> None:
        """Put an expired task back to the queue, or end it when its run is cancelled or its attempts are used."""
        run = self._lock_run_of(task_id)
        task = self.session.scalars(
            select(Task).where(Task.id == task_id, Task.state == RUNNING, Task.lease_until < clock(self.session))
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

    def held_by(self, prefix: str) -> list[tuple[str, str]]:
        """(id, worker) of running tasks whose worker's name starts so."""
        query = select(Task.id, Task.worker).where(
            Task.state == RUNNING, Task.worker.startswith(prefix, autoescape=True)
        )
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
