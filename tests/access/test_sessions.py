"""Signing in: cookies, fixation, forged requests, guessing, and everything that ends a session."""

from __future__ import annotations

from datetime import timedelta

import pytest
from sqlalchemy import select, update

from api.attempts import Attempts
from api.guard import COOKIE, SECURE_COOKIE
from store.clock import utc_now
from store.errors import TooManyError
from store.people import SignIn
from store.settings import Settings
from store.tokens import SESSION, csrf_token, digest, is_token, new_token
from tests.access.conftest import ORIGIN, PASSWORD, World
from tests.api.conftest import TestClient
from tests.service.conftest import REDIS, need

SIGN_IN = "/api/v1/auth/sign-in"


def credentials(name: str = "editor", password: str = PASSWORD) -> dict[str, str]:
    return {"email": f"{name}@x.org", "password": password}


def enter(client: TestClient, name: str = "editor") -> str:
    """Sign in as a browser does; gives the session's token."""
    answer = client.post(SIGN_IN, json=credentials(name))
    assert answer.status_code == 200, answer.text
    return str(answer.cookies[COOKIE])


def test_the_way_in_and_out(world: World) -> None:
    client = world.client(**ORIGIN)
    assert client.get("/api/v1/auth").json() == {"accounts": True, "signed_in": False, "provider": None}
    answer = client.post(SIGN_IN, json={"email": "  Editor@X.org ", "password": PASSWORD})
    assert answer.json()["user"]["email"] == "editor@x.org"
    assert answer.json()["home"]["role"] == "editor"
    assert client.get("/api/v1/auth").json() == {"accounts": True, "signed_in": True, "provider": None}
    me = client.get("/api/v1/me").json()
    assert (me["mode"], me["by"], me["csrf_token"]) == ("accounts", "session", answer.json()["csrf_token"])
    token = client.cookies[COOKIE]
    assert client.post("/api/v1/auth/sign-out").status_code == 204
    assert COOKIE not in client.cookies
    client.cookies.set(COOKIE, token)
    assert client.get("/api/v1/me").status_code == 401


def test_the_cookie(world: World) -> None:
    cookie = world.client().post(SIGN_IN, json=credentials()).headers["set-cookie"]
    parts = {part.strip().lower() for part in cookie.split(";")[1:]}
    assert {"httponly", "samesite=lax", "path=/"} <= parts
    assert "secure" not in parts
    with TestClient(world.app, base_url="https://localhost") as https:
        cookie = https.post(SIGN_IN, json=credentials()).headers["set-cookie"]
    assert cookie.startswith(f"{SECURE_COOKIE}=sds_")
    assert "secure" in {part.strip().lower() for part in cookie.split(";")[1:]}


def test_only_the_hmac_is_stored(world: World) -> None:
    token = enter(world.client())
    assert is_token(token, SESSION)
    with world.database.read() as session:
        kept = list(session.scalars(select(SignIn.digest)))
    assert digest(token, world.secret) in kept
    assert token not in kept
    assert digest(token, b"another secret") not in kept


def test_fixation(world: World) -> None:
    """A token that an attacker has planted in the browser is not the session that begins."""
    planted = new_token(SESSION)
    victim = world.client(**ORIGIN)
    victim.cookies.set(COOKIE, planted)
    assert enter(victim) != planted
    attacker = world.client()
    attacker.cookies.set(COOKIE, planted)
    assert attacker.get("/api/v1/me").status_code == 401
    own = enter(world.client(), "viewer")  # a session of the attacker's own, planted
    victim = world.client(cookie=f"{COOKIE}={own}", **ORIGIN)
    answer = victim.post(SIGN_IN, json=credentials("editor"))
    assert own not in answer.headers["set-cookie"]
    attacker = world.client(cookie=f"{COOKIE}={own}")
    assert attacker.get("/api/v1/me").status_code == 401  # it has ended, too


