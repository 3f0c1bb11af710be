"""The FastAPI app."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import APIRouter, Depends, FastAPI, Security
from fastapi.security import APIKeyCookie, HTTPBearer
from starlette.types import ASGIApp
from starlette_compress import CompressMiddleware, remove_compress_type

from store import isolation
from store.database import Database
from store.doorbell import Doorbell
from store.health import Health
from store.reconcile import Reconciler
from store.settings import Settings

from . import errors
from .access import admit
from .attempts import Attempts
from .context import Context
from .doorkeeper import Doorkeeper
from .etag import ETags
from .guard import COOKIE, Guard
from .metrics import Meter, Metrics, ServiceState
from .oidc_provider import Provider
from .rates import Rates
from .refusals import Refusals
from .request_ids import RequestIds
from .routes import (
    auth,
    cases,
    catalogue,
    data_sets,
    events,
    exports,
    health,
    hydrodynamics,
    imports,
    moordyn,
    oidc,
    queue,
    runs,
    shares,
    studies,
    teams,
    users,
)
from .routes.common import problems
from .streams import Streams
from .watcher import Watcher

BASE = "/api/v1"
READERS = tuple(f"api.services.{name}" for name in ("bundle_check", "data_reading", "mesh_reading"))
"""Called in child processes (store/isolation), and loaded before the first."""
remove_compress_type("text/event-stream")  # each open stream would keep a compressor, a megabyte with zstd
# for the OpenAPI description only: api/doorkeeper.py reads them
BEARER = HTTPBearer(auto_error=False, scheme_name="key", description="an API key, sdk_…")
SESSION = APIKeyCookie(
    name=COOKIE, auto_error=False, scheme_name="session", description="of a browser, see /auth/sign-in"
)


class Guarded(FastAPI):
    """FastAPI with the guard around everything, its own error pages and limits included."""

    def build_middleware_stack(self) -> ASGIApp:
        context: Context = self.state.context
        inner = Doorkeeper(super().build_middleware_stack(), context, BASE)
        return RequestIds(Meter(Guard(inner, context.settings.hosts), self.state.metrics))


def create_app(settings: Settings | None = None, reconcile: bool = True) -> FastAPI:
    """`reconcile`: put right what faults leave behind, and count ended runs for the metrics. Of the processes that
    answer on one port, one does so."""
    settings = settings or Settings.from_env()
    context = Context(settings, Database(settings.database), Doorbell(settings))
    checks = Health(settings, context.database)
    metrics = Metrics(context.database, count_runs=reconcile)
    streams = Streams(settings)
    metrics.registry.register(ServiceState(checks, context.doorbell, streams))

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        isolation.warm_up(*READERS)
        reconciler = Reconciler(context.database, context.doorbell, settings) if reconcile else None
        if reconciler:
            reconciler.start()
        with metrics.counting():
            yield
        if reconciler:
            reconciler.stop()
        checks.close()
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
    app.state.health = checks
    app.state.refusals = Refusals()
    app.state.streams, app.state.watcher = streams, Watcher(context.database)
    app.state.attempts = Attempts(settings)
    app.state.oidc = Provider(settings) if settings.oidc_issuer else None
    errors.install(app)
    app.state.metrics = metrics
    app.add_middleware(ETags)
    app.add_middleware(CompressMiddleware, minimum_size=2000, zstd_level=3, brotli=False, gzip_level=5)
    app.add_middleware(
        Rates, per_minute=settings.rate_per_minute, broker_url=settings.broker_url, prefix=settings.queue_prefix
    )
    app.include_router(health.router)
    doors = [Depends(admit), Security(BEARER), Security(SESSION)]
    base = APIRouter(prefix=BASE, responses=problems(400, 401, 403, 404, 413, 422), dependencies=doors)
    for module in (  # looked through in this order: what is asked most comes first
        runs,
        events,
        studies,
        auth,
        cases,
        catalogue,
        data_sets,
        exports,
        hydrodynamics,
        imports,
        moordyn,
        oidc,
        queue,
        shares,
        teams,
        users,
    ):
        base.include_router(module.router)
    base.include_router(queue.quota_router)
    base.include_router(shares.opened)
    app.include_router(base)
    return app
