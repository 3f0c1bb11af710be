"""Hydrodynamic jobs over REST and in a worker: from a mesh to a data set that a case refers to."""

from __future__ import annotations

import shutil
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from solver.vessel.data import read_bytes
from store.database import Database
from store.repositories import DataSetRepository
from store.repositories.hydrodynamics import HydrodynamicsRepository
from store.scope import Scope
from store.settings import Settings
from tests.api.conftest import ROOT, TestClient, client, migrated  # noqa: F401  (fixtures)
from worker.execute import Worker, execute_next

from .shapes import as_gdf, box, need_capytaine

BASE = "/api/v1/hydrodynamics"
JOB: dict[str, Any] = {
    "name": "small barge",
    "geometry": {"hull": {"kind": "barge", "length": 80, "breadth": 24, "draft": 8}, "panel_size": 8},
    "body": {"centre_of_gravity": [0, 0, 2], "mass": 1.5e7, "radii_of_gyration": [8, 22, 23]},
    "frequencies": {"from": 0.2, "to": 1.2, "step": 0.2},
    "headings": {"from": "0 deg", "to": "345 deg", "step": "15 deg"},
}


@pytest.fixture
def service_settings(tmp_path: Path, migrated: Path) -> Settings:  # noqa: F811
    shutil.copy(migrated, tmp_path / "slowdrift.db")
    return Settings(data_dir=tmp_path, bem_memory_mb=550)


@pytest.fixture
def worker(service_settings: Settings) -> Iterator[Worker]:
    settings = service_settings.model_copy(update={"heartbeat_seconds": 0.05, "checkpoint_seconds": 0.01})
    database = Database(settings.database)
    yield Worker(database, None, settings, "host/1/2")  # type: ignore[arg-type]
    database.close()


def upload(client: TestClient, content: bytes, name: str = "hull.gdf") -> Any:  # noqa: F811
    return client.post(f"{BASE}/meshes", files={"file": (name, content)})


def test_a_mesh_is_stored_once_measured_and_listed(client: TestClient) -> None:  # noqa: F811
    first = upload(client, as_gdf(box(80, 24, 8, 8)))
    assert first.status_code == 201
    mesh = first.json()
    assert (mesh["format"], mesh["quality"]["symmetry"]) == ("GDF", ["x", "y"])
    assert mesh["quality"]["volume"] == pytest.approx(80 * 24 * 8)
    assert len(mesh["preview"]["faces"]) == mesh["quality"]["panels"]
    assert upload(client, as_gdf(box(80, 24, 8, 8))).status_code == 200
    listed = client.get(f"{BASE}/meshes").json()["items"]
    assert [item["id"] for item in listed] == [mesh["id"]]
    assert "preview" not in listed[0]
    assert client.get(f"{BASE}/meshes/{mesh['id']}").json() == mesh
    assert client.delete(f"{BASE}/meshes/{mesh['id']}").status_code == 204
    assert client.get(f"{BASE}/meshes/{mesh['id']}").status_code == 404


def test_a_mesh_that_cannot_be_read_is_not_stored(client: TestClient) -> None:  # noqa: F811
    answer = upload(client, as_gdf(box(80, 24, 8, 8))[:300])
    assert answer.status_code == 422
    fault = answer.json()["errors"][0]
    assert fault["field"] == "file"
    assert "line" in fault["message"]
    assert client.get(f"{BASE}/meshes").json()["items"] == []
    assert upload(client, b"\0" * 33_600_000).status_code == 422


