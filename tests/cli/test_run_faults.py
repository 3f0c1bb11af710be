"""`slowdrift run` names all faults of a case, of its data and of its options together, each with its line."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
import yaml

from cli.main import main
from solver.case import parse_case
from solver.case.case import Case
from solver.case.partial import read_part
from solver.case.text import read_case
from solver.outcome import CaseError
from tests.service.running import ROOT

FPSO = (ROOT / "examples" / "fpso-2000m.yaml").read_text()
FIVE = """slowdrift: 1
name: Five mistakes
environment:
  depth: -100 m
vessel:
  mass: 1e8
  centre_of_gravity: [0, 0, 0]
  radii_of_gyration: [10, 50, 50]
  hydrodynamics: {data: nowhere.nc}
line_types:
  chain: {diameter: 0.1, mass: 200, EA: 1 GN}
lines:
  bow:
    segments:
      - {type: chian, length: 500 m, elements: 10}
    end_a: {anchor: {point: [400, 0]}}
    end_b: {fairlead: [100, 0, 0]}
  stern:
    segments:
      - type: chain
        length: 500 m
        elements: 10
        element_length: 5 m
    end_a: {anchor: {point: [-400, 0]}}
    end_b: {fairlead: [-100, 0, 0]}
attachments:
  - {line: bough, arc_length: 10, mass: 100}
analyses:
  statics: {}
