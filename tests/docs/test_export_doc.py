"""docs/export.md says what is written: numbers, attributes, sizes of groups, and its examples run."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cli.main import main
from solver.io.export import ENDINGS, describe, write_results
from solver.io.selection import select_channels
from solver.io.statistics import statistics_tables
from solver.io.table import BLOCK
from solver.results.channel import Axis, Channel
from store.arrays import decode_values, encode_values, pick_codec
from tests.io.channels import made, selection
from tests.systems import case_of, riser

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs/export.md").read_text(encoding="utf-8")
EVERYTHING = {
    "case_hash": "a", "data_hash": "b", "solver_version": "1", "seeds": [1], "tp": 1.0, "hs_in_band": 1.0,
    "seastates": [{"hs": 1.0}],
}  # fmt: skip


def test_every_ending_is_in_the_table() -> None:
    table = TEXT.split("| ending |")[1].split("\n\n")[0]
    assert set(re.findall(r"`(\.[a-z0-9]+)`", table)) == set(ENDINGS)


def test_the_attributes_of_the_file_are_those_written() -> None:
    sentence = TEXT.split("Attributes of the file:")[1].split("Variables")[0]
    written = set(describe({"provenance": EVERYTHING, "warnings": []}, "", ""))
    assert set(re.findall(r"`(\w+)`", sentence)) == written - {"case", "summary"} | {"run"}


@pytest.mark.slow
def test_histories_are_float32_and_all_else_float64_on_the_command_line(tmp_path: Path) -> None:
    import h5py

    out = tmp_path / "r.nc"
    case = str(ROOT / "examples" / "hanging-riser-case1.yaml")
    assert main(["run", case, "--quiet", "--duration", "27", "--out", str(out)]) == 0
    kinds: dict[str, set[str]] = {"float32": set(), "float64": set()}

    def note(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f":
            kinds[str(item.dtype)].add(name)

    with h5py.File(out) as file:
        file.visititems(note)
        assert file["time/line/riser/seed"].dtype == np.int64
        assert file["static/line/riser/axis"].asstr()[:].tolist() == ["x", "y", "z"]
    assert kinds["float32"] == {
        f"time/line/riser/{what}" for what in ("top_tension", "end_a_tension", "end_b_tension", "anchor_vertical")
    }
    assert {"static/line/riser/tension", "frequency/line/riser/tension_amplitude", "time/line/riser/time",
            "time/line/riser/tension_max"} <= kinds["float64"]  # fmt: skip


def test_rest_stores_float32_but_for_numbers_beyond_it() -> None:
    for values, kept in ((np.array([1.0, 2.5e-3]), np.float32), (np.array([1e300, 1.0]), np.float64)):
        codec = pick_codec(values)
        assert decode_values(encode_values(values, codec), codec, values.shape).dtype == kept


def test_parquet_holds_every_float32_and_has_row_groups_of_one_channel(tmp_path: Path) -> None:
    pq = pytest.importorskip("pyarrow.parquet")
    values = np.random.default_rng(1).normal(size=BLOCK + 5).astype(np.float32)
    axis = Axis("time", "s", np.arange(float(values.size)))
    channels = {name: Channel(name, values, (axis,), "m", "") for name in ("time/vessel/surge", "time/vessel/sway")}
    chosen = select_channels(dict.fromkeys(channels, ("time",)), channels.__getitem__)
    with (tmp_path / "r.parquet").open("wb") as file:
        write_results(file, "parquet", chosen, describe({"provenance": EVERYTHING, "warnings": []}, "c", "t"))
    read = pq.ParquetFile(tmp_path / "r.parquet")
    assert BLOCK == 100_000
    assert [read.metadata.row_group(at).num_rows for at in range(read.num_row_groups)] == [BLOCK, 5] * 2
    assert read.metadata.row_group(0).column(0).compression == "ZSTD"
    table = read.read()
    assert str(table.schema.field("value").type) == "double"
    np.testing.assert_array_equal(table["value"].to_numpy()[: values.size].astype(np.float32), values)
    assert {b"case", b"summary", b"case_hash", b"warnings"} <= set(read.schema_arrow.metadata)


def test_the_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("xarray")
    pytest.importorskip("pyarrow")
    monkeypatch.chdir(tmp_path)
    about = describe({"provenance": EVERYTHING, "warnings": []}, "slowdrift: 1", "t")
    for name, kind in (("results.nc", "netcdf"), ("results.parquet", "parquet")):
        with Path(name).open("wb+") as file:
            write_results(file, kind, selection(), about)
    found: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", TEXT, re.S):
        exec(block.replace("seed=1", "seed=4"), found)
    surge = made()["time/vessel/surge"]
    assert found["surge"].dims == ("time", "seed")
    assert found["tension"].dims == ("arc_length_10",)
    assert found["case"] == "slowdrift: 1"
    np.testing.assert_array_equal(found["histories"].to_numpy(), surge.values)
    assert found["histories"].columns.tolist() == [3, 4, 5]


def test_every_sheet_is_in_the_table() -> None:
    documented = re.findall(r"^\| ([A-Z][a-z ]+) \|", TEXT.split("| sheet |")[1], re.M)
    made_by = ROOT / "solver" / "io" / "statistics.py"
    titles = set(re.findall(r'able\(\s*"([A-Z][a-z ]+)"', made_by.read_text(encoding="utf-8")))
    assert set(documented) == titles
    summary = {"case": "", "analyses": ["statics"], "warnings": [], "failures": {}}
    assert {table.title for table in statistics_tables(summary, case_of(riser()))} <= titles
