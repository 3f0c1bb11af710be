"""The queue: what waits and what is at work."""

from __future__ import annotations

from fastapi import APIRouter, Request

from store.priority import name_of
from store.quotas import STREAMS, WHO, Quota, quotas
from store.repositories import QueueRepository

from ..context import ContextDep, ScopeDep
from ..refusals import Refusals
from ..streams import Streams
from ..study_schemas import QueueClass, QueueInfo, QuotaInfo, QuotaItem, Refusal

router = APIRouter(prefix="/queue", tags=["studies"])
quota_router = APIRouter(tags=["studies"])


@quota_router.get("/quota")
def get_quota(request: Request, context: ContextDep, scope: ScopeDep) -> QuotaInfo:
    """What the team has at work, queued and stored, the limits, what is left of them, and what they refused of late."""
    streams: Streams = request.app.state.streams
    refusals: Refusals = request.app.state.refusals
    with context.database.read() as session:
        found = quotas(context.settings, session, scope)
    found.append(Quota(STREAMS, streams.of_team(scope.team_id), streams.per_team, "QUOTA_STREAMS"))
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
        ],
        refused=[Refusal(at=at, detail=detail) for at, detail in refusals.of(scope.team_id)],
        who=WHO,
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
