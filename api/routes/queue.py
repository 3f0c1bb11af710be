"""The queue: what waits and what is at work."""

from __future__ import annotations

from fastapi import APIRouter

from store.priority import name_of
from store.quotas import quotas
from store.repositories import QueueRepository

from ..context import ContextDep, ScopeDep
from ..study_schemas import QueueClass, QueueInfo, QuotaInfo, QuotaItem

router = APIRouter(prefix="/queue", tags=["studies"])
quota_router = APIRouter(tags=["studies"])


@quota_router.get("/quota")
def get_quota(context: ContextDep, scope: ScopeDep) -> QuotaInfo:
    """What the team has queued and stored, the limits, and what is left of them."""
    with context.database.read() as session:
        found = quotas(context.settings, session, scope)
    return QuotaInfo(
        items=[
            QuotaItem(
                name=each.name,
                used=each.used,
                limit=each.limit or None,
                left=each.left,
                setting=f"SLOWDRIFT_{each.setting}",
            )
            for each in found
        ]
    )


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
