"""Studies: what can be varied, the values a person writes, the table with modes by name, and its curves."""

from __future__ import annotations

import json
from typing import Any

import flask
import plotly.utils
import pytest

from frontend.pages import studies, study
from frontend.pointers import magnitude, places, said, values
from frontend.study_table import MODES, Table, by_name, header, quantity, unit


def text_of(component: Any) -> str:
    return json.dumps(component, cls=plotly.utils.PlotlyJSONEncoder, ensure_ascii=False)


def test_places_are_pointers_that_lead_back() -> None:
    case = {"slowdrift": 1, "name": "x", "lines": {"a/b": {"x~y": 2.0}}, "seas": [{"hs": 8.0, "on": True}]}
    assert places(case) == [("/lines/a~1b/x~0y", 2.0), ("/seas/0/hs", 8.0)]
    assert said("/lines/a~1b/x~0y") == "lines › a/b › x~y"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("8, 10, 12", [8.0, 10.0, 12.0]),
        ("8, 10, 12 m", ["8 m", "10 m", "12 m"]),
        ("800 kN, 1 MN", ["800 kN", "1 MN"]),
        ("0 .. 1 in 5", [0.0, 0.25, 0.5, 0.75, 1.0]),
        ("jonswap, pm", ["jonswap", "pm"]),
    ],
)
def test_values_as_people_write_them(text: str, expected: list[Any]) -> None:
    assert values(text) == expected


@pytest.mark.parametrize("text", ["", " , ", "0..1 in 1", "0..1 in 999"])
def test_what_is_no_list_of_values_is_said(text: str) -> None:
    with pytest.raises(ValueError, match=r"values|steps"):
        values(text)


def test_magnitude_of_a_cell() -> None:
    assert [magnitude(cell) for cell in (2, "8 m", "wire", None, True)] == [2.0, 8.0, None, None, None]


def _row(index: int, drag: float, modes: list[tuple[str, float]]) -> list[Any]:
    flat = [part for label, period in modes for part in (label, period, period / 1000.0)]
    return [index, f"run{index}", "succeeded", drag, 0.01 * drag, *flat, *[None] * (3 * MODES - len(flat))]


def _table() -> Table:
    columns = ["index", "run_id", "state", "/drag/normal", "frequency_domain.vessel_std.lf.yaw"]
    columns += [f"modes.{k}.{part}" for k in range(MODES) for part in ("label", "period", "damping_lines")]
    first = _row(0, 1.0, [("yaw", 300.0), ("surge", 260.0), ("line", 52.0)])
    second = _row(1, 2.0, [("surge", 270.0), ("yaw", 250.0), ("line", 53.0)])
    return by_name(Table(columns, [first, second]), 5)


def test_modes_keep_their_names_when_their_order_changes() -> None:
    table = _table()
    assert table.column("modes.yaw.period") == [300.0, 250.0]
    assert table.column("modes.surge.period") == [260.0, 270.0]
    assert not any(name.startswith("modes.line.") for name in table.results)


def test_units_and_words() -> None:
    assert header("frequency_domain.vessel_std.lf.yaw") == "frequency domain σ of LF yaw [deg]"
    assert quantity("max(time_domain.lines.a.tension_std.wf)") == "time domain line a σ of tension WF, largest"
    assert unit("max(time_domain.lines.a.tension_max)") == ("kN", 1e-3)
    assert header("modes.surge.damping_lines") == "damping by the lines, surge [%]"


def test_curve_and_rows(request_context: flask.Flask) -> None:
    table = _table()
    drawn = text_of(study.curves(table, "/drag/normal", "frequency_domain.vessel_std.lf.yaw"))
    assert "σ of LF yaw [deg]" in drawn
    grid = study.listed(table)
    assert grid.rowData[0]["run_id"] == "run0"
    assert grid.rowData[1]["c3"] == pytest.approx(0.02 * 57.29577951)


def test_count_says_how_many_and_what_is_wrong() -> None:
    words, off, faults = studies.count(["/a", "/b", None], ["1, 2, 3", "4, 5", None], "case")
    assert (words, off, faults) == ("6 runs", False, [None, None, None])
    words, off, faults = studies.count(["/a", None, None], ["0..1 in 1", "3", None], "case")
    assert off
    assert faults[0] is not None
    assert "steps" in faults[0]
    assert faults[1] == "choose what takes these values"
    words, off, _ = studies.count(["/a", "/b", None], ["0..1 in 100", "0..1 in 100", None], "case")
    assert off
    assert "10000 runs" in words


def test_layouts_ask_nothing_of_the_service(request_context: flask.Flask) -> None:
    for made in (studies.layout(), studies.new_layout(case="x"), study.layout("s", x="/a", y="b", tab="z")):
        assert made is not None
    assert '"x": "/a"' in text_of(study.layout("s", x="/a"))
