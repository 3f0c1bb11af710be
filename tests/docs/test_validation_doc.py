"""docs/validation.md holds real numbers in their bands, and its tables can be made anew from any run."""

from __future__ import annotations

import importlib.util
import re
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

DOCS = Path(__file__).parents[2] / "docs"
TEXT = (DOCS / "validation.md").read_text(encoding="utf-8")


@cache
def _maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_validation", DOCS / "make_validation.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _rows(text: str = TEXT) -> list[list[str]]:
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]


def _row(*first: str) -> list[str]:
    """The first row of the page that begins with these cells."""
    return next(row for row in _rows() if tuple(row[: len(first)]) == first)


def _number(cell: str) -> float:
    found = re.match(r"[-+]?\d+(\.\d+)?", cell)
    assert found is not None, cell
    return float(found.group())


@pytest.mark.parametrize(
    ("name", "check"),
    [
        ("top tension", 47.113),
        ("bottom tension", 26.602),
        ("vertical reaction, top", 45.713),
        ("horizontal reaction", 11.398),
        ("vertical reaction, bottom", 24.037),
    ],
)
def test_statics_are_the_checks(name: str, check: float) -> None:
    assert _number(_row(name)[1]) == pytest.approx(check, abs=0.011)


@pytest.mark.parametrize(("case", "low", "high"), [("1", 41.65, 52.30), ("2", 42.50, 52.85)])
def test_top_tension_ranges_lie_within_those_of_two_codes(case: str, low: float, high: float) -> None:
    row = next(row for row in _rows() if row[0] == case and " to " in row[1])
    shown = [float(part) for part in row[1].split(" to ")]
    assert shown == pytest.approx([low, high], abs=0.35)


@pytest.mark.parametrize(("case", "half", "first"), [("1", 24.5, 11.7), ("2", 12.2, 0.8)])
def test_discrepancies_along_the_riser_are_the_checks(case: str, half: float, first: float) -> None:
    row = _row(case, "1")
    assert _number(row[4]) == pytest.approx(half, abs=2.0)
    assert _number(row[6]) == pytest.approx(first, abs=1.0)
    tenth = _row(case, "0.1")
    assert _number(tenth[6]) < 2.0
    assert _number(tenth[8]) < 10.0


@pytest.mark.parametrize(
    ("label", "period", "damping", "mass"),
    [("surge", 262.0, 36.7, 4.3), ("sway", 313.0, 30.6, 3.0), ("yaw", 301.0, 45.8, 5.6)],
)
def test_modes_are_the_checks(label: str, period: float, damping: float, mass: float) -> None:
    row = _row(label)
    assert _number(row[1]) == pytest.approx(period, rel=0.01)
    assert _number(row[4]) == pytest.approx(damping, abs=2.0)
    assert _number(row[9]) == pytest.approx(mass, abs=0.3)


@pytest.mark.parametrize(
    ("dof", "unit", "sigma"), [("surge", "m", 2.0), ("sway", "m", 0.83), ("heave", "m", 2.4), ("yaw", "deg", 0.8)]
)
def test_wave_motion_agrees_between_domains_and_with_the_check(dof: str, unit: str, sigma: float) -> None:
    row = _row(f"WF {dof}, {unit}")
    assert _number(row[1]) == pytest.approx(sigma, rel=0.04)
    assert _number(row[2]) == pytest.approx(_number(row[1]), rel=0.01)


def test_slow_motion_in_the_same_waves() -> None:
    for dof, unit, band in (("surge", "m", 0.05), ("sway", "m", 0.05), ("yaw", "deg", 0.12)):
        assert _number(_row(f"LF {dof}, {unit}")[5]) == pytest.approx(1.0, abs=band)
    assert _number(_row("LF yaw, deg")[6]) == pytest.approx(1.0, abs=0.06)


def test_tension_in_waves_lies_a_little_below_the_time_domains() -> None:
    rows = [row for row in _rows() if row[0] in ("WF top", "WF bottom")]
    assert len(rows) == 8
    assert all(0.945 < _number(row[4]) < 1.0 for row in rows)


