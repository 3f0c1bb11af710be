"""Without accounts: nobody signs in, everything works, and the first account ends that at once."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from api import doorkeeper
from api.main import create_app
from store.database import Database
from store.models import DEFAULT_PROJECT, DEFAULT_TEAM
from store.repositories.accounts import AccountRepository
from store.settings import Settings
from tests.api.conftest import TestClient, service_settings  # noqa: F401  (fixture)
from tests.service.running import a_case


@pytest.fixture
def alone(service_settings: Settings, monkeypatch: pytest.MonkeyPatch) -> Iterator[TestClient]:  # noqa: F811
    monkeypatch.setattr(doorkeeper, "ASK_AGAIN", 0.0)
    with TestClient(create_app(service_settings, reconcile=False), base_url="http://localhost") as client:
        yield client


def test_everything_is_open_to_this_machine(alone: TestClient) -> None:
    assert alone.get("/api/v1/auth").json() == {"accounts": False, "signed_in": False, "provider": None}
    me = alone.get("/api/v1/me").json()
    assert (me["mode"], me["by"], me["user"]) == ("one-person", "local", None)
    assert (me["home"]["team_id"], me["home"]["project_id"]) == (DEFAULT_TEAM, DEFAULT_PROJECT)
    run = alone.post("/api/v1/runs", json={"case": a_case("mine")}).json()
    link = alone.post("/api/v1/shares", json={"run_ids": [run["id"]]}).json()["token"]
    assert alone.get(f"/api/v1/shared/{link}").json()["runs"][0]["id"] == run["id"]
    project = alone.post(f"/api/v1/teams/{DEFAULT_TEAM}/projects", json={"name": "Second"}).json()["project_id"]
    assert alone.get("/api/v1/runs", params={"project": project, "total": True}).json()["total"] == 0
    assert alone.get("/api/v1/runs", params={"project": "f" * 32}).status_code == 404
    assert alone.get("/api/v1/teams").json()["items"][0]["projects"] == 2


def test_what_needs_a_person_says_so(alone: TestClient) -> None:
    for method, path, body in (
        ("GET", "/keys", None),
        ("POST", "/keys", {"name": "k"}),
        ("PATCH", "/me", {"name": "n"}),
        ("PUT", "/me/password", {"old": "x", "new": "0123456789"}),
        ("POST", "/users", {"email": "a@x.org", "name": "A"}),
    ):
        answer = alone.request(method, f"/api/v1{path}", json=body)
        assert (answer.status_code, answer.json()["type"]) == (409, "conflict"), path
        assert "slowdrift user add" in answer.json()["detail"]
    wrong = alone.post("/api/v1/auth/sign-in", json={"email": "a@x.org", "password": "whatever it is"})
    assert wrong.status_code == 401


def test_the_first_account_locks_a_running_service(alone: TestClient, service_settings: Settings) -> None:  # noqa: F811
    assert alone.get("/api/v1/runs").status_code == 200
    database = Database(service_settings.database)
    with database.write() as session:
        AccountRepository(session).add("ada@x.org", "Ada", None, True)
    database.close()
    assert alone.get("/api/v1/runs").status_code == 401
    assert alone.get("/api/v1/auth").json() == {"accounts": True, "signed_in": False, "provider": None}
