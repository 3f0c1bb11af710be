"""Two teams with everybody in them, in a database of the test's own: who asks is one word."""

from __future__ import annotations

import asyncio
import io
import os
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import timedelta
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI

from api.guard import COOKIE
from api.main import create_app
from store import migrations
from store.bundled import register_bundled
from store.clock import utc_now
from store.database import Database
from store.models import DEFAULT_PROJECT, DEFAULT_TEAM
from store.passwords import hash_password
from store.people import ADMIN, READ, SUBMIT, ApiKey
from store.repositories.accounts import AccountRepository
from store.repositories.teams import TeamRepository
from store.scope import Scope
from store.settings import Settings
from store.tokens import KEY, SESSION, START, digest, new_token, read_secret
from tests.api.conftest import TestClient, fpso, migrated, riser  # noqa: F401  (fixtures)
from tests.awaiting import awaited
from tests.service import fake_solver
from tests.service.conftest import create_database, drop_database
from tests.service.running import a_case
from worker.execute import Worker, execute

PASSWORD = "correct horse battery"
ORIGIN = {"origin": "http://localhost"}


@pytest.fixture(scope="session")
def password_hash() -> str:
    return hash_password(PASSWORD)


@dataclass
class World:
    """Team `default` with an owner (administrator), an editor and a viewer; team `other` with an owner."""

    app: FastAPI
    settings: Settings
    database: Database
    ids: dict[str, str] = field(default_factory=dict)
    keys: dict[str, str] = field(default_factory=dict)
    clients: dict[str, TestClient] = field(default_factory=dict)

    def client(self, **headers: str) -> TestClient:
        """A browser or program with no cookie yet."""
        return TestClient(self.app, base_url="http://localhost", headers=headers, raise_server_exceptions=False)

    def signed_in(self, name: str) -> TestClient:
        """As after POST /auth/sign-in, but for the work of a password's hash."""
        if name not in self.clients:
            token = new_token(SESSION)
            with self.database.write() as session:
                later = utc_now() + timedelta(hours=1)
                AccountRepository(session).sign_in(self.ids[name], digest(token, self.secret), "test", later)
            self.clients[name] = self.client(**ORIGIN)
            self.clients[name].cookies.set(COOKIE, token)
        return self.clients[name]

    @cached_property
    def secret(self) -> bytes:
        return read_secret(self.settings)

    def with_key(self, name: str) -> TestClient:
        return self.client(authorization=f"Bearer {self.keys[name]}")

    def status_of_stream(self, client: TestClient, address: str) -> tuple[int, str]:
        """Of an answer that may have no end: the app is told that the client has gone once it has begun."""

        async def ask() -> int:
            status, begun = [0], asyncio.Event()
            headers = {
                **client.headers,
                "host": "localhost",
                "cookie": "; ".join(f"{k}={v}" for k, v in client.cookies.items()),
            }
            scope = {
                "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": "GET", "scheme": "http",
                "path": address, "raw_path": address.encode(), "query_string": b"", "root_path": "",
                "headers": [(name.lower().encode(), value.encode()) for name, value in headers.items() if value],
                "client": ("127.0.0.1", 1), "server": ("localhost", 80),
            }  # fmt: skip

            async def receive() -> dict[str, Any]:
                if not asked:
                    asked.append(True)
                    return {"type": "http.request", "body": b"", "more_body": False}
                await begun.wait()
                return {"type": "http.disconnect"}

            async def send(message: dict[str, Any]) -> None:
                if message["type"] == "http.response.start":
                    status[0] = message["status"]
                begun.set()

            asked: list[bool] = []
            await self.app(scope, receive, send)
            return status[0]

        return awaited(ask()), ""

    def finish(self) -> None:
        """Do what stands in the queue, in this process."""
        from sqlalchemy import select

        from store.models import Task

        with self.database.read() as session:
            tasks = list(session.scalars(select(Task.id).where(Task.state == "queued")))
        for task in tasks:
            execute(Worker(self.database, fake_solver, self.settings, "host/1/1"), task)  # type: ignore[arg-type]

    def run(self, name: str = "a run", who: str = "editor", **knobs: Any) -> dict[str, Any]:
        """A finished run."""
        answer = self.signed_in(who).post("/api/v1/runs", json={"case": a_case(name, **knobs)})
        assert answer.status_code == 202, answer.text
        self.finish()
        return dict(self.signed_in(who).get(f"/api/v1/runs/{answer.json()['id']}").json())


