"""Results as files over REST."""

from __future__ import annotations

import csv
import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient

from store.database import Database
from store.models import Run
from store.repositories import ChannelRepository
from tests.io.channels import made

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def run(client: TestClient, database: Database, riser: str) -> str:
    """A run with channels and a summary, as if it had been computed."""
    key = str(client.post("/api/v1/runs", json={"yaml": riser}).json()["id"])
    with database.write() as session:
        row = session.get(Run, key)
        assert row is not None
        row.summary = json.dumps({"provenance": {"case_hash": row.content_hash, "seeds": [3, 4, 5]}, "warnings": []})
        ChannelRepository(session).put(key, made(np.float32).values())
    return key


def test_netcdf_opens_in_xarray(client: TestClient, run: str, tmp_path: Path, riser: str) -> None:
    xr = pytest.importorskip("xarray")
    answer = client.get(f"/api/v1/runs/{run}/export", params={"format": "netcdf"})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/x-netcdf"
    assert answer.headers["content-disposition"] == f'attachment; filename="slowdrift-{run}.nc"'
    path = tmp_path / "results.nc"
    path.write_bytes(answer.content)
    with xr.open_datatree(path) as tree:
        for name, channel in made(np.float32).items():
            np.testing.assert_array_equal(tree[name].values, channel.values)
        assert tree.attrs["run"] == run
        assert str(tree["case"].values) == riser


def test_csv_and_parquet_hold_what_is_chosen(client: TestClient, run: str, tmp_path: Path) -> None:
    asked = {"format": "csv", "channels": "time/vessel/*, time/line/bow 2.b/top_tension", "layout": "wide", "seed": 5}
    answer = client.get(f"/api/v1/runs/{run}/export", params=asked)
    assert answer.status_code == 200, answer.text
    rows = list(csv.reader(io.StringIO(answer.text)))
    assert rows[0] == [
        "time [s]",
        "time/vessel/surge [m]",
        "time/vessel/heave [m]",
        "time/line/bow 2.b/top_tension [N]",
    ]
    surge = np.array([row[1] for row in rows[1:]], dtype=np.float32)
    np.testing.assert_array_equal(surge, made(np.float32)["time/vessel/surge"].values[:, 2])
    pq = pytest.importorskip("pyarrow.parquet")
    answer = client.get(f"/api/v1/runs/{run}/export", params={"format": "parquet", "channels": "modes/*"})
    assert pq.read_table(io.BytesIO(answer.content)).num_rows == 12


def test_the_zip_is_still_there(client: TestClient, run: str) -> None:
    answer = client.get(f"/api/v1/runs/{run}/export")
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        assert set(archive.namelist()) == {"run.json", "summary.json", "case.yaml", "channels.npz"}
        with np.load(io.BytesIO(archive.read("channels.npz"))) as npz:
            np.testing.assert_array_equal(npz["time/vessel/surge@seed"], [3, 4, 5])


def test_wrong_choices_are_refused(client: TestClient, run: str, riser: str) -> None:
    address = f"/api/v1/runs/{run}/export"
    for params, field in (
        ({"format": "excel"}, "format"), ({"format": "csv", "channels": "time/vesel/*"}, "channels"),
        ({"format": "csv", "seed": 77}, "seed"), ({"format": "csv", "layout": "wide"}, "layout"),
        ({"format": "netcdf", "layout": "wide"}, "layout"), ({"channels": "time/*"}, "channels"), ({"seed": 3}, "seed"),
    ):  # fmt: skip
        answer = client.get(address, params=params)
        assert answer.status_code == 422, params
        assert answer.json()["errors"][0]["field"] == field
    fresh = client.post("/api/v1/runs", json={"yaml": riser.replace("Hanging riser", "Another")}).json()["id"]
    for kind in ("zip", "netcdf", "csv"):
        assert client.get(f"/api/v1/runs/{fresh}/export", params={"format": kind}).status_code == 409
    assert client.get("/api/v1/runs/none/export", params={"format": "csv"}).status_code == 404


def test_without_pyarrow_parquet_is_refused_with_the_remedy(
    client: TestClient, run: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    answer = client.get(f"/api/v1/runs/{run}/export", params={"format": "parquet"})
    assert answer.status_code == 422
    assert "slowdrift[parquet]" in answer.json()["errors"][0]["message"]


def test_hydrodynamic_data_leave_as_netcdf_and_as_wamit_files(client: TestClient, tmp_path: Path) -> None:
    xr = pytest.importorskip("xarray")
    payload = (ROOT / "examples" / "barge-240x46x10.nc").read_bytes()
    sent = client.post("/api/v1/data-sets", files={"file": ("barge.nc", payload)}, data={"name": "barge 240"}).json()
    address = f"/api/v1/data-sets/{sent['id']}/export"
    answer = client.get(address)
    assert answer.headers["content-disposition"] == 'attachment; filename="barge_240.nc"'
    path = tmp_path / "barge.nc"
    path.write_bytes(answer.content)
    with xr.open_dataset(path) as ours, xr.open_dataset(ROOT / "examples" / "barge-240x46x10.nc") as theirs:
        finite = np.isfinite(theirs["omega"].values) & (theirs["omega"].values > 0)
        assert np.isin(theirs["omega"].values[finite], ours["omega"].values).all()
    answer = client.get(address, params={"format": "wamit", "length": 10})
    assert answer.status_code == 200, answer.text
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        assert {"barge_240.1", "barge_240.3", "barge_240.hst"} <= set(archive.namelist())
    back = client.post("/api/v1/data-sets", files={"file": ("again.zip", answer.content)})
    assert back.status_code == 201, back.text
    assert client.get(address, params={"format": "matlab"}).status_code == 422
    assert client.get(address, params={"length": 0}).status_code == 422
    assert client.get("/api/v1/data-sets/none/export").status_code == 404
