"""Server-sent events: a run, or all of a project's, sent whenever something about them changes.

The database is looked at a few times a second while somebody listens; that works alike on both databases and with any
number of API processes.
"""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends
from fastapi.sse import EventSourceResponse, ServerSentEvent
from starlette.concurrency import run_in_threadpool

from store.errors import NotFoundError
from store.models import ACTIVE, FINAL
from store.repositories import RunRepository
from store.scope import Scope

from ..context import Context, ContextDep, ScopeDep
from ..schemas import RunInfo
from ..services import runs as service
from .common import Key, problems

router = APIRouter(tags=["events"])
RUN_SECONDS, PROJECT_SECONDS = 0.25, 0.5
NEWEST, MOST_ACTIVE = 50, 200
SIGNED_IN_SECONDS = 600.0
"""A stream of somebody signed in, or behind a share link, ends after so long: whoever may still ask opens another (a
browser does so by itself), whoever may no longer is refused."""


def _deadline(scope: Scope) -> float:
    may_change = scope.user_id is not None or scope.run_ids is not None
    return time.monotonic() + SIGNED_IN_SECONDS if may_change else math.inf


def existing_run(context: ContextDep, scope: ScopeDep, run_id: Key) -> RunInfo:
    """The run, or a 404 before the stream begins."""
    return service.show(context, scope, run_id)


@router.get("/runs/{run_id}/events", response_class=EventSourceResponse, responses=problems(404))
async def follow_run(
    context: ContextDep, scope: ScopeDep, run: Annotated[RunInfo, Depends(existing_run)]
) -> AsyncIterator[ServerSentEvent]:
    """Event `run` with the run as data: at once, at every change, and a last time in its final state."""
    until = _deadline(scope)
    yield _event(run)
    while run.state not in FINAL and time.monotonic() < until:
        await asyncio.sleep(RUN_SECONDS)
        try:
            now = await run_in_threadpool(service.show, context, scope, run.id)
        except NotFoundError:
            return
        if now != run:
            run = now
            yield _event(run)


@router.get("/events", response_class=EventSourceResponse)
async def follow_project(context: ContextDep, scope: ScopeDep) -> AsyncIterator[ServerSentEvent]:
    """Event `run` for every active run of the project at first, then for every change."""
    until = _deadline(scope)
    seen = await run_in_threadpool(_look, context, scope, {})
    for run in sorted(seen.values(), key=lambda run: run.id):
        if run.state in ACTIVE:
            yield _event(run)
    while time.monotonic() < until:
        await asyncio.sleep(PROJECT_SECONDS)
        now = await run_in_threadpool(_look, context, scope, seen)
        for key, run in now.items():
            if seen.get(key) != run:
                yield _event(run)
        seen = now


def _look(context: Context, scope: Scope, seen: dict[str, RunInfo]) -> dict[str, RunInfo]:
    """The newest runs, the active ones, and those that were active at the last look."""
    with context.database.read() as session:
        runs = RunRepository(session, scope)
        views = [*runs.page(NEWEST, None, None)[0], *runs.active(MOST_ACTIVE)]
        found = {view.run.id: view for view in views}
        ended = [key for key, run in seen.items() if run.state in ACTIVE and key not in found]
        found |= {view.run.id: view for view in runs.views(ended)}
        return {key: service.info(view) for key, view in found.items()}


def _event(run: RunInfo) -> ServerSentEvent:
    return ServerSentEvent(event="run", data=run)
