"""Whether the process is up, and whether it can do its work."""

from __future__ import annotations

import asyncio
import hmac
from typing import Any

from fastapi import APIRouter, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST

from store.errors import NotFoundError
from store.health import NOT_READY, Health

from ..context import ContextDep
from ..nearness import is_local

router = APIRouter(tags=["health"])
LOOK_SECONDS = 0.01


@router.get("/healthz")
async def healthz() -> dict[str, str]:
    """The process is up."""
    return {"status": "ok"}


@router.get("/metrics", include_in_schema=False)
def metrics(request: Request, context: ContextDep) -> Response:
    """For Prometheus. With the setting metrics_token for whoever knows it; else for this machine only, and for nobody
    where the settings name a proxy."""
    token = context.settings.metrics_token
    if token:
        given = request.headers.get("authorization", "").removeprefix("Bearer ")
        allowed = hmac.compare_digest(given.encode(), token.encode())
    else:
        allowed = not context.settings.behind_proxy and is_local(request.scope)
    if not allowed:
        raise NotFoundError("page", "metrics")
    return Response(request.app.state.metrics.text(), media_type=CONTENT_TYPE_LATEST)


@router.get("/readyz")
async def readyz(request: Request, response: Response) -> dict[str, Any]:
    """`ok`, `degraded` (answers, and says what does not work) or, with status 503, `not ready`; within 2 s.

    Of the checks, database, writes and migrations are needed; without broker or disk the service is degraded.
    """
    health: Health = request.app.state.health
    health.start()
    while health.pending():
        await asyncio.sleep(LOOK_SECONDS)
    state, checks = health.report()
    response.status_code = 503 if state == NOT_READY else 200
    return {"status": state, "checks": checks}
