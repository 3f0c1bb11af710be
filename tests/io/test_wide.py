"""Wide tables: a file for each set of axes, a column for each channel and seed."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from cli.main import main
from solver.case import parse_case
from solver.io.possible import possible_channels
from solver.io.selection import select_channels
from solver.io.wide import WideTable, wide_tables, write_table
from solver.results.channel import Axis, Channel
from solver.vessel.data import FileSource
from tests.systems import example

from .channels import made, selection
from .decks import ROOT


def _read(table: WideTable) -> tuple[list[str], np.ndarray]:
    target = io.BytesIO()
    write_table(target, table)
    header, *rows = list(csv.reader(io.StringIO(target.getvalue().decode())))
    return header, np.array(rows)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_histories_have_a_column_for_each_seed(dtype: type) -> None:
    channels = made(dtype)
    tables = wide_tables(selection(("time/*",), dtype=dtype))
    assert list(tables) == [""]
    header, rows = _read(tables[""])
    names = ["time/vessel/surge", "time/vessel/heave", "time/line/bow 2.b/top_tension"]
    assert header == ["time [s]", *(f"{n}, seed {s} [{channels[n].unit}]" for n in names for s in (3, 4, 5))]
    np.testing.assert_array_equal(rows[:, 0].astype(float), channels[names[0]].axes[0].values)
    for at, name in enumerate(names):
        np.testing.assert_array_equal(rows[:, 1 + 3 * at : 4 + 3 * at].astype(dtype), channels[name].values)


def test_each_set_of_axes_has_a_table_of_its_own() -> None:
    tables = wide_tables(selection())
    assert list(tables) == [
        "arc_length-bow-port_11", "arc_length-bow-port_10", "omega_30", "omega_20", "omega-arc_length", "mode", "time",
    ]  # fmt: skip
    written = {name.split(",")[0].split(" [")[0] for table in tables.values() for name in table.columns}
    assert written == set(made())
    header, rows = _read(tables["omega-arc_length"])
    spectrum = made()["frequency/line/bow-port/tension"]
    assert header == ["omega [rad/s]", "arc_length [m]", "frequency/line/bow-port/tension [N2 s/rad]"]
    np.testing.assert_array_equal(rows[:, 2].astype(float).reshape(spectrum.values.shape), spectrum.values)
    np.testing.assert_array_equal(rows[:10, 1].astype(float), spectrum.axes[1].values)
    header, rows = _read(tables["mode"])
    assert header[:3] == ["mode", "modes/vessel/shape, surge [1]", "modes/vessel/shape, sway [1]"]
    np.testing.assert_array_equal(rows[:, 1:].astype(float), made()["modes/vessel/shape"].values)
    assert rows[:, 0].tolist() == ["1", "2"]
    header, rows = _read(tables["arc_length-bow-port_11"])
    assert header == ["arc_length [m]", *(f"static/line/bow-port/position, {axis} [m]" for axis in "xyz")]


def test_tables_of_the_same_axes_are_named_for_their_lines_and_never_alike() -> None:
    def one(name: str, *points: float) -> Channel:
        return Channel(name, np.zeros(len(points)), (Axis("arc_length", "m", np.array(points)),), "N", "")

    found = [
        one("static/line/a/tension", 1, 2), one("static/line/b/tension", 1, 3), one("static/line/b/position", 0, 1, 2),
        one("static/line/c/tension", 5, 6), one("time/line/c/tension_max", 5, 6), one("static/line/c/other", 6, 7),
    ]  # fmt: skip
    channels = {channel.name: channel for channel in found}
    dims = {name: channel.dims for name, channel in channels.items()}
    tables = wide_tables(select_channels(dims, channels.__getitem__))
    assert list(tables) == [
        "arc_length-a", "arc_length-b_2", "arc_length-b_3", "arc_length-c_2", "arc_length-c_2_2",
    ]  # fmt: skip
    assert len(tables["arc_length-c_2"].columns) == 2


def test_long_tables_are_written_in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = {name: _read(table) for name, table in wide_tables(selection()).items()}
    monkeypatch.setattr("solver.io.wide.BLOCK", 7)
    for name, table in wide_tables(selection()).items():
        header, rows = _read(table)
        assert header == whole[name][0]
        np.testing.assert_array_equal(rows, whole[name][1])


RISER = str(ROOT / "examples" / "hanging-riser-case1.yaml")
SHORT = ("--duration", "27", "--seeds", "2", "--only", "statics,time_domain")


@pytest.mark.slow
def test_the_command_chooses_channels_and_names_the_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "r.csv"
    patterns = "time/line/*/end_?_tension,static/line/riser/tension,time/line/riser/rainflow"
    assert main(["run", RISER, *SHORT, "--out", str(out), "--channels", patterns, "--layout", "wide"]) == 0
    said = capsys.readouterr()
    names = ["r-arc_length.csv", "r-time.csv", "r-tension_range.csv"]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    for name in names:
        assert f"{tmp_path / name}: {(tmp_path / name).stat().st_size / 1e3:.3g} " in said.out.replace("\n", "")
    header, *rows = list(csv.reader((tmp_path / "r-time.csv").open()))
    assert header == ["time [s]", *(f"time/line/riser/end_{e}_tension, seed {s} [N]" for e in "ba" for s in (1, 2))]
    assert len(rows) == 540
    assert all(float(text) == np.float32(text).astype(float) or "." in text for text in rows[0][1:])


@pytest.mark.slow
def test_channels_that_this_run_has_not_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "r.csv"
    patterns = "static/line/*/tension,frequency/wave/elevation"  # harmonic motion: no spectrum of waves
    only = ("--only", "statics,frequency_domain", "--quiet")
    assert main(["run", RISER, *only, "--out", str(out), "--channels", patterns]) == 0
    assert "this run has no channel 'frequency/wave/elevation'" in capsys.readouterr().err
    rows = list(csv.DictReader(out.open()))
    assert {row["channel"] for row in rows} == {"static/line/riser/tension"}
    out.unlink()
    assert main(["run", RISER, *only, "--out", str(out), "--channels", "frequency/wave/*"]) == 0
    assert "is not written: there are no channels for it" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.slow
def test_a_run_has_no_channel_that_was_not_possible() -> None:
    from solver.run import run

    data = example("fpso-2000m")
    del data["analyses"]["time_domain"]
    case = parse_case(data)
    names = set(possible_channels(case))
    assert {channel.name for channel in run(case, FileSource(ROOT / "examples")).channels} <= names
    assert not [name for name in names if name.startswith("time/")]
