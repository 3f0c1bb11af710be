"""Limits of a team: refused in words that name the limit, shown, and of one team only."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

import pytest

from api.main import create_app
from solver.results.part import Chunk
from store.database import Database
from store.models import Project, Run, Task, Team
from store.repositories import CaseRepository, RunRepository, TaskRepository
from store.repositories.cases import NewCase
from store.repositories.runs import Labels
from store.repositories.usage import UsageRepository
from store.scope import Scope
from store.settings import Settings
from tests.api.conftest import TestClient
from tests.service.running import a_case
from tests.store.test_isolation import BARGE

EA = "/line_types/t/EA"
LONG = {"time_domain": {"step": 0.01, "duration": 5000, "build_up": 0, "seeds": 10}}


@pytest.fixture
def small(service_settings: Settings) -> Iterator[TestClient]:
    """An installation with small limits."""
    limits = {"quota_queued_runs": 5, "quota_stored_runs": 8, "quota_data_sets": 2, "quota_data_bytes": 300_000}
    with TestClient(
        create_app(service_settings.model_copy(update=limits), reconcile=False), base_url="http://localhost"
    ) as client:
        yield client


def shown(client: TestClient) -> dict[str, tuple[int, int | None, int | None]]:
    items = client.get("/api/v1/quota").json()["items"]
    return {item["name"]: (item["used"], item["limit"], item["left"]) for item in items}


def study(client: TestClient, runs: int, **more: Any) -> Any:
    grid = {EA: [1e8 + k for k in range(runs)]}
    return client.post("/api/v1/studies", json={"case": a_case("study"), "grid": grid} | more)


def test_runs_beyond_the_limit_are_refused(small: TestClient) -> None:
    assert study(small, 4).status_code == 202
    assert shown(small)["queued runs"] == (4, 5, 1)
    answer = study(small, 2)
    assert answer.status_code == 429
    detail = answer.json()["detail"]
    assert "4 queued runs of at most 5" in detail
    assert "would add 2" in detail
    assert "SLOWDRIFT_QUOTA_QUEUED_RUNS" in detail
    assert small.get("/api/v1/studies").json()["items"][0]["size"] == 4  # and nothing of it is stored
    assert small.post("/api/v1/runs", json={"case": a_case("one")}).status_code == 202
    assert small.post("/api/v1/runs", json={"case": a_case("two")}).status_code == 429
    assert shown(small)["queued runs"] == (5, 5, 0)


def test_cancelled_runs_make_room_and_stay_stored(small: TestClient) -> None:
    made = study(small, 5).json()
    small.post(f"/api/v1/studies/{made['id']}/cancel")
    assert shown(small)["queued runs"] == (0, 5, 5)
    assert study(small, 3).status_code == 202
    answer = study(small, 1)
    assert answer.status_code == 429
    assert "8 stored runs of at most 8" in answer.json()["detail"]
    small.delete(f"/api/v1/studies/{made['id']}")
    assert study(small, 1).status_code == 202


def test_data_beyond_the_limit_are_refused(small: TestClient) -> None:
    def upload(content: bytes) -> Any:
        return small.post("/api/v1/data-sets", files={"file": ("barge.nc", content)})

    payload = BARGE.read_bytes()
    assert len(payload) < 300_000 < 2 * len(payload)
    assert upload(payload).status_code == 201
    assert upload(payload).status_code == 200  # what is there already takes nothing
    other = upload(payload + b"\0")
    assert other.status_code == 429, other.text
    assert "bytes of data sets and meshes of at most 300000" in other.json()["detail"]
    assert shown(small)["bytes of data sets and meshes"] == (len(payload), 300_000, 300_000 - len(payload))
    assert len(small.get("/api/v1/data-sets").json()["items"]) == 1


def test_a_limit_of_zero_is_none(client: TestClient, service_settings: Settings) -> None:
    free = service_settings.model_copy(update={"quota_queued_runs": 0})
    with TestClient(create_app(free, reconcile=False), base_url="http://localhost") as client:
        assert study(client, 3).status_code == 202
        assert shown(client)["queued runs"] == (3, None, None)


def test_other_teams_do_not_count(database: Database) -> None:
    here = Scope()
    there = Scope(team_id="a" * 32, project_id="b" * 32)
    with database.write() as session:
        session.add(Team(id=there.team_id, name="another"))
        session.flush()
        session.add(Project(id=there.project_id, team_id=there.team_id, name="theirs"))
        session.flush()
        for scope in (here, there, there):
            version, _ = CaseRepository(session, scope).save(NewCase("c", "h" * 64, "{}", "x: 1"))
            RunRepository(session, scope).create(version, ["statics"], [Chunk("frequency")])
    with database.read() as session:
        assert [UsageRepository(session, scope).of_team().queued for scope in (here, there)] == [1, 2]


# --- priorities


def test_interactive_is_a_matter_of_size(client: TestClient) -> None:
    long = {"case": a_case("long", {"statics": {}} | LONG), "priority": "interactive"}
    answer = client.post("/api/v1/runs", json=long)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == "priority"
    assert "at most 3 frequency-domain runs' work" in answer.json()["errors"][0]["message"]
    assert study(client, 50, priority="interactive").status_code == 422  # each is small, together they are not
    assert study(client, 2, priority="interactive").status_code == 202
    assert client.post("/api/v1/runs", json=long | {"priority": "normal"}).status_code == 202


def test_many_small_runs_of_one_user_leave_the_quick_places_to_others(database: Database) -> None:
    """The 21st small run that waits is normal; another user's first is interactive, and done before."""
    script, colleague = Scope(user_id="1" * 32), Scope(user_id="2" * 32)

    def queue(scope: Scope, priority: int | None = None) -> int:
        with database.write() as session:
            version, _ = CaseRepository(session, scope).save(NewCase("c", "h" * 64, "{}", "x: 1"))
            run, _ = RunRepository(session, scope).create(
                version, ["statics"], [Chunk("frequency")], labels=Labels(priority=priority)
            )
            return session.query(Task.priority).filter(Task.run_id == run.id).scalar()  # type: ignore[no-any-return]

    made = [queue(script) for _ in range(25)]
    assert made == [10] * 20 + [20] * 5
    assert queue(colleague) == 10
    with database.write() as session:  # one of them has begun
        first = session.query(Task).join(Run).filter(Run.created_by == script.user_id).order_by(Task.id).first()
        assert first is not None
        first.state = "running"
    assert queue(script) == 10
    assert queue(script) == 20


