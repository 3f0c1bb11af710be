"""Teams, invitations, keys and links over their whole lives."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

import pytest
from sqlalchemy import func, select, update

from store.clock import utc_now
from store.models import DEFAULT_TEAM
from store.people import ApiKey, Audit, Invitation, Share
from store.tokens import INVITATION, digest, new_token
from tests.access.conftest import ORIGIN, PASSWORD, World
from tests.service.running import a_case

TEAM = f"/api/v1/teams/{DEFAULT_TEAM}"
GUEST = {"email": "guest@x.org", "name": "Guest", "password": PASSWORD}


def invite(world: World, **asked: Any) -> dict[str, Any]:
    answer = world.signed_in("owner").post(f"{TEAM}/invitations", json=asked)
    assert answer.status_code == 201, answer.text
    return dict(answer.json())


def accept(world: World, token: str, given: dict[str, Any] | None = None, who: str = "") -> Any:
    client = world.signed_in(who) if who else world.client(**ORIGIN)
    return client.post(f"/api/v1/invitations/{token}/accept", json=given)


def test_an_invitation_works_once(world: World) -> None:
    with world.database.read() as session:
        before = session.scalar(select(func.max(Audit.id))) or 0  # other tests accept invitations too
    made = invite(world, role="editor")
    assert made["url"] == f"http://localhost/app/invitations/{made['token']}"
    shown = world.client().get(f"/api/v1/invitations/{made['token']}").json()
    assert (shown["kind"], shown["role"], shown["email"]) == ("join", "editor", None)
    assert accept(world, made["token"], {"name": "Guest"}).status_code == 422  # nothing used up
    answer = accept(world, made["token"], GUEST)
    assert (answer.status_code, answer.json()["home"]["role"]) == (200, "editor")
    assert accept(world, made["token"], GUEST | {"email": "b@x.org"}).status_code == 404
    listed = world.signed_in("owner").get(f"{TEAM}/invitations").json()["items"]
    assert made["id"] not in {item["id"] for item in listed}
    with world.database.read() as session:
        rows = session.scalars(select(Audit).where(Audit.action.endswith("/accept"), Audit.id > before)).all()
    assert [row.actor for row in rows] == ["guest@x.org"]
    assert made["token"] not in str([(row.action, row.subject) for row in rows])


def test_an_invitation_for_one_address(world: World) -> None:
    made = invite(world, email="Ada@X.org")
    assert accept(world, made["token"], GUEST | {"email": "eve@x.org"}).status_code == 422
    assert accept(world, made["token"], {}, "stranger").status_code == 422
    assert accept(world, made["token"], GUEST | {"email": "ada@x.org"}).status_code == 200


def test_invitations_that_are_over(world: World) -> None:
    late, gone = invite(world), invite(world)
    with world.database.write() as session:
        hashed = digest(late["token"], world.secret)
        past = utc_now() - timedelta(seconds=1)
        session.execute(update(Invitation).where(Invitation.digest == hashed).values(expires_at=past))
    assert world.signed_in("owner").delete(f"{TEAM}/invitations/{gone['id']}").status_code == 204
    for token in (late["token"], gone["token"], "sdi_nonsense", late["token"][:-1] + "x"):
        assert world.client().get(f"/api/v1/invitations/{token}").status_code == 404
        assert accept(world, token, GUEST).status_code == 404


def test_an_account_that_is_there(fresh: World) -> None:
    """Nobody takes over an account by an invitation; its owner signs in and joins."""
    made = invite(fresh)
    taken = accept(fresh, made["token"], GUEST | {"email": "stranger@x.org"})
    assert (taken.status_code, taken.json()["errors"][0]["field"]) == (422, "email")
    joined = accept(fresh, made["token"], None, "stranger")
    assert {home["role"] for home in joined.json()["homes"]} == {"owner", "viewer"}
    assert accept(fresh, invite(fresh)["token"], None, "stranger").status_code == 409


def test_a_member_of_two_teams(fresh: World) -> None:
    """A request works where it says; an id in the address says it too; and with the role one has there."""
    run = fresh.run("theirs")
    assert accept(fresh, invite(fresh)["token"], None, "stranger").status_code == 200
    fresh.clients.pop("stranger")
    both = fresh.signed_in("stranger")
    here, there = fresh.ids["project"], fresh.ids["other_project"]
    assert both.patch("/api/v1/me", json={"project_id": there}).json()["home"]["project_id"] == there
    assert both.get("/api/v1/runs?total=true").json()["total"] == 0
    assert both.get("/api/v1/runs", params={"project": here, "total": True}).json()["total"] == 1
    assert both.get("/api/v1/runs?total=true", headers={"slowdrift-project": here}).json()["total"] == 1
    assert both.get(f"/api/v1/runs/{run['id']}").status_code == 200  # a permalink
    assert both.delete(f"/api/v1/runs/{run['id']}").status_code == 403  # a viewer there
    sent = {"json": {"case": a_case("mine")}}
    assert both.post("/api/v1/runs", **sent).status_code == 202
    assert both.post("/api/v1/runs", params={"project": here}, **sent).status_code == 403
    assert both.get("/api/v1/runs", params={"project": "f" * 32}).status_code == 404
    assert both.patch("/api/v1/me", json={"project_id": "f" * 32}).status_code == 404


def test_the_first_administrators_link_is_over_with_the_first_account(world: World) -> None:
    token = new_token(INVITATION)
    with world.database.write() as session:
        row = Invitation(team_id=DEFAULT_TEAM, role="owner", is_admin=True, digest=digest(token, world.secret))
        row.expires_at = utc_now() + timedelta(days=1)
        session.add(row)
    assert accept(world, token, GUEST | {"email": "late@x.org"}).status_code == 404


def test_roles_and_the_last_owner(fresh: World) -> None:
    owner, ids = fresh.signed_in("owner"), fresh.ids
    me = f"{TEAM}/members/{ids['owner']}"
    assert owner.put(me, json={"role": "viewer"}).status_code == 409
    assert owner.delete(me).status_code == 409
    assert owner.put(f"{TEAM}/members/{ids['viewer']}", json={"role": "owner"}).status_code == 204
    assert owner.put(f"{TEAM}/members/{ids['stranger']}", json={"role": "owner"}).status_code == 404
    assert fresh.signed_in("viewer").delete(me).status_code == 204
    assert owner.get(f"{TEAM}/members").status_code == 404
    assert owner.get("/api/v1/runs").status_code == 403  # of no team at all
    assert "invitation" in owner.get("/api/v1/runs").json()["detail"]
    assert owner.get("/api/v1/me").json()["homes"] == []


def test_teams_and_projects_come_and_go(fresh: World) -> None:
    owner = fresh.signed_in("owner")
    team = owner.post("/api/v1/teams", json={"name": "Second"}).json()["id"]
    assert owner.post("/api/v1/teams", json={"name": "Second"}).status_code == 409
    project = owner.post(f"/api/v1/teams/{team}/projects", json={"name": "Floater"}).json()["project_id"]
    at = {"params": {"project": project}}
    assert owner.get("/api/v1/data-sets", **at).json()["items"], "a new project holds the bundled data"
    case = owner.post("/api/v1/cases", json=a_case("kept"), **at).json()
    assert owner.delete(f"/api/v1/projects/{project}").status_code == 409
    assert owner.delete(f"/api/v1/teams/{team}").status_code == 409
    once = {"headers": {"Idempotency-Key": "of a client"}} | at
    run = owner.post("/api/v1/runs", json={"case_id": case["id"]}, **once).json()
    assert owner.post(f"/api/v1/runs/{run['id']}/cancel").status_code == 202
    assert owner.delete(f"/api/v1/runs/{run['id']}").status_code == 204
    assert owner.delete(f"/api/v1/cases/{case['id']}").status_code == 204
    assert owner.delete(f"/api/v1/projects/{project}").status_code == 204
    assert owner.delete(f"/api/v1/teams/{team}").status_code == 204
    assert owner.get(f"/api/v1/teams/{team}/members").status_code == 404
    assert owner.delete(TEAM).status_code == 409


@pytest.mark.parametrize(
    ("path", "body", "field"),
    [
        ("/keys", {"name": ""}, "name"),
        ("/keys", {"name": "a\nb"}, "name"),
        ("/keys", {"name": "a", "scope": "all"}, "scope"),
        ("/keys", {"name": "a", "expires_in_days": 0}, "expires_in_days"),
        ("/keys", {"name": "a", "surprise": 1}, "surprise"),
        ("/users", {"email": "nobody", "name": "N"}, "email"),
        ("/users", {"email": "a b@x.org", "name": "N"}, "email"),
        ("/shares", {"run_ids": []}, "run_ids"),
        ("/shares", {"run_ids": ["x"]}, "run_ids.0"),
        ("/shares", {"run_ids": ["0" * 32], "view": {"a": "x" * 20_000}}, "view"),
    ],
)
def test_faults_are_named(world: World, path: str, body: dict[str, Any], field: str) -> None:
    answer = world.signed_in("owner").post(f"/api/v1{path}", json=body)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["field"] == field


def test_a_key_over_its_life(fresh: World) -> None:
    owner = fresh.signed_in("owner")
    team = owner.post("/api/v1/teams", json={"name": "Second"}).json()["id"]
    made = owner.post("/api/v1/keys", json={"name": "ci", "scope": "admin", "team_id": team}).json()
    assert made["token"].startswith(made["start"])
    program = fresh.client(authorization=f"Bearer {made['token']}")
    assert {home["team_id"] for home in program.get("/api/v1/me").json()["homes"]} == {team}
    assert [item["id"] for item in program.get("/api/v1/teams").json()["items"]] == [team]
    assert program.get(f"{TEAM}/members").status_code == 404  # the owner's too, but not this key's
    listed = owner.get("/api/v1/keys").json()["items"][0]
    assert (listed["id"], listed["team_name"]) == (made["id"], "Second")
    assert listed["last_used_at"] is not None
    assert "token" not in listed
    assert owner.delete(f"/api/v1/keys/{made['id']}").status_code == 204
    assert program.get("/api/v1/me").status_code == 401
    assert owner.delete(f"/api/v1/keys/{made['id']}").status_code == 404
    assert fresh.signed_in("editor").delete(f"/api/v1/keys/{fresh.ids['key read']}").status_code == 404
    with fresh.database.read() as session:
        assert made["token"] not in str([(key.digest, key.start) for key in session.scalars(select(ApiKey))])


def test_a_link_shows_its_runs_and_nothing_else(world: World) -> None:
    shown, also, hidden = world.run("shown"), world.run("also"), world.run("hidden")
    editor = world.signed_in("editor")
    asked = {"run_ids": [shown["id"], also["id"]], "view": {"tab": "spectra"}}
    made = editor.post("/api/v1/shares", json=asked).json()
    anyone, base = world.client(), f"/api/v1/shared/{made['token']}"
    opened = anyone.get(base).json()
    assert ([run["id"] for run in opened["runs"]], opened["view"]) == (asked["run_ids"], {"tab": "spectra"})
    assert {run["created_by"] for run in opened["runs"]} == {None}  # who works here is nobody else's business
    assert editor.get(f"/api/v1/runs/{shown['id']}").json()["created_by"] == "Editor"
    for run, status in ((shown, 200), (also, 200), (hidden, 404)):
        for part in ("", "/summary", "/channels", "/channels/frequency/vessel/surge", "/case"):
            assert anyone.get(f"{base}/runs/{run['id']}{part}").status_code == status, (run["case_name"], part)
        assert anyone.get(f"{base}/cases/{run['case_id']}").status_code == status
        assert world.status_of_stream(anyone, f"{base}/runs/{run['id']}/events")[0] == status
    for method in ("post", "put", "patch", "delete"):  # read-only
        assert anyone.request(method, f"{base}/runs/{shown['id']}").status_code == 405
    assert anyone.get(f"/api/v1/runs/{shown['id']}").status_code == 401
    other = world.signed_in("stranger").post("/api/v1/shares", json=asked)
    assert other.status_code == 404
    assert world.signed_in("stranger").get(base).status_code == 200  # whoever has it


def test_links_end(world: World) -> None:
    run, editor = world.run("for a while"), world.signed_in("editor")
    tokens = [editor.post("/api/v1/shares", json={"run_ids": [run["id"]]}).json()["token"] for _ in range(2)]
    assert world.client().get(f"/api/v1/shared/{tokens[0]}").status_code == 200
    with world.database.write() as session:
        past = utc_now() - timedelta(seconds=1)
        row = update(Share).where(Share.digest == digest(tokens[0], world.secret)).values(expires_at=past)
        session.execute(row)
    assert world.client().get(f"/api/v1/shared/{tokens[0]}").status_code == 404
    assert editor.delete(f"/api/v1/runs/{run['id']}").status_code == 204
    left = world.client().get(f"/api/v1/shared/{tokens[1]}")
    assert (left.status_code, left.json()["runs"]) == (200, [])
    assert world.client().get(f"/api/v1/shared/{tokens[1]}/runs/{run['id']}").status_code == 404


def test_the_log_says_who_did_what(fresh: World) -> None:
    run = fresh.run("logged")
    program = fresh.with_key("submit")
    queued = program.post("/api/v1/runs", json={"case": a_case("by a key")}).json()
    program.post(f"/api/v1/runs/{queued['id']}/cancel")
    fresh.signed_in("viewer").post("/api/v1/runs", json={"case": a_case("refused")})
    fresh.signed_in("viewer").post("/api/v1/cases/check", json=a_case("only checked"))
    fresh.signed_in("editor").delete(f"/api/v1/runs/{run['id']}")
    told = fresh.signed_in("owner").get(f"{TEAM}/audit").json()["items"]
    assert [(item["actor"], item["action"]) for item in told] == [
        ("editor@x.org", "DELETE /api/v1/runs/{run_id}"),
        ("owner@x.org (key submit)", "POST /api/v1/runs/{run_id}/cancel"),
        ("owner@x.org (key submit)", "POST /api/v1/runs"),
        ("editor@x.org", "POST /api/v1/runs"),
    ]
    assert told[0]["subject"]["run_id"] == run["id"]
    page = fresh.signed_in("owner").get(f"{TEAM}/audit", params={"limit": 2}).json()
    rest = fresh.signed_in("owner").get(f"{TEAM}/audit", params={"limit": 2, "cursor": page["next_cursor"]}).json()
    assert [item["id"] for item in page["items"] + rest["items"]] == [item["id"] for item in told]


def test_administrators_make_accounts(fresh: World) -> None:
    owner = fresh.signed_in("owner")
    made = owner.post("/api/v1/users", json={"email": "New@x.org", "name": "New"}).json()
    assert owner.post("/api/v1/users", json={"email": "new@x.org", "name": "New"}).status_code == 409
    shown = fresh.client().get(f"/api/v1/invitations/{made['token']}").json()
    assert (shown["kind"], shown["email"], shown["team"]) == ("password", "new@x.org", None)
    assert accept(fresh, made["token"], {"password": "short"}).status_code == 422
    assert accept(fresh, made["token"], {"password": PASSWORD}).json()["user"]["email"] == "new@x.org"
    reset = owner.post(f"/api/v1/users/{made['user']['id']}/reset").json()
    assert accept(fresh, reset["token"], {"password": "another good one"}).status_code == 200
    signed = fresh.client().post("/api/v1/auth/sign-in", json={"email": "new@x.org", "password": "another good one"})
    assert signed.status_code == 200
    path = f"/api/v1/users/{fresh.ids['owner']}"
    assert owner.patch(path, json={"is_admin": False}).status_code == 409
    page = owner.get("/api/v1/users", params={"limit": 2}).json()
    assert len(page["items"]) == 2
    assert page["next_cursor"]
