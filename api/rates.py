"""How many requests a caller may send: so that one script gone wild does not shut out the others."""

from __future__ import annotations

import time

from limits import RateLimitItemPerMinute
from limits.storage import MemoryStorage
from limits.strategies import SlidingWindowCounterRateLimiter
from starlette.types import ASGIApp, Receive, Scope, Send

from .guard import problem


class Rates:
    """Counts in this process by key or session, of strangers by address. The one person of a service without accounts
    is not limited, nor is anybody where the setting is 0."""

    def __init__(self, app: ASGIApp, per_minute: int):
        self.app = app
        self._item = RateLimitItemPerMinute(per_minute) if per_minute else None
        self._limiter = SlidingWindowCounterRateLimiter(MemoryStorage())

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if self._item is None or scope["type"] != "http":
            return await self.app(scope, receive, send)
        caller = _caller(scope)
        if caller is None or self._limiter.hit(self._item, caller):
            return await self.app(scope, receive, send)
        wait = max(1, int(self._limiter.get_window_stats(self._item, caller).reset_time - time.time()) + 1)
        answer = problem(429, "too-many", f"More than {self._item.amount} requests in a minute; try again in {wait} s.")
        answer.headers["retry-after"] = str(wait)
        return await answer(scope, receive, send)


def _caller(scope: Scope) -> str | None:
    principal = scope.get("state", {}).get("principal")
    if principal is not None:
        return None if principal.kind == "local" else f"{principal.kind} {principal.credential_id}"
    client = scope.get("client")
    return f"address {client[0]}" if client else "address unknown"
