"""What hostile names, references, paths and bodies do: nothing."""

from __future__ import annotations

import builtins
import gzip
import io
import socket
import urllib.request
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
import zstandard
from a2wsgi import WSGIMiddleware

from tests.access.conftest import World, netcdf
from tests.api.conftest import TestClient
from tests.service.running import a_case

SCRIPT = "<script>alert(1)</script><img src=x onerror=alert(2)>"


def test_scripts_in_names_stay_text(world: World) -> None:
    """The API answers JSON and says that it is nothing else; what it says is what was stored."""
    run = world.run(SCRIPT)
    editor, owner = world.signed_in("editor"), world.signed_in("owner")
    assert editor.patch(f"/api/v1/runs/{run['id']}", json={"name": SCRIPT}).status_code == 200
    share = editor.post("/api/v1/shares", json={"run_ids": [run["id"]], "title": SCRIPT, "view": {"tab": SCRIPT}})
    owner.post("/api/v1/teams", json={"name": SCRIPT})
    editor.patch("/api/v1/me", json={"name": SCRIPT})
    text = f"# {SCRIPT}\n" + editor.get(f"/api/v1/cases/{run['case_id']}").json()["yaml"]
    case = editor.post("/api/v1/cases", content=text, headers={"content-type": "application/yaml"}).json()
    paths = (
        "runs", f"runs/{run['id']}", f"runs/{run['id']}/summary", f"cases/{run['case_id']}", f"cases/{case['id']}",
        "cases", "shares", f"shared/{share.json()['token']}", "me", f"teams/{world.ids['team']}/members", "runs/<script>",
    )  # fmt: skip
    for path in paths:
        answer = editor.get(f"/api/v1/{path}")
        assert answer.headers["content-type"].partition(";")[0] in ("application/json", "application/problem+json")
        assert answer.headers["x-content-type-options"] == "nosniff"
        answer.json()
    assert editor.get(f"/api/v1/runs/{run['id']}").json()["case_name"] == SCRIPT


def test_pages_hold_no_name(world: World) -> None:
    """A page is the same for every run: names come as data, and the policy forbids inline scripts."""
    from frontend.app import create_app

    run = world.run(SCRIPT)
    pages = TestClient(WSGIMiddleware(create_app("http://localhost")), base_url="http://localhost")  # type: ignore[arg-type]
    encoded = quote(f'">{SCRIPT}')
    for path in ("/", f"/runs/{run['id']}", f"/runs/{SCRIPT}", f"/?q={SCRIPT}", f"/runs/{encoded}?q={encoded}"):
        page = pages.get(path)
        assert page.headers["content-type"].startswith("text/html")
        assert "<script>alert" not in page.text
        assert "<img" not in page.text
        policy = page.headers["content-security-policy"]
        scripts = next(part for part in policy.split("; ") if part.startswith("script-src"))
        assert "unsafe-inline" not in scripts
        assert "unsafe-eval" not in scripts


REFERENCES = (
    "http://169.254.169.254/latest/meta-data/", "https://evil.example/a.nc", "file:///etc/passwd", "/etc/passwd",
    "../../../../etc/passwd", "\\\\evil\\share\\a.nc", "s3://bucket/a.nc", "http://127.0.0.1:5432/", "~/.ssh/id_rsa",
    "examples/barge-240x46x10.nc", "|id", "ftp://evil.example/x", "http://[::1]:80/", "dict://127.0.0.1:6379/info",
)  # fmt: skip


