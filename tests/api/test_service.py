"""What the API answers when all is well, and who it answers to."""

from __future__ import annotations

import io
import json
import subprocess
import sys
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from api.main import create_app
from solver.results.channel import Axis, Channel
from store.database import Database
from store.settings import Settings
from tests.api.conftest import TestClient
from tests.service import fake_solver
from tests.service.running import a_case
from tests.vessel import synthetic
from worker.execute import Worker, execute
from worker.preview import answer_preview

ROOT = Path(__file__).resolve().parents[2]


def finish(client: TestClient, database: Database, settings: Settings) -> None:
    """Do what stands in the queue, in this process."""
    from sqlalchemy import select

    from store.models import Task

    with database.read() as session:
        tasks = list(session.scalars(select(Task.id).where(Task.state == "queued")))
    for task in tasks:
        execute(Worker(database, fake_solver, settings, "host/1/1"), task)  # type: ignore[arg-type]


@pytest.fixture
def done(client: TestClient, database: Database, service_settings: Settings) -> dict[str, Any]:
    run = client.post("/api/v1/runs", json={"case": a_case("done")}).json()
    assert run["state"] == "queued"
    finish(client, database, service_settings)
    return dict(client.get(f"/api/v1/runs/{run['id']}").json())


def test_cases_are_versions(client: TestClient, riser: str) -> None:
    yaml = {"content-type": "application/yaml"}
    first = client.post("/api/v1/cases", content=riser, headers=yaml)
    assert (first.status_code, first.json()["version"]) == (201, 1)
    again = client.post("/api/v1/cases", content=riser, headers=yaml)
    assert (again.status_code, again.json()["id"]) == (200, first.json()["id"])
    other = client.post("/api/v1/cases", content=riser.replace("170 m", "171 m"), headers=yaml)
    assert (other.status_code, other.json()["version"]) == (201, 2)
    shown = client.get(f"/api/v1/cases/{first.json()['id']}").json()
    assert shown["yaml"] == riser
    assert client.post("/api/v1/cases", json=shown["case"]).json()["id"] == first.json()["id"]
    page = client.get("/api/v1/cases?limit=1").json()
    assert page["items"][0]["id"] == other.json()["id"]
    rest = client.get("/api/v1/cases", params={"limit": 5, "cursor": page["next_cursor"]}).json()
    assert [item["id"] for item in rest["items"]] == [first.json()["id"]]
    assert client.delete(f"/api/v1/cases/{other.json()['id']}").status_code == 204
    assert client.get(f"/api/v1/cases/{other.json()['id']}").status_code == 404
    checked = client.post("/api/v1/cases/check", content=riser, headers=yaml).json()
    assert (checked["ok"], checked["analyses"]) == (True, ["statics", "frequency_domain", "time_domain"])


def test_a_run_and_its_results(client: TestClient, done: dict[str, Any]) -> None:
    assert (done["state"], done["warnings"], done["progress"]) == ("succeeded", ["a warning"], 1.0)
    base = f"/api/v1/runs/{done['id']}"
    assert client.get(f"{base}/summary").json()["statics"] == {"converged": True}
    items = client.get(f"{base}/channels").json()["items"]
    assert items[1]["dims"] == ["omega", "arc_length"]
    assert items[1]["axes"][1] == {"name": "arc_length", "unit": "m", "size": 3, "first": 0.0, "last": 120.0}
    whole = client.get(f"{base}/channels/frequency/vessel/surge").json()
    assert (len(whole["values"]), whole["decimation"]) == (50, None)
    part = client.get(f"{base}/channels/frequency/line/top/tension?arc_length=70&from=0.5&to=0.6").json()
    assert part["values"] == [2.0 * k for k in range(21, 25)]
    assert [axis["name"] for axis in part["axes"]] == ["omega"]
    strided = client.get(f"{base}/channels/frequency/line/top/tension?points=10").json()
    assert (strided["decimation"], strided["full_size"], len(strided["values"])) == ("stride", 50, 10)
    for query in ("points=1", "from=nan", "seed=1", "points=x"):
        answer = client.get(f"{base}/channels/frequency/vessel/surge?{query}")
        assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json")
    assert client.get(f"{base}/channels/../../../etc/passwd").status_code == 404
    with zipfile.ZipFile(io.BytesIO(client.get(f"{base}/export").content)) as archive:
        assert set(archive.namelist()) == {"run.json", "summary.json", "case.yaml", "channels.npz"}
        arrays = np.load(io.BytesIO(archive.read("channels.npz")))
        assert arrays["frequency/line/top/tension"].shape == (50, 3)
        assert arrays["frequency/line/top/tension@omega"].dtype == np.float64
    assert client.get("/api/v1/runs?state=succeeded&total=true").json()["total"] == 1
    assert client.get("/api/v1/runs?state=failed&total=true").json() == {"items": [], "next_cursor": None, "total": 0}
    assert client.delete(f"/api/v1/cases/{done['case_id']}").status_code == 409
    assert client.delete(base).status_code == 204
    assert client.get(f"{base}/channels").status_code == 404


