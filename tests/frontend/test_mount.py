"""Mounted as the service mounts it: prefix, own files, headers."""

from __future__ import annotations

import re
import time
from concurrent.futures import ThreadPoolExecutor

import flask
import pytest
from a2wsgi import WSGIMiddleware
from dash import Dash
from fastapi.testclient import TestClient

from frontend import caching
from frontend.app import create_app
from frontend.security import content_security_policy
from tests.frontend.fake_api import create_fake


@pytest.fixture(scope="module")
def mounted() -> TestClient:
    app = create_fake(0.0)
    app.mount("/app", WSGIMiddleware(create_app("http://service.test")))
    return TestClient(app)


@pytest.mark.parametrize("path", ["/app/", "/app/new", "/app/runs/abc?tab=spectra"])
def test_deep_links_answer(mounted: TestClient, path: str) -> None:
    page = mounted.get(path)
    assert page.status_code == 200
    assert '"requests_pathname_prefix":"\\u002fapp\\u002f"' in page.text


def test_without_the_slash_leads_to_the_pages(mounted: TestClient) -> None:
    assert mounted.get("/app").url.path == "/app/"


def test_every_file_is_our_own(mounted: TestClient) -> None:
    page = mounted.get("/app/").text
    addresses = re.findall(r'(?:src|href)="([^"]+)"', page)
    assert len(addresses) > 10
    assert all(address.startswith("/app/") for address in addresses)
    for address in addresses:
        assert mounted.get(address).status_code == 200, address


def test_nothing_from_elsewhere_is_allowed(mounted: TestClient) -> None:
    policy = mounted.get("/app/").headers["content-security-policy"]
    assert "default-src 'self'" in policy
    assert "http" not in policy
    script = next(part for part in policy.split("; ") if part.startswith("script-src"))
    assert "unsafe" not in script
    assert "'sha256-" in script


def test_policy_by_directive() -> None:
    assert "script-src 'self' 'sha256-x'" in content_security_policy(["'sha256-x'"])


def test_the_first_pages_are_whole_however_many_ask_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    lists_assets = Dash._walk_assets_directory

    def slowly(app: Dash) -> None:
        time.sleep(0.3)
        lists_assets(app)

    monkeypatch.setattr(Dash, "_walk_assets_directory", slowly)
    server = create_app("http://service.test", prefix="/")

    def ask(_: int) -> tuple[frozenset[str], int]:
        with server.test_client() as client:
            page, callbacks = client.get("/new"), client.get("/_dash-dependencies")
            return frozenset(re.findall(r'(?:src|href)="([^"?]+)', page.text)), len(callbacks.get_json())

    with ThreadPoolExecutor(4) as many:
        answers = set(many.map(ask, range(4)))
    assert len(answers) == 1
    assert "/assets/editor/7-yaml.js" in answers.pop()[0]


def test_rest_stays_rest(mounted: TestClient) -> None:
    assert mounted.get("/api/v1/runs").json()["items"] == []


def test_files_that_name_their_version_are_kept_for_good_and_compressed_once(mounted: TestClient) -> None:
    page = mounted.get("/app/new").text
    found = [part for part in re.findall(r'src="([^"]+)"', page) if "assets/" in part or "dash_mantine" in part]
    assert len(found) > 5
    plotly = "/app/_dash-component-suites/plotly/package_data/plotly.min.js?v=1"
    for path in (found[0], found[-1], *(part for part in found if "dash_mantine" in part), plotly):
        answers = [mounted.get(path) for _ in range(2)]
        assert answers[0].headers["Cache-Control"] == "public, max-age=31536000, immutable", path
        assert answers[0].headers["Content-Encoding"] in ("zstd", "br", "gzip"), path
        assert answers[0].content == answers[1].content
    assert "immutable" not in mounted.get("/app/new").headers.get("Cache-Control", "")


def test_answers_of_callbacks_are_never_kept() -> None:
    held = caching.Compressed()
    with flask.Flask("x").test_request_context("/_dash-update-component", method="POST"):
        key = f"br;{caching.compressed_key(flask.request)}"
    held.set(key, b"somebody's")
    assert held.get(key) is None


def test_the_scheme_is_set_before_anything_is_drawn(mounted: TestClient) -> None:
    page = mounted.get("/app/").text
    head = page.split("</head>")[0]
    assert "assets/first.js" in head
    assert '<html lang="en">' in page
