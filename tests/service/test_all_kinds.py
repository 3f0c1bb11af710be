"""The same tests over SQLite + files, PostgreSQL + Redis, PostgreSQL + RabbitMQ, with real processes."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator

import httpx
import pytest

from .conftest import KINDS, Place
from .running import a_case, service, submit, wait_for, wait_until

pytestmark = [pytest.mark.services, pytest.mark.slow]


@pytest.fixture(params=KINDS)
def client(request: pytest.FixtureRequest, make_place: Callable[..., Place]) -> Iterator[httpx.Client]:
    place = make_place(request.param)
    with service(place.settings, separate=request.param != "embedded") as client:
        yield client


def test_a_run_from_case_to_channels_preview_and_cancel(client: httpx.Client) -> None:
    run = wait_for(client, submit(client, a_case("first", seconds=0.5)))
    assert (run["state"], run["attempt"], run["progress"], run["outcomes"]) == (
        "succeeded",
        1,
        1.0,
        {"statics": "succeeded"},
    )
    assert client.get(f"/api/v1/runs/{run['id']}/summary").json()["case"] == "first"
    names = [item["name"] for item in client.get(f"/api/v1/runs/{run['id']}/channels").json()["items"]]
    assert names[0] == "frequency/vessel/surge"
    _followed(client)
    _cancelled_while_running(client)
    _failed(client)
    _previewed(client)
    _many(client)


def _followed(client: httpx.Client) -> None:
    """Server-sent events: a first state, progress, the final state, and the end of the stream."""
    run_id = submit(client, a_case("followed", seconds=2))
    seen = []
    with client.stream("GET", f"/api/v1/runs/{run_id}/events") as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        for line in stream.iter_lines():
            if line.startswith("data: "):
                seen.append(json.loads(line.removeprefix("data: ")))
    assert seen[-1]["state"] == "succeeded"
    assert any(0 < run["progress"] < 1 and run["message"].startswith("step") for run in seen)


def _cancelled_while_running(client: httpx.Client) -> None:
    run_id = submit(client, a_case("long", seconds=60))
    wait_until(lambda: client.get(f"/api/v1/runs/{run_id}").json()["state"] == "running", 10)
    began = time.monotonic()
    answer = client.post(f"/api/v1/runs/{run_id}/cancel")
    assert (answer.status_code, answer.json()["state"]) == (202, "cancelling")
    assert wait_for(client, run_id)["state"] == "cancelled"
    assert time.monotonic() - began < 2
    assert client.post(f"/api/v1/runs/{run_id}/cancel").status_code == 409
    assert client.delete(f"/api/v1/runs/{run_id}").status_code == 204
    assert client.get(f"/api/v1/runs/{run_id}").status_code == 404


def _failed(client: httpx.Client) -> None:
    run = wait_for(client, submit(client, a_case("bad", fault="diverge")))
    assert (run["state"], run["reason"]) == ("failed", "It went on and on. Use a shorter line.")
    assert run["attempt"] == 1
    run = wait_for(client, submit(client, a_case("bug", fault="bug")))
    assert run["state"] == "failed"
    assert "secret" not in run["reason"]


def _previewed(client: httpx.Client) -> None:
    wait_until(lambda: client.post("/api/v1/preview", json=a_case("warm")).status_code == 200, 10)
    began = time.monotonic()
    answer = client.post("/api/v1/preview", json=a_case("seen"))
    assert answer.json()["lines"]["top"]["position"][2] == [20.0, 0.0, 0.0]
    assert time.monotonic() - began < 1


def _many(client: httpx.Client) -> None:
    """Every one of twenty runs ends once, and dispatch is quick."""
    began = time.monotonic()
    ids = [submit(client, a_case(f"many {number}")) for number in range(20)]
    assert {wait_for(client, run_id)["state"] for run_id in ids} == {"succeeded"}
    assert time.monotonic() - began < 20
