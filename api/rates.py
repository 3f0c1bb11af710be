"""How many requests a caller may send: so that one script gone wild does not shut out the others."""

from __future__ import annotations

import logging
import time
from typing import Any, cast

from limits import RateLimitItemPerMinute
from limits.aio.storage import Storage
from limits.aio.strategies import SlidingWindowCounterRateLimiter as SharedLimiter
from limits.storage import MemoryStorage, storage_from_string
from limits.strategies import SlidingWindowCounterRateLimiter
from redis.asyncio import BlockingConnectionPool
from starlette.types import ASGIApp, Receive, Scope, Send

from .guard import problem

REDIS_SECONDS = 0.5
"""How long an answer of Redis is waited for."""
REDIS_AWAY = 10.0
"""Seconds between two attempts to reach a Redis that did not answer; each is one request's."""
CONNECTIONS = 16
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
        self._shared = _in_redis(broker_url) if broker_url.startswith(("redis://", "rediss://")) else None
        self._away = False
        self._ask_again_at = 0.0

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
        if self._shared and time.monotonic() >= self._ask_again_at:
            if self._away:
                self._ask_again_at = time.monotonic() + REDIS_AWAY  # the others do not wait for this one's answer
            try:
                wait = await self._wait_shared(self._shared, item, caller)
            except Exception as error:  # whatever it is, it must not fail the request
                self._redis_is_away(error)
            else:
                self._away, self._ask_again_at = False, 0.0
                return wait
        if self._own.hit(item, caller):
            return 0
        return seconds_to(self._own.get_window_stats(item, caller).reset_time)

    async def _wait_shared(self, limiter: SharedLimiter, item: RateLimitItemPerMinute, caller: str) -> int:
        if await limiter.hit(item, self._prefix, caller):
            return 0
        return seconds_to((await limiter.get_window_stats(item, self._prefix, caller)).reset_time)

    def _redis_is_away(self, error: Exception) -> None:
        if not self._away:
            log.warning("Requests are counted in this process only: %s: %s", type(error).__name__, error)
        self._away, self._ask_again_at = True, time.monotonic() + REDIS_AWAY


def _in_redis(url: str) -> SharedLimiter:
    """With a pool of its own: it waits for a free connection, where the usual one would say that there are too many."""
    seconds = {"timeout": REDIS_SECONDS, "socket_connect_timeout": REDIS_SECONDS, "socket_timeout": REDIS_SECONDS}
    pool = BlockingConnectionPool.from_url(url, max_connections=CONNECTIONS, **seconds)
    options: dict[str, Any] = {"wrap_exceptions": True, "implementation": "redispy", "connection_pool": pool}
    return SharedLimiter(cast(Storage, storage_from_string("async+redis://", **options)))


def seconds_to(moment: float) -> int:
    """From now, for the header retry-after: whole ones, at least 1."""
    return max(1, int(moment - time.time()) + 1)


def _caller(scope: Scope) -> str | None:
    principal = scope.get("state", {}).get("principal")
    if principal is not None:
        return None if principal.kind == "local" else f"{principal.kind} {principal.credential_id}"
    client = scope.get("client")
    return f"address {client[0]}" if client else "address unknown"
