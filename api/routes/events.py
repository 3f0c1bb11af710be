"""Server-sent events: a run, or all of a project's, sent whenever something about them changes.

One watcher of the process (api/watcher.py) looks at the database for all who listen.
"""

from __future__ import annotations

import math
import time
from collections.abc import AsyncIterator
from contextlib import AbstractContextManager
from typing import Annotated

from fastapi import APIRouter, Depends, Request
from fastapi.responses import StreamingResponse

from store.models import FINAL
from store.scope import Scope

from ..context import ContextDep, ScopeDep
from ..schemas import RunInfo
from ..services import runs as service
from ..streams import PlaceDep
from ..watcher import Listener, Watcher, event_of
from .common import Key, problems

router = APIRouter(tags=["events"])
SIGNED_IN_SECONDS = 600.0
"""A stream of somebody signed in, or behind a share link, ends after so long: whoever may still ask opens another (a
browser does so by itself), whoever may no longer is refused."""
PING_SECONDS = 15.0
PING = b": ping\n\n"
"""A comment, so that no proxy takes a quiet stream for a dead one."""
HEADERS = {"Cache-Control": "no-cache", "X-Accel-Buffering": "no"}
"""So that no proxy keeps events back."""


class EventStream(StreamingResponse):
    """FastAPI's own makes each event, and a task that waits for it, anew for every listener."""

    media_type = "text/event-stream"


def existing_run(context: ContextDep, scope: ScopeDep, run_id: Key) -> RunInfo:
    """The run, or a 404 before the stream begins."""
    return service.show(context, scope, run_id)


@router.get("/runs/{run_id}/events", response_class=EventStream, responses=problems(404, 429, 503))
async def follow_run(
    request: Request, scope: ScopeDep, run: Annotated[RunInfo, Depends(existing_run)], place: PlaceDep
) -> EventStream:
    """Event `run` with the run as data: at once, at every change, and a last time in its final state."""
    first = event_of(run.model_dump_json())
    following = None if run.state in FINAL else _watcher(request).run(scope, run.id, first)
    return EventStream(_events(first, following, scope), headers=HEADERS)


@router.get("/events", response_class=EventStream, responses=problems(429, 503))
async def follow_project(request: Request, scope: ScopeDep, place: PlaceDep) -> EventStream:
    """Event `run` for every active run of the project at first, then for every change."""
    return EventStream(_events(b"", _watcher(request).project(scope), scope), headers=HEADERS)


def _watcher(request: Request) -> Watcher:
    watcher: Watcher = request.app.state.watcher
    return watcher


async def _events(
    first: bytes, following: AbstractContextManager[Listener] | None, scope: Scope
) -> AsyncIterator[bytes]:
    may_change = scope.user_id is not None or scope.run_ids is not None
    until = time.monotonic() + SIGNED_IN_SECONDS if may_change else math.inf
    if first:
        yield first
    if following is None:
        return
    with following as listener:
        while not listener.ended and (left := until - time.monotonic()) > 0:
            events = await listener.take(min(PING_SECONDS, left))
            if events is not None:
                yield events
            elif not listener.ended and left > PING_SECONDS:
                yield PING
