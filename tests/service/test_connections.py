"""Connections that send no whole request, or too slowly, leave room for the others, and fill no disk."""

from __future__ import annotations

import contextlib
import resource
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest

from .conftest import Place
from .running import command, end, environment, free_port, wait_until

pytestmark = pytest.mark.slow
HALF = b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Never-Ending: "


@contextlib.contextmanager
def serving(place: Place, open_files: int, **settings: object) -> Iterator[tuple[int, Path]]:
    """`slowdrift serve` where the system allows so many open files: its port and its logs."""
    port = free_port()
    place.settings.data_dir.mkdir(parents=True, exist_ok=True)
    names = {f"SLOWDRIFT_{name.upper()}": str(value) for name, value in settings.items()}
    process = subprocess.Popen(
        command("serve", "--port", str(port), "--no-pages", "--workers", "0"),
        env=environment(place.settings) | names,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (min(open_files, 1024), open_files)),
    )
    try:
        wait_until(lambda: answers(port), 60)
        yield port, place.settings.data_dir / "logs"
    finally:
        end(process)


def answers(port: int) -> bool:
    """A request on a connection of its own."""
    with contextlib.suppress(httpx.HTTPError):
        return httpx.get(f"http://127.0.0.1:{port}/healthz", timeout=20).status_code == 200
    return False


def half_open(port: int, count: int) -> list[socket.socket]:
    made = []
    for _ in range(count):
        one = socket.create_connection(("127.0.0.1", port), 20)
        one.sendall(HALF)
        made.append(one)
    return made


def is_closed(one: socket.socket) -> bool:
    one.setblocking(False)
    try:
        return one.recv(1) == b""
    except BlockingIOError:
        return False
    except OSError:
        return True


@pytest.mark.parametrize("open_files", [4096, 700])
def test_a_thousand_half_open_connections(make_place: Callable[..., Place], open_files: int) -> None:
    """With places for all of them, and with fewer: then the longest waiting give theirs."""
    with serving(make_place("embedded"), open_files) as (port, logs):
        held: list[socket.socket] = []
        try:
            for _ in range(10):
                held += half_open(port, 100)
                assert answers(port)
            wait_until(lambda: all(is_closed(one) for one in held), 60)  # the time limit of a head
            assert answers(port)
        finally:
            for one in held:
                one.close()
        assert sum(path.stat().st_size for path in logs.iterdir()) < 100_000


def test_a_head_by_drops_and_a_body_that_stops(make_place: Callable[..., Place]) -> None:
    with serving(make_place("embedded"), 1024) as (port, _):
        slow = half_open(port, 1)[0]
        body = socket.create_connection(("127.0.0.1", port), 20)
        body.sendall(
            b"POST /api/v1/cases HTTP/1.1\r\nHost: 127.0.0.1\r\nOrigin: http://127.0.0.1\r\n"
            b"Content-Type: application/json\r\nContent-Length: 1000\r\n\r\n{"
        )
        began = time.monotonic()
        while not is_closed(slow):
            slow.setblocking(True)
            with contextlib.suppress(OSError):
                slow.sendall(b"x")
            time.sleep(0.5)
            assert time.monotonic() - began < 60
        assert time.monotonic() - began > 5
        wait_until(lambda: is_closed(body), 90)
        assert answers(port)