@pytest.mark.parametrize("origin", ["https://evil.example", "http://localhost:9", "null", "", "http://[", "localhost"])
def test_changes_from_elsewhere(world: World, origin: str) -> None:
    client = world.client()
    token = enter(client)
    answer = client.post("/api/v1/keys", json={"name": "forged"}, headers={"origin": origin})
    assert (answer.status_code, answer.json()["type"]) == (403, "origin-foreign")
    assert client.get("/api/v1/keys").json()["items"] == []
    assert token == client.cookies[COOKIE]


def test_changes_by_cookie_alone(world: World) -> None:
    """A form of another site sends the cookie (in old browsers), and cannot read the token."""
    client = world.client()
    token = enter(client)
    for headers in ({}, {"x-csrf-token": "0" * 64}, {"x-csrf-token": csrf_token("sds_other")}, {"x-csrf-token": "ä"}):
        raw = {name: value.encode() for name, value in headers.items()}
        answer = client.patch("/api/v1/me", json={"name": "forged"}, headers=raw)  # type: ignore[arg-type]
        assert (answer.status_code, answer.json()["type"]) == (403, "csrf")
    assert client.patch("/api/v1/me", json={}, headers={"authorization": "Basic eDp5"}).status_code == 403
    assert client.patch("/api/v1/me", json={}, headers={"x-csrf-token": csrf_token(token)}).status_code == 200
    assert client.patch("/api/v1/me", json={}, headers=ORIGIN).status_code == 200


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x"])
def test_a_form_cannot_sign_in(world: World, kind: str) -> None:
    """Else another site could sign a browser in as somebody of its choice."""
    body = '{"email": "editor@x.org", "password": "correct horse battery"}'
    answer = world.client().post(SIGN_IN, content=body, headers={"content-type": kind})
    assert answer.status_code in (400, 422)
    assert "set-cookie" not in answer.headers


def test_guessing(fresh: World) -> None:
    client = fresh.client(**ORIGIN)
    answers = [client.post(SIGN_IN, json=credentials("editor", f"guess {n}")) for n in range(7)]
    assert [answer.status_code for answer in answers] == [401] * 5 + [429] * 2
    assert answers[-1].json()["type"] == "too-many"
    assert 1 <= int(answers[-1].headers["retry-after"]) <= 61
    assert client.post(SIGN_IN, json=credentials()).status_code == 429  # the right one, too
    assert client.post(SIGN_IN, json=credentials("viewer")).status_code == 200  # others are not kept out


def test_nobody_learns_who_has_an_account(fresh: World) -> None:
    client = fresh.client(**ORIGIN)
    wrong = client.post(SIGN_IN, json=credentials("editor", "wrong password"))
    nobody = client.post(SIGN_IN, json=credentials("nobody", "wrong password"))
    assert (wrong.status_code, wrong.json()) == (nobody.status_code, nobody.json()) == (401, wrong.json())


def attempts_of(kind: str) -> Attempts:
    if kind == "redis":
        need("Redis", 6379)
    return Attempts(Settings(broker_url=REDIS if kind == "redis" else "", queue_prefix=f"sd_{new_token('t')[4:20]}"))


@pytest.mark.parametrize("kind", ["memory", pytest.param("redis", marks=pytest.mark.services)])
def test_attempts_are_counted(kind: str) -> None:
    attempts = attempts_of(kind)
    for _ in range(5):
        attempts.begin("a", "1.1.1.1")
    with pytest.raises(TooManyError):
        attempts.begin("a", "1.1.1.1")
    attempts.begin("a", "2.2.2.2")
    attempts.forgive("a", "1.1.1.1")
    attempts.begin("a", "1.1.1.1")
    for number in range(60):
        attempts.begin(f"account {number}", "3.3.3.3")
    with pytest.raises(TooManyError):  # one address, many accounts
        attempts.begin("account 60", "3.3.3.3")
    for number in range(50):
        attempts.begin("b", f"4.4.4.{number}")
    with pytest.raises(TooManyError):  # one account, many addresses
        attempts.begin("b", "4.4.4.50")


