"""Behind a proxy: which requests count as this machine's own, for a service without accounts and for /metrics."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import flask
import pytest

import frontend.app
from api.main import create_app
from api.nearness import is_local
from cli.serve import compose_app
from store.settings import Settings, SettingsError
from tests.api.conftest import TestClient, service_settings  # noqa: F401  (fixture)

HERE = ("127.0.0.1", 50_000)


def a_scope(client: Any = HERE, host: str = "localhost:8000", version: str = "1.1", **headers: str) -> dict[str, Any]:
    named = {"host": host} | {name.replace("_", "-"): value for name, value in headers.items()}
    raw = [(name.encode(), value.encode()) for name, value in named.items()]
    return {"type": "http", "client": client, "http_version": version, "headers": raw}


@pytest.mark.parametrize("address", ["127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1"])
@pytest.mark.parametrize("host", ["localhost", "127.0.0.1:8000", "[::1]:8000", "LOCALHOST:1"])
def test_a_program_on_this_machine_is_local(address: str, host: str) -> None:
    assert is_local(a_scope((address, 1), host, user_agent="curl", accept="*/*", x_request_id="7"))


@pytest.mark.parametrize("address", ["192.0.2.1", "10.0.0.1", "::ffff:192.0.2.1", "2001:db8::1", "testclient", ""])
def test_other_machines_are_not(address: str) -> None:
    assert not is_local(a_scope((address, 1)))
    assert not is_local(a_scope(None))


@pytest.mark.parametrize(
    "name",
    ["forwarded", "x_forwarded_for", "x_forwarded_proto", "x_forwarded_host", "x_forwarded_server", "via", "x_real_ip",
     "cf_connecting_ip", "true_client_ip", "x_client_ip", "x_forwarded", "x_original_host"],
)  # fmt: skip
def test_what_a_proxy_adds_tells_it(name: str) -> None:
    """Even where the header claims that the caller is here: any caller can write that."""
    assert not is_local(a_scope(**{name: "127.0.0.1"}))
    assert not is_local(a_scope(**{name: ""}))


def test_what_a_proxy_does_without_headers_tells_it() -> None:
    assert not is_local(a_scope(version="1.0"))  # nginx with `proxy_pass` alone
    assert not is_local(a_scope(host="slowdrift.example.org"))
    assert not is_local(a_scope(host=""))


@contextmanager
def serving(settings: Settings, client: Any = HERE, **changed: Any) -> Iterator[TestClient]:
    app = create_app(settings.model_copy(update=changed), reconcile=False)
    with TestClient(app, base_url="http://localhost", client=client) as made:
        yield made


PROXIED = {"x-forwarded-for": "192.0.2.7"}


def test_a_proxy_on_this_machine_opens_nothing(service_settings: Settings) -> None:  # noqa: F811
    with serving(service_settings) as client:
        assert client.get("/api/v1/runs").status_code == 200
        assert client.get("/metrics").status_code == 200
        answer = client.get("/api/v1/runs", headers=PROXIED)
        assert (answer.status_code, answer.json()["type"]) == (401, "sign-in-required")
        assert "slowdrift user add" in answer.json()["detail"]
        assert client.post("/api/v1/runs", json={}, headers=PROXIED).status_code == 401
        assert client.get("/metrics", headers=PROXIED).status_code == 404
        assert client.get("/api/v1/auth", headers=PROXIED).json() == {
            "accounts": True,
            "signed_in": False,
            "provider": None,
        }
        assert client.get("/healthz", headers=PROXIED).status_code == 200
        assert client.get("/api/v1/runs").status_code == 200  # and the person here goes on


def test_other_machines_see_nothing_without_accounts(service_settings: Settings) -> None:  # noqa: F811
    with serving(service_settings, client=("192.0.2.7", 1)) as client:
        assert client.get("/api/v1/runs").status_code == 401
        assert client.get("/metrics").status_code == 404


@pytest.mark.parametrize("named", [{"public_url": "https://x.org"}, {"forwarded_allow_ips": "127.0.0.1"}])
def test_settings_of_a_proxy_close_the_one_person_mode(service_settings: Settings, named: Any) -> None:  # noqa: F811
    """A proxy need not leave a mark; so where one is named, no request counts as this machine's."""
    with serving(service_settings, **named) as client:
        assert client.get("/api/v1/runs").status_code == 401
        assert client.get("/metrics").status_code == 404
    with serving(service_settings, metrics_token="x" * 20, **named) as client:
        assert client.get("/metrics", headers={"authorization": f"Bearer {'x' * 20}"} | PROXIED).status_code == 200


def test_told_so_it_obeys_everybody(service_settings: Settings) -> None:  # noqa: F811
    with serving(service_settings, client=("192.0.2.7", 1), allow_no_login=True) as client:
        assert client.get("/api/v1/runs").status_code == 200
        assert client.get("/api/v1/runs", headers=PROXIED).status_code == 200
        assert client.get("/metrics").status_code == 404


def test_the_pages_hand_the_mark_on(service_settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: F811
    """They ask the API from this machine, for callers elsewhere."""
    seen: list[dict[str, str]] = []
    make = frontend.app.create_app

    def with_one_more_page(*arguments: Any) -> flask.Flask:
        server = make(*arguments)
        pages = server.config["SLOWDRIFT_CLIENT"]
        monkeypatch.setattr(pages, "_answer", lambda method, url, headers, **_: seen.append(headers))
        server.add_url_rule("/asked", view_func=lambda: str(pages.get("/runs")))
        return server

    monkeypatch.setattr(frontend.app, "create_app", with_one_more_page)
    with TestClient(compose_app(service_settings, 1), base_url="http://localhost") as client:
        for headers in ({}, PROXIED, {"via": "1.1 proxy"}):
            assert client.get("/app/asked", headers=headers).status_code == 200
    assert [headers.get("x-forwarded-for") for headers in seen] == [None, "192.0.2.7", "127.0.0.1"]


@pytest.mark.parametrize("names", ["*", "127.0.0.1,*", "proxy", "10.0.0.1/8", "127.0.0.1;10.0.0.1"])
def test_proxies_are_named_by_address(names: str) -> None:
    with pytest.raises(SettingsError, match=r"SLOWDRIFT_FORWARDED_ALLOW_IPS.*no address and no network of a proxy"):
        Settings.from_env({"SLOWDRIFT_FORWARDED_ALLOW_IPS": names})


def test_the_name_that_uvicorn_has_for_it_is_read() -> None:
    assert Settings.from_env({"FORWARDED_ALLOW_IPS": "10.0.0.0/8, ::1"}).forwarded_allow_ips == "10.0.0.0/8, ::1"
    both = {"FORWARDED_ALLOW_IPS": "10.0.0.1", "SLOWDRIFT_FORWARDED_ALLOW_IPS": "10.0.0.2"}
    assert Settings.from_env(both).forwarded_allow_ips == "10.0.0.2"
    assert Settings.from_env({}).forwarded_allow_ips == ""
