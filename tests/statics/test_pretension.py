"""The wanted pretension: a radius, a length, an anchor at either end, and a refusal that says what can be had."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from solver.outcome import CaseError
from solver.statics.catenary import solve_catenary
from tests.systems import example, moored_box, solved


def _fpso_line() -> dict[str, Any]:
    """One of the example's lines between a pinned top and its anchor."""
    data = example("fpso-2000m")
    line = data["lines"]["bow-port"]
    line["end_b"] = {"pinned": [80, 23, -10]}
    return {
        **{key: data[key] for key in ("slowdrift", "name", "line_types")},
        "environment": {**data["environment"], "seastates": []}, "lines": {"line": line}, "analyses": {"statics": {}},
    }  # fmt: skip


def _tension(static, first: int = 0) -> float:  # type: ignore[no-untyped-def]
    return float(np.linalg.norm(static.state.end_forces[0][first : first + 3]))


def test_paper_pretension_gives_its_horizontal_tension_and_grounded_length() -> None:
    """validation.md §2, elastic catenary: 1.80 MN (1.795 to 1.805 rounds to it) and about 225 m on the bed.

    The discretised line, on its soft bed, touches to within an element (66 m) of it.
    """
    _, static = solved(_fpso_line())
    assert _tension(static) == pytest.approx(4370e3, rel=1e-8)
    assert np.hypot(*static.state.end_forces[0][:2]) == pytest.approx(1.80e6, abs=5e3)
    z = static.state.shapes[0][:, 2] + 2000.0
    assert np.flatnonzero(z < 0.0).max() * 66.0 == pytest.approx(225.0, abs=66.0)
    w = (150.0 - 1025.0 * np.pi * 0.15**2 / 4) * 9.807
    radius = float(np.hypot(*(static.lines[0].end_a.point - static.lines[0].end_b.point)[:2]))
    closed = solve_catenary(radius, 1990.0, 3300.0, w, 1e9, seabed=True)
    assert closed is not None
    assert closed.horizontal == pytest.approx(1.80e6, abs=2e4)  # at the radius of the discretised line
    exact = brentq(lambda r: solve_catenary(r, 1990.0, 3300.0, w, 1e9, seabed=True).tension - 4370e3, 2300, 2500)  # type: ignore[union-attr]
    closed = solve_catenary(exact, 1990.0, 3300.0, w, 1e9, seabed=True)
    assert closed is not None
    assert closed.horizontal == pytest.approx(1.80e6, abs=5e3)
    assert closed.grounded == pytest.approx(225.0, abs=5.0)


def test_a_found_radius_given_back_gives_the_same_tension() -> None:
    data = _fpso_line()
    _, static = solved(data)
    anchor = static.lines[0].end_a.point
    radius = float(np.hypot(*(anchor - np.array([80, 23, 0]))[:2]))
    assert np.degrees(np.arctan2(anchor[1] - 23, anchor[0] - 80)) == pytest.approx(45.0, abs=1e-9)
    data["lines"]["line"]["end_a"] = {"anchor": {"azimuth": "45 deg", "radius": radius}}
    _, again = solved(data)
    assert _tension(again) == pytest.approx(4370e3, rel=1e-6)


def test_anchor_at_end_b_is_the_same_line_backwards() -> None:
    data = _fpso_line()
    _, plain = solved(data)
    line = data["lines"]["line"]
    line["end_a"], line["end_b"] = line["end_b"], line["end_a"]
    _, turned = solved(data)
    np.testing.assert_allclose(turned.lines[0].end_b.point, plain.lines[0].end_a.point, atol=1e-4)
    assert _tension(turned, 3) == pytest.approx(4370e3, rel=1e-8)


@pytest.mark.parametrize("wanted", [3.0e6, 4.37e6, 6.0e6])
def test_a_length_is_found_for_a_given_anchor(wanted: float) -> None:
    data = _fpso_line()
    line = data["lines"]["line"]
    line["segments"] = [
        {"type": "wire", "length": 800, "elements": 12},
        {"type": "wire", "length": "find", "elements": 40},
    ]
    line["end_a"] = {"anchor": {"azimuth": "45 deg", "radius": 2500, "pretension": wanted}}
    _, static = solved(data)
    assert _tension(static) == pytest.approx(wanted, rel=1e-8)
    found = float(static.lines[0].length - 800)
    line["segments"][1]["length"] = found
    del line["end_a"]["anchor"]["pretension"]
    line["allow_stretch"] = True
    _, again = solved(data)
    assert _tension(again) == pytest.approx(wanted, rel=1e-6)


def test_length_by_point_and_by_radius_agree() -> None:
    data = _fpso_line()
    line = data["lines"]["line"]
    line["segments"] = [{"type": "wire", "length": "find", "elements": 50}]
    line["end_a"] = {"anchor": {"azimuth": "45 deg", "radius": 2500, "pretension": 4.37e6}}
    _, one = solved(data)
    away = 2500 / np.sqrt(2)
    line["end_a"] = {"anchor": {"point": [80 + away, 23 + away], "pretension": 4.37e6}}
    _, other = solved(data)
    assert other.lines[0].length == pytest.approx(one.lines[0].length, rel=1e-9)