# --- runs at work


def test_a_team_has_so_many_runs_at_work(database: Database) -> None:
    here, there = Scope(), Scope(team_id="a" * 32, project_id="b" * 32)
    with database.write() as session:
        session.add(Team(id=there.team_id, name="another"))
        session.flush()
        session.add(Project(id=there.project_id, team_id=there.team_id, name="theirs"))
        session.flush()
        for scope, runs in ((here, 4), (there, 1)):
            version, _ = CaseRepository(session, scope).save(NewCase("c", "h" * 64, "{}", "x: 1"))
            for _ in range(runs):
                chunks = [Chunk("time", (k, k + 1), 1.0) for k in range(2)]
                RunRepository(session, scope).create(version, ["statics"], chunks)

    def claimed(most: int) -> str | None:
        with database.write() as session:
            ticket = TaskRepository(session).claim_next("runs", "w", 60.0, 3, most_running=most)
            return None if ticket is None else session.get_one(Run, ticket.run_id).project_id

    found = [claimed(2) for _ in range(7)]  # two runs of two tasks each, and the other team's one
    assert Counter(found) == {here.project_id: 4, there.project_id: 2, None: 1}
    assert found[-1] is None  # two more runs wait
    with database.read() as session:
        assert UsageRepository(session, here).of_team().running == 2
    assert claimed(0) == here.project_id


def test_what_was_refused_is_shown(small: TestClient) -> None:
    study(small, 4)
    before = small.get("/api/v1/quota").json()
    assert before["refused"] == []
    assert "whoever runs the service" in before["who"]
    study(small, 2)
    refused = small.get("/api/v1/quota").json()["refused"]
    assert len(refused) == 1
    assert "4 queued runs of at most 5" in refused[0]["detail"]
    assert {"running runs", "event streams"} <= set(shown(small))
