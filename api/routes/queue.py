"""The queue: what waits and what is at work."""

from __future__ import annotations

from fastapi import APIRouter

from store.priority import name_of
from store.repositories import QueueRepository

from ..context import ContextDep
from ..study_schemas import QueueClass, QueueInfo

router = APIRouter(prefix="/queue", tags=["studies"])


@router.get("")
def get_queue(context: ContextDep) -> QueueInfo:
    """In numbers only, of the whole installation: one queue serves all teams."""
    with context.database.read() as session:
        queues = QueueRepository(session)
        waiting, busy, left = queues.waiting(), len(queues.workers()), queues.seconds_left()
    items = [
        QueueClass(
            queue=each.queue,
            priority=name_of(each.priority),
            queued=each.queued,
            running=each.running,
            oldest_seconds=each.oldest_seconds,
        )
        for each in waiting
    ]
    return QueueInfo(items=items, busy_workers=busy, seconds_left=left)