def test_out_of_reach_names_the_field_and_the_range() -> None:
    data = _fpso_line()
    data["lines"]["line"]["end_a"]["anchor"]["pretension"] = 1e3
    with pytest.raises(CaseError) as caught:
        solved(data)
    (error,) = caught.value.errors
    assert error.field == "lines.line.end_a.anchor.pretension"
    assert "allowed" in error.message


def test_a_line_too_short_for_the_depth_names_its_field() -> None:
    data = _fpso_line()
    data["lines"]["line"]["segments"][0]["length"] = 1500
    with pytest.raises(CaseError, match="cannot reach the seabed") as caught:
        solved(data)
    assert caught.value.errors[0].field.startswith("lines.line")


def test_a_taut_leg_is_found_by_its_stretch() -> None:
    """Polyester: a pretension needs the anchor farther off than the unstretched line reaches."""
    data = moored_box(20, 4)
    data["line_types"]["chain"] = {"diameter": 0.2, "mass": 33.0, "EA": 4e7}
    for line in data["lines"].values():
        line["segments"] = [{"type": "chain", "length": 400, "elements": 20}]
        line["end_a"]["anchor"] = {"azimuth": line["end_a"]["anchor"]["azimuth"], "pretension": 1.5e6}
        line["allow_stretch"] = True
    _, static = solved(data)
    assert _tension(static) == pytest.approx(1.5e6, rel=1e-8)
    assert np.linalg.norm(static.state.shapes[0][-1] - static.state.shapes[0][0]) > 400.0


def test_pretension_is_set_in_still_water_and_the_current_adds_to_it() -> None:
    data = _fpso_line()
    current = copy.deepcopy(data)
    current["environment"]["current"] = {"depths": [0, 2000], "speeds": [1.5, 0.2], "direction": "225 deg"}
    _, still = solved(data)
    _, flowing = solved(current)
    np.testing.assert_allclose(flowing.lines[0].end_a.point, still.lines[0].end_a.point, rtol=1e-9)
    assert abs(_tension(flowing) - 4370e3) > 1e3


@pytest.mark.parametrize(("chain", "depth"), [(800.0, 1500.0), (1500.0, 2500.0), (300.0, 700.0)])
def test_a_pretension_below_the_averaged_line_s_weight_is_found(chain: float, depth: float) -> None:
    """Wire above heavy chain: the tension hanging down is that of the wire, well below that of their mean."""
    w = (70.0 - 1025 * np.pi * 0.12**2 / 4) * 9.80665
    data = {
        "slowdrift": 1, "name": "chain and wire", "environment": {"depth": depth},
        "line_types": {"chain": {"diameter": 0.2, "mass": 300.0, "EA": 1e9},
                       "wire": {"diameter": 0.12, "mass": 70.0, "EA": 8e8}},
        "lines": {"line": {
            "segments": [{"type": "chain", "length": chain, "elements": 20},
                         {"type": "wire", "length": 1.5 * depth, "elements": 60}],
            "end_a": {"anchor": {"azimuth": "20 deg", "pretension": 1.25 * w * depth}}, "end_b": {"pinned": [0, 0, 0]},
        }}, "analyses": {"statics": {}},
    }  # fmt: skip
    _, static = solved(data)
    assert _tension(static) == pytest.approx(1.25 * w * depth, rel=1e-8)


@pytest.mark.parametrize("anchor_at", ["end_a", "end_b"])
def test_the_least_pretension_is_the_weight_that_hangs(anchor_at: str) -> None:
    """1990 m of wire at 150 kg/m hang: less is refused with that weight, a little more is had."""
    data = _fpso_line()
    line = data["lines"]["line"]
    segments = [{**segment, "elements": 120} for segment in line["segments"]]
    ends = {"end_a": line["end_a"], "end_b": line["end_b"]}
    if anchor_at == "end_b":
        ends = {"end_a": line["end_b"], "end_b": line["end_a"]}
    line |= {"segments": segments, **ends}
    w = (150.0 - 1025.0 * np.pi * 0.15**2 / 4) * 9.807
    hung = w * 1990.0
    line[anchor_at]["anchor"]["pretension"] = 0.99 * hung
    with pytest.raises(
        CaseError, match=r"is less than the weight of the line that hangs .* 1990 m below; allowed: more than"
    ) as told:
        solved(data)
    said = float(str(told.value).split("more than ")[1].split(" N")[0])
    assert said == pytest.approx(hung, rel=0.99 * hung / 1e9 + 1e-3)
    line[anchor_at]["anchor"]["pretension"] = 1.05 * hung
    _, static = solved(data)
    assert _tension(static, 0 if anchor_at == "end_a" else 3) == pytest.approx(1.05 * hung, rel=1e-7)


def test_a_line_with_a_buoy_has_no_least_pretension_of_its_weight() -> None:
    """A float carries part of what hangs: what S17 says does not hold, and the pretension is had."""
    data = _fpso_line()
    line = data["lines"]["line"]
    w = (150.0 - 1025.0 * np.pi * 0.15**2 / 4) * 9.807
    lift = 0.4 * w * 1990.0
    data["attachments"] = [{"line": "line", "arc_length": 2500.0, "volume": lift / (0.8 * 1025.0 * 9.807),
                            "mass": 0.2 * lift / (0.8 * 9.807), "drag_area": 0.0}]  # fmt: skip
    line["end_a"]["anchor"]["pretension"] = 0.9 * w * 1990.0
    _, static = solved(data)
    assert _tension(static) == pytest.approx(0.9 * w * 1990.0, rel=1e-7)
