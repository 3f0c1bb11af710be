"""Signing in by OpenID Connect at a real provider: the whole way by HTTP, and who gets in."""

from __future__ import annotations

import re
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest
from sqlalchemy import func, select

from store.clock import utc_now
from store.people import Audit, Identity, Invitation, SignIn, User
from store.repositories.accounts import AccountRepository
from store.repositories.teams import TeamRepository
from store.tokens import INVITATION, digest, new_token
from tests.access.conftest import World, opened
from tests.api.conftest import TestClient, migrated  # noqa: F401  (fixture)
from tests.deploy.tools import missing, npm
from tests.service.running import free_port, wait_until

PUBLIC = "https://localhost"
START, CALLBACK = "/api/v1/auth/oidc/start", "/api/v1/auth/oidc/callback"
SECRET = "a secret of the test's own"


@contextmanager
def provider(folder: Path, public: str) -> Iterator[str]:
    """oidc-provider from npm, run by node, for a service at the public address; its issuer."""
    script = npm("oidc-provider").parents[1] / "provider.mjs"
    if not shutil.which("node"):
        missing("no node")
    port, log = free_port(), folder / "provider.log"
    with log.open("w") as out:
        command = ["node", str(script), str(port), public + CALLBACK, f"{public}/app/sign-in"]
        process = subprocess.Popen(command, stdout=out, stderr=out)
    wait_until(lambda: "listening" in log.read_text() or process.poll() is not None, 120)
    assert process.poll() is None, log.read_text()
    yield f"http://127.0.0.1:{port}"
    process.terminate()
    process.wait(30)


@pytest.fixture(scope="module")
def issuer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with provider(tmp_path_factory.mktemp("provider"), PUBLIC) as made:
        yield made


@contextmanager
def service(folder: Path, template: Path, hashed: str, issuer: str, **settings: str) -> Iterator[World]:
    given = {"oidc_issuer": issuer, "oidc_client_id": "slowdrift", "oidc_client_secret": SECRET, "public_url": PUBLIC}
    with opened(folder, template, hashed, **(given | settings)) as made:
        yield made


@pytest.fixture
def world(tmp_path: Path, migrated: Path, password_hash: str, issuer: str) -> Iterator[World]:  # noqa: F811
    with service(tmp_path, migrated, password_hash, issuer, oidc_domains="staff.example, x.example") as made:
        yield made


def browser(world: World) -> TestClient:
    return TestClient(world.app, base_url=PUBLIC, follow_redirects=False)


def at_provider(address: str, login: str) -> str:
    """Signs in at the provider as a person does, with its forms: the address to which it sends the browser back."""
    with httpx.Client(follow_redirects=False, timeout=60) as client:
        answer = client.get(address)
        for _ in range(12):
            if answer.is_redirect:
                to = str(answer.next_request.url) if answer.next_request else ""
                if to.startswith(PUBLIC):
                    return to
                answer = client.get(to)
                continue
            form = re.search(r'action="([^"]+)"', answer.text)
            prompt = re.search(r'name="prompt" value="(\w+)"', answer.text)
            assert form is not None, answer.text
            assert prompt is not None, answer.text
            fields = {"prompt": prompt.group(1)} | (
                {"login": login, "password": "any"} if prompt.group(1) == "login" else {}
            )
            answer = client.post(str(answer.url.join(form.group(1))), data=fields)
    raise AssertionError("the provider sends nobody back")


def sign_in(client: TestClient, login: str, page: str = "/app/") -> httpx.Response:
    """The whole way; the answer of the callback."""
    begun = client.get(START, params={"next": page})
    assert begun.status_code == 303, begun.text
    back = at_provider(begun.headers["location"], login)
    return client.get(back.removeprefix(PUBLIC))


def refusal(answer: httpx.Response) -> str:
    """Why the sign-in page says that somebody was refused; no session was begun."""
    assert answer.status_code == 303
    assert not any("slowdrift=sds_" in cookie for cookie in answer.headers.get_list("set-cookie"))
    place = urlsplit(answer.headers["location"])
    assert (f"{place.scheme}://{place.netloc}", place.path) == (PUBLIC, "/app/sign-in")
    return parse_qs(place.query)["oidc"][0]


def count(world: World, model: type) -> int:
    with world.database.read() as session:
        return session.scalar(select(func.count()).select_from(model)) or 0


def invite(world: World, email: str | None, days: int = 1) -> None:
    row = Invitation(
        team_id=world.ids["team"], role="editor", email=email, expires_at=utc_now() + timedelta(days=days),
        digest=digest(new_token(INVITATION), world.secret),
    )  # fmt: skip
    with world.database.write() as session:
        TeamRepository(session).invite(row)


