"""The examples through the whole service with the real solver, as README and docs show them."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest

from .conftest import Place
from .running import ROOT, command, environment, processes_of, service, wait_until

pytestmark = pytest.mark.slow


@pytest.fixture
def client(make_place: Callable[..., Place]) -> Iterator[httpx.Client]:
    place = make_place("embedded", solver="solver.run", lease_seconds=60)
    with service(place.settings, False) as client:
        yield client


def test_the_ten_line_client(client: httpx.Client) -> None:
    script = [sys.executable, str(ROOT / "examples" / "rest_client.py"), str(client.base_url).rstrip("/")]
    done = subprocess.run(script, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1].startswith("surge sigma: ")
    run = client.get("/api/v1/runs").json()["items"][0]
    assert run["outcomes"] == {"statics": "succeeded", "frequency_domain": "succeeded", "modes": "succeeded"}
    assert run["data_set_id"]
    names = {item["name"] for item in client.get(f"/api/v1/runs/{run['id']}/channels").json()["items"]}
    assert "frequency/vessel/surge" in names
    riser = (ROOT / "examples" / "hanging-riser-case1.yaml").read_text()
    wait_until(lambda: client.post("/api/v1/preview", content=riser).status_code == 200, 120)


def test_the_readme_s_ten_lines(client: httpx.Client) -> None:
    text = (ROOT / "README.md").read_text()
    code = text.split("```python\n", 1)[1].split("```", 1)[0]
    code = code.replace("http://127.0.0.1:8000", str(client.base_url).rstrip("/"))
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
    assert 1.8 < float(done.stdout.split()[0]) < 2.3


def test_seeds_of_the_time_domain_are_tasks_of_one_run(client: httpx.Client) -> None:
    text = (ROOT / "examples" / "fpso-2000m.yaml").read_text()
    found = next(line for line in text.splitlines() if "time_domain:" in line)
    short = "  time_domain: {step: 0.1, build_up: 60 s, duration: 300 s, seeds: 5, output_step: 0.5 s}"
    answer = client.post("/api/v1/runs", json={"yaml": text.replace(found, short)}).json()
    wait_until(lambda: client.get(f"/api/v1/runs/{answer['id']}").json()["state"] in ("succeeded", "failed"), 240)
    summary = client.get(f"/api/v1/runs/{answer['id']}/summary").json()
    assert summary["failures"] == {}
    assert summary["time_domain"]["realisations"] == 5
    ratio = (
        summary["frequency_domain"]["vessel_std"]["wf"]["heave"] / summary["time_domain"]["vessel_std"]["wf"]["heave"]
    )
    assert abs(ratio - 1) < 0.05
    address = f"/api/v1/runs/{answer['id']}/channels/time/line/bow-port/end_b_tension"
    channel = client.get(address, params={"seed": 3, "points": 200}).json()
    assert len(channel["values"]) <= 400
    assert 3e6 < min(channel["values"]) < max(channel["values"]) < 7e6


def test_demo_ends_and_leaves_nothing(make_place: Callable[..., Place], tmp_path: Path) -> None:
    settings = make_place("embedded", solver="solver.run", lease_seconds=60).settings
    done = subprocess.run(
        command("demo", "--exit", "--port", "0"),
        env=environment(settings), capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    for word in ("surge", "damping", "largest σ of tension", "/app/runs/"):
        assert word in done.stdout
    assert not processes_of(settings)


def test_the_python_client_of_the_docs(client: httpx.Client) -> None:
    pytest.importorskip("xarray")
    text = (ROOT / "docs" / "client.md").read_text()
    code = text.split("<!-- client-example -->\n```python\n", 1)[1].split("```", 1)[0]
    code = code.replace("http://127.0.0.1:8000", str(client.base_url).rstrip("/"))
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[-2].startswith("surge: ")
    assert lines[-1].startswith("spectrum over ")


def test_a_rerun_and_a_study_of_the_same_give_the_same_numbers(client: httpx.Client) -> None:
    text = (ROOT / "examples" / "hanging-riser-case1.yaml").read_text()
    analyses = ["statics", "frequency_domain"]
    first = client.post("/api/v1/runs", json={"yaml": text, "analyses": analyses}).json()
    again = client.post(f"/api/v1/runs/{first['id']}/rerun").json()
    study = {"case_id": first["case_id"], "analyses": analyses, "overrides": [{}, {"/environment/depth": 301.0}]}
    made = client.post("/api/v1/studies", json=study).json()
    wait_until(lambda: client.get("/api/v1/runs?state=queued,running&total=true").json()["total"] == 0, 120)
    assert client.get("/api/v1/runs?state=succeeded&total=true").json()["total"] == 4
    same, other = client.get(f"/api/v1/studies/{made['id']}/runs").json()["items"]
    assert same["content_hash"] == first["content_hash"] != other["content_hash"]
    summaries = [
        _numbers(client.get(f"/api/v1/runs/{run['id']}/summary").json()) for run in (first, again, same, other)
    ]
    assert summaries[0] == summaries[1] == summaries[2] != summaries[3]


def _numbers(summary: object) -> object:
    """Without the times that it took."""
    if isinstance(summary, dict):
        return {key: _numbers(value) for key, value in summary.items() if key not in ("wall_time", "compile_time")}
    return summary
