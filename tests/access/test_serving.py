"""The service as it is started: who needs no login, the pages' calls with the caller's session, the command line."""

from __future__ import annotations

import io
import json
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import flask
import httpx
import pytest
import uvicorn

from api.guard import COOKIE
from cli.main import main
from cli.serve import compose_app
from store.database import Database
from store.settings import Settings
from store.tokens import csrf_token, is_token
from tests.access.conftest import PASSWORD, World, people
from tests.service.running import ROOT, a_case

ASK = "/app/ask"


@pytest.fixture(scope="module")
def serving(
    tmp_path_factory: pytest.TempPathFactory, migrated: Path, password_hash: str
) -> Iterator[tuple[str, World]]:
    """API and pages as `slowdrift serve` composes them, with accounts; and one page that asks the API for a reader."""
    from frontend import app as pages
    from frontend.client import attempt, client

    folder = tmp_path_factory.mktemp("serving")
    shutil.copy(migrated, folder / "slowdrift.db")
    settings = Settings(data_dir=folder, solver="tests.service.fake_solver", accounts="on")
    listener = socket.create_server(("127.0.0.1", 0))
    port = listener.getsockname()[1]
    really = pages.create_app

    def with_a_page(*given: Any) -> flask.Flask:
        server = really(*given)

        def ask() -> Any:
            method = flask.request.method
            call: Callable[[], Any] = (
                (lambda: client().get("/me")) if method == "GET" else lambda: client().post("/cases", a_case("asked"))
            )
            answer, error = attempt(call)
            return flask.jsonify(answer if error is None else {"status": error.status})

        rule = "/ask"
        server.view_functions["ask"] = ask
        server.url_map.add(server.url_rule_class(rule, endpoint="ask", methods=["GET", "POST"]))
        return server

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pages, "create_app", with_a_page)
        app = compose_app(settings, port)
    database = Database(settings.database)
    world = World(app, settings, database)
    people(world, password_hash)
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=1))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
    thread.start()
    deadline = time.monotonic() + 30
    while not server.started and time.monotonic() < deadline:
        time.sleep(0.02)
    yield f"http://127.0.0.1:{port}", world
    server.should_exit = True
    thread.join(10)
    database.close()


@pytest.fixture
def reader(serving: tuple[str, World]) -> Iterator[httpx.Client]:
    url, _ = serving
    with httpx.Client(base_url=url, trust_env=False, timeout=30) as client:
        answer = client.post("/api/v1/auth/sign-in", json={"email": "editor@x.org", "password": PASSWORD})
        assert answer.status_code == 200, answer.text
        yield client


def test_pages_ask_with_the_readers_session(serving: tuple[str, World], reader: httpx.Client) -> None:
    url, _ = serving
    assert reader.get("/app/").status_code == 200
    assert reader.get(ASK).json()["user"]["email"] == "editor@x.org"
    made = reader.post(ASK, headers={"origin": url})
    assert made.json().get("content_hash"), made.text
    with httpx.Client(base_url=url, trust_env=False) as stranger:
        assert stranger.get("/app/").status_code == 200  # a page holds nothing by itself
        assert stranger.get(ASK).json() == {"status": 401}
        assert stranger.post(ASK, headers={"origin": url}).json() == {"status": 401}


def test_pages_vouch_for_no_forged_request(serving: tuple[str, World], reader: httpx.Client) -> None:
    for headers in ({}, {"origin": "https://evil.example"}, {"x-csrf-token": "x"}):
        assert reader.post(ASK, headers=headers).status_code == 403
    token = reader.cookies[COOKIE]
    assert reader.post(ASK, headers={"x-csrf-token": csrf_token(token)}).status_code == 200


def test_event_streams_take_the_cookie(serving: tuple[str, World], reader: httpx.Client) -> None:
    url, world = serving
    run = reader.post("/api/v1/runs", json={"case": a_case("followed")}, headers={"origin": url}).json()
    with reader.stream("GET", f"/api/v1/runs/{run['id']}/events") as stream:
        lines = stream.iter_lines()
        assert next(lines) == "event: run"
        assert json.loads(next(lines).removeprefix("data: "))["state"] == "queued"
        world.finish()
        last = [line for line in lines if line.startswith("data: ")][-1]
    assert json.loads(last.removeprefix("data: "))["state"] == "succeeded"
    with httpx.Client(base_url=url, trust_env=False) as stranger:
        assert stranger.get(f"/api/v1/runs/{run['id']}/events").status_code == 401
        assert stranger.get("/api/v1/events").status_code == 401


