"""One fault, many runs: submitted by clients that try again, followed to their end, their numbers checked."""

from __future__ import annotations

import os
import threading
import time
import uuid
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx

from ..running import FINAL, ROOT, a_case, end, free_port, processes_of, start, wait_until
from .faults import Fault, in_background
from .rig import Rig, rig

CLIENTS = 4
STUCK_SECONDS = 60.0
CLOCK = """
import os, time
_path, _real, _real_ns = os.environ.get("SD_TEST_CLOCK"), time.time, time.time_ns
_known = [0.0, 0.0]
def _offset():
    now = time.monotonic()
    if now - _known[0] > 0.05:
        try: _known[:] = [now, float(open(_path).read() or 0)]
        except (OSError, ValueError): _known[0] = now
    return _known[1]
if _path:
    time.time = lambda: _real() + _offset()
    time.time_ns = lambda: _real_ns() + int(_offset() * 1e9)
"""


@dataclass
class Tally:
    """How it went. `wrong` holds a sentence for each thing that should not be."""

    kind: str
    fault: str
    accepted: int = 0
    refusals: int = 0
    succeeded: int = 0
    failed: int = 0
    retried: int = 0
    seconds_after: float = 0.0
    """From the end of the fault to the end of the last run."""
    wrong: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        verdict = "ok" if not self.wrong else "; ".join(self.wrong)[:300]
        return (
            f"| {self.kind} | {self.fault} | {self.accepted} | {self.succeeded} | {self.failed} | {self.retried} | "
            f"{self.refusals} | {self.seconds_after:.0f} s | {verdict} |"
        )


HEADER = (
    "| on | fault | accepted | succeeded | failed with reason | more than one attempt | requests tried again | "
    "last end after the fault | verdict |\n| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |"
)


class Clients:
    """Submit every run under a key of its own until it is accepted."""

    def __init__(self, url: str, runs: int, hogs: int, tally: Tally):
        self.url, self.runs, self.hogs, self.tally = url, runs, hogs, tally
        self.accepted: dict[str, int] = {}
        self._next = iter(range(runs))
        self._lock = threading.Lock()
        self.threads = [threading.Thread(target=self._run, name=f"client {k}") for k in range(CLIENTS)]

    def start(self) -> None:
        for thread in self.threads:
            thread.start()

    def join(self) -> None:
        for thread in self.threads:
            thread.join()

    def _run(self) -> None:
        with httpx.Client(base_url=self.url, timeout=40) as client:
            while True:
                with self._lock:
                    number = next(self._next, None)
                if number is None:
                    return
                self._submit(client, number)
                time.sleep(0.02)

    def _submit(self, client: httpx.Client, number: int) -> None:
        key = {"Idempotency-Key": uuid.uuid4().hex}
        deadline = time.monotonic() + 120
        while True:
            try:
                answer = client.post(
                    "/api/v1/runs", json={"case": the_case(number, self.runs, number < self.hogs)}, headers=key
                )
                if answer.status_code == 202:
                    with self._lock:
                        self.accepted[str(answer.json()["id"])] = number
                    return
                if answer.status_code < 500:
                    self.tally.wrong.append(f"run {number} refused: {answer.status_code} {answer.text[:200]}")
                    return
            except httpx.HTTPError:
                pass
            with self._lock:
                self.tally.refusals += 1
            if time.monotonic() > deadline:
                self.tally.wrong.append(f"run {number} could not be submitted")
                return
            time.sleep(0.3)


def the_case(number: int, runs: int, hog: bool) -> dict[str, Any]:
    """Long enough that all together outlast the fault."""
    seconds = min(0.8, max(0.15, 30 / runs))
    made = a_case(f"run {number}", seconds=seconds, **({"fault": "hog"} if hog else {}))
    made["line_types"]["t"]["EA"] = 1e8 + number
    return made