@pytest.mark.parametrize("reference", REFERENCES)
def test_references_open_nothing(world: World, fpso: str, reference: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A case's data are rows of its project: the server opens no file and no address that a case names."""
    import yaml

    case = yaml.safe_load(fpso)
    case["vessel"]["hydrodynamics"]["data"] = reference
    opened: list[Any] = []
    really = builtins.open

    def watched(file: Any, *args: Any, **kwargs: Any) -> Any:
        opened.append(file)
        return really(file, *args, **kwargs)

    def refused(*args: Any, **_: Any) -> Any:
        opened.append(args)
        raise OSError("the network was asked")

    editor = world.signed_in("editor")
    editor.get("/api/v1/runs")
    with monkeypatch.context() as patch:
        patch.setattr(builtins, "open", watched)
        patch.setattr(Path, "read_bytes", lambda self: opened.append(self))
        patch.setattr(socket, "create_connection", refused)
        patch.setattr(socket, "getaddrinfo", refused)
        patch.setattr(urllib.request, "urlopen", refused)
        answers = [
            editor.post("/api/v1/cases/check", json=case),
            editor.post("/api/v1/runs", json={"case": case}),
            editor.post("/api/v1/preview", json=case),
            editor.post("/api/v1/studies", json={"case": case, "overrides": [{"/environment/depth": 1900}]}),
        ]
    assert [answer.status_code for answer in answers] == [422] * 4
    for answer in answers:
        assert any("hydrodynamics.data" in fault["field"] for fault in answer.json()["errors"]), answer.text
        assert "root:" not in answer.text
    assert opened == []


PATHS = (
    "/api/v1/runs/../../../../etc/passwd", "/api/v1/runs/..%2f..%2f..%2fetc%2fpasswd", "/api/v1/runs/%2e%2e/cases",
    "/api/v1/runs/x/channels/../../../../etc/passwd", "/app/assets/../../../../etc/passwd",
    "/app/assets/..%2f..%2f..%2fetc%2fpasswd", "/app/_dash-component-suites/dash/../../../../etc/passwd",
    "/app/assets/%2e%2e/app.py", "//etc/passwd", "/api/v1/cases/....//....//etc/passwd",
)  # fmt: skip


@pytest.mark.parametrize("path", PATHS)
def test_paths_that_lead_elsewhere(world: World, path: str) -> None:
    from frontend.app import create_app

    if not any(getattr(route, "path", "") == "/app" for route in world.app.routes):
        world.app.mount("/app", WSGIMiddleware(create_app("http://localhost")))  # type: ignore[arg-type]
    answer = world.signed_in("editor").get(path)
    assert answer.status_code in (200, 400, 404)
    assert "root:" not in answer.text
    assert "import annotations" not in answer.text
    if answer.status_code == 200:  # a page of ours that says there is nothing, or a list of one's own
        assert answer.headers["content-type"].startswith(("text/html", "application/json"))


@pytest.mark.parametrize(
    "name", ["../../../tmp/x.nc", "/etc/passwd", "C:\\x.nc", "a\r\nSet-Cookie: b=c", '"; x="', "ü"]
)
def test_file_names_are_made_harmless(world: World, tmp_path: Path, name: str) -> None:
    file = netcdf(tmp_path, seed=hash(name) % 10_000)
    made = world.signed_in("editor").post("/api/v1/data-sets", files={"file": (name, file)}, data={"name": name})
    assert made.status_code in (200, 201), made.text
    for kept in (made.json()["name"], made.json()["filename"]):
        assert not set(kept) & set('/\\:"\r\n;')


@pytest.mark.parametrize("packer", [gzip.compress, zstandard.compress])
@pytest.mark.parametrize("path", ["cases", "runs", "data-sets", "imports/run", "studies", "hydrodynamics/meshes"])
def test_compressed_bodies_are_not_unpacked(world: World, path: str, packer: Any) -> None:
    """No request body is decompressed, so none can grow."""
    bomb = packer(b'{"a": "' + b" " * 30_000_000 + b'"}')
    assert len(bomb) < 40_000
    kind = "gzip" if packer is gzip.compress else "zstd"
    headers = {"content-encoding": kind, "content-type": "application/json"}
    answer = world.signed_in("editor").post(f"/api/v1/{path}", content=bomb, headers=headers)
    assert answer.status_code in (400, 415, 422), answer.text


def test_a_netcdf_that_swells(world: World) -> None:
    """A dataset of a terabyte in a few kilobytes: chunks that are not there, and a filter that unpacks zeros."""
    import h5py

    target = io.BytesIO()
    with h5py.File(target, "w") as file:
        for name in ("added_mass", "radiation_damping", "omega", "diffraction_force"):
            file.create_dataset(name, shape=(10**6, 10**6), dtype="f8", chunks=(1000, 1000), compression="gzip")
    assert len(target.getvalue()) < 20_000
    answer = world.signed_in("editor").post("/api/v1/data-sets", files={"file": ("a.nc", target.getvalue())})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["field"] == "file"


def test_yaml_that_swells(world: World) -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join(10 * [f'*a{n - 1}'])}]" for n in range(1, 10)]
    headers = {"content-type": "application/yaml"}
    answer = world.signed_in("editor").post("/api/v1/cases", content="\n".join(lines), headers=headers)
    assert answer.status_code == 422
    assert len(answer.content) < 100_000


def test_numbers_that_swell(world: World) -> None:
    case = a_case("large") | {"description": "9" * 500_000}
    answer = world.signed_in("editor").post("/api/v1/cases", json=case)
    assert answer.status_code in (201, 422)
    body = '{"case": ' + "[" * 50_000 + "]" * 50_000 + "}"
    headers = {"content-type": "application/json"}
    assert world.signed_in("editor").post("/api/v1/runs", content=body, headers=headers).status_code == 422
    body = '{"name": "n", "expires_in_days": ' + "9" * 5000 + "}"
    assert world.signed_in("editor").post("/api/v1/keys", content=body, headers=headers).status_code in (400, 422)


def test_a_strangers_body_is_not_read(world: World) -> None:
    """401 before the first byte: nobody fills the disk who may not upload."""
    asked: list[int] = []

    def pieces() -> Any:
        for _ in range(3):
            asked.append(1)
            yield b"x" * 1000

    answer = world.client().post("/api/v1/data-sets", content=pieces(), headers={"content-type": "application/zip"})
    assert answer.status_code == 401


def test_hosts_of_another_name(world: World) -> None:
    for host in ("evil.example", "localhost.evil.example", "", "localhost:80@evil.example"):
        answer = world.client(host=host).get("/api/v1/auth")
        assert answer.status_code == 400, host


def test_answers_are_nobody_elses(world: World) -> None:
    """A browser may be somebody else's tomorrow: it asks again each time."""
    for path in ("me", "runs"):
        headers = world.signed_in("editor").get(f"/api/v1/{path}").headers
        assert "no-cache" in headers["cache-control"]
        assert "private" in headers["cache-control"]
        assert {"cookie", "authorization"} <= {part.strip().lower() for part in headers["vary"].split(",")}
