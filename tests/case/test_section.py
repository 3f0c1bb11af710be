"""Nominal, drag and displaced size of a line: which number each force takes, and lines that float."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.case.section import section
from solver.check import check
from solver.model.line import discretise
from solver.outcome import CaseError
from solver.run import run
from tests.systems import span

RHO, G = 1000.0, 9.807  # of `span`
KIND = {"diameter": 0.1, "mass": 200.0, "EA": 8e8, "drag": {"normal": 2.4, "tangential": 1.15},
        "added_mass": {"normal": 1.0, "tangential": 0.5}}  # fmt: skip


def made(**kind: Any) -> Any:
    case = span(100.0, (0, 0, -50), (80, 0, -50), **{**KIND, **kind})
    case["environment"]["seabed"] = {"soil": 2e5}
    return parse_case(case)


@pytest.mark.parametrize(
    ("kind", "kilograms"),
    [
        ({}, 191.95),  # a solid cylinder of 0.1 m: what a chain does not weigh
        ({"volume": 200 / 7850}, 173.89),
        ({"submerged_weight": "173.89 kgf/m"}, 173.89),
        ({"diameter": 0.2, "mass": 27.16}, -5.04),
        ({"diameter": 0.2, "mass": 27.16, "volume": "19.681 L/m"}, 6.987),
        ({"volume": 0}, 200.0),
    ],
)
def test_weight_in_water(kind: dict[str, Any], kilograms: float) -> None:
    case = span(100.0, (0, 0, -50), (80, 0, -50), **{**KIND, **kind})
    case["environment"]["water"] = {"density": 1025}
    found = section(parse_case(case).line_types["wire"], parse_case(case).environment.water)
    assert found.weight_in_water / 9.80665 == pytest.approx(kilograms, abs=6e-3)


def test_each_force_takes_its_own_size() -> None:
    a = discretise(made(drag_diameter=0.18, volume=0.025), "line", 0.0, 0.0)
    L = 5.0
    assert a.b_wet == pytest.approx(RHO * G * 0.025 * L)
    assert a.mw == pytest.approx(0.5 * RHO * 0.025 * L)
    assert a.cdn == pytest.approx(0.25 * RHO * L * 0.18 * 2.4)
    assert a.cdt == pytest.approx(0.25 * RHO * L * 0.18 * 1.15)
    assert pytest.approx(math.sqrt(4 * 0.025 / math.pi)) == a.D
    assert a.a1[1:-1] == pytest.approx(2e5 * 0.1 * L)
    assert a.w_dry == pytest.approx(200.0 * G * L)


def test_with_the_diameter_alone_nothing_changes_to_the_last_bit() -> None:
    a = discretise(made(), "line", 0.0, 0.0)
    L, D = np.full(20, 5.0), np.full(20, 0.1)
    assert np.array_equal(a.b_wet, RHO * G * (0.25 * math.pi * D**2) * L)
    assert np.array_equal(a.mw, 0.5 * RHO * (0.25 * math.pi * D**2) * L)
    assert np.array_equal(a.cdn, 0.25 * RHO * L * D * 2.4)
    assert np.array_equal(a.D, D)


@pytest.mark.parametrize("kind", [{"volume": 0.0254}, {"submerged_weight": 1700.0}])
def test_the_ends_carry_the_weight_in_water(kind: dict[str, Any]) -> None:
    case = made(**kind)
    summary = run(case, None).summary
    line = summary["statics"]["lines"]["line"]
    expected = 100.0 * section(case.line_types["wire"], case.environment.water).weight_in_water
    assert line["weight_in_water"] == pytest.approx(expected, rel=1e-12)
    assert -(line["end_a"]["force"][2] + line["end_b"]["force"][2]) == pytest.approx(expected, rel=1e-6)
    told = summary["line_types"]["wire"]
    assert told["weight_in_water"] == pytest.approx(expected / 100.0, rel=1e-12)
    assert (told["diameter"], told["drag_diameter"], told["mass"]) == (0.1, 0.1, 200.0)


def test_the_drag_of_a_current_is_on_the_drag_diameter() -> None:
    """A taut vertical line across a uniform current: its ends take ½ρ D_d C_n U² per metre, less the half elements."""
    sums = {}
    for diameter in (None, 0.3):
        case = span(59.9, (0, 0, -70), (0, 0, -10), **{**KIND, "volume": 0.0254}, elements=30)
        case["lines"]["line"]["allow_stretch"] = True
        case["line_types"]["wire"] |= {} if diameter is None else {"drag_diameter": diameter}
        case["environment"]["current"] = {"depths": [0], "speeds": [0.5], "direction": "0 deg"}
        line = run(parse_case(case), None).summary["statics"]["lines"]["line"]
        sums[diameter] = line["end_a"]["force"][0] + line["end_b"]["force"][0]
    assert sums[None] == pytest.approx(0.5 * RHO * 0.1 * 2.4 * 0.25 * 59.9, rel=2e-3)
    assert sums[0.3] == pytest.approx(3 * sums[None], rel=2e-3)


def warned(**kind: Any) -> list[str]:
    case = made(**kind)
    told = [text for text in check(case, None) if "floats" in text]
    assert [text for text in run(case, None).summary["warnings"] if "floats" in text] == told  # once each
    return told


def test_a_type_that_floats_as_a_cylinder_is_warned_of() -> None:
    [told] = warned(diameter=0.2, mass=20.0)
    assert told.startswith("line type 'wire' floats: as a solid cylinder of 0.2 m it weighs -112 N/m in water")
    assert "`volume` or `submerged_weight`" in told


def test_a_line_that_floats_as_a_whole_is_warned_of() -> None:
    [told] = warned(mass=20.0, submerged_weight=-50.0)
    assert told.startswith("line 'line' floats as a whole: -5 kN in water")


def test_a_light_rope_with_its_volume_is_not() -> None:
    assert warned(diameter=0.2, mass=27.16, volume=27.16 / 1380) == []
    assert warned() == []


def buoyant(module: dict[str, Any], attachment: dict[str, Any] | None = None) -> list[str]:
    case = span(100.0, (0, 0, -50), (60, 0, -10), **KIND)
    case["line_types"]["module"] = {"diameter": 0.9, "mass": 400.0, "EA": 5e8, **module}
    case["lines"]["line"]["segments"].append({"type": "module", "length": 20.0, "elements": 5})
    if attachment:
        case["attachments"] = [{"line": "line", "arc_length": 50.0, **attachment}]
    return [text for text in check(parse_case(case), None) if "floats" in text]


def test_a_buoyant_section_that_is_meant_is_not_warned_of() -> None:
    assert buoyant({"volume": 0.6}) == []
    [told] = buoyant({})
    assert told.startswith("line type 'module' floats")


def test_attachments_count_in_a_line_that_floats() -> None:
    [told] = buoyant({"volume": 0.6}, {"volume": 30.0})
    assert told.startswith("line 'line' floats as a whole")
    assert buoyant({"volume": 1.6}, {"mass": 20e3}) == []


def test_a_weight_in_water_above_that_in_air_is_refused() -> None:
    with pytest.raises(CaseError, match="more than the weight in air"):
        made(submerged_weight=2000.0)
    with pytest.raises(CaseError, match="at most one of volume and submerged_weight"):
        made(submerged_weight=1000.0, volume=0.01)