def campaign(kind: str, name: str, fault: Fault, runs: int, root: Path) -> Tally:
    """Raises MissingError where this machine has not what it needs."""
    tally = Tally(kind, name)
    with rig(kind, root, fault.on_small_disk, **fault.settings) as made:
        _fake_clock(made)
        port = free_port()
        process = start(made.settings, "serve", "--port", str(port), "--no-pages", "--workers", "2")
        try:
            url = f"http://127.0.0.1:{port}"
            with httpx.Client(base_url=url, timeout=40) as client:
                wait_until(lambda: _up(client), 90)
                _computes(client)
                clients = Clients(url, runs, fault.hogs, tally)
                clients.start()
                wait_until(lambda: len(clients.accepted) >= min(runs // 4, 20), 120)
                thread, over = in_background(fault.strike, made)
                clients.join()
                thread.join()
                tally.accepted = len(clients.accepted)
                _follow(client, clients, tally, over[0])
                _verify(client, clients, tally, fault)
        finally:
            end(process, 30)
        wait_until(lambda: not processes_of(made.settings), 10)
    return tally


def _fake_clock(made: Rig) -> None:
    """Every Python process of the service takes its time from a file."""
    folder = made.root / "site"
    folder.mkdir(exist_ok=True)
    (folder / "sitecustomize.py").write_text(CLOCK)
    made.clock_file.write_text("0")
    os.environ["SD_TEST_CLOCK"] = str(made.clock_file)
    os.environ["SD_TEST_PATH"] = f"{folder}{os.pathsep}{ROOT}"


def _up(client: httpx.Client) -> bool:
    try:
        return client.get("/readyz").status_code == 200
    except httpx.HTTPError:
        return False


def _computes(client: httpx.Client) -> None:
    """Workers take a while to start; the fault is to strike when they work."""
    run = client.post("/api/v1/runs", json={"case": a_case("warm")}).json()
    wait_until(lambda: client.get(f"/api/v1/runs/{run['id']}").json()["state"] == "succeeded", 120)


def _follow(client: httpx.Client, clients: Clients, tally: Tally, over: float) -> None:
    """Wait for all; a minute after the fault plus the time that the work itself takes is the limit."""
    limit = over + STUCK_SECONDS + 0.5 * clients.runs
    states: Counter[str] = Counter()
    while time.monotonic() < limit:
        try:
            answer = client.get(
                "/api/v1/runs", params={"state": "queued,running,cancelling", "limit": 1, "total": True}
            )
            if answer.status_code == 200 and answer.json()["total"] == 0:
                tally.seconds_after = max(0.0, time.monotonic() - over)
                return
            states = Counter({"active": answer.json().get("total", -1)})
        except httpx.HTTPError:
            pass
        time.sleep(0.25)
    tally.seconds_after = time.monotonic() - over
    tally.wrong.append(f"stuck: {dict(states)}")


def _verify(client: httpx.Client, clients: Clients, tally: Tally, fault: Fault) -> None:
    """Every accepted run is there once, ended once, with its own numbers or with a reason."""
    total = client.get("/api/v1/runs", params={"limit": 1, "total": True}).json()["total"]
    if total != tally.accepted + 1:  # and the one that warmed up
        tally.wrong.append(f"{total - 1} runs in the store for {tally.accepted} accepted")
    for run_id, number in clients.accepted.items():
        run = client.get(f"/api/v1/runs/{run_id}").json()
        if run.get("state") not in FINAL:
            tally.wrong.append(f"run {number} is {run.get('state', 'gone')}")
            continue
        tally.retried += run["attempt"] > 1
        if run["state"] == "succeeded":
            tally.succeeded += 1
            _check_numbers(client, run_id, number, tally)
        else:
            tally.failed += 1
            expected = "memory" if number < fault.hogs else None
            if expected is None or expected not in str(run["reason"]):
                tally.wrong.append(f"run {number} {run['state']}: {run['reason']}")


def _check_numbers(client: httpx.Client, run_id: str, number: int, tally: Tally) -> None:
    summary = client.get(f"/api/v1/runs/{run_id}/summary").json()
    channels = client.get(f"/api/v1/runs/{run_id}/channels").json()["items"]
    surge = client.get(f"/api/v1/runs/{run_id}/channels/frequency/vessel/surge").json()["values"]
    right = summary["case"] == f"run {number}" and summary["answer"] == (1e8 + number) / 3
    if not right or len(channels) != 3 or abs(surge[49] - 49 * (1e8 + number) / 1e8) > 1e-4:
        tally.wrong.append(f"run {number} has the numbers of another")