def test_a_stream_ends_and_is_asked_for_again(
    serving: tuple[str, World], reader: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What one may follow is judged again now and then, though a stream has no end."""
    from api.routes import events

    url, _ = serving
    monkeypatch.setattr(events, "SIGNED_IN_SECONDS", 0.3)
    run = reader.post("/api/v1/runs", json={"case": a_case("waits")}, headers={"origin": url}).json()
    for path in ("/api/v1/events", f"/api/v1/runs/{run['id']}/events"):
        assert reader.get(path, timeout=20).status_code == 200  # it has ended


# -- the command line


class Command:
    """`slowdrift …` in this process, on a folder of its own."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str], patch: pytest.MonkeyPatch):
        self.folder, self.capsys, self.patch = folder, capsys, patch

    def __call__(self, *arguments: str, given: str = "") -> tuple[int, str]:
        """The status, and what was said on either stream."""
        self.patch.setattr(sys, "stdin", io.StringIO(given))
        status = main([*arguments, "--data-dir", str(self.folder)])
        said = self.capsys.readouterr()
        return status, said.out + said.err


@pytest.fixture
def slowdrift(
    tmp_path: Path, migrated: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Command:
    shutil.copy(migrated, tmp_path / "slowdrift.db")
    return Command(tmp_path, capsys, monkeypatch)


def test_accounts_from_the_command_line(slowdrift: Command, tmp_path: Path) -> None:
    status, said = slowdrift("user", "add", "ada@x.org", "--password-stdin", given="short\n")
    assert (status, "allowed: 10 to 200" in said) == (2, True)
    status, said = slowdrift("user", "add", "ada", "--link")
    assert (status, "no e-mail address" in said) == (2, True)
    status, said = slowdrift("user", "add", "Ada@x.org", "--password-stdin", given=f"{PASSWORD}\n")
    assert (status, said.splitlines()[0]) == (0, "ada@x.org is owner of the team 'default', and administrator.")
    status, said = slowdrift("user", "add", "bob@x.org", "--link")
    assert status == 0
    assert "bob@x.org is viewer" in said
    assert "/app/invitations/sdi_" in said
    assert slowdrift("user", "add", "bob@x.org", "--link")[0] == 2
    listed = slowdrift("user", "list")[1].splitlines()
    assert [line.split()[0] for line in listed] == ["ada@x.org", "bob@x.org"]
    assert slowdrift("user", "disable", "ada@x.org") == (
        2,
        "slowdrift: This is the last administrator; make another one first.\n",
    )
    assert slowdrift("user", "disable", "bob@x.org")[0] == 0
    assert "disabled" in slowdrift("user", "list")[1]
    assert slowdrift("user", "disable", "eve@x.org")[0] == 2
    assert (tmp_path / "secret").stat().st_mode & 0o777 == 0o600


def test_keys_from_the_command_line(slowdrift: Command) -> None:
    slowdrift("user", "add", "ada@x.org", "--password-stdin", given=f"{PASSWORD}\n")
    status, said = slowdrift("key", "add", "ada@x.org", "ci", "--scope", "read")
    key = said.strip()
    assert (status, is_token(key, "sdk")) == (0, True)
    assert key[:10] in slowdrift("key", "list", "ada@x.org")[1]
    assert slowdrift("key", "add", "ada@x.org", "ci", "--days", "9999")[0] == 2
    assert slowdrift("key", "revoke", "ada@x.org", "sdk_nothing")[0] == 2
    assert slowdrift("key", "revoke", "ada@x.org", key[:10])[0] == 0
    assert "revoked" in slowdrift("key", "list", "ada@x.org")[1]


@pytest.mark.slow
def test_a_setup_link_for_the_first_account(tmp_path: Path, migrated: Path) -> None:
    """Other machines are served once people sign in; the link makes the first account, once."""
    shutil.copy(migrated, tmp_path / "slowdrift.db")
    command = [sys.executable, "-P", "-m", "cli.main", "serve", "--host", "0.0.0.0", "--port", "0", "--setup"]
    command += ["--workers", "0", "--no-pages", "--data-dir", str(tmp_path)]
    process = subprocess.Popen(command, env={"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin"}, stdout=subprocess.PIPE)
    try:
        assert process.stdout is not None
        at, link = process.stdout.readline().decode(), process.stdout.readline().decode()
        url, token = at.split()[3].rstrip("/"), link.split("/app/invitations/")[1].split()[0]
        with httpx.Client(base_url=url, trust_env=False, timeout=30) as client:
            deadline = time.monotonic() + 60
            while time.monotonic() < deadline:
                try:
                    if client.get("/healthz").status_code == 200:
                        break
                except httpx.TransportError:
                    time.sleep(0.1)
            assert client.get("/api/v1/runs").status_code == 401
            path = f"/api/v1/invitations/{token}/accept"
            answer = client.post(path, json={"email": "ada@x.org", "name": "Ada", "password": PASSWORD})
            assert (answer.status_code, answer.json()["user"]["is_admin"]) == (200, True), answer.text
            assert answer.json()["home"]["role"] == "owner"
            assert client.post(path, json={}, headers={"origin": url}).status_code == 404
            assert client.get("/api/v1/runs").status_code == 200
    finally:
        process.terminate()
        process.wait(30)
