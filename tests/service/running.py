"""A service started with the very commands a person or a container uses, and a client for it."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx

from store.settings import Settings

ROOT = Path(__file__).resolve().parents[2]
FINAL = ("succeeded", "failed", "cancelled")


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-P", "-m", "cli.main", *arguments]


TABLES = Path(tempfile.gettempdir()) / "slowdrift-tests-capytaine"
"""The Green function's tables, which every worker of hydrodynamic jobs would make anew in its data folder."""


def environment(settings: Settings) -> dict[str, str]:
    return (
        os.environ
        | settings.as_env()
        | {"CAPYTAINE_CACHE_DIR": str(TABLES)}
        | {"PYTHONPATH": os.environ.get("SD_TEST_PATH", str(ROOT))}
    )


def start(settings: Settings, *arguments: str) -> subprocess.Popen[str]:
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    log = (settings.data_dir / f"{arguments[0]}-{time.time_ns()}.out").open("w")
    return subprocess.Popen(
        command(*arguments), env=environment(settings), stdout=log, stderr=log, text=True, start_new_session=True
    )


def end(process: subprocess.Popen[str], wait: float = 15.0) -> int:
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
    try:
        return process.wait(wait)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        raise


def processes_of(settings: Settings) -> list[int]:
    """Every process whose environment names this test's queues."""
    mark = f"SLOWDRIFT_QUEUE_PREFIX={settings.queue_prefix}".encode()
    found = []
    for path in Path("/proc").iterdir():
        if path.name.isdigit() and int(path.name) != os.getpid():
            with contextlib.suppress(OSError):
                if mark in (path / "environ").read_bytes() and (path / "stat").read_text().split(") ")[1][0] != "Z":
                    found.append(int(path.name))
    return found


def command_line(pid: int) -> str:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    return ""


def free_port() -> int:
    import socket

    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@contextlib.contextmanager
def service(settings: Settings, separate: bool, *extra: str) -> Iterator[httpx.Client]:
    """The service: all in one, or API and workers apart as in docker-compose.yml. Ends, and leaves nothing."""
    port = free_port()
    serve = ["serve", "--port", str(port), "--no-pages", "--log", "here", *extra]
    if separate:
        commands = [[*serve, "--workers", "0"], ["worker", "--concurrency", "2"], ["worker", "--queue", "interactive"]]
    else:
        commands = [[*serve, "--workers", "2"]]
    running = [start(settings, *one) for one in commands]
    try:
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=30) as client:
            wait_until(lambda: _ready(client), 60)
            yield client
    finally:
        for process in running:
            end(process)
    wait_until(lambda: not processes_of(settings), 5)


def _ready(client: httpx.Client) -> bool:
    try:
        return client.get("/readyz").status_code == 200
    except httpx.HTTPError:
        return False


def wait_until(true: Any, seconds: float) -> None:
    deadline = time.monotonic() + seconds
    while not true():
        if time.monotonic() > deadline:
            raise AssertionError(f"still not so after {seconds} s")
        time.sleep(0.05)


def a_case(name: str, analyses: dict[str, Any] | None = None, **orders: Any) -> dict[str, Any]:
    """A small case that tells the fake solver, in its description, what to do."""
    return {
        "slowdrift": 1,
        "name": name,
        "description": json.dumps(orders),
        "environment": {"depth": 100},
        "line_types": {"t": {"diameter": 0.1, "mass": 50, "EA": 1e8}},
        "lines": {
            "top": {
                "segments": [{"type": "t", "length": 120, "elements": 6}],
                "end_a": {"pinned": [0, 0, -100]},
                "end_b": {"pinned": [30, 0, 0]},
            }
        },
        "analyses": analyses or {"statics": {}},
    }


def submit(client: httpx.Client, case: dict[str, Any]) -> str:
    answer = client.post("/api/v1/runs", json={"case": case})
    assert answer.status_code == 202, answer.text
    return str(answer.json()["id"])


def wait_for(client: httpx.Client, run_id: str, seconds: float = 30.0) -> dict[str, Any]:
    deadline = time.monotonic() + seconds
    while True:
        run: dict[str, Any] = client.get(f"/api/v1/runs/{run_id}").json()
        if run["state"] in FINAL:
            return run
        assert time.monotonic() < deadline, run
        time.sleep(0.05)
