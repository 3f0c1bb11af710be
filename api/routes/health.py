"""Whether the process is up, and whether it can do its work."""

from __future__ import annotations

import hmac
from typing import Any

from fastapi import APIRouter, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST
from sqlalchemy.exc import SQLAlchemyError

from store import migrations
from store.errors import NotFoundError
from store.settings import LOOPBACK

from ..context import Context, ContextDep

router = APIRouter(tags=["health"])


@router.get("/healthz")
async def healthz() -> dict[str, str]:
    """The process is up."""
    return {"status": "ok"}


@router.get("/metrics", include_in_schema=False)
def metrics(request: Request, context: ContextDep) -> Response:
    """For Prometheus. With the setting metrics_token for whoever knows it, else for this machine only."""
    token = context.settings.metrics_token
    if token:
        given = request.headers.get("authorization", "").removeprefix("Bearer ")
        allowed = hmac.compare_digest(given.encode(), token.encode())
    else:
        allowed = request.client is None or request.client.host in (*LOOPBACK, "testclient")
    if not allowed:
        raise NotFoundError("page", "metrics")
    return Response(request.app.state.metrics.text(), media_type=CONTENT_TYPE_LATEST)


@router.get("/readyz")
def readyz(context: ContextDep, response: Response) -> dict[str, Any]:
    """Database, migrations and broker, each `ok` or why not; 503 unless all are."""
    checks = {"database": _database(context), "migrations": "unknown", "broker": _broker(context)}
    if checks["database"] == "ok":
        current = migrations.is_current(context.database)
        checks["migrations"] = (
            "ok" if current else "the database is not at this version's schema; run slowdrift migrate"
        )
    ready = all(answer == "ok" for answer in checks.values())
    response.status_code = 200 if ready else 503
    return {"status": "ok" if ready else "not ready", "checks": checks}


def _database(context: Context) -> str:
    try:
        context.database.ping()
    except SQLAlchemyError as error:
        return f"not reachable ({type(error).__name__})"
    return "ok"


def _broker(context: Context) -> str:
    reason = context.doorbell.reachable()
    return "ok" if reason is None else f"not reachable ({reason.partition(':')[0]})"
