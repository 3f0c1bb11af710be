"""Reads beside open event streams: `python benchmarks/event_streams.py [--streams 0 500 2000] [--before FOLDER]`.

A service with one API process. The streams, in a process of their own, follow 100 runs (half of them) and the project
(the other half) while a study is at work; 50 clients poll, each once a second, for runs and
lists. Printed: times of the reads, the memory of the API process, events that arrived.

`--before` names a folder with another version of the program (`git worktree add FOLDER COMMIT`), which is measured in
the same way, by turns with this one.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import psutil
from service_load import KINDS, ROOT, end_polling, start_polling, started, summary

from cli.options import raise_open_files
from tests.service.running import a_case

OPEN_AT_ONCE = 50


class _Stream(asyncio.Protocol):
    """Counts, and holds nothing: the reader must not take the processor from what it measures."""

    def __init__(self, path: str, counts: dict[str, int], answered: asyncio.Future[None]):
        self._path, self._counts, self._answered = path, counts, answered

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        request = f"GET {self._path} HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: text/event-stream\r\n\r\n"
        transport.write(request.encode())  # type: ignore[attr-defined]

    def data_received(self, data: bytes) -> None:
        if not self._answered.done():
            self._counts["open" if data.startswith(b"HTTP/1.1 200") else "refused"] += 1
            self._answered.set_result(None)
        self._counts["events"] += data.count(b"event: run")

    def connection_lost(self, exc: Exception | None) -> None:
        self._counts["ended"] += 1


def follow(port: int, streams: int, ids: list[str]) -> None:
    """The child process: says when all are open, then reads until its standard input ends, and prints the counts."""
    raise_open_files()
    counts = dict.fromkeys(("open", "refused", "ended", "events"), 0)

    async def open_one(path: str, gate: asyncio.Semaphore) -> None:
        loop = asyncio.get_running_loop()
        async with gate:
            answered: asyncio.Future[None] = loop.create_future()
            await loop.create_connection(lambda: _Stream(path, counts, answered), "127.0.0.1", port)
            await answered

    async def all_of_them() -> None:
        gate = asyncio.Semaphore(OPEN_AT_ONCE)
        paths = [f"/api/v1/runs/{ids[n % len(ids)]}/events" if n % 2 else "/api/v1/events" for n in range(streams)]
        await asyncio.gather(*(open_one(path, gate) for path in paths))
        print("open", flush=True)
        await asyncio.to_thread(sys.stdin.read)
        print(json.dumps(counts), flush=True)

    asyncio.run(all_of_them())


def memory_of_api() -> float:
    """Resident megabytes of the API process that this one started."""
    me = psutil.Process()
    pages = [each for each in me.children(recursive=True) if "api" in each.cmdline() and "--fd" in each.cmdline()]
    return sum(each.memory_info().rss for each in pages) / 2**20


def measure(kind: str, streams: int, seconds: float) -> dict[str, float]:
    """Two workers at work on runs of 1.5 s that compute nothing, so that something changes all the while."""
    with started(kind, "--workers", "2", solver="tests.service.fake_solver") as client:
        grid = {"/line_types/t/EA": [1e8 + number for number in range(300)]}
        body = {"case": a_case("followed", seconds=1.5), "grid": grid}
        assert client.post("/api/v1/studies", json=body).status_code == 202
        waiting = [run["id"] for run in client.get("/api/v1/runs?limit=100").json()["items"]]
        following = None
        began = time.monotonic()
        if streams:
            command = [sys.executable, __file__, "--follow", str(client.base_url.port), str(streams), *waiting]
            following = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT)
            assert following.stdout is not None
            assert following.stdout.readline().strip() == "open"
        opened = time.monotonic() - began
        polling = start_polling(client, 50, waiting[:20])
        began = time.monotonic()
        time.sleep(seconds)
        reads = end_polling(polling)
        found = summary([took for when, took in reads if when >= began])
        found |= {"opened_s": opened, "api_mb": memory_of_api()}
        if following is not None:
            found |= json.loads(following.communicate()[0])
        return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--kind", nargs="*", choices=KINDS, default=["embedded", "postgres-redis"])
    parser.add_argument("--streams", nargs="*", type=int, default=[0, 500, 2000])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--before", type=Path)
    parser.add_argument("--follow", nargs="*", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.follow:
        port, streams, *ids = options.follow
        return follow(int(port), int(streams), ids)
    versions = {"now": ROOT} | ({"before": options.before.resolve()} if options.before else {})
    for kind in options.kind:
        for streams in options.streams:
            for name, folder in versions.items():
                os.environ["SD_TEST_PATH"] = str(folder)
                found = measure(kind, streams, options.seconds)
                print(
                    f"{kind}, {streams} streams, {name}: " + ", ".join(f"{key} {found[key]:.4g}" for key in found),
                    flush=True,
                )
    return None


if __name__ == "__main__":
    main()
