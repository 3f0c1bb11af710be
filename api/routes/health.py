"""Whether the process is up, and whether it can do its work."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Response
from sqlalchemy.exc import SQLAlchemyError

from store import migrations

from ..context import Context, ContextDep

router = APIRouter(tags=["health"])


@router.get("/healthz")
async def healthz() -> dict[str, str]:
    """The process is up."""
    return {"status": "ok"}


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
