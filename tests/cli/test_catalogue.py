"""`slowdrift catalogue`, and what a run prints of line types."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest
from rich.console import Console

from cli.main import main
from cli.table import show
from solver.case import load_case
from solver.run import run

CASE = """
slowdrift: 1
name: Catalogue
environment: {depth: 100 m}
line_types:
  chain: {catalogue: chain-R4-studless, diameter: 120 mm}
  rope: {diameter: 100 mm, mass: 20 kg/m, EA: 200 MN, volume: 10 L/m}
lines:
  leg:
    segments: [{type: chain, length: 100 m, elements: 10}, {type: rope, length: 50 m, elements: 5}]
    end_a: {pinned: [0, 0, -90]}
    end_b: {pinned: [120, 0, -20]}
analyses: {statics: {}}
"""


def test_the_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["catalogue"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("chain-R4-studless") and "20 to 220 mm" in line for line in lines)
    assert any(line.startswith("chain-R6-studlink") and "(unverified: breaking_load)" in line for line in lines)
    assert main(["catalogue", "--json"]) == 0
    assert {"wire", "polyester", "nylon", "hmpe"} <= {item["name"] for item in json.loads(capsys.readouterr().out)}


def test_one_entry(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["catalogue", "chain-R4-studless", "--diameter", "120 mm"]) == 0
    out = capsys.readouterr().out
    assert "weight in water 2443.26 N/m at 1025 kg/m3" in out
    assert "0.0274 (44 d² - 0.08 d³) kN, d in mm" in out
    assert "[3] DNVGL-OS-E302" in out
    assert main(["catalogue", "chain-R4-studless", "--diameter", "0.12", "--stiffness", "orcaflex", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["diameter"], found["stiffness"]) == (0.12, "orcaflex")
    assert found["values"]["EA"]["value"] == pytest.approx(1229.76e6)
    assert {"value", "unit", "formula", "source", "status"} == set(found["values"]["mass"])
    assert main(["catalogue", "nylon"]) == 0
    assert "give --diameter" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["chain-R7-studless"], "name: there is no 'chain-R7-studless'"),
        (["wire", "--diameter", "1 m"], "diameter: 1 m is outside the range of wire; allowed: 20 to 200 mm"),
        (["wire", "--diameter", "10 kN"], "diameter: unit 'kN' is not known"),
        (["wire", "--diameter", "0.1", "--stiffness", "e301"], "stiffness: wire has one EA only"),
        (["chain-R4-studless", "--diameter", "0.1", "--stiffness", "x"], "allowed: e301 or orcaflex"),
        (["wire", "--diameter", "0.1", "--density", "heavy"], "density: 'heavy' is not a number"),
    ],
)
def test_what_is_wrong_is_said(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["catalogue", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert words in err


def test_a_run_prints_types_and_what_the_catalogue_gave(tmp_path: Path) -> None:
    summary = run(load_case(CASE), None).summary
    text = io.StringIO()
    show(summary, Console(file=text, width=140))
    out = text.getvalue()
    assert "chain, from the catalogue, chain-R4-studless:" in out
    assert "breaking_load         1.35729e+07 N     verified [3]" in out
    assert "rope, from the catalogue" not in out
    line = next(line for line in out.splitlines() if "leg, a" in line)
    weight = 100 * 286.56 * (1 - 1025 / 7850) + 50 * (20 - 1025 * 0.010)
    assert f"{9.80665 * weight / 1e3:.1f}" in line
