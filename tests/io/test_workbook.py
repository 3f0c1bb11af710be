"""The statistics workbook, read back by another library."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path
from typing import Any

import pytest

from cli.main import main
from solver.case import Case, load_case, parse_case
from solver.io.statistics import statistics_tables
from solver.io.workbook import write_workbook
from tests.systems import example

from .decks import ROOT

Sheets = dict[str, list[tuple[Any, ...]]]


def _sheets(source: Any) -> Sheets:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.load_workbook(source, read_only=False)
    return {sheet.title: list(sheet.iter_rows(values_only=True)) for sheet in book}


def _column(rows: list[tuple[Any, ...]], header: str) -> dict[Any, Any]:
    at = rows[0].index(header)
    return {row[0]: row[at] for row in rows[1:]}


def _written(summary: dict[str, Any], case: Case) -> Sheets:
    target = io.BytesIO()
    write_workbook(target, summary, case)
    target.seek(0)
    return _sheets(target)


def _fpso() -> Case:
    data = example("fpso-2000m")
    data["line_types"]["wire"]["breaking_load"] = "8 MN"
    return parse_case(data)


SUMMARY: dict[str, Any] = {
    "case": "=1+1", "analyses": ["statics", "frequency_domain", "time_domain", "modes"],
    "warnings": ["the step is long"], "failures": {"modes": "interrupted"},
    "provenance": {"case_hash": "ab", "seeds": [1, 2], "tp": 18.0, "seastates": [{"hs": 15.7, "tp": 18.0}]},
    "statics": {
        "vessel": {"position": [1, 2, 3, 0.1, 0.2, 0.3], "mean_drift": [1e3, 0, 0, 0, 0, 5e3]},
        "lines": {"bow-port": {
            "end_a": {"tension": 1e6, "force": [1e3, 2e3, 3e3], "position": [7, 8, 9]},
            "end_b": {"tension": 2e6, "force": [4e3, 5e3, 6e3], "position": [1, 2, 3]},
            "tension": [1e6, 3e6, 2e6], "arc_length": [5, 15, 25], "length": 30, "grounded_length": 4.5, "multiplicity": 6,
        }},
    },
    "frequency_domain": {
        "vessel_std": {"wf": dict.fromkeys(("surge", "yaw"), 0.5), "lf": {"surge": 2.0}},
        "vessel_significant": {"wf": {"surge": 1.0}}, "vessel_most_probable_max": {"combined": {"surge": 9.0, "yaw": 0.1}},
        "lines": {"bow-port": {"arc_length": [5, 15, 25], "tension_std": {"wf": [1e3, 2e3, 3e3], "lf": [4e3, 5e3, 6e3]},
                               "tension_most_probable_max": [4e6, 3e6, 5e6]}},
    },
    "time_domain": {
        "vessel_std": {"wf": {"surge": 0.6, "yaw": 0.7}}, "vessel_mean": {"surge": -1.5},
        "lines": {"bow-port": {"arc_length": [5, 15, 25], "tension_std": {"wf": [1.5e3, 2.5e3, 3.5e3]},
                               "tension_max": [5e6, 6e6, 5.5e6], "tension_min": [3e5, 2e5, 4e5],
                               "end_b_tension": {"min": 4.4e5, "max": 5.6e6}}},
    },
}  # fmt: skip


def test_motions_of_both_domains_stand_side_by_side() -> None:
    rows = _written(SUMMARY, _fpso())["Vessel"]
    headers = list(rows[0])
    first = headers.index("WF σ, frequency domain [m, deg]")
    assert headers[first + 1] == "WF σ, time domain [m, deg]"
    assert _column(rows, "WF σ, frequency domain [m, deg]")["surge"] == 0.5
    assert _column(rows, "WF σ, frequency domain [m, deg]")["yaw"] == pytest.approx(math.degrees(0.5))
    assert _column(rows, "WF σ, time domain [m, deg]")["yaw"] == pytest.approx(math.degrees(0.7))
    assert _column(rows, "WF significant (2σ), time domain [m, deg]")["surge"] == pytest.approx(1.2)
    assert _column(rows, "combined most probable maximum, frequency domain [m, deg]")["surge"] == 9.0
    assert _column(rows, "mean about the static position, time domain [m, deg]")["surge"] == -1.5
    assert _column(rows, "static position from the design position [m, deg]")["roll"] == pytest.approx(
        math.degrees(0.1)
    )
    assert _column(rows, "mean wave drift force [kN, kN m]")["yaw"] == 5.0
    assert "LF σ, time domain [m, deg]" not in headers  # nothing to say


def test_lines_have_ends_extremes_places_and_utilisation() -> None:
    sheets = _written(SUMMARY, _fpso())
    ends = sheets["Line ends"]
    assert _column(ends, "static tension [kN]") == {"bow-port, end a": 1000, "bow-port, end b": 2000}
    assert _column(ends, "WF σ, frequency domain [kN]") == {"bow-port, end a": 1, "bow-port, end b": 3}
    assert _column(ends, "WF σ, time domain [kN]") == {"bow-port, end a": 1.5, "bow-port, end b": 3.5}
    assert _column(ends, "largest reaction, time domain [kN]") == {"bow-port, end a": None, "bow-port, end b": 5600}
    lines = sheets["Lines"]
    for header, value in {
        "number of real lines [1]": 6, "length on the bed [m]": 4.5, "lowest breaking load [kN]": 8000,
        "largest static axial force [kN]": 3000, "largest static axial force: arc length from end a [m]": 15,
        "largest static axial force: utilisation [1]": 0.375,
        "most probable maximum, frequency domain [kN]": 5000,
        "most probable maximum, frequency domain: arc length from end a [m]": 25,
        "most probable maximum, frequency domain: utilisation [1]": 0.625,
        "largest axial force, time domain [kN]": 6000, "largest axial force, time domain: arc length from end a [m]": 15,
        "largest axial force, time domain: utilisation [1]": 0.75,
        "least axial force, time domain [kN]": 200, "least axial force, time domain: arc length from end a [m]": 15,
    }.items():  # fmt: skip
        assert _column(lines, header) == {"bow-port": pytest.approx(value)}, header


def test_the_other_sheets_and_text_that_looks_like_a_formula() -> None:
    sheets = _written(SUMMARY, _fpso())
    assert list(sheets) == ["Vessel", "Line ends", "Lines", "Statics", "Warnings", "Provenance"]
    assert _column(sheets["Statics"], "force y on the support [kN]") == {"bow-port, end a": 2, "bow-port, end b": 5}
    assert sheets["Warnings"][1:] == [("warning", None, "the step is long"), ("not done", "modes", "interrupted")]
    known = {row[0]: row[1:] for row in sheets["Provenance"]}
    assert known["case"][0] == "=1+1"
    assert known["seeds"][0] == "1, 2"
    assert known["tp"] == (18, "s")
    assert known["sea 1, hs"] == (15.7, "m")


def test_every_header_of_numbers_has_a_unit() -> None:
    for table in statistics_tables(SUMMARY, _fpso()):
        for at, header in enumerate(table.headers):
            numbers = [row[at] for row in table.rows if isinstance(row[at], int | float)]
            assert not numbers or "[" in header or table.title == "Provenance" or at == 0, header


@pytest.mark.slow
def test_the_command_writes_the_numbers_of_the_summary(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case, out = ROOT / "examples" / "hanging-riser-case1.yaml", tmp_path / "r.xlsx"
    assert main(["run", str(case), "--duration", "27", "--json", str(tmp_path / "s.json"), "--out", str(out)]) == 0
    assert f"{out}: {out.stat().st_size / 1e3:.3g} kB" in capsys.readouterr().out.replace("\n", "")
    summary, sheets = json.loads((tmp_path / "s.json").read_text()), _sheets(out)
    assert list(sheets) == ["Line ends", "Lines", "Statics", "Warnings", "Provenance"]
    fd, td = (summary[key]["lines"]["riser"] for key in ("frequency_domain", "time_domain"))
    found = _column(sheets["Line ends"], "amplitude, frequency domain [kN]")
    assert found["riser, end b"] == pytest.approx(fd["tension_amplitude"][-1] / 1e3, rel=1e-12)
    found = _column(sheets["Line ends"], "amplitude, time domain [kN]")
    assert found["riser, end b"] == pytest.approx(td["tension_first_harmonic"][-1] / 1e3, rel=1e-12)
    found = _column(sheets["Lines"], "largest axial force, time domain [kN]")
    assert found["riser"] == pytest.approx(max(td["tension_max"]) / 1e3, rel=1e-12)
    known = {row[0]: row[1] for row in sheets["Provenance"]}
    assert known["case_hash"] == summary["provenance"]["case_hash"]
    assert load_case(case.read_bytes()).name == known["case"]
