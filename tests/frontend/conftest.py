"""The pages without a browser: the Flask app over the fake service, which answers in this process."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import flask
import httpx
import pytest
from fastapi.testclient import TestClient

from frontend.app import create_app
from frontend.client import Client
from tests.frontend.fake_api import create_fake


class Direct(httpx.BaseTransport):
    """Hands each request of the pages to the fake service."""

    def __init__(self, service: TestClient) -> None:
        self.service = service
        self.seen: list[httpx.Request] = []

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        self.seen.append(request)
        answer = self.service.request(
            request.method, request.url.raw_path.decode(), content=request.read(), headers=dict(request.headers)
        )
        kept = {"content-type": answer.headers.get("content-type", "")}
        return httpx.Response(answer.status_code, content=answer.content, headers=kept, request=request)


@pytest.fixture(scope="session")
def service() -> Iterator[TestClient]:
    with TestClient(create_fake(run_seconds=0.0)) as made:
        yield made


@pytest.fixture(scope="session")
def server(service: TestClient) -> flask.Flask:
    made = create_app("http://service.test")
    pages: Client = made.config["SLOWDRIFT_CLIENT"]
    pages._http = httpx.Client(transport=Direct(service))
    return made


@pytest.fixture
def request_context(server: flask.Flask) -> Iterator[flask.Flask]:
    with server.test_request_context("/", headers={"Cookie": "session=abc"}):
        yield server


def submit(service: TestClient, example: str, analyses: list[str] | None = None) -> dict[str, Any]:
    listed = {item["name"]: item["yaml"] for item in service.get("/api/v1/examples").json()}
    case = service.post("/api/v1/cases", content=listed[example]).json()
    run: dict[str, Any] = service.post("/api/v1/runs", json={"case_id": case["id"], "analyses": analyses}).json()
    return run


@pytest.fixture(scope="session")
def vessel_run(service: TestClient) -> dict[str, Any]:
    return submit(service, "fpso-2000m", ["statics", "frequency_domain", "modes"])


@pytest.fixture(scope="session")
def riser_run(service: TestClient) -> dict[str, Any]:
    return submit(service, "hanging-riser-case1", ["statics", "frequency_domain"])


@pytest.fixture(scope="session")
def timed_run(service: TestClient) -> dict[str, Any]:
    """A vessel with a time domain."""
    return submit(service, "fpso-2000m")


@pytest.fixture(scope="session")
def timed_riser(service: TestClient) -> dict[str, Any]:
    return submit(service, "hanging-riser-case1")
