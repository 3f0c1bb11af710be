"""Lines that are slack: hanging beside their anchor, lying in excess on the bed, neutral in water."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.forces import axial
from solver.outcome import NotConverged
from solver.statics.catenary import solve_catenary
from solver.statics.solve import StaticState
from tests.statics.independent import residuals
from tests.systems import solved

G = 9.80665


def _line(
    length: float, anchor: float, depth: float, elements: int, kind: dict[str, float], **seabed: Any
) -> dict[str, Any]:
    """A line from an anchor at (-anchor, 0) on the bed up to a point at the surface."""
    return {
        "slowdrift": 1, "name": "slack", "environment": {"depth": depth, "seabed": seabed},
        "line_types": {"k": kind},
        "lines": {"a": {"segments": [{"type": "k", "length": length, "elements": elements}],
                        "end_a": {"anchor": {"point": [-anchor, 0]}}, "end_b": {"pinned": [0, 0, 0]},
                        "allow_stretch": True}},
        "analyses": {"statics": {}},
    }  # fmt: skip


def _wet(kind: dict[str, float]) -> float:
    return G * (kind["mass"] - 1025.0 * 0.25 * np.pi * kind["diameter"] ** 2)


def _ends(static: StaticState) -> tuple[np.ndarray, np.ndarray]:
    force = static.state.end_forces[0]
    return force[:3], force[3:]


HEAVY = {"diameter": 0.2, "mass": 500.0, "EA": 2e9}
LIGHT = {"diameter": 0.18, "mass": 200.0, "EA": 8e8}
SLACK = {
    "chain, 190 m too long": (890.0, 400.0, 300.0, 40, HEAVY),
    "chain, 30 m too long": (330.0, 100.0, 200.0, 60, HEAVY),
    "chain with some bending stiffness": (700.0, 250.0, 250.0, 70, {**HEAVY, "EI": 2e4}),
    "200 elements, just too long": (400.2, 300.0, 100.0, 200, LIGHT),
    "200 elements, 20 m too long": (420.0, 300.0, 100.0, 200, LIGHT),
    "225 elements, 50 m too long": (450.0, 300.0, 100.0, 225, LIGHT),
}


@pytest.mark.parametrize("name", SLACK)
def test_a_line_longer_than_its_way_along_the_bed_hangs_straight_down(name: str) -> None:
    """The end carries the weight of the depth; nothing pulls or pushes along the bed, nor at the anchor."""
    length, anchor, depth, elements, kind = SLACK[name]
    model, static = solved(_line(length, anchor, depth, elements, kind, soil=1e6))
    top, bottom = _ends(static)
    weight = _wet(kind) * depth
    most = 1e-3 * weight + np.pi**2 * kind.get("EI", 0.0) * (elements / length) ** 2  # compression an element carries
    assert np.linalg.norm(top) == pytest.approx(weight, rel=0.01)
    assert abs(top[0]) < most
    assert abs(bottom[0]) < most
    tension = axial.tension(static.lines[0].arrays, static.state.shapes[0])
    assert tension.min() > -most
    assert residuals(model, static)["nodes"] < 1e-8


@pytest.mark.parametrize(("elements", "transition"), [(200, 0.1), (150, 0.2), (100, 0.1)])
def test_a_line_exactly_as_long_as_its_way_along_the_bed(elements: int, transition: float) -> None:
    """400 m from the surface, 100 m deep, to an anchor 300 m away: the closed form has no horizontal force."""
    data = _line(400.0, 300.0, 100.0, elements, LIGHT, soil=1e5, transition=transition)
    model, static = solved(data)
    top, bottom = _ends(static)
    assert np.linalg.norm(top) == pytest.approx(_wet(LIGHT) * 100.0, rel=0.01)
    assert abs(bottom[0]) < 2e-3 * _wet(LIGHT) * 100.0
    assert residuals(model, static)["nodes"] < 1e-8


def _rope(mass: float, length: float = 730.0, current: float = 0.0) -> dict[str, Any]:
    data = _line(length, 700.0, 200.0, 40, {"diameter": 0.2, "mass": mass, "EA": 1e9})
    data["lines"]["a"]["end_b"] = {"pinned": [-20, 0, -10]}
    if current:
        data["environment"]["current"] = {"depths": [0], "speeds": [current], "direction": "90 deg"}
    return data


@pytest.mark.parametrize("mass", [32.2, 32.2013, 32.20132, 32.22])
def test_a_slack_line_that_is_neutral_in_water_is_refused(mass: float) -> None:
    with pytest.raises(NotConverged, match=r"weighs .* N/m in water.*nothing gives it a shape.*Give it a weight"):
        solved(_rope(mass))


def test_a_taut_line_that_is_neutral_in_water_is_a_straight_spring() -> None:
    _, static = solved(_rope(32.2013, 700.0))
    stretch = np.hypot(680.0, 190.0) / 700.0 - 1.0
    assert np.linalg.norm(_ends(static)[0]) == pytest.approx(1e9 * stretch, rel=1e-3)


@pytest.mark.parametrize("mass", [32.3, 33.0, 40.0])
def test_a_slack_line_of_little_weight_has_the_catenary_s_tension(mass: float) -> None:
    _, static = solved(_rope(mass))
    w = _wet({"mass": mass, "diameter": 0.2})
    exact = solve_catenary(680.0, 190.0, 730.0, w, 1e9, seabed=True)
    assert exact is not None
    top, bottom = _ends(static)
    assert np.linalg.norm(top) == pytest.approx(exact.tension, rel=0.01)
    assert abs(bottom[0]) == pytest.approx(exact.horizontal, rel=0.01)


def test_a_neutral_slack_line_in_a_current_carries_its_drag() -> None:
    model, static = solved(_rope(32.2013, current=0.8))
    top, bottom = _ends(static)
    assert residuals(model, static)["nodes"] < 1e-8
    assert top[1] + bottom[1] > 0.5 * 0.5 * 1025 * 0.2 * 0.8**2 * 680.0
    assert static.state.shapes[0][:, 1].max() > 50.0