def test_a_row_that_falls_short_says_so() -> None:
    """The page hides no limit that is missed."""
    found = [row for row in _rows() if row[-1] in ("holds", "**falls short**")]
    assert len(found) == 9
    missed = {row[0] for row in found if row[-1] != "holds"}
    assert missed <= {"LF yaw, same waves over time domain", "LF roll, same waves over time domain"}


def test_plots_are_there_and_small() -> None:
    shown = re.findall(r"!\[[^]]+\]\((validation/[^)]+\.png)\)", TEXT)
    assert len(shown) == len(set(shown)) == 6
    for name in shown:
        assert 1_000 < (DOCS / name).stat().st_size < 60_000
    assert {path.name for path in (DOCS / "validation").iterdir()} == {Path(name).name for name in shown}


def test_the_page_names_no_place_of_this_machine() -> None:
    assert not re.search(r"/(tmp|home|root|work)/", TEXT)
    assert "nan" not in TEXT.lower().split()


def _small(data: dict[str, Any]) -> dict[str, Any]:
    for line in data["lines"].values():
        line["segments"][0]["elements"] = 10
    data["analyses"]["frequency_domain"] |= {
        "wave": {"from": 0.2, "to": 1.2, "step": 0.02},
        "low": {"to": 0.2, "step": 0.005},
        "tolerance": 1e-2,
    }
    return data


def test_the_riser_tables_are_made_of_any_run() -> None:
    maker = _maker()
    runner = maker.Runner(tell=lambda _text: None)
    found = {}
    for case in (1, 2):
        data = maker.runs.riser_case(case)
        data["lines"]["riser"]["segments"][0]["elements"] = 10
        data["analyses"]["time_domain"] |= {
            "step": "0.1 s",
            "output_step": "0.1 s",
            "build_up": "27 s",
            "duration": "54 s",
        }
        one = runner.solve("", data)
        found |= {(case, factor): one for factor in maker.runs.FACTORS}
    study = maker.Study(found, *[None] * 6)
    tables = maker.tables
    assert len(_rows(tables.statics_table(found[1, 1.0].summary))) == 2 + 5
    assert len(_rows(tables.range_table(study))) == 2 + 2
    assert len(_rows(tables.gap_table(study))) == 2 + 8
    assert "25 and 15 %" in maker._riser(study)


def test_the_vessels_tables_are_made_of_any_run() -> None:
    maker = _maker()
    runner = maker.Runner(seeds=2, duration=80.0, tell=lambda _text: None)
    data = _small(runner.fpso())
    pair = runner.pair("", data)
    summary, tables = pair.summary, maker.tables
    assert len(_rows(tables.sigma_table(pair))) == 2 + 10
    assert len(_rows(tables.tension_table(pair))) == 2 + 16
    assert len(_rows(tables.agreement_table(pair))) == 2 + 9
    assert len(_rows(tables.modes_table(summary))) == 2 + 4
    assert len(_rows(tables.scan_table({"follows": summary}))) == 2 + 2
    assert len(_rows(tables.sweep_table({1.0: summary, 2.0: summary}, "C_D"))) == 2 + 2
    study = maker.Study(
        {},
        pair,
        {1.0: summary, 2.0: summary},
        {2.0: summary, 4.0: summary},
        {"follows": summary},
        summary,
        summary,
        dict.fromkeys(maker.runs.SIDE, pair),
    )
    for text in (maker._head(study), maker._fpso(study), maker._radiation(study), maker._differences(study)):
        assert _rows(text) or text.startswith("# ")


def test_the_scaled_barge_has_its_drift_multiplied_and_nothing_else() -> None:
    runs = _maker().runs
    one, ten = (runs.Scaled(factor).open("barge-240x46x10.nc") for factor in (1.0, 10.0))
    assert ten.mean_drift == pytest.approx(10.0 * one.mean_drift)
    assert ten.excitation == pytest.approx(one.excitation)
