"""Whether a request comes from this machine itself: what the one person of a service without accounts is known by.

A proxy on this machine connects from loopback, too, for callers from anywhere. So a request is not local either when a
header of proxies is there, when the Host is not a name of this machine, or in HTTP/1.0: nginx speaks it, and adds no
header, unless told otherwise. A proxy that forwards bytes (socat, `ssh -L`) cannot be told from a program here.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Iterable

from starlette.types import ASGIApp, Receive, Scope, Send

from store.settings import LOOPBACK, Settings

from .guard import host_name

FORWARDED_FOR = b"x-forwarded-for"
PROXY_HEADERS = frozenset(
    (
        b"forwarded", b"via", b"x-real-ip", b"x-client-ip", b"x-cluster-client-ip", b"x-original-host", b"true-client-ip",
        b"x-original-forwarded-for", b"cf-connecting-ip", b"cf-ray", b"fastly-client-ip", b"x-envoy-external-address",
        b"x-azure-clientip", b"x-amzn-trace-id", b"x-proxyuser-ip", b"x-host",
    )
)  # fmt: skip


def is_loopback(address: str) -> bool:
    try:
        known = ipaddress.ip_address(address)
    except ValueError:
        return False
    mapped = getattr(known, "ipv4_mapped", None)
    return (mapped or known).is_loopback


def is_proxied(headers: Iterable[tuple[bytes, bytes]]) -> bool:
    """Whether a proxy has left its mark among the headers (names in lower case)."""
    return any(name in PROXY_HEADERS or name.startswith(b"x-forwarded") for name, _ in headers)


def is_local(scope: Scope) -> bool:
    """Whether the request was sent by a program on this machine, to this machine."""
    client = scope.get("client")
    if client is None or not is_loopback(client[0]) or scope.get("http_version") == "1.0":
        return False
    host = next((value for name, value in scope["headers"] if name == b"host"), b"")
    return host_name(host.decode("latin-1")) in LOOPBACK and not is_proxied(scope["headers"])


def may_go_unnamed(settings: Settings, scope: Scope) -> bool:
    """Whether a service without accounts obeys this request."""
    return settings.allow_no_login or (not settings.behind_proxy and is_local(scope))


class MarkForwarded:
    """Around the pages, which ask the API over loopback for their callers: marks the requests of callers elsewhere, so
    that the pages hand the mark on and the API does not take those callers for this machine's."""

    def __init__(self, app: ASGIApp):
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        headers = scope.get("headers", [])
        if scope["type"] == "http" and not is_local(scope) and all(name != FORWARDED_FOR for name, _ in headers):
            address = (scope.get("client") or ("unknown", 0))[0]
            scope = {**scope, "headers": [*headers, (FORWARDED_FOR, address.encode("latin-1"))]}
        await self.app(scope, receive, send)
