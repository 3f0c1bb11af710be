"""Several API processes on one port: all of them answer, and whichever is asked counts for all."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest

from .conftest import Place
from .running import FINAL, ROOT, command_line, processes_of, service, wait_until

CASE = (ROOT / "examples" / "hanging-riser-case1.yaml").read_text()
ASKED = re.compile(r'slowdrift_request_seconds_count\{method="GET",route="/healthz",status="200"\} (\S+)')
ENDED = re.compile(r'slowdrift_run_seconds_count\{kind="case",state="succeeded"\} (\S+)')


pytestmark = pytest.mark.slow


@pytest.fixture(params=["embedded", pytest.param("postgres-redis", marks=pytest.mark.services)])
def place(request: pytest.FixtureRequest, make_place: Callable[..., Place]) -> Place:
    return make_place(request.param)


@pytest.fixture
def client(place: Place) -> Iterator[httpx.Client]:
    with service(place.settings, False, "--api-processes", "3") as client:
        yield client


def api_processes(place: Place) -> list[int]:
    return [pid for pid in processes_of(place.settings) if " api --fd " in command_line(pid)]


def ask_on_a_new_connection(client: httpx.Client, path: str = "/healthz") -> httpx.Response:
    return httpx.get(f"{client.base_url}{path}", timeout=30)


def counted(client: httpx.Client, what: re.Pattern[str]) -> float:
    found = what.search(ask_on_a_new_connection(client, "/metrics").text)
    return float(found.group(1)) if found else 0.0


def test_they_count_together_and_one_may_die(place: Place, client: httpx.Client) -> None:
    assert len(api_processes(place)) == 3
    before = counted(client, ASKED)
    with ThreadPoolExecutor(20) as pool:
        answers = list(pool.map(lambda _: ask_on_a_new_connection(client).status_code, range(200)))
    assert answers == [200] * 200
    wait_until(lambda: counted(client, ASKED) == before + 200, 10)  # counted once sent, so perhaps a moment later
    assert [counted(client, ASKED) for _ in range(10)] == [before + 200] * 10

    runs = [client.post("/api/v1/runs", json={"yaml": CASE.replace("name: ", f"name: {k} ", 1)}) for k in range(5)]
    for run in runs:
        where = f"/api/v1/runs/{run.json()['id']}"
        wait_until(lambda where=where: ask_on_a_new_connection(client, where).json()["state"] in FINAL, 60)
    wait_until(lambda: counted(client, ENDED) == 5.0, 60)
    assert [counted(client, ENDED) for _ in range(10)] == [5.0] * 10

    for victim in sorted(api_processes(place)):  # whichever it is, the others answer, and it comes back
        os.kill(victim, signal.SIGKILL)
        wait_until(lambda victim=victim: victim not in api_processes(place), 10)
        assert [ask_on_a_new_connection(client, "/api/v1/runs?total=true").json()["total"] for _ in range(20)] == [
            5
        ] * 20
        wait_until(lambda: len(api_processes(place)) == 3, 30)
    assert counted(client, ENDED) == 5.0
