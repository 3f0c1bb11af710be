"""Ensembles of the real march on real workers: one killed in the middle changes no number; cancel stops it at once."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import httpx
import numpy as np
import pytest
from sqlalchemy import select
from sqlalchemy.orm import undefer

from solver.case import parse_case
from solver.results.part import Result
from solver.run import run
from store.database import Database
from store.models import Task
from store.settings import Settings

from .conftest import Place
from .running import FINAL, end, free_port, processes_of, service, start, submit, wait_for, wait_until

pytestmark = pytest.mark.slow
SEEDS, BUILD_UP, DURATION = 12, 100.0, 8_000.0


def _case(seeds: int = SEEDS, duration: float = DURATION) -> dict[str, Any]:
    """Two short lines in a random sea: chunks of four seeds, a second or two each."""
    lines = {
        f"line-{k}": {
            "segments": [{"type": "t", "length": 130, "elements": 5}],
            "end_a": {"pinned": [0, 10 * k, -100]},
            "end_b": {"pinned": [60, 10 * k, -4]},
        }
        for k in range(2)
    }
    spec = {
        "step": 0.1,
        "build_up": BUILD_UP,
        "duration": duration,
        "output_step": 5.0,
        "seeds": seeds,
        "wave_step": 0.01,
    }
    return {
        "slowdrift": 1, "name": "ensemble",
        "environment": {"depth": 100, "seastates": [{"spectrum": "jonswap", "hs": 4, "tp": 10, "direction": "0 deg"}]},
        "line_types": {"t": {"diameter": 0.1, "mass": 50, "EA": 1e8}}, "lines": lines, "analyses": {"time_domain": spec},
    }  # fmt: skip


@pytest.fixture(scope="module")
def undisturbed() -> Result:
    return run(parse_case(_case()), None, threads=2)


@dataclass(frozen=True)
class Row:
    """A task as the database has it."""

    id: str
    state: str
    attempt: int
    worker: str
    progress: float
    saved_step: int


def _rows(database: Database, run_id: str) -> list[Row]:
    with database.read() as session:
        query = select(Task).where(Task.run_id == run_id).order_by(Task.number).options(undefer(Task.checkpoint))
        return [
            Row(t.id, t.state, t.attempt, t.worker or "", t.progress, _saved_step(t.checkpoint))
            for t in session.scalars(query)
        ]


def _saved_step(checkpoint: bytes | None) -> int:
    if checkpoint is None:
        return 0
    with np.load(io.BytesIO(checkpoint), allow_pickle=False) as stored:
        return int(stored["0/step"])


def _in_the_middle(database: Database, run_id: str) -> Row:
    """A task well on its way that has saved where it is."""
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        for row in _rows(database, run_id):
            if row.state == "running" and row.saved_step > 0 and 0.3 < row.progress < 0.8:
                return row
        time.sleep(0.02)
    raise AssertionError(_rows(database, run_id))


def _same_numbers(client: httpx.Client, run_id: str, whole: Result) -> None:
    summary = client.get(f"/api/v1/runs/{run_id}/summary").json()
    for name, line in whole.summary["time_domain"]["lines"].items():
        for key in ("tension_min", "tension_max", "tension_mean", "end_b_max_per_seed"):
            np.testing.assert_allclose(summary["time_domain"]["lines"][name][key], line[key], rtol=1e-10)
    channel = next(one for one in whole.channels if one.name == "time/line/line-0/end_b_tension")
    for column, seed in enumerate(channel.axes[1].values):
        query = {"seed": int(seed), "points": 100_000}
        got = client.get(f"/api/v1/runs/{run_id}/channels/{channel.name}", params=query).json()["values"]
        np.testing.assert_allclose(np.ravel(got), np.asarray(channel.values)[:, column], rtol=1e-10)


def _killed_in_the_middle(client: httpx.Client, settings: Settings, whole: Result, whole_worker: bool) -> None:
    database = Database(settings.database)
    run_id = submit(client, _case())
    victim = _in_the_middle(database, run_id)
    parent, child = (int(part) for part in victim.worker.split("/")[1:3])
    os.kill(parent if whole_worker else child, signal.SIGKILL)
    seen: list[float] = []
    while client.get(f"/api/v1/runs/{run_id}").json()["state"] not in FINAL:
        row = next(one for one in _rows(database, run_id) if one.id == victim.id)
        if row.attempt == 2 and row.state == "running" and row.progress > 0.051:
            seen.append(row.progress)
        time.sleep(0.02)
    assert wait_for(client, run_id)["state"] == "succeeded"
    rows = _rows(database, run_id)
    assert len(rows) == 3
    assert sorted(row.attempt for row in rows) == [1, 1, 2]  # the others lost nothing
    steps = round((BUILD_UP + DURATION) / 0.1)
    assert seen, "the second attempt was too short to be seen"
    assert (
        min(seen) >= 0.05 + 0.93 * victim.saved_step / steps - 1e-9
    )  # went on from the checkpoint, not from the start
    _same_numbers(client, run_id, whole)
    database.close()


def test_a_killed_child_of_the_embedded_service_changes_no_number(
    make_place: Callable[..., Place], undisturbed: Result
) -> None:
    settings = make_place("embedded", solver="solver.run").settings
    with service(settings, False) as client:
        _killed_in_the_middle(client, settings, undisturbed, whole_worker=False)


@contextlib.contextmanager
def _two_workers(settings: Settings) -> Iterator[httpx.Client]:
    """An API and two workers, each a process of its own as on two machines."""
    port = free_port()
    commands = [["serve", "--port", str(port), "--no-pages", "--log", "here", "--workers", "0"], ["worker"], ["worker"]]
    running = [start(settings, *one) for one in commands]
    try:
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=30) as client:
            wait_until(lambda: _answers(client), 60)
            yield client
    finally:
        for process in running:
            end(process, 30)
    wait_until(lambda: not processes_of(settings), 5)


def _answers(client: httpx.Client) -> bool:
    with contextlib.suppress(httpx.HTTPError):
        return client.get("/healthz").status_code == 200
    return False


@pytest.mark.services
def test_a_killed_worker_beside_another_changes_no_number(
    make_place: Callable[..., Place], undisturbed: Result
) -> None:
    settings = make_place("postgres-redis", solver="solver.run").settings
    with _two_workers(settings) as client:
        _killed_in_the_middle(client, settings, undisturbed, whole_worker=True)


def test_cancel_stops_the_march_within_two_seconds(make_place: Callable[..., Place]) -> None:
    """With the heartbeat a service has by default; stopped means that no worker holds a task any more."""
    settings = make_place("embedded", solver="solver.run", heartbeat_seconds=1.0, checkpoint_seconds=30).settings
    database = Database(settings.database)
    with service(settings, False) as client:
        for share in (0.06, 0.15):
            run_id = submit(client, _case(seeds=8, duration=80_000.0))
            wait_until(lambda run_id=run_id, share=share: _rows(database, run_id)[0].progress > share, 120)
            asked = time.monotonic()
            assert client.post(f"/api/v1/runs/{run_id}/cancel").status_code in (200, 202)
            wait_until(lambda run_id=run_id: client.get(f"/api/v1/runs/{run_id}").json()["state"] == "cancelled", 10)
            took = time.monotonic() - asked
            assert all(row.state == "cancelled" for row in _rows(database, run_id))
            assert took < 2.0, f"cancel took {took:.2f} s"
    database.close()
