"""ETags: an answer that the caller has already costs no bytes (304)."""

from __future__ import annotations

import hashlib

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

MOST = 4_000_000
"""Larger answers go out as they come."""


class ETags:
    """For whole JSON answers to GET. Weak: the same content may be compressed in several ways."""

    def __init__(self, app: ASGIApp):
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or scope["method"] not in ("GET", "HEAD"):
            return await self.app(scope, receive, send)
        known = Headers(scope=scope).get("if-none-match", "")
        held: list[Message] = []

        async def hold(message: Message) -> None:
            if message["type"] == "http.response.start" and _suits(message):
                held.append(message)
                return
            if held and message["type"] == "http.response.body":
                start = held.pop()
                whole = not message.get("more_body", False) and len(message.get("body", b"")) <= MOST
                if whole and _mark(start, message.get("body", b""), known):
                    message = {"type": "http.response.body", "body": b""}
                await send(start)
            await send(message)

        return await self.app(scope, receive, hold)


def _suits(message: Message) -> bool:
    headers = Headers(raw=message["headers"])
    return message["status"] == 200 and headers.get("content-type", "").startswith("application/json")


def _mark(start: Message, body: bytes, known: str) -> bool:
    """Put the tag on the answer; True if the caller has it, and the answer is now a 304."""
    tag = f'W/"{hashlib.blake2b(body, digest_size=16).hexdigest()}"'
    headers = MutableHeaders(raw=start["headers"])
    headers["etag"] = tag
    headers.setdefault("cache-control", "no-cache, private")
    same = known.strip() == "*" or tag in (each.strip() for each in known.split(","))
    if same:
        start["status"] = 304
        del headers["content-length"]
        del headers["content-type"]
    start["headers"] = headers.raw
    return same
