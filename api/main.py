"""The FastAPI app."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import APIRouter, Depends, FastAPI
from starlette.middleware.gzip import GZipMiddleware
from starlette.types import ASGIApp

from store.database import Database
from store.doorbell import Doorbell
from store.reconcile import Reconciler
from store.settings import Settings

from . import errors
from .access import admit
from .attempts import Attempts
from .context import Context
from .doorkeeper import Doorkeeper
from .guard import Guard
from .routes import (
    auth,
    cases,
    catalogue,
    data_sets,
    events,
    exports,
    health,
    moordyn,
    runs,
    shares,
    studies,
    teams,
    users,
)
from .routes.common import problems

BASE = "/api/v1"


class Guarded(FastAPI):
    """FastAPI with the guard around everything, its own error pages and limits included."""

    def build_middleware_stack(self) -> ASGIApp:
        context: Context = self.state.context
        return Guard(Doorkeeper(super().build_middleware_stack(), context, BASE), context.settings.hosts)


def create_app(settings: Settings | None = None, reconcile: bool = True) -> FastAPI:
    settings = settings or Settings.from_env()
    context = Context(settings, Database(settings.database), Doorbell(settings))

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        reconciler = Reconciler(context.database, context.doorbell, settings) if reconcile else None
        if reconciler:
            reconciler.start()
        yield
        if reconciler:
            reconciler.stop()
        context.doorbell.close()
        context.database.close()

    app = Guarded(
        title="Slowdrift",
        summary="Frequency- and time-domain analysis of moored floating vessels",
        version="1",
        openapi_url=f"{BASE}/openapi.json",
        docs_url=None,  # its page loads scripts from elsewhere
        redoc_url=None,
        max_body_size=settings.max_request_bytes,
        lifespan=lifespan,
    )
    app.state.context = context
    app.state.attempts = Attempts(settings)
    errors.install(app)
    app.add_middleware(GZipMiddleware, minimum_size=2000, compresslevel=5)
    app.include_router(health.router)
    base = APIRouter(prefix=BASE, responses=problems(400, 401, 403, 404, 413, 422), dependencies=[Depends(admit)])
    for module in (auth, cases, catalogue, data_sets, events, exports, moordyn, runs, shares, studies, teams, users):
        base.include_router(module.router)
    base.include_router(shares.opened)
    app.include_router(base)
    return app