def test_the_whole_way(world: World) -> None:
    client = browser(world)
    assert client.get("/api/v1/auth").json() == {"accounts": True, "signed_in": False, "provider": "your organisation"}
    begun = client.get(START, params={"next": "/app/runs?x=1"})
    asked = {name: values[0] for name, values in parse_qs(urlsplit(begun.headers["location"]).query).items()}
    assert asked["code_challenge_method"] == "S256"
    assert asked["response_type"] == "code"
    assert asked["redirect_uri"] == PUBLIC + CALLBACK
    assert len({asked["state"], asked["nonce"], asked["code_challenge"]}) == 3
    cookie = begun.headers["set-cookie"]
    assert {"httponly", "secure", "samesite=lax"} <= {part.strip().lower() for part in cookie.split(";")}
    assert not any(asked[name] in cookie for name in ("state", "nonce"))
    answer = client.get(at_provider(begun.headers["location"], "e-1/editor@x.org/verified").removeprefix(PUBLIC))
    assert (answer.status_code, answer.headers["location"]) == (303, f"{PUBLIC}/app/runs?x=1")
    me = client.get("/api/v1/me").json()
    assert (me["user"]["email"], me["by"], me["by_provider"]) == ("editor@x.org", "session", True)
    assert "__Host-slowdrift-oidc" not in client.cookies
    assert sign_in(browser(world), "e-1/editor@x.org/verified").headers["location"] == f"{PUBLIC}/app/"
    assert count(world, Identity) == 1


def test_the_log_names_who_and_how(world: World) -> None:
    sign_in(browser(world), "e-1/editor@x.org/verified")
    with world.database.read() as session:
        entry = session.scalars(select(Audit).order_by(Audit.id.desc())).first()
    assert entry is not None
    assert (entry.actor, entry.user_id) == ("editor@x.org", world.ids["editor"])
    assert entry.action == f"GET {CALLBACK}"
    assert entry.subject["linked"] == "e-1/editor@x.org/verified"
    assert "code" not in entry.subject


def test_sign_out(world: World) -> None:
    client = browser(world)
    sign_in(client, "e-1/editor@x.org/verified")
    assert client.post("/api/v1/auth/sign-out", headers={"origin": PUBLIC}).status_code == 204
    assert client.get("/api/v1/me").status_code == 401
    answer = client.get("/api/v1/auth/oidc/sign-out")
    place = urlsplit(answer.headers["location"])
    assert place.path == "/session/end"
    assert parse_qs(place.query)["post_logout_redirect_uri"] == [f"{PUBLIC}/app/sign-in"]
    assert httpx.get(answer.headers["location"], timeout=60).status_code == 200  # the provider knows us and the address


@pytest.mark.parametrize(
    "page", ["https://evil.example/", "//evil.example", "/app/\\evil", "/app/\r\nx", "javascript:1", ""]
)
def test_it_leads_on_to_our_own_pages_only(world: World, page: str) -> None:
    assert sign_in(browser(world), "e-1/editor@x.org/verified", page).headers["location"] == f"{PUBLIC}/app/"


# -- who gets in


def test_the_subject_counts_not_the_address(world: World) -> None:
    """Once linked, somebody stays who they are when the address changes; and the address alone is nobody."""
    sign_in(browser(world), "e-1/editor@x.org/verified")
    assert refusal(sign_in(browser(world), "e-2/editor@x.org/verified")) == "other"
    with world.database.write() as session:
        AccountRepository(session).get(world.ids["editor"]).email = "editor@new.org"
    client = browser(world)
    sign_in(client, "e-1/editor@x.org/verified")
    assert client.get("/api/v1/me").json()["user"]["id"] == world.ids["editor"]


@pytest.mark.parametrize(
    ("login", "reason"),
    [
        ("u/editor@x.org/unverified", "email"),
        ("u//verified", "email"),
        ("u/nobody@x.org/verified", "unknown"),
        ("u/nobody@sub.staff.example/verified", "unknown"),
        ("u/nobody@evilstaff.example/verified", "unknown"),
        ("u/newcomer@staff.example/unverified", "email"),
    ],
)
def test_who_does_not_get_in(world: World, login: str, reason: str) -> None:
    before = count(world, User), count(world, SignIn)
    client = browser(world)
    assert refusal(sign_in(client, login)) == reason
    assert client.get("/api/v1/me").status_code == 401
    assert (count(world, User), count(world, SignIn), count(world, Identity)) == (*before, 0)


def test_an_invitation_lets_in(world: World) -> None:
    invite(world, "eve@elsewhere.org")
    client = browser(world)
    assert sign_in(client, "eve/eve@elsewhere.org/verified").headers["location"] == f"{PUBLIC}/app/"
    me = client.get("/api/v1/me").json()
    assert (me["home"]["team_id"], me["home"]["role"]) == (world.ids["team"], "editor")
    assert (me["user"]["name"], me["user"]["is_admin"]) == ("eve", False)
    with world.database.read() as session:
        assert session.scalars(select(Invitation).where(Invitation.used_by == me["user"]["id"])).one().used_at
    password = {"email": "eve@elsewhere.org", "password": ""}
    assert client.post("/api/v1/auth/sign-in", json=password, headers={"origin": PUBLIC}).status_code == 401


@pytest.mark.parametrize(("email", "days"), [(None, 1), ("eve@elsewhere.org", -1), ("eva@elsewhere.org", 1)])
def test_other_invitations_do_not(world: World, email: str | None, days: int) -> None:
    """One for whoever has the link, one that is over, somebody else's."""
    invite(world, email, days)
    assert refusal(sign_in(browser(world), "eve/eve@elsewhere.org/verified")) == "unknown"


