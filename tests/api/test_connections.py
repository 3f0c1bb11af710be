"""Rules of api/connections.py without a server: who is refused, who gives up the place, what has passed its time."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any

import pytest

from api.connections import Connections, trusted_by


class Fake:
    """As much of a protocol as the rules look at."""

    def __init__(self, connections: Connections, waits: bool, since: float = 0.0):
        self.connections, self.since, self.waits, self.aborted = connections, since, waits, False
        self.transport = SimpleNamespace(abort=self.abort)

    def abort(self) -> None:
        self.aborted = True

    def waits_for_a_head(self) -> bool:
        return self.waits


def opened(connections: Any, address: str, waits: bool = True, since: float = 0.0) -> tuple[Fake, str | None]:
    one = Fake(connections, waits, since)
    return one, connections.admit(one, address)


def test_one_address_has_so_many_and_others_still_come() -> None:
    connections = Connections(most=100, most_per_address=3, trusted=trusted_by("192.0.2.1, 198.51.100.0/24"))
    assert [opened(connections, "203.0.113.5")[1] for _ in range(4)] == [None, None, None, "address"]
    assert opened(connections, "203.0.113.6")[1] is None
    for address in ("127.0.0.1", "::1", "192.0.2.1", "198.51.100.77"):
        assert [opened(connections, address)[1] for _ in range(10)] == [None] * 10
    assert [opened(connections, f"2001:db8::{k}")[1] for k in range(4)] == [None, None, None, "address"]  # one network
    assert opened(connections, "2001:db8:0:1::1")[1] is None


def test_a_place_that_is_given_back_is_free() -> None:
    connections: Any = Connections(most=100, most_per_address=1)
    one, reason = opened(connections, "203.0.113.5")
    assert reason is None
    connections.forget(one)
    connections.forget(one)  # twice is once
    assert opened(connections, "203.0.113.5")[1] is None
    assert connections.of_address == {"203.0.113.5": 1}


def test_the_longest_waiting_gives_its_place() -> None:
    connections = Connections(most=3)
    asks, _ = opened(connections, "a", waits=False, since=1.0)
    old, _ = opened(connections, "b", since=2.0)
    new, _ = opened(connections, "c", since=3.0)
    assert opened(connections, "d", waits=False)[1] is None
    assert (asks.aborted, old.aborted, new.aborted) == (False, True, False)
    assert opened(connections, "e", waits=False)[1] is None
    assert new.aborted
    assert opened(connections, "f", waits=False)[1] == "full"  # every place has a request
    assert connections.closed == {"room": 2}


@pytest.mark.parametrize(
    ("state", "expected"),
    [
        ({"cycle": None, "since": 9.0}, None),
        ({"cycle": None, "since": 11.0}, "head"),
        ({"cycle": "done", "since": 1000.0, "idle": True}, None),
        ({"cycle": "done", "since": 11.0}, "head"),  # another request has begun
        ({"cycle": "body", "since": 25.0, "heard": 25.0}, None),
        ({"cycle": "body", "since": 31.0, "heard": 31.0}, "body"),
        ({"cycle": "body", "since": 100.0, "heard": 1.0, "received": 60_000}, "body"),  # 70 s at less than 1 kB/s
        ({"cycle": "body", "since": 100.0, "heard": 1.0, "received": 80_000}, None),
        ({"cycle": "body", "since": 100.0, "heard": 90.0, "read_paused": True}, None),  # we do not read it
        ({"cycle": "answer", "since": 100.0}, None),
        ({"cycle": "answer", "since": 100.0, "stuck": 29.0}, None),
        ({"cycle": "answer", "since": 100.0, "stuck": 31.0}, "answer"),
    ],
)
def test_time_limits(state: dict[str, Any], expected: str | None) -> None:
    """Seconds ago, of 10 for a head and 30 for a body or an answer that is not read."""
    from api.connections import LimitedProtocol

    now = time.monotonic()
    one: Any = LimitedProtocol.__new__(LimitedProtocol)
    cycle = state["cycle"]
    one._all = Connections(header_seconds=10, body_seconds=30, least_rate=1000)
    one.cycle = cycle and SimpleNamespace(response_complete=cycle == "done", more_body=cycle == "body")
    one.flow = SimpleNamespace(write_paused="stuck" in state, read_paused=state.get("read_paused", False))
    one.since, one._heard_at = now - state["since"], now - state.get("heard", 0.0)
    one._received, one._idle = state.get("received", 0), state.get("idle", False)
    one._stuck_since = now - state["stuck"] if "stuck" in state else None
    assert one.overdue(now) == expected