def test_attempts_without_their_redis() -> None:
    attempts = Attempts(Settings(broker_url="redis://127.0.0.1:1/0"))
    for _ in range(5):
        attempts.begin("a", "1.1.1.1")
    with pytest.raises(TooManyError):
        attempts.begin("a", "1.1.1.1")


def test_sessions_end_by_time(world: World) -> None:
    client = world.client()
    token = enter(client)
    with world.database.write() as session:
        past = utc_now() - timedelta(seconds=1)
        session.execute(update(SignIn).where(SignIn.digest == digest(token, world.secret)).values(expires_at=past))
    assert client.get("/api/v1/me").status_code == 401


def test_a_new_password_ends_the_others(fresh: World) -> None:
    here, there = fresh.client(**ORIGIN), fresh.client(**ORIGIN)
    enter(here), enter(there)
    path, new = "/api/v1/me/password", "another good one"
    assert here.put(path, json={"old": "wrong one!", "new": new}).status_code == 422
    assert here.put(path, json={"old": PASSWORD, "new": "short"}).status_code == 422
    assert there.get("/api/v1/me").status_code == 200
    assert here.put(path, json={"old": PASSWORD, "new": new}).status_code == 204
    assert here.get("/api/v1/me").status_code == 200
    assert there.get("/api/v1/me").status_code == 401
    assert there.post(SIGN_IN, json=credentials()).status_code == 401
    assert there.post(SIGN_IN, json=credentials("editor", new)).status_code == 200


def test_a_disabled_account(fresh: World) -> None:
    client, key = fresh.client(**ORIGIN), fresh.with_key("viewers")
    enter(client, "viewer")
    assert key.get("/api/v1/me").status_code == 200
    path, owner = f"/api/v1/users/{fresh.ids['viewer']}", fresh.signed_in("owner")
    assert owner.patch(path, json={"disabled": True}).json()["disabled"] is True
    assert client.get("/api/v1/me").status_code == 401
    assert key.get("/api/v1/me").status_code == 401
    assert client.post(SIGN_IN, json=credentials("viewer")).status_code == 401
    assert owner.patch(path, json={"disabled": False}).status_code == 200
    assert key.get("/api/v1/me").status_code == 200
    assert owner.patch(f"/api/v1/users/{fresh.ids['owner']}", json={"disabled": True}).status_code == 409


def test_sign_out_everywhere(fresh: World) -> None:
    here, there = fresh.client(**ORIGIN), fresh.client(**ORIGIN)
    enter(here), enter(there)
    assert here.post("/api/v1/auth/sign-out", json={"everywhere": True}).status_code == 204
    assert there.get("/api/v1/me").status_code == 401


def test_a_key_goes_before_the_cookie(world: World) -> None:
    """A request says one thing about who asks; a bad key does not fall back on the browser's session."""
    client = world.client(**ORIGIN)
    enter(client)
    key = world.keys["viewers"]
    assert client.get("/api/v1/me", headers={"authorization": f"Bearer {key}"}).json()["by"] == "key"
    for bad in ("Bearer ", "bearer x", f"Bearer {key}x", f"Bearer {world.keys['expired']}", f"Bearer {'x' * 9000}"):
        assert client.get("/api/v1/me", headers={"authorization": bad}).status_code == 401


def test_tokens() -> None:
    tokens = {new_token(SESSION) for _ in range(1000)}
    assert len(tokens) == 1000
    for token in list(tokens)[:50]:
        assert is_token(token, SESSION)
        assert not is_token(token, "sdk")
        for place in (5, 20, len(token) - 1):
            other = "A" if token[place] != "A" else "B"
            assert not is_token(token[:place] + other + token[place + 1 :], SESSION)
    assert not is_token("", SESSION)
    assert not is_token("ä" * 53, SESSION)
