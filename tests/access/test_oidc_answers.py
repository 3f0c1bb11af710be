"""A provider whose answers are not what they should be: none of them signs anybody in.

The real provider (test_oidc.py) gives no such answers. This one signs what the test wants.
"""

from __future__ import annotations

import hmac
import json
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from hashlib import sha256
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from joserfc import jwt
from joserfc.jwk import RSAKey
from joserfc.util import urlsafe_b64encode

from store.settings import Settings, SettingsError
from tests.access.conftest import World, opened
from tests.access.test_oidc import CALLBACK, PUBLIC, START, browser, refusal
from tests.api.conftest import migrated  # noqa: F401  (fixture)

OWN, FOREIGN = RSAKey.generate_key(2048), RSAKey.generate_key(2048)


@dataclass
class Forger:
    """What it answers where; a test changes that."""

    address: str = ""
    metadata: dict[str, Any] = field(default_factory=dict)
    keys: list[dict[str, Any]] = field(default_factory=list)
    token: str | None = None
    userinfo: Any = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)

    def reset(self) -> None:
        self.metadata = {
            "issuer": self.address,
            "authorization_endpoint": f"{self.address}/auth",
            "token_endpoint": f"{self.address}/token",
            "jwks_uri": f"{self.address}/keys",
            "userinfo_endpoint": f"{self.address}/userinfo",
        }
        self.keys = [OWN.as_dict(private=False) | {"kid": "own"}]
        self.token, self.userinfo, self.asked = None, {}, []

    def answer(self, path: str) -> Any:
        self.asked.append(path)
        return {
            "/.well-known/openid-configuration": self.metadata,
            "/keys": {"keys": self.keys},
            "/token": {"access_token": "a", "token_type": "Bearer", "id_token": self.token},
            "/userinfo": self.userinfo,
        }[path]


class Answering(BaseHTTPRequestHandler):
    forger: Forger

    def do_GET(self) -> None:
        body = json.dumps(self.forger.answer(urlsplit(self.path).path)).encode()
        self.rfile.read(int(self.headers.get("content-length") or 0))
        self.send_response(200)
        self.send_header("content-type", "application/json")
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    do_POST = do_GET  # noqa: N815

    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture(scope="module")
def serving() -> Iterator[Forger]:
    forger = Forger()
    server = ThreadingHTTPServer(("127.0.0.1", 0), type("Mine", (Answering,), {"forger": forger}))
    forger.address = f"http://127.0.0.1:{server.server_address[1]}"
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield forger
    server.shutdown()


@pytest.fixture
def forger(serving: Forger) -> Forger:
    serving.reset()
    return serving


@pytest.fixture
def world(tmp_path: Path, migrated: Path, password_hash: str, forger: Forger) -> Iterator[World]:  # noqa: F811
    settings = {"oidc_issuer": forger.address, "oidc_client_id": "slowdrift", "public_url": PUBLIC}
    with opened(tmp_path, migrated, password_hash, **settings) as made:
        yield made


def signed(claims: dict[str, Any], algorithm: str = "RS256", key: Any = OWN, kid: str = "own") -> str:
    return jwt.encode({"alg": algorithm, "kid": kid}, claims, key, algorithms=[algorithm])


def unsigned(claims: dict[str, Any]) -> str:
    parts = [{"alg": "none"}, claims]
    return ".".join(urlsafe_b64encode(json.dumps(part).encode()).decode() for part in parts) + "."


def confused(claims: dict[str, Any]) -> str:
    """Signed with the public key, which everybody has, as if it were a secret."""
    parts = [{"alg": "HS256", "kid": "own"}, claims]
    said = ".".join(urlsafe_b64encode(json.dumps(part).encode()).decode() for part in parts)
    signature = hmac.new(OWN.as_pem(private=False), said.encode(), sha256).digest()
    return f"{said}.{urlsafe_b64encode(signature).decode()}"


def answered(world: World, forger: Forger, make: Callable[[dict[str, Any]], str | None], **query: str) -> Any:
    client = browser(world)
    begun = client.get(START)
    assert "oidc=" not in begun.headers["location"], begun.headers["location"]
    asked = parse_qs(urlsplit(begun.headers["location"]).query)
    now = int(time.time())
    claims = {
        "iss": forger.address, "sub": "e-1", "aud": "slowdrift", "iat": now, "exp": now + 60,
        "nonce": asked["nonce"][0], "email": "editor@x.org", "email_verified": True,
    }  # fmt: skip
    forger.token = make(claims)
    return client.get(CALLBACK, params={"state": asked["state"][0], "code": "c"} | query)


def changed(**values: Any) -> Callable[[dict[str, Any]], str]:
    """The good token with other claims; None takes one away."""

    def make(claims: dict[str, Any]) -> str:
        return signed({name: value for name, value in (claims | values).items() if value is not None})

    return make