"""
FAULTS = [
    "environment.depth (line 4): '-100 m' is out of range; allowed: > 0",
    "vessel.hydrodynamics.data (line 9): nowhere.nc: there is no such file beside the case; check vessel.hydrodynamics.data",
    "lines.bow.segments.0.type (line 15): no line type 'chian'; known: chain",
    "lines.stern.segments.0 (line 20): give exactly one of elements and element_length",
    "attachments.0.line (line 27): no line 'bough'; known: bow, stern",
]


def _said(path: Path, capsys: pytest.CaptureFixture[str], *options: str) -> list[str]:
    assert main(["run", str(path), "--quiet", *options]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    rows = err.splitlines()
    assert all(row.startswith(f"{path}: ") for row in rows)
    return [row.removeprefix(f"{path}: ") for row in rows]


def test_five_mistakes_are_five_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.yaml"
    path.write_text(FIVE)
    assert _said(path, capsys) == FAULTS
    assert list(tmp_path.iterdir()) == [path]


def test_json_text_has_lines_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.json"
    path.write_text(json.dumps(yaml.safe_load(FIVE), indent=1))
    rows = path.read_text().splitlines()
    said = _said(path, capsys)
    assert len(said) == 5
    for fault, key in zip(said, ('"depth"', '"data"', '"type": "chian"', '"type": "chain"', '"line"'), strict=True):
        line = int(fault.split("(line ")[1].split(")")[0])
        assert key in rows[line - 1] or key in rows[line], fault


def test_options_and_case_are_told_together(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.yaml"
    path.write_text(FIVE.replace("statics: {}", "time_domain: {}"))
    options = ("--duration", "-1", "--out", str(tmp_path / "none" / "r.nc"), "--layout", "wide", "--only", "static")
    said = _said(path, capsys, *options)
    assert [row.split(" (line")[0].split(":")[0] for row in said] == [
        "analyses", "--out", "--layout", "--duration", "environment.depth", "vessel.hydrodynamics.data",
        "lines.bow.segments.0.type", "lines.stern.segments.0", "attachments.0.line",
    ]  # fmt: skip
    assert said[3] == "--duration: -1.0 is out of range; allowed: > 0"


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--seeds", "2"), "--seeds belongs to the time domain, not asked for"),
        (("--only", "motion"), "no analysis 'motion'"),
        (("--channels", "time/*"), "--channels: this belongs to --out FILE, not given"),
        (("--layout", "wide"), "--layout: this belongs to --out FILE, not given"),
        (("--out", "r.xlsx", "--channels", "static/*"), "statistics tables (.xlsx) hold no channels"),
        (("--out", "r.csv", "--channels", " ,"), "names no channel"),
        (("--out", "r.csv", "--channels", "static/*,statc/*"), "no channel is called 'statc/*'"),
        (("--out", "r.csv", "--channels", "time/*"), "no channel is called 'time/*'"),
    ],
)
def test_options_that_do_not_fit_are_refused_before_the_run(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    options: tuple[str, ...],
    says: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "case.yaml"
    text = (ROOT / "examples" / "hanging-riser-case1.yaml").read_text()
    path.write_text(text[: text.index("  frequency_domain:")])
    (said,) = _said(path, capsys, *options)
    assert says in said
    assert list(tmp_path.iterdir()) == [path]


def test_seeds_and_duration_change_the_case(tmp_path: Path) -> None:
    import argparse

    from cli.run import _checked

    options = argparse.Namespace(
        case=ROOT / "examples" / "fpso-2000m.yaml", seeds=7, duration=300.0, only="time_domain, modes", out=None,
        channels=None, layout="long",
    )  # fmt: skip
    case, wanted, _, _ = _checked(options)
    assert case.analyses.requested() == ("time_domain", "modes")
    assert case.analyses.time_domain is not None
    assert (case.analyses.time_domain.seeds, case.analyses.time_domain.duration) == (7, 300.0)
    assert wanted is None


# What one change adds to the FPSO's faults: one fault, and none that only follows from it.
ALONE = [
    ("depth: 2000 m", "depth: deep", "environment.depth"),
    ("mass: 110000 t", "mass: -110000 t", "vessel.mass"),
    ("vessel:\n", "vesel:\n", "vesel"),
    ("line_types:\n", "line_type:\n", "line_type"),
    ("  time_domain: {", "  time_domain: {seed: 3, ", "analyses.time_domain.seed"),
    ("slowdrift: 1\n", "slowdrift: 1\nattachments: 3\n", "attachments"),
    ("slowdrift: 1\n", "slowdrift: 1\nattachments: [3]\n", "attachments.0"),
    ("slowdrift: 1\n", "slowdrift: 1\nname: twice\n", "name"),
]


@pytest.mark.parametrize(("old", "new", "field"), ALONE)
def test_one_mistake_is_one_fault(old: str, new: str, field: str) -> None:
    assert old in FPSO
    text = FPSO.replace(old, new, 1)
    with pytest.raises(CaseError) as caught:
        read_case(text).sound()
    assert [error.field for error in caught.value.errors] == [field]
    line = caught.value.errors[0].line
    assert line is not None
    assert [part for part in field.split(".") if not part.isdigit()][-1] in text.splitlines()[line - 1]


def test_rules_between_fields_are_checked_beside_another_fault() -> None:
    data = yaml.safe_load(FPSO)
    sea = data["environment"]["seastates"][0]
    sea.update(direction=45, gamma=2.0)
    sea.setdefault("tp", "18 s")
    sea["tz"] = "14 s"
    data["lines"]["bow-port"]["segments"][0].update(elements=10, element_length="60 m", type=3)
    with pytest.raises(CaseError) as caught:
        parse_case(data)
    assert {error.field for error in caught.value.errors} == {
        "environment.seastates.0.direction", "environment.seastates.0", "lines.bow-port.segments.0.type",
        "lines.bow-port.segments.0",
    }  # fmt: skip


def test_a_sound_part_is_read_as_the_case_reads_it() -> None:
    data = yaml.safe_load(FPSO)
    case, faults = read_part(Case, data | {"colour": 1})
    assert faults == []
    assert case.model_dump() == parse_case(data).model_dump()


def test_a_line_number_is_that_of_the_key() -> None:
    reading = read_case("slowdrift: 1\nname: x\nenvironment:\n\n  water:\n    density: 0\n")
    lines = {error.field: error.line for error in reading.errors}
    assert lines == {"environment.depth": 3, "environment.water.density": 6, "analyses": 1, "(case)": 1}


def test_a_new_file_is_readable_as_any_other(tmp_path: Path) -> None:
    from cli.files import write_whole

    mask = os.umask(0o022)
    try:
        write_whole(tmp_path / "a.json", "{}")
    finally:
        os.umask(mask)
    assert (tmp_path / "a.json").stat().st_mode & 0o777 == 0o644


def _leaves(node: object, path: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    found: list[tuple[str | int, ...]] = [path] if path else []
    for key, value in node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ():
        found += _leaves(value, (*path, key))
    return found


@pytest.mark.parametrize("name", ["fpso-2000m-design", "hanging-riser-case1", "hanging-riser-case2", "volturnus-s"])
def test_no_fault_only_follows_from_another(name: str) -> None:
    """Each part of an example in turn is made unreadable: every fault stands there, or at what holds it."""
    whole = yaml.safe_load((ROOT / "examples" / f"{name}.yaml").read_text())
    for path in _leaves(whole):
        data = json.loads(json.dumps(whole))
        at = data
        for key in path[:-1]:
            at = at[key]
        at[path[-1]] = {"?": 1} if not isinstance(at[path[-1]], dict) else 7
        with pytest.raises(CaseError) as caught:
            parse_case(data)
        if path[-2:-1] == ("point",):  # two or three numbers: a wrong one is told for both
            path = path[:-1]
        for error in caught.value.errors:
            short = min(len(error.loc), len(path))
            assert error.loc[:short] == path[:short], (path, str(error))