def people(world: World, hashed: str) -> None:
    secret = world.secret
    with world.database.write() as session:
        accounts, teams = AccountRepository(session), TeamRepository(session)
        users = {name: accounts.add(f"{name}@x.org", name.title(), hashed, name == "owner") for name in NAMES}
        for name in NAMES[:3]:
            teams.join(DEFAULT_TEAM, users[name].id, name)
        other = teams.add("other", users["stranger"].id)
        world.ids = {name: user.id for name, user in users.items()}
        world.ids |= {"team": DEFAULT_TEAM, "project": DEFAULT_PROJECT, "other_team": other.id}
        world.ids["other_project"] = teams.projects(other.id)[0].id
        for label, who, scope, days in KEYS:
            token = new_token(KEY)
            expires_at = utc_now() + timedelta(days=days)
            key = ApiKey(
                user_id=users[who].id, name=label, scope=scope, start=token[:START], digest=digest(token, secret),
                expires_at=expires_at,
            )  # fmt: skip
            accounts.add_key(key)
            world.keys[label], world.ids[f"key {label}"] = token, key.id


NAMES = ("owner", "editor", "viewer", "stranger")
KEYS = (
    ("read", "owner", READ, 1),
    ("submit", "owner", SUBMIT, 1),
    ("admin", "owner", ADMIN, 1),
    ("viewers", "viewer", ADMIN, 1),
    ("expired", "owner", ADMIN, -1),
)


@contextmanager
def opened(folder: Path, template: Path, hashed: str, **settings: Any) -> Iterator[World]:
    shutil.copy(template, folder / "slowdrift.db")
    chosen = Settings(data_dir=folder, preview_seconds=0.2, solver="tests.service.fake_solver", accounts="on")
    name = f"sd_test_{uuid.uuid4().hex[:12]}"
    on_server = os.environ.get("SLOWDRIFT_TEST_DATABASE") == "postgresql"  # the whole folder of tests, over a server
    if on_server:
        settings |= {"database_url": create_database(name)}
    chosen = chosen.model_copy(update=settings)
    database = Database(chosen.database)
    migrations.upgrade(database)
    app = create_app(chosen, reconcile=False)
    with TestClient(app, base_url="http://localhost"):
        world = World(app, chosen, database)
        people(world, hashed)
        yield world
    database.close()
    if on_server:
        drop_database(name)


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory, migrated: Path, password_hash: str) -> Iterator[World]:  # noqa: F811
    """One for all tests of a file, which therefore count on no row but their own."""
    with opened(tmp_path_factory.mktemp("world"), migrated, password_hash) as made:
        yield made


@pytest.fixture
def fresh(tmp_path: Path, migrated: Path, password_hash: str) -> Iterator[World]:  # noqa: F811
    """One of the test's own."""
    with opened(tmp_path, migrated, password_hash) as made:
        yield made


def with_data(world: World) -> None:
    """The bundled data set in both teams' projects."""
    for team, project in (("team", "project"), ("other_team", "other_project")):
        register_bundled(world.database, Scope(world.ids[team], world.ids[project]))


def netcdf(folder: Path, seed: int = 0) -> io.BytesIO:
    from tests.vessel import synthetic

    return io.BytesIO(synthetic.to_bytes(synthetic.dataset(seed=seed), folder))