def test_m4_keeps_every_peak() -> None:
    from api.services.channels import View, look

    rng = np.random.default_rng(1)
    t = np.arange(150_000) * 0.4
    for _ in range(20):
        values = rng.normal(size=t.size).cumsum()
        shown = look(Channel("c", values, (Axis("time", "s", t),), "N", ""), View(points=2000))
        assert len(shown["values"]) <= 2000
        assert (max(shown["values"]), min(shown["values"])) == (values.max(), values.min())


def test_unfinished_and_cancelled(client: TestClient) -> None:
    run = client.post("/api/v1/runs", json={"case": a_case("waits")}).json()
    assert client.get(f"/api/v1/runs/{run['id']}/summary").status_code == 409
    assert client.delete(f"/api/v1/runs/{run['id']}").status_code == 409
    assert client.post(f"/api/v1/runs/{run['id']}/cancel").json()["outcomes"] == {"statics": "cancelled"}
    with client.stream("GET", f"/api/v1/runs/{run['id']}/events") as stream:
        lines = [line for line in stream.iter_lines() if line]
    assert lines[0] == "event: run"
    assert json.loads(lines[1].removeprefix("data: "))["state"] == "cancelled"
    assert client.get("/api/v1/runs/nobody/events").status_code == 404


def test_part_of_the_analyses_may_fail(client: TestClient, database: Database, service_settings: Settings) -> None:
    analyses = {"statics": {}, "modes": {"count": 3}}
    run = client.post("/api/v1/runs", json={"case": a_case("half", analyses, failures={"modes": "No."})}).json()
    finish(client, database, service_settings)
    run = client.get(f"/api/v1/runs/{run['id']}").json()
    assert (run["state"], run["reason"]) == ("failed", "modes: No.")
    assert run["outcomes"] == {"statics": "succeeded", "modes": "failed"}
    assert client.get(f"/api/v1/runs/{run['id']}/summary").status_code == 200


def test_data_sets(client: TestClient, tmp_path: Path) -> None:
    payload = synthetic.to_bytes(synthetic.dataset(), tmp_path)
    name = "../../<script>ship\x00.nc"
    made = client.post("/api/v1/data-sets", files={"file": (name, payload)}, data={"name": "a/b/ship.nc"})
    assert made.status_code == 201, made.text
    assert made.json()["name"] == "ship.nc"
    assert not set("/\\<>\0") & set(made.json()["filename"])
    assert client.post("/api/v1/data-sets", files={"file": ("other.nc", payload)}).status_code == 200
    other = synthetic.to_bytes(synthetic.dataset(seed=2), tmp_path)
    second = client.post("/api/v1/data-sets", files={"file": ("ship.nc", other)}).json()
    assert second["version"] == 2
    assert len(client.get("/api/v1/data-sets").json()["items"]) == 2
    assert client.delete(f"/api/v1/data-sets/{second['id']}").status_code == 204


def test_catalogue(client: TestClient) -> None:
    assert client.get("/api/v1/schema").json()["properties"]["lines"]
    examples = client.get("/api/v1/examples").json()
    assert {"fpso-2000m", "hanging-riser-case1"} <= {example["name"] for example in examples}
    spec = client.get("/api/v1/openapi.json").json()
    assert "/api/v1/runs/{run_id}/channels/{name}" in spec["paths"]
    assert "#/$defs" not in json.dumps(spec["paths"])
    assert "HTTPValidationError" not in json.dumps(spec["paths"])
    assert spec["paths"]["/api/v1/cases"]["post"]["requestBody"]["content"]["application/yaml"]["example"]


