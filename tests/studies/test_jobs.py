"""Priorities, reruns, reuse, idempotency keys, labels, filters, estimates, retention."""

from __future__ import annotations

import json
from collections.abc import Callable
from datetime import timedelta
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import select, update

from store import effective, estimate, retention
from store.clock import utc_now
from store.database import Database
from store.doorbell import Doorbell
from store.models import IdempotencyKey, Run, Task
from store.reconcile import Reconciler
from store.settings import Settings
from tests.service.running import a_case

Work = Callable[[], list[str]]
EA = "/line_types/t/EA"


def submit(client: TestClient, case: str, status: int = 202, headers: dict[str, str] | None = None, **more: Any) -> Any:
    answer = client.post("/api/v1/runs", json={"case": a_case(case)} | more, headers=headers or {})
    assert answer.status_code == status, answer.text
    return answer.json()


def order(database: Database, done: list[str]) -> list[str]:
    with database.read() as session:
        names = {row[0]: row[1] for row in session.execute(select(Task.id, Run.case_name).join(Run))}
    return [names[task] for task in done]


def test_who_waits_for_an_answer_never_waits_for_a_study(client: TestClient, work: Work, database: Database) -> None:
    client.post("/api/v1/studies", json={"case": a_case("study"), "grid": {EA: [1e8 + k for k in range(50)]}})
    long = {"time_domain": {"step": 0.01, "duration": 5000, "build_up": 0, "seeds": 10}}
    client.post("/api/v1/runs", json={"case": a_case("long", {"statics": {}} | long)})
    assert submit(client, "late but urgent")["priority"] == "interactive"
    submit(client, "patient", priority="batch")
    names = list(dict.fromkeys(order(database, work())))
    assert names == ["late but urgent", "long", "study", "patient"]


def test_a_rerun_computes_the_very_same(client: TestClient, work: Work) -> None:
    study = client.post("/api/v1/studies", json={"case": a_case("base"), "grid": {EA: [2e8]}}).json()
    old = client.get(f"/api/v1/studies/{study['id']}/runs").json()["items"][0]
    work()
    new = client.post(f"/api/v1/runs/{old['id']}/rerun").json()
    same = ("content_hash", "data_hash", "analyses", "overrides", "case_id")
    assert [new[name] for name in same] == [old[name] for name in same]
    assert (new["rerun_of"], new["study_id"]) == (old["id"], None)
    work()
    first, second = (client.get(f"/api/v1/runs/{run['id']}/summary").json() for run in (old, new))
    assert first == second
    assert client.post("/api/v1/runs/none/rerun").status_code == 404


