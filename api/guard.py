"""What every request passes before a route: the Host it names, the Origin it comes from; and headers on every answer.

Without accounts, whatever a browser on this machine sends is obeyed; so a page from elsewhere must not be able to make
it send anything (Origin), nor reach us under a name of its own (Host, "DNS rebinding"). With accounts, a request that
changes something by the cookie of a session must also show an Origin of ours, or know the session's CSRF token.
"""

from __future__ import annotations

import hmac
import json
from collections.abc import Sequence
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import cookie_parser
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from store.tokens import csrf_token

SAFE = ("GET", "HEAD", "OPTIONS")
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "X-Frame-Options": "SAMEORIGIN",
}
PROBLEM = "application/problem+json"
COOKIE, SECURE_COOKIE = "slowdrift", "__Host-slowdrift"
"""The session's cookie over http and https; a browser takes the latter over https alone, and from this very host."""
CSRF_HEADER = "x-csrf-token"


def _content(status: int, kind: str, title: str) -> bytes:
    return json.dumps({"type": kind, "title": title, "status": status, "detail": title}).encode()


TOO_LARGE = _content(413, "too-large", "The body is larger than this route takes.")


class Guard:
    def __init__(self, app: ASGIApp, allowed_hosts: Sequence[str]):
        self.app, self.allowed = app, set(allowed_hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            return await self.app(scope, receive, send)
        refusal = self._refusal(scope["method"], Headers(scope=scope)) or _null_byte(scope)
        state: dict[str, bool] = {}

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
                if scope["path"].startswith("/api/"):  # a browser may be somebody else's tomorrow: ask again each time
                    headers.setdefault("Cache-Control", "private, no-cache")
                    headers.add_vary_header("Cookie")
                    headers.add_vary_header("Authorization")
                if message["status"] == 413 and headers.get("content-type") != PROBLEM:
                    headers["content-type"] = PROBLEM  # the framework's own is bare text
                    headers["content-length"] = str(len(TOO_LARGE))
                    state["replace"] = True
            elif state.get("replace"):
                message = {"type": "http.response.body", "body": TOO_LARGE if state.pop("replace") else b""}
            await send(message)

        return await (refusal or self.app)(scope, receive, send_with_headers)

    def _refusal(self, method: str, headers: Headers) -> Response | None:
        host = headers.get("host", "")
        if "*" not in self.allowed and host_name(host) not in self.allowed:
            return problem(400, "host-unknown", "This server does not answer to that name.")
        origin = headers.get("origin")
        if method not in SAFE and origin is not None and _netloc(origin) != host:
            return problem(403, "origin-foreign", "Pages of another origin may not change anything here.")
        by_key = headers.get("authorization", "").lower().startswith("bearer ")
        if method not in SAFE and origin is None and not by_key:
            return _csrf(session_token(headers.get("cookie", "")), headers.get(CSRF_HEADER, ""))
        return None


def _csrf(session: str, shown: str) -> Response | None:
    if not session or hmac.compare_digest(csrf_token(session).encode(), shown.encode()):
        return None
    title = "A change by cookie needs the header Origin, or X-CSRF-Token with the token that GET /me tells."
    return problem(403, "csrf", title)


def session_token(cookies: str) -> str:
    """The session's token in a Cookie header; empty where there is none."""
    return cookie_value(cookies, SECURE_COOKIE, COOKIE)


def cookie_value(cookies: str, secure_name: str, name: str) -> str:
    """Of a cookie that has one name over https and another over http; empty where there is none."""
    jar = cookie_parser(cookies)
    return jar.get(secure_name) or jar.get(name) or ""


def _null_byte(scope: Scope) -> Response | None:
    """No id or name of ours holds one, and a database may choke on it."""
    if "\0" in scope["path"] or b"%00" in scope["query_string"]:
        return problem(400, "request-invalid", "The address holds a null byte.")
    return None


def host_name(host: str) -> str:
    """The name in a Host header, without the port; empty where it is malformed."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


def _netloc(origin: str) -> str:
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return ""


def problem(status: int, kind: str, title: str) -> Response:
    return Response(_content(status, kind, title), status, media_type=PROBLEM)