def test_health_tells_the_truth(client: TestClient, service_settings: Settings, tmp_path: Path) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}
    ready = client.get("/readyz").json()
    assert ready["status"] == "ok"
    assert ready["checks"] == dict.fromkeys(("database", "writes", "migrations", "broker", "disk"), "ok")
    broken = service_settings.model_copy(
        update={"database_url": f"sqlite:///{tmp_path}/new.db", "broker_url": "redis://127.0.0.1:1/0"}
    )
    with TestClient(create_app(broken, reconcile=False), base_url="http://localhost") as client:
        answer = client.get("/readyz")
        assert answer.status_code == 503
        assert answer.json()["checks"]["database"] == "ok"
        assert "slowdrift migrate" in answer.json()["checks"]["migrations"]
        assert "ConnectionError" in answer.json()["checks"]["broker"]


def test_a_dead_broker_loses_no_run(client: TestClient, service_settings: Settings) -> None:
    deaf = service_settings.model_copy(update={"broker_url": "redis://127.0.0.1:1/0"})
    with TestClient(create_app(deaf, reconcile=False), base_url="http://localhost") as other:
        began = time.monotonic()
        assert other.post("/api/v1/runs", json={"case": a_case("unheard")}).status_code == 202
        assert time.monotonic() - began < 1
        assert other.post("/api/v1/preview", json=a_case("unseen")).status_code in (503, 504)
    assert client.get("/api/v1/runs?total=true").json()["total"] == 1


def test_who_may_ask(client: TestClient) -> None:
    assert client.get("/api/v1/runs", headers={"host": "evil.example"}).status_code == 400
    assert client.get("/healthz", headers={"host": "127.0.0.1:8000"}).status_code == 200
    assert client.get("/healthz", headers={"host": "[::1]:8000"}).status_code == 200
    foreign = client.post("/api/v1/runs", json={"case": {}}, headers={"origin": "https://evil.example"})
    assert (foreign.status_code, foreign.json()["type"]) == (403, "origin-foreign")
    own = client.post("/api/v1/runs", json={"case": {}}, headers={"origin": "http://localhost"})
    assert own.status_code == 422
    for answer in (foreign, own, client.get("/api/v1/schema"), client.get("/nothing")):
        assert answer.headers["x-content-type-options"] == "nosniff"
    large = client.post("/api/v1/data-sets", content=b"", headers={"content-length": "999999999"})
    assert (large.status_code, large.headers["content-type"]) == (413, "application/problem+json")
    assert large.json()["type"] == "too-large"


def test_an_error_of_ours_tells_nothing(service_settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    from api.services import runs

    monkeypatch.setattr(runs, "show", lambda *_: 1 / 0)
    app = create_app(service_settings, reconcile=False)
    with TestClient(app, base_url="http://localhost", raise_server_exceptions=False) as client:
        answer = client.get("/api/v1/runs/x")
    assert (answer.status_code, answer.json()["type"]) == (500, "internal-error")
    assert "ZeroDivision" not in answer.text
    assert "division" not in answer.text


def test_preview(
    client: TestClient, database: Database, service_settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert client.post("/api/v1/preview", json=a_case("nobody there")).status_code == 504
    context = client.app.state.context  # type: ignore[attr-defined]

    def ring(key: str) -> None:
        answer_preview(database, fake_solver, service_settings, key)  # type: ignore[arg-type]

    monkeypatch.setattr(context.doorbell, "ring_preview", ring)
    answer = client.post("/api/v1/preview", json=a_case("shape", {"modes": {"count": 2}}))
    assert answer.status_code == 200, answer.text
    assert answer.json()["lines"]["top"]["arc_length"] == [0.0, 60.0, 120.0]
    bad = client.post("/api/v1/preview", json=a_case("bad", fault="diverge"))
    assert (bad.status_code, bad.json()["type"]) == (422, "not-converged")
    slow = client.post("/api/v1/preview", json=a_case("slow", seconds=5))
    assert slow.status_code == 422


def test_the_api_loads_no_solver_and_no_worker() -> None:
    unwanted = ("numba", "worker", "solver.run", "dash", "alembic")
    code = f"import sys, api.main, cli.main; print([m for m in {unwanted} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_help_loads_no_library() -> None:
    code = (
        "import sys, cli.main\ntry: cli.main.main(['--help'])\nexcept SystemExit: pass\n"
        "print([m for m in ('fastapi', 'celery', 'numpy', 'pydantic', 'sqlalchemy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