def test_a_hull_is_looked_at_before_it_is_computed(client: TestClient) -> None:  # noqa: F811
    found = client.post(f"{BASE}/mesh", json={"geometry": JOB["geometry"], "coarsest": 2.5}).json()
    assert found["quality"]["closed"]
    assert [doubt["check"] for doubt in found["warnings"]] == ["panels per wavelength"]
    assert found["estimate"]["panels"] == found["preview"]["panels"]
    assert client.get(BASE).json()["total"] == 0
    mesh = upload(client, as_gdf(box(80, 24, 8, 8))).json()
    moved = client.post(f"{BASE}/mesh", json={"geometry": {"mesh": mesh["id"], "move": [0, 0, 2]}}).json()
    assert moved["quality"]["draught"] == pytest.approx(6)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"body": None}, "body"),
        ({"geometry": {"hull": {"kind": "barge", "length": 80, "breadth": 24, "draft": 0}}}, "geometry.hull.draft"),
        ({"geometry": {"mesh": "nowhere.gdf"}}, "geometry.mesh"),
        ({"geometry": {**JOB["geometry"], "panel_size": 0.8}}, "geometry"),
    ],
)
def test_a_faulty_job_is_refused_and_nothing_queued(client: TestClient, change: Any, field: str) -> None:  # noqa: F811
    answer = client.post(BASE, json=JOB | change)
    assert answer.status_code == 422
    assert [fault["field"] for fault in answer.json()["errors"]] == [field]
    assert client.get(BASE).json()["total"] == 0


def test_the_schema_names_what_a_job_takes(client: TestClient) -> None:  # noqa: F811
    assert {"geometry", "body", "frequencies", "headings"} <= set(client.get(f"{BASE}/schema").json()["properties"])


def test_a_job_makes_a_data_set_that_a_case_refers_to(client: TestClient, worker: Worker) -> None:  # noqa: F811
    need_capytaine()
    mesh = upload(client, as_gdf(box(80, 24, 8, 8))).json()
    asked = JOB | {"geometry": {"mesh": "hull.gdf"}}
    started = client.post(BASE, content=yaml.safe_dump(asked), headers={"content-type": "application/yaml"})
    assert started.status_code == 202, started.text
    job = started.json()
    assert (job["state"], job["mesh_id"], job["data_set_id"]) == ("queued", mesh["id"], None)
    assert any("kg" in warning for warning in job["warnings"]) is False
    assert client.delete(f"{BASE}/meshes/{mesh['id']}").status_code == 409
    listed = client.get("/api/v1/runs").json()["items"]
    assert [(run["kind"], run["case_id"], run["case_name"]) for run in listed] == [
        ("hydrodynamics", None, "small barge")
    ]
    assert execute_next(worker, "runs") is None
    done = execute_next(worker, "hydrodynamics")
    assert done is not None
    assert done[1] == "succeeded"
    job = client.get(f"{BASE}/{job['id']}").json()
    assert (job["state"], job["progress"]) == ("succeeded", 1.0)
    data = client.get(f"/api/v1/data-sets/{job['data_set_id']}").json()
    assert (data["name"], data["version"]) == ("small barge", 1)
    assert data["summary"]["mean_drift"]
    summary = client.get(f"/api/v1/runs/{job['id']}/summary").json()["hydrodynamics"]
    assert summary["estimate"]["panels"] == mesh["quality"]["panels"]
    case = yaml.safe_load((ROOT / "examples" / "fpso-2000m.yaml").read_text())
    case["vessel"]["hydrodynamics"]["data"] = "small barge"
    assert client.post("/api/v1/cases/check", json=case).status_code in (
        200,
        422,
    )  # the band may be wider than the data
    assert client.get(f"/api/v1/runs/{job['id']}/export").status_code == 200
    assert client.post(f"/api/v1/runs/{job['id']}/rerun").status_code in (404, 405, 409)
    assert client.delete(f"{BASE}/{job['id']}").status_code == 204
    assert client.get(f"/api/v1/data-sets/{job['data_set_id']}").status_code == 200
    assert client.delete(f"{BASE}/meshes/{mesh['id']}").status_code == 204


def start(client: TestClient, **change: Any) -> str:  # noqa: F811
    return str(client.post(BASE, json=JOB | change).json()["id"])


def test_a_queued_job_is_cancelled_at_once(client: TestClient, worker: Worker) -> None:  # noqa: F811
    key = start(client)
    assert client.post(f"{BASE}/{key}/cancel").json()["state"] == "cancelled"
    assert execute_next(worker, "hydrodynamics") is None
    assert client.post(f"{BASE}/{key}/cancel").status_code == 409


