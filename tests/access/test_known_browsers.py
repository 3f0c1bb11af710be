"""Strangers who guess at an account's password do not keep its owner out."""

from __future__ import annotations

import pytest

from api.attempts import Attempts
from api.known_browsers import DAYS, KNOWN, SECURE_KNOWN, known_browser, known_value
from store.errors import TooManyError
from store.tokens import new_token
from tests.access.conftest import ORIGIN, PASSWORD, World
from tests.access.test_sessions import SIGN_IN, attempts_of, credentials, enter
from tests.api.conftest import TestClient

SECRET = b"s" * 40


def attempts(world: World) -> Attempts:
    found: Attempts = world.app.state.attempts
    return found


def strangers_guess(world: World, name: str = "editor") -> None:
    """From many addresses, until nobody may try this account."""
    for number in range(60):
        try:
            attempts(world).begin(f"{name}@x.org", f"4.4.4.{number}")
        except TooManyError:
            return
    raise AssertionError("there is no limit")


def test_the_owner_gets_in_while_strangers_guess(fresh: World) -> None:
    known = fresh.client(**ORIGIN)
    enter(known)
    assert known.post("/api/v1/auth/sign-out").status_code == 204
    strangers_guess(fresh)
    assert fresh.client(**ORIGIN).post(SIGN_IN, json=credentials()).status_code == 429
    assert known.post(SIGN_IN, json=credentials()).status_code == 200
    assert known.put("/api/v1/me/password", json={"old": PASSWORD, "new": "another good one"}).status_code == 204


def test_a_stranger_behind_the_same_address_keeps_nobody_out(fresh: World) -> None:
    known, stranger = fresh.client(**ORIGIN), fresh.client(**ORIGIN)
    enter(known)
    assert [stranger.post(SIGN_IN, json=credentials("editor", "wrong one")).status_code for _ in range(6)][-1] == 429
    assert known.post(SIGN_IN, json=credentials()).status_code == 200
    for number in range(60):
        stranger.post(SIGN_IN, json=credentials(f"nobody{number}", "wrong one"))
    assert stranger.post(SIGN_IN, json=credentials("viewer")).status_code == 429
    assert known.post(SIGN_IN, json=credentials()).status_code == 200


def test_a_known_browser_has_limits_of_its_own(fresh: World) -> None:
    known = fresh.client(**ORIGIN)
    enter(known)
    answers = [known.post(SIGN_IN, json=credentials("editor", f"guess {n}")).status_code for n in range(6)]
    assert answers == [401] * 5 + [429]
    assert known.post(SIGN_IN, json=credentials()).status_code == 429
    assert fresh.client(**ORIGIN).post(SIGN_IN, json=credentials()).status_code == 200  # others are not kept out


def test_it_is_known_to_its_account_only(fresh: World) -> None:
    """Who has an account here must not get round the limits at the accounts of others."""
    viewers = fresh.client(**ORIGIN)
    enter(viewers, "viewer")
    strangers_guess(fresh)
    assert viewers.post(SIGN_IN, json=credentials()).status_code == 429


def test_the_cookie(fresh: World) -> None:
    def cookie(client: TestClient, body: dict[str, str]) -> str:
        found = client.post(SIGN_IN, json=body).headers.get_list("set-cookie")
        return next((one for one in found if "known" in one), "")

    client = fresh.client(**ORIGIN)
    assert cookie(client, credentials("editor", "wrong one")) == ""
    made = cookie(client, credentials())
    parts = {part.strip().lower() for part in made.split(";")[1:]}
    assert {"httponly", "samesite=lax", "path=/", f"max-age={DAYS * 86_400}"} <= parts
    assert cookie(client, credentials()) == ""  # it is known already
    with TestClient(fresh.app, base_url="https://localhost") as https:
        made = cookie(https, credentials())
    assert made.startswith(f"{SECURE_KNOWN}=")
    assert "secure" in {part.strip().lower() for part in made.split(";")[1:]}


def test_it_opens_nothing(fresh: World) -> None:
    client = fresh.client(**ORIGIN)
    enter(client)
    other = fresh.client(cookie=f"{KNOWN}={client.cookies[KNOWN]}")
    assert other.get("/api/v1/me").status_code == 401


def test_forged_values_are_strangers() -> None:
    good = known_value("ada", SECRET, now=0)
    assert known_browser(f"{KNOWN}={good}", "ada", SECRET, now=86_400 * DAYS) is not None
    assert known_browser(f"{KNOWN}={good}", "ada", SECRET, now=86_400 * (DAYS + 1)) is None
    assert known_browser(f"{KNOWN}={good}", "bob", SECRET, now=0) is None
    assert known_browser(f"{KNOWN}={good}", "ada", b"another" * 6, now=0) is None
    user, number, ends, signature = good.split(".")
    for forged in (
        f"bob.{number}.{ends}.{signature}",
        f"ada.{number}x.{ends}.{signature}",
        f"ada.{number}.{int(ends) + 1}.{signature}",
        f"ada.{number}.{ends}.",
        signature,
        "...",
        "",
        "ä.ö.1.x",
    ):
        assert known_browser(f"{KNOWN}={forged}", "ada", SECRET, now=0) is None
        assert known_browser(f"{KNOWN}={forged}", "bob", SECRET, now=0) is None
    assert user == "ada"


@pytest.mark.parametrize("kind", ["memory", pytest.param("redis", marks=pytest.mark.services)])
def test_counts_are_apart(kind: str) -> None:
    counted = attempts_of(kind)
    account = new_token("t")
    for number in range(50):
        counted.begin(account, f"4.4.4.{number}")
    with pytest.raises(TooManyError):
        counted.begin(account, "5.5.5.5")
    for _ in range(5):
        counted.begin(account, "5.5.5.5", "one")
    with pytest.raises(TooManyError):
        counted.begin(account, "5.5.5.5", "one")
    counted.begin(account, "5.5.5.5", "two")
    counted.forgive(account, "5.5.5.5", "one")
    counted.begin(account, "5.5.5.5", "one")
