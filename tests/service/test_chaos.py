"""Whatever is killed, every accepted run ends exactly once."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from .conftest import KINDS, Place
from .running import a_case, command_line, processes_of, service, submit, wait_for, wait_until

pytestmark = [pytest.mark.services, pytest.mark.slow]


def _kill(settings: object, what: Callable[[str], bool], of_pool: bool) -> bool:
    """Kill -9 a worker (`of_pool` False) or all children of the workers."""
    workers = [pid for pid in processes_of(settings) if what(command_line(pid))]  # type: ignore[arg-type]
    parents = {
        int(Path(f"/proc/{pid}/stat").read_text().split(") ")[1].split()[1])
        for pid in workers
        if Path(f"/proc/{pid}").exists()
    }
    chosen = [pid for pid in workers if (pid not in parents) == of_pool]
    for pid in chosen if of_pool else chosen[:1]:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    return bool(chosen)


@pytest.mark.parametrize("kind", KINDS)
def test_killed_children_and_workers_lose_no_run(kind: str, make_place: Callable[..., Place], tmp_path: Path) -> None:
    settings = make_place(kind, max_attempts=6).settings
    log = tmp_path / "starts.log"

    def is_worker(line: str) -> bool:
        return "cli.main worker" in line and "hydrodynamics" not in line  # small runs are the interactive queue's

    def begun() -> int:
        return len(log.read_text().splitlines()) if log.exists() else 0

    with service(settings, False) as client:
        ids = [submit(client, a_case(f"run {number}", seconds=0.4, log=str(log))) for number in range(24)]
        chance = random.Random(7)
        for round_number in range(5):
            before = begun()
            wait_until(lambda before=before: begun() > before, 60)  # a task is at work now
            time.sleep(0.3 * chance.random())
            _kill(settings, is_worker, of_pool=round_number % 2 == 0)
        ends = {run_id: wait_for(client, run_id, 60) for run_id in ids}
        assert {run["state"] for run in ends.values()} == {"succeeded"}
        for run_id in ids:
            assert len(client.get(f"/api/v1/runs/{run_id}/channels").json()["items"]) == 3
    starts = log.read_text().splitlines()
    assert len(starts) >= 24
    assert any(run["attempt"] > 1 for run in ends.values())


def test_a_task_that_always_kills_its_worker_fails_with_the_reason(make_place: Callable[..., Place]) -> None:
    settings = make_place("embedded", max_attempts=2).settings
    with service(settings, False) as client:
        run = wait_for(client, submit(client, a_case("killer", fault="die")), 60)
        assert run["state"] == "failed"
        assert "lost 2 times" in run["reason"]
        assert wait_for(client, submit(client, a_case("next")))["state"] == "succeeded"


def test_a_restarted_worker_goes_on_from_the_checkpoint(make_place: Callable[..., Place]) -> None:
    """An orderly end gives the task back at once, with its checkpoint and without counting the attempt."""
    settings = make_place("embedded", max_attempts=1).settings
    with service(settings, False) as client:
        run_id = submit(client, a_case("long", seconds=8))
        wait_until(lambda: client.get(f"/api/v1/runs/{run_id}").json()["progress"] > 0.2, 10)
    with service(settings, False) as client:
        assert wait_for(client, run_id)["state"] == "succeeded"
        assert client.get(f"/api/v1/runs/{run_id}/summary").json()["resumed_from"] > 50


def test_a_killed_supervisor_leaves_nothing_running(make_place: Callable[..., Place]) -> None:
    from .running import free_port, start

    settings = make_place("embedded").settings
    process = start(settings, "serve", "--port", str(free_port()), "--no-pages")
    wait_until(lambda: len(processes_of(settings)) >= 5, 60)
    process.kill()
    process.wait()
    wait_until(lambda: not processes_of(settings), 5)