def test_an_identical_run_is_offered_from_the_store(
    client: TestClient, work: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(effective, "solver_version", lambda: "1.2.3")
    first = submit(client, "same", reuse="allow")
    assert submit(client, "same", reuse="allow")["id"] != first["id"]  # the first has no answer yet
    work()
    found = submit(client, "same", status=200, reuse="allow")
    assert found["state"] == "succeeded"
    assert submit(client, "same")["state"] == "queued"  # who does not ask for it gets a new one
    assert submit(client, "other", reuse="allow")["state"] == "queued"
    monkeypatch.setattr(effective, "solver_version", lambda: "1.2.4")
    assert submit(client, "same", reuse="allow")["state"] == "queued"


def test_without_a_version_nothing_is_taken_for_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(effective, "solver_version", lambda: None)
    assert effective.identity("h", None, ["statics"]) is None


@pytest.mark.parametrize("address", ["runs", "studies"])
def test_the_same_request_again_makes_nothing_more(client: TestClient, address: str) -> None:
    body: dict[str, Any] = {"case": a_case("once")} | ({"grid": {EA: [1e8]}} if address == "studies" else {})
    key = {"Idempotency-Key": "3f1c 77"}
    first, again = (client.post(f"/api/v1/{address}", json=body, headers=key) for _ in range(2))
    assert (first.status_code, again.status_code, first.json()["id"]) == (202, 202, again.json()["id"])
    assert "idempotent-replayed" not in first.headers
    assert again.headers["idempotent-replayed"] == "true"
    other = client.post(f"/api/v1/{address}", json=body | {"name": "another"}, headers=key)
    assert (other.status_code, other.json()["type"]) == (409, "conflict")
    assert client.post(f"/api/v1/{address}", json=body).json()["id"] != first.json()["id"]
    assert client.get(f"/api/v1/{address}").json()["items"].__len__() == 2
    bad = client.post(f"/api/v1/{address}", json={"case": {}}, headers={"Idempotency-Key": "new"})
    assert bad.status_code == 422  # a refused request does not use up its key
    assert client.post(f"/api/v1/{address}", json=body, headers={"Idempotency-Key": "new"}).status_code == 202


def test_labels_and_filters(client: TestClient, work: Work, database: Database) -> None:
    one = submit(client, "FPSO north", name="basis", tags=["north", "basis 1"])
    work()
    two = submit(client, "FPSO south", tags=["south"])

    def found(**params: Any) -> list[str]:
        return [run["id"] for run in client.get("/api/v1/runs", params=params).json()["items"]]

    assert found(q="fpso") == [two["id"], one["id"]]
    assert found(q="BASIS") == [one["id"]]
    assert found(q="100%") == []
    assert found(tag="north") == [one["id"]]
    assert found(tag="nort") == []
    assert found(state="queued,running") == [two["id"]]
    assert found(case=one["case_id"]) == [one["id"]]
    assert found(sort="created") == [one["id"], two["id"]]
    assert found(**{"from": two["created_at"]}) == [two["id"]]
    assert found(to="2020-01-01T00:00:00") == []
    changed = client.patch(f"/api/v1/runs/{one['id']}", json={"pinned": True, "tags": ["kept"]}).json()
    assert (changed["name"], changed["tags"], changed["pinned"]) == ("basis", ["kept"], True)
    assert found(pinned=True) == [one["id"]]
    for wrong in ({"tags": ["<b>"]}, {"name": "x\n"}, {"tags": ["a"] * 21}, {"state": "failed"}):
        assert client.patch(f"/api/v1/runs/{one['id']}", json=wrong).status_code == 422, wrong
    assert client.get("/api/v1/runs", params={"state": "lost"}).status_code == 422


def test_retention_takes_the_old_and_leaves_the_pinned(client: TestClient, work: Work, database: Database) -> None:
    old, kept = submit(client, "old"), submit(client, "kept")
    client.post("/api/v1/studies", json={"case": a_case("study"), "grid": {EA: [1e8, 2e8]}})
    work()
    waiting = submit(client, "waiting")
    client.patch(f"/api/v1/runs/{kept['id']}", json={"pinned": True})
    assert retention.sweep(database, 30) == 0
    with database.write() as session:
        session.execute(update(Run).where(Run.state == "succeeded").values(finished_at=utc_now() - timedelta(days=31)))
    assert retention.sweep(database, 30, dry_run=True) == 3
    assert retention.sweep(database, 30) == 3
    assert {run["id"] for run in client.get("/api/v1/runs").json()["items"]} == {kept["id"], waiting["id"]}
    assert client.get("/api/v1/studies").json()["items"] == []
    assert client.get(f"/api/v1/runs/{old['id']}").status_code == 404


def test_keys_are_forgotten_where_runs_are_kept_for_good(
    client: TestClient, database: Database, service_settings: Settings
) -> None:
    assert service_settings.retention_days == 0
    for key in ("long ago", "today"):
        client.post("/api/v1/runs", json={"case": a_case(key)}, headers={"Idempotency-Key": key})
    with database.write() as session:
        old = update(IdempotencyKey).where(IdempotencyKey.key == "long ago")
        session.execute(old.values(created_at=utc_now() - timedelta(days=3)))
    doorbell = Doorbell(service_settings)
    Reconciler(database, doorbell, service_settings)._sweep()
    doorbell.close()
    with database.read() as session:
        assert session.scalars(select(IdempotencyKey.key)).all() == ["today"]


def test_a_case_stays_while_a_study_without_runs_refers_to_it(client: TestClient, work: Work) -> None:
    study = client.post("/api/v1/studies", json={"case": a_case("study"), "grid": {EA: [1e8]}}).json()
    work()
    for run in client.get(f"/api/v1/studies/{study['id']}/runs").json()["items"]:
        assert client.delete(f"/api/v1/runs/{run['id']}").status_code == 204
    refused = client.delete(f"/api/v1/cases/{study['case_id']}")
    assert (refused.status_code, refused.json()["detail"]) == (
        409,
        "1 study(ies) refer to this case; delete them first.",
    )
    assert client.delete(f"/api/v1/studies/{study['id']}").status_code == 204
    assert client.delete(f"/api/v1/cases/{study['case_id']}").status_code == 204


def test_the_estimate_of_the_time_left() -> None:
    waiting = [(10, "a"), (20, "b"), (30, "c"), (30, "d")]
    queue = estimate.Snapshot(0.0, {None: 2.0, "study": 0.5}, waiting, [0.0, 1.0, 3.0, 4.0, 8.0], workers=2)
    nothing = estimate.Snapshot()
    amount = estimate.Amount
    assert nothing.left(amount(total=1.0), None) is None
    # at work for 6 s, a quarter done: 18 s left by its own pace, whatever others took
    assert queue.left(amount(4.0, 1.0, at_work=1, tasks=1, seconds=6.0), None) == 18.0
    # two at work share what is left
    assert queue.left(amount(4.0, 1.0, at_work=2, tasks=2, seconds=6.0), None) == 9.0
    # waits behind weight 4 at 2 s each over two workers, then its own weight 4
    assert queue.left(amount(4.0, tasks=1, first=(30, "d")), None) == 4.0 + 8.0
    # a study's runs go by the study's pace
    assert queue.left(amount(4.0, tasks=1, first=(10, "a")), "study") == 2.0
    assert estimate.Snapshot(0.0, {None: 1.0}).left(amount(1234.0, tasks=1), None) == 1300.0  # two digits, upwards


def test_a_waiting_run_gets_an_estimate_once_something_was_seen(client: TestClient, work: Work) -> None:
    assert submit(client, "first")["eta_seconds"] is None
    work()
    estimate._kept.clear()
    assert submit(client, "second")["eta_seconds"] is not None
    assert client.get("/api/v1/queue").json()["items"][0]["queued"] == 1


def test_the_case_of_a_run_as_it_was_submitted(client: TestClient) -> None:
    run = submit(client, "whole")
    shown = client.get(f"/api/v1/runs/{run['id']}/case").json()
    assert (shown["name"], shown["content_hash"]) == ("whole", run["content_hash"])
    assert json.loads(shown["case"]["description"]) == {}
