"""Exported files read back with the libraries their readers use."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

from solver.io.export import describe, format_of, write_results
from solver.io.selection import LABELS, select_channels
from solver.outcome import CaseError
from solver.results.channel import Axis, Channel

from .channels import made, selection

SUMMARY = {
    "provenance": {"case_hash": "ab", "solver_version": "0.1.0", "seeds": [3, 4, 5], "tp": 12.5},
    "warnings": ["one", "two"],
}
ABOUT = describe(SUMMARY, "slowdrift: 1\nname: é\n", "a case")


def _write(path: Path, kind: str, **options: object) -> Path:
    with path.open("wb+") as file:
        write_results(file, kind, selection(**options), ABOUT)  # type: ignore[arg-type]
    return path


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_reads_every_channel_with_its_axes_and_units(tmp_path: Path, engine: str) -> None:
    xr = pytest.importorskip("xarray")
    path = _write(tmp_path / "results.nc", "netcdf")
    with xr.open_datatree(path, engine=engine) as tree:
        for name, channel in made().items():
            item = tree[name]
            assert item.attrs["units"] == channel.unit
            assert (item.attrs["long_name"], item.attrs["band"]) == (channel.description, channel.band)
            np.testing.assert_array_equal(item.values, channel.values)
            for dim, axis in zip(item.dims, channel.axes, strict=True):
                assert dim.startswith(axis.name)
                there = item.coords[dim].values
                if axis.name in LABELS:
                    assert list(there) == list(LABELS[axis.name])
                else:
                    np.testing.assert_array_equal(there.astype(float), axis.values)
        assert tree["time/vessel/surge"].dims == ("time", "seed")
        assert set(tree["static/line/bow-port"].sizes) == {"arc_length", "axis", "arc_length_10"}
        assert json.loads(str(tree["summary"].values)) == SUMMARY
        assert "é" in str(tree["case"].values)
        attributes = tree.attrs
    assert attributes["title"] == "a case"
    assert attributes["case_hash"] == "ab"
    assert attributes["tp"] == 12.5
    assert json.loads(attributes["seeds"]) == [3, 4, 5]
    assert attributes["warnings"] == "one\ntwo"


def test_hdf5_has_a_channel_at_its_name(tmp_path: Path) -> None:
    import h5py

    with h5py.File(_write(tmp_path / "results.nc", "netcdf")) as file:
        np.testing.assert_array_equal(file["time/vessel/surge"][...], made()["time/vessel/surge"].values)
        assert file["time/vessel/surge"].dims[0][0].name == "/time/vessel/time"


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_long_table_has_every_value_once(dtype: type) -> None:
    target = io.BytesIO()
    write_results(target, "csv", selection(dtype=dtype), ABOUT)
    rows = list(csv.DictReader(io.StringIO(target.getvalue().decode())))
    channels = made(dtype)
    assert len(rows) == sum(channel.values.size for channel in channels.values())
    back: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        back.setdefault(row["channel"], []).append(row)
    for name, channel in channels.items():
        values = np.array([row["value"] for row in back[name]]).astype(dtype).reshape(channel.values.shape)
        np.testing.assert_array_equal(values, channel.values)
        assert {row["unit"] for row in back[name]} == {channel.unit}
        assert all(
            row[key] == "" for row in back[name][:1] for key in ("time", "omega", "mode") if key not in channel.dims
        )
    some = back["static/line/bow-port/position"][4]
    assert (some["arc_length"], some["axis"]) == ("10.0", "y")
    assert back["time/vessel/surge"][1]["seed"] == "4"


def test_parquet_is_the_same_table(tmp_path: Path) -> None:
    pq = pytest.importorskip("pyarrow.parquet")
    path = _write(tmp_path / "results.parquet", "parquet")
    table = pq.read_table(path, filters=[("channel", "==", "time/vessel/surge")])
    channel = made()["time/vessel/surge"]
    np.testing.assert_array_equal(table["value"].to_numpy().reshape(channel.values.shape), channel.values)
    assert table["seed"].to_pylist()[:3] == [3, 4, 5]
    file = pq.ParquetFile(path)
    assert file.num_row_groups == len(made())
    assert file.schema_arrow.metadata[b"case_hash"] == b"ab"
    assert pq.read_table(path, filters=[("channel", "==", "modes/vessel/shape")])["dof"].to_pylist()[:2] == [
        "surge",
        "sway",
    ]


def test_the_wide_table_has_a_column_per_channel() -> None:
    target = io.BytesIO()
    write_results(target, "csv", selection(("time/*",)), ABOUT, wide=True)
    rows = list(csv.reader(io.StringIO(target.getvalue().decode())))
    names = ["time/vessel/surge [m]", "time/vessel/heave [m]", "time/line/bow 2.b/top_tension [N]"]
    assert rows[0] == ["time [s]", "seed", *names]
    assert len(rows) == 1 + 40 * 3
    values = np.array([row[2] for row in rows[1:]], dtype=float).reshape(40, 3)
    np.testing.assert_array_equal(values, made()["time/vessel/surge"].values)


def test_a_seed_and_patterns_choose(tmp_path: Path) -> None:
    xr = pytest.importorskip("xarray")
    path = _write(tmp_path / "one.nc", "netcdf", patterns=("time/vessel/*", "static/line/bow-port/tension"), seed=4)
    with xr.open_datatree(path) as tree:
        assert tree["time/vessel/surge"].dims == ("time",)
        np.testing.assert_array_equal(tree["time/vessel/surge"].values, made()["time/vessel/surge"].values[:, 1])
        assert "frequency" not in tree.children


REFUSED = [
    ({"patterns": ("time/vessel/surg",)}, "netcdf", False, "no channel is called 'time/vessel/surg'"),
    ({"seed": 9}, "csv", False, "there is no seed 9; allowed: 3 to 5"),
    ({"patterns": ("time/*", "modes/*")}, "csv", True, "not on the axes of"),
    ({}, "parquet", True, "a wide table is CSV"),
]


@pytest.mark.parametrize(("options", "kind", "wide", "said"), REFUSED)
def test_what_cannot_be_chosen_is_refused(options: dict[str, object], kind: str, wide: bool, said: str) -> None:
    with pytest.raises(CaseError, match=said):
        write_results(io.BytesIO(), kind, selection(**options), ABOUT, wide)  # type: ignore[arg-type]


def test_a_wide_table_is_bounded_and_one_channel_at_a_time_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    loaded: list[str] = []
    axis = Axis("time", "s", np.arange(6e6))

    def load(name: str) -> Channel:
        loaded.append(name)
        return Channel(name, np.zeros(6_000_000), (axis,), "m", "")

    chosen = select_channels(dict.fromkeys([f"time/vessel/{i}" for i in range(9)], ("time",)), load)
    with pytest.raises(CaseError, match="20000000 values"):
        write_results(io.BytesIO(), "csv", chosen, ABOUT, wide=True)
    assert len(loaded) == 4


def test_nothing_to_write_and_unknown_endings_are_refused() -> None:
    with pytest.raises(CaseError, match="no channels"):
        write_results(io.BytesIO(), "csv", select_channels({}, made().__getitem__), ABOUT)
    with pytest.raises(CaseError, match=r"allowed: \.nc, \.h5, \.csv, \.parquet, \.xlsx"):
        format_of("results.xls")
    assert format_of("A.B.NC") == "netcdf"