def test_a_domain_that_settings_allow(world: World) -> None:
    client = browser(world)
    sign_in(client, "n/New.Comer@Staff.Example/verified")
    me = client.get("/api/v1/me").json()
    assert (me["user"]["email"], me["home"], me["homes"]) == ("new.comer@staff.example", None, [])


def test_a_disabled_account(world: World) -> None:
    sign_in(browser(world), "v-1/viewer@x.org/verified")
    with world.database.write() as session:
        accounts = AccountRepository(session)
        accounts.set_disabled(accounts.get(world.ids["viewer"]), True)
    assert refusal(sign_in(browser(world), "v-1/viewer@x.org/verified")) == "disabled"


# -- what goes wrong on the way


def test_somebody_elses_answer(world: World) -> None:
    """An attacker's own answer in the victim's browser would sign the victim in as the attacker."""
    attacker, victim = browser(world), browser(world)
    begun = attacker.get(START)
    back = at_provider(begun.headers["location"], "e-1/editor@x.org/verified").removeprefix(PUBLIC)
    assert refusal(victim.get(back)) == "expired"  # has begun nothing
    victim.get(START)
    assert refusal(victim.get(back)) == "expired"  # has begun another


@pytest.mark.parametrize("spoil", ["state", "code", "cookie", "time"])
def test_wrong_state_code_cookie_and_time(world: World, spoil: str, monkeypatch: pytest.MonkeyPatch) -> None:
    client = browser(world)
    begun = client.get(START)
    back = at_provider(begun.headers["location"], "e-1/editor@x.org/verified").removeprefix(PUBLIC)
    if spoil in ("state", "code"):
        back = re.sub(rf"{spoil}=[^&]+", f"{spoil}={'0' * 64}", back)
    if spoil == "cookie":
        name, _, value = begun.headers["set-cookie"].partition(";")[0].partition("=")
        number, began, rest = value.split(".", 2)
        client.cookies.clear()
        client.cookies.set(name, f"{number}.{int(began) + 1}.{rest}")
    if spoil == "time":
        now = time.time()
        monkeypatch.setattr("api.services.oidc.time.time", lambda: now + 601)
    assert refusal(client.get(back)) == ("failed" if spoil == "code" else "expired")


def test_a_code_works_once(world: World) -> None:
    client = browser(world)
    begun = client.get(START)
    cookie = begun.headers["set-cookie"].partition(";")[0].partition("=")
    back = at_provider(begun.headers["location"], "e-1/editor@x.org/verified").removeprefix(PUBLIC)
    assert client.get(back).headers["location"] == f"{PUBLIC}/app/"
    assert refusal(client.get(back)) == "expired"
    client.cookies.set(cookie[0], cookie[2])
    assert refusal(client.get(back)) == "failed"


def test_a_code_that_has_expired(tmp_path: Path, migrated: Path, password_hash: str, issuer: str) -> None:  # noqa: F811
    with service(tmp_path, migrated, password_hash, issuer, oidc_client_id="hasty") as world:
        client = browser(world)
        begun = client.get(START)
        back = at_provider(begun.headers["location"], "e-1/editor@x.org/verified").removeprefix(PUBLIC)
        time.sleep(2.5)  # the provider's codes are good for a second here
        assert refusal(client.get(back)) == "failed"


def test_a_wrong_secret(tmp_path: Path, migrated: Path, password_hash: str, issuer: str) -> None:  # noqa: F811
    with service(tmp_path, migrated, password_hash, issuer, oidc_client_secret="not that one") as world:
        assert refusal(sign_in(browser(world), "e-1/editor@x.org/verified")) == "failed"


def test_the_provider_refuses(world: World) -> None:
    client = browser(world)
    asked = parse_qs(urlsplit(client.get(START).headers["location"]).query)
    assert refusal(client.get(CALLBACK, params={"state": asked["state"][0], "error": "access_denied"})) == "refused"


def test_no_provider(tmp_path: Path, migrated: Path, password_hash: str) -> None:  # noqa: F811
    port = free_port()
    with service(tmp_path, migrated, password_hash, f"http://127.0.0.1:{port}") as world:
        assert refusal(browser(world).get(START)) == "unavailable"
        answer = browser(world).get("/api/v1/auth/oidc/sign-out")
        assert answer.headers["location"] == f"{PUBLIC}/app/sign-in"


def test_strangers_cannot_make_us_ask_for_ever(world: World) -> None:
    client = browser(world)
    answers = [client.get(CALLBACK, params={"state": "x", "code": "y"}) for _ in range(62)]
    assert [refusal(answer) for answer in answers] == ["expired"] * 60 + ["many"] * 2


def test_without_the_setting_there_is_nothing(tmp_path: Path, migrated: Path, password_hash: str) -> None:  # noqa: F811
    with opened(tmp_path, migrated, password_hash) as world:
        assert world.client().get("/api/v1/auth").json()["provider"] is None
        for path in (START, CALLBACK, "/api/v1/auth/oidc/sign-out"):
            assert world.client().get(path).status_code == 404
