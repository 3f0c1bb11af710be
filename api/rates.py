"""How many requests a caller may send: so that one script gone wild does not shut out the others."""

from __future__ import annotations

import logging
import time
from typing import cast

import limits.aio.storage
import limits.aio.strategies
from limits import RateLimitItemPerMinute
from limits.errors import StorageError
from limits.storage import MemoryStorage, storage_from_string
from limits.strategies import SlidingWindowCounterRateLimiter
from starlette.types import ASGIApp, Receive, Scope, Send

from .guard import problem

REDIS_AWAY = 10.0
"""Seconds a Redis that did not answer is not asked again: requests must not wait for it one after the other."""
log = logging.getLogger(__name__)


class Rates:
    """Counts by key or session, of strangers by address: in Redis where the service has one, so that all processes that
    answer count together, else (or while Redis is away) in this process. The one person of a service without accounts
    is not limited, nor is anybody where the setting is 0."""

    def __init__(self, app: ASGIApp, per_minute: int, broker_url: str = "", prefix: str = ""):
        self.app = app
        self._prefix = prefix
        self._item = RateLimitItemPerMinute(per_minute) if per_minute else None
        self._own = SlidingWindowCounterRateLimiter(MemoryStorage())
        self._shared = _in_redis(broker_url) if broker_url.startswith("redis") else None
        self._away_until = 0.0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if self._item is None or scope["type"] != "http":
            return await self.app(scope, receive, send)
        caller = _caller(scope)
        wait = await self._wait(self._item, caller) if caller is not None else 0
        if not wait:
            return await self.app(scope, receive, send)
        answer = problem(429, "too-many", f"More than {self._item.amount} requests in a minute; try again in {wait} s.")
        answer.headers["retry-after"] = str(wait)
        return await answer(scope, receive, send)

    async def _wait(self, item: RateLimitItemPerMinute, caller: str) -> int:
        """Counts the request; 0, or the seconds after which the caller may ask again."""
        if self._shared and time.monotonic() >= self._away_until:
            try:
                if await self._shared.hit(item, self._prefix, caller):
                    return 0
                return _seconds_to((await self._shared.get_window_stats(item, self._prefix, caller)).reset_time)
            except StorageError as error:
                self._away_until = time.monotonic() + REDIS_AWAY
                log.warning("Requests are counted in this process only: %s", error)
        if self._own.hit(item, caller):
            return 0
        return _seconds_to(self._own.get_window_stats(item, caller).reset_time)


def _in_redis(url: str) -> limits.aio.strategies.SlidingWindowCounterRateLimiter:
    options: dict[str, float | str | bool] = {"socket_connect_timeout": 0.5, "socket_timeout": 0.5}
    storage = storage_from_string(f"async+{url}", wrap_exceptions=True, implementation="redispy", **options)
    return limits.aio.strategies.SlidingWindowCounterRateLimiter(cast(limits.aio.storage.Storage, storage))


def _seconds_to(moment: float) -> int:
    return max(1, int(moment - time.time()) + 1)


def _caller(scope: Scope) -> str | None:
    principal = scope.get("state", {}).get("principal")
    if principal is not None:
        return None if principal.kind == "local" else f"{principal.kind} {principal.credential_id}"
    client = scope.get("client")
    return f"address {client[0]}" if client else "address unknown"