NOW = int(time.time())
GOOD: dict[str, Callable[[dict[str, Any]], str | None]] = {
    "as it should be": signed,
    "for several": changed(aud=["slowdrift", "other"], azp="slowdrift"),
    "verified as a text": changed(email_verified="true"),
    "another algorithm": lambda claims: signed(claims, "PS512"),
    "a clock a little behind": changed(iat=NOW - 90, exp=NOW + 3000),
}
BAD: dict[str, Callable[[dict[str, Any]], str | None]] = {
    "wrong issuer": changed(iss="https://other.example"),
    "no issuer": changed(iss=None),
    "wrong audience": changed(aud="other"),
    "for several, made for another": changed(aud=["slowdrift", "other"], azp="other"),
    "for several, made for nobody": changed(aud=["slowdrift", "other"]),
    "no audience": changed(aud=None),
    "wrong nonce": changed(nonce="0" * 64),
    "no nonce": changed(nonce=None),
    "expired": changed(exp=NOW - 3600),
    "no expiry": changed(exp=None),
    "of the future": changed(iat=NOW + 36_000, exp=NOW + 40_000),
    "no subject": changed(sub=None),
    "alg none": unsigned,
    "signed with the public key": confused,
    "signed with another key": lambda claims: signed(claims, key=FOREIGN),
    "signed with a key of another name": lambda claims: signed(claims, key=FOREIGN, kid="foreign"),
    "spoilt": lambda claims: signed(claims)[:-4] + "AAAA",
    "no token": lambda _: None,
    "no JWT": lambda _: "x.y.z",
    "a text": lambda _: "",
}


@pytest.mark.parametrize("name", GOOD)
def test_good_answers(world: World, forger: Forger, name: str) -> None:
    assert answered(world, forger, GOOD[name]).headers["location"] == f"{PUBLIC}/app/"


@pytest.mark.parametrize("name", BAD)
def test_bad_answers(world: World, forger: Forger, name: str) -> None:
    assert refusal(answered(world, forger, BAD[name])) == "failed"


@pytest.mark.parametrize("value", [False, "false", None, 1, "yes", []])
def test_an_address_that_is_not_vouched_for(world: World, forger: Forger, value: Any) -> None:
    assert refusal(answered(world, forger, changed(email_verified=value))) == "email"


def test_the_callback_names_its_issuer(world: World, forger: Forger) -> None:
    assert refusal(answered(world, forger, signed, iss="https://other.example")) == "failed"
    assert answered(world, forger, signed, iss=forger.address).headers["location"] == f"{PUBLIC}/app/"


def test_the_callback_must_name_it_where_the_provider_says_so(world: World, forger: Forger) -> None:
    forger.metadata["authorization_response_iss_parameter_supported"] = True
    assert refusal(answered(world, forger, signed)) == "failed"


def test_userinfo_of_somebody_else(world: World, forger: Forger) -> None:
    forger.userinfo = {"sub": "e-2", "email": "owner@x.org", "email_verified": True}
    assert refusal(answered(world, forger, changed(email=None))) == "failed"
    forger.userinfo["sub"] = "e-1"
    assert answered(world, forger, changed(email=None)).headers["location"] == f"{PUBLIC}/app/"


def test_userinfo_vouches_for_its_own_address_only(world: World, forger: Forger) -> None:
    """`email_verified` of the token says nothing of an address that comes from elsewhere."""
    forger.userinfo = {"sub": "e-1", "email": "owner@x.org"}
    assert refusal(answered(world, forger, changed(email=None, email_verified=True))) == "email"


@pytest.mark.parametrize("userinfo", [[], "text", None, {}])
def test_userinfo_that_is_none(world: World, forger: Forger, userinfo: Any) -> None:
    forger.userinfo = userinfo
    assert refusal(answered(world, forger, changed(email=None))) == "failed"


def test_new_keys_are_fetched(world: World, forger: Forger) -> None:
    """A provider changes its keys now and then."""
    assert answered(world, forger, signed).headers["location"] == f"{PUBLIC}/app/"
    forger.keys = [FOREIGN.as_dict(private=False) | {"kid": "new"}]
    new = answered(world, forger, lambda claims: signed(claims, key=FOREIGN, kid="new"))
    assert new.headers["location"] == f"{PUBLIC}/app/"
    assert forger.asked.count("/keys") == 2
    assert forger.asked.count("/.well-known/openid-configuration") == 1


@pytest.mark.parametrize(
    "change",
    [{"issuer": "https://other.example"}, {"issuer": None}, {"authorization_endpoint": None},
     {"authorization_endpoint": "ftp://x"}, {"authorization_endpoint": ["x"]}],
)  # fmt: skip
def test_a_provider_that_is_another(world: World, forger: Forger, change: dict[str, Any]) -> None:
    forger.metadata |= change
    assert refusal(browser(world).get(START)) == "unavailable"


def test_keys_that_are_none(world: World, forger: Forger) -> None:
    forger.keys = [{"kty": "nothing"}]
    assert refusal(answered(world, forger, signed)) == "failed"


@pytest.mark.parametrize(
    "issuer", ["http://provider.example", "ftp://x", "provider.example", "https://", "file:///etc"]
)
def test_the_issuer_is_reached_by_https(issuer: str) -> None:
    given = {"SLOWDRIFT_OIDC_ISSUER": issuer, "SLOWDRIFT_OIDC_CLIENT_ID": "x", "SLOWDRIFT_PUBLIC_URL": PUBLIC}
    with pytest.raises(SettingsError, match="SLOWDRIFT_OIDC_ISSUER"):
        Settings.from_env(given)


@pytest.mark.parametrize("missing", ["SLOWDRIFT_OIDC_CLIENT_ID", "SLOWDRIFT_PUBLIC_URL"])
def test_what_an_issuer_needs(missing: str) -> None:
    given = {
        "SLOWDRIFT_OIDC_ISSUER": "https://id.example",
        "SLOWDRIFT_OIDC_CLIENT_ID": "x",
        "SLOWDRIFT_PUBLIC_URL": PUBLIC,
    }
    Settings.from_env(given)
    with pytest.raises(SettingsError, match=missing):
        Settings.from_env({name: value for name, value in given.items() if name != missing})