def test_a_job_at_work_reports_and_is_cancelled_between_solutions(client: TestClient, worker: Worker) -> None:  # noqa: F811
    need_capytaine()
    key = start(client, geometry={**JOB["geometry"], "panel_size": 3})
    words: list[Any] = []
    thread = threading.Thread(target=lambda: words.append(execute_next(worker, "hydrodynamics")))
    thread.start()
    deadline = time.monotonic() + 60
    while client.get(f"{BASE}/{key}").json()["progress"] == 0 and time.monotonic() < deadline:
        time.sleep(0.02)
    assert " of 8, " in client.get(f"{BASE}/{key}").json()["message"]
    assert client.post(f"{BASE}/{key}/cancel").json()["state"] == "cancelling"
    began = time.monotonic()
    thread.join(30)
    assert time.monotonic() - began < 10
    assert words[0][1] == "cancelled"
    assert client.get(f"{BASE}/{key}").json()["state"] == "cancelled"
    assert client.get("/api/v1/data-sets").json()["items"] == []


def test_a_worker_that_leaves_hands_its_frequencies_on(client: TestClient, worker: Worker) -> None:  # noqa: F811
    need_capytaine()
    key = start(client)
    leaving = threading.Event()

    class Leaver:
        """Says that it leaves once a frequency is solved."""

        def __call__(self) -> bool:
            with worker.database.read() as session:
                view = HydrodynamicsRepository(session, Scope()).job(key).view
            return leaving.is_set() or view.progress > 0.3

    first = Worker(worker.database, None, worker.settings, "host/1/3", Leaver())  # type: ignore[arg-type]
    done = execute_next(first, "hydrodynamics")
    assert done is not None
    assert done[1] == "released"
    second = execute_next(worker, "hydrodynamics")
    assert second is not None
    assert second[1] == "succeeded"
    job = client.get(f"{BASE}/{key}").json()
    assert (job["state"], job["attempt"]) == ("succeeded", 2)
    with worker.database.read() as session:
        row = DataSetRepository(session, Scope()).get(job["data_set_id"])
        assert read_bytes(row.payload, row.filename).omega.size == 6


def test_the_command_line_does_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    need_capytaine()
    from cli.main import main

    (tmp_path / "hull.gdf").write_bytes(as_gdf(box(80, 24, 8, 8)))
    job = tmp_path / "job.yaml"
    job.write_text(yaml.safe_dump(JOB | {"geometry": {"mesh": "hull.gdf"}, "frequencies": [0.5]}))
    assert main(["bem", str(job)]) == 0
    assert "15360 m3 displaced" in capsys.readouterr().out
    out = tmp_path / "hull.nc"
    assert main(["bem", str(job), "--out", str(out), "--json", str(tmp_path / "hull.json"), "--quiet"]) == 0
    assert read_bytes(out.read_bytes(), "hull.nc").omega == pytest.approx([0.5])
    job.write_text("name: a\ngeometry: {hull: {kind: barge, length: 1}}\n")
    assert main(["bem", str(job), "--out", str(out)]) == 2
    assert "geometry.hull.draft (line 2)" in capsys.readouterr().err


def test_a_worker_makes_its_tables_before_it_takes_a_task(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Making them holds Python's lock, a minute and more on a busy machine: a lease would run out."""
    from solver.bem import green
    from solver.outcome import DataError
    from worker import hydrodynamics, main

    order: list[str] = []
    monkeypatch.setattr(hydrodynamics, "warm_up", lambda folder: order.append("tables"))
    monkeypatch.setattr("worker.app.app.worker_main", lambda arguments: order.append("worker"))
    main.run_worker("hydrodynamics")
    main.run_worker("runs")
    assert order == ["tables", "worker", "worker"]
    monkeypatch.undo()

    def missing() -> None:
        raise DataError("boundary elements need Capytaine, which is not installed here; install slowdrift[bem]")

    monkeypatch.setenv("CAPYTAINE_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(green, "make_tables", missing)
    hydrodynamics.warm_up(tmp_path)
    assert "install slowdrift[bem]" in caplog.text
