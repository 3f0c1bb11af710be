"""Limits on open connections: how many there may be, and how long one may take to send or to read.

A connection that has sent no whole request costs its sender nothing, and a thousand of them would leave no file
descriptor for anybody else. So they have a time limit, and are closed first, longest waiting before the others, when
all places are taken.
"""

from __future__ import annotations

import asyncio
import ipaddress
import logging
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

log = logging.getLogger(__name__)
FULL = (
    b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nRetry-After: 5\r\nConnection: close\r\n\r\n"
    b"Too many connections are open; try again in a moment.\n"
)
NETWORK = 64
"""Bits of an IPv6 address that one subscriber has."""


@dataclass
class Connections:
    """Open connections of this process. Times in seconds.

    most : altogether; most_per_address : of one address, 0 for any number, not counted for `trusted` ones (proxies).
    header_seconds : until a request's head is there. body_seconds : without a byte of a body that is wanted, or of an
    answer that is not read. least_rate : bytes a second of a body, on average after body_seconds.
    """

    most: int = 5000
    most_per_address: int = 500
    header_seconds: float = 10.0
    body_seconds: float = 30.0
    least_rate: float = 1000.0
    trusted: Callable[[str], bool] = field(default=lambda _: False)
    open: dict[LimitedProtocol, str] = field(default_factory=dict)
    of_address: Counter[str] = field(default_factory=Counter)
    closed: Counter[str] = field(default_factory=Counter)
    """Connections that were closed or refused, by reason."""

    def protocol(self, *arguments: Any, **named: Any) -> LimitedProtocol:
        """What uvicorn calls to make one."""
        return LimitedProtocol(self, *arguments, **named)

    def admit(self, protocol: LimitedProtocol, address: str) -> str | None:
        """Count a new connection; or the reason why it has to be refused."""
        key = _network(address)
        counted = self.most_per_address > 0 and not self.trusted(address)
        if counted and self.of_address[key] >= self.most_per_address:
            return "address"
        if len(self.open) >= self.most and not self._make_room():
            return "full"
        self.open[protocol] = key
        self.of_address[key] += 1
        return None

    def _make_room(self) -> bool:
        waiting = [each for each in self.open if each.waits_for_a_head()]
        if not waiting:
            return False
        self.close(min(waiting, key=lambda each: each.since), "room")
        return True

    def forget(self, protocol: LimitedProtocol) -> None:
        key = self.open.pop(protocol, None)
        if key is not None:
            self.of_address[key] -= 1
            if self.of_address[key] <= 0:
                del self.of_address[key]

    def close(self, protocol: LimitedProtocol, reason: str) -> None:
        self.forget(protocol)
        self.count(reason)
        protocol.transport.abort()

    def count(self, reason: str) -> None:
        self.closed[reason] += 1
        log.info("A connection was closed: %s", REASONS[reason])

    def sweep(self) -> None:
        """Close what has passed a time limit. Called once a second."""
        now = time.monotonic()
        for protocol in list(self.open):
            reason = protocol.overdue(now)
            if reason is not None:
                self.close(protocol, reason)


REASONS = {
    "address": "too many from one address",
    "full": "all places are taken by requests",
    "room": "it had sent no request, and its place was needed",
    "head": "the head of a request took too long",
    "body": "the body of a request took too long",
    "answer": "the answer was not read",
}


class LimitedProtocol(H11Protocol):
    """uvicorn's, with the limits of `Connections`."""

    def __init__(self, connections: Connections, *arguments: Any, **named: Any):
        super().__init__(*arguments, **named)
        self._all = connections
        self.since = self._heard_at = time.monotonic()
        """When it began to wait for a head, or the request began."""
        self._received = 0
        self._stuck_since: float | None = None
        self._refused = False
        self._idle = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        reason = self._all.admit(self, self.client[0] if self.client else "")
        if reason is not None:
            self._refused = True
            self._all.count(reason)
            transport.write(FULL)
            transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        self._all.forget(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        if self._refused:
            return
        now = time.monotonic()
        if self._idle:  # the first byte of another request on the same connection
            self.since, self._idle = now, False
        self._heard_at = now
        self._received += len(data)
        before = self.cycle
        super().data_received(data)
        if self.cycle is not before:
            self.since, self._received = now, 0

    def on_response_complete(self) -> None:
        self._idle = True  # until then, uvicorn's keep-alive time limit is the one that counts
        self.since = time.monotonic()
        super().on_response_complete()

    def waits_for_a_head(self) -> bool:
        return self.cycle is None or self.cycle.response_complete

    def overdue(self, now: float) -> str | None:
        """The time limit that it has passed."""
        limits = self._all
        if self.waits_for_a_head():
            return "head" if not self._idle and now - self.since > limits.header_seconds else None
        if self.flow.write_paused:
            self._stuck_since = now if self._stuck_since is None else self._stuck_since
            return "answer" if now - self._stuck_since > limits.body_seconds else None
        self._stuck_since = None
        if not self.cycle.more_body or self.flow.read_paused:
            self._heard_at = now
            return None
        took = now - self.since
        slow = took > limits.body_seconds and self._received < limits.least_rate * (took - limits.body_seconds)
        return "body" if slow or now - self._heard_at > limits.body_seconds else None


def _network(address: str) -> str:
    try:
        known = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(known, ipaddress.IPv6Address) and known.ipv4_mapped is None:
        return str(ipaddress.ip_network((known, NETWORK), strict=False))
    return address


def trusted_by(names: str) -> Callable[[str], bool]:
    """Whether an address is this machine's or one of these (addresses and networks, with commas; * for any)."""
    networks = [ipaddress.ip_network(name.strip()) for name in names.split(",") if name.strip() not in ("", "*")]
    return partial(_trusts, networks, "*" in names.split(","))


def _trusts(networks: list[Any], any_of_them: bool, address: str) -> bool:
    try:
        known = ipaddress.ip_address(address)
    except ValueError:
        return any_of_them
    return any_of_them or known.is_loopback or any(known in network for network in networks)
