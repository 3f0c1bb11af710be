"""A tanker of 200 m on eight lines of chain, polyester and chain finds its equilibrium whatever the sea."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.model.build import build
from solver.statics.solve import StaticState, solve_statics
from tests.statics.independent import residuals
from tests.sweep import ScaledBarge

LENGTH = 200.0


def _tanker(
    hs: float, trim: str = "balanced", rope_mass: float = 22.0, factor: float = 1.0, direction: float = 180.0
) -> dict[str, Any]:
    lines = {}
    for azimuth in (30, 60, 120, 150, 210, 240, 300, 330):
        x, y = 90.0 if azimuth < 90 or azimuth > 270 else -90.0, 16.0 if azimuth < 180 else -16.0
        lines[f"at {azimuth}"] = {
            "segments": [{"type": "chain", "length": 400, "elements": 40}, {"type": "polyester", "length": 250, "elements": 20},
                         {"type": "chain", "length": 50, "elements": 8}],
            "end_a": {"anchor": {"azimuth": f"{azimuth} deg", "pretension": 9e5}}, "end_b": {"fairlead": [x, y, -5]},
        }  # fmt: skip
    return {
        "slowdrift": 1, "name": "tanker",
        "environment": {
            "depth": 150,
            "seastates": [{"spectrum": "jonswap", "hs": hs, "tp": 14, "gamma": 3.3, "direction": f"{direction} deg"}],
            "current": {"depths": [0, 150], "speeds": [1, 0], "direction": "0 deg"},
        },
        "line_types": {
            "chain": {"diameter": 0.095, "mass": 180, "EA": 770e6 * factor, "drag": {"normal": 2.4, "tangential": 1.15}},
            "polyester": {"diameter": 0.143, "mass": rope_mass, "EA": 60e6 * factor,
                          "drag": {"normal": 1.2, "tangential": 0.1}},
        },
        "lines": lines, "analyses": {"statics": {}},
        "vessel": {"mass": 68966e3, "centre_of_gravity": [0, 0, 1], "radii_of_gyration": [12, 50, 50], "trim": trim,
                   "hydrodynamics": {"data": f"barge-{LENGTH}", "radiation": "constant", "frequency": 0.8}},
    }  # fmt: skip


def _solved(data: dict[str, Any]) -> StaticState:
    model = build(parse_case(data), ScaledBarge(data))
    static = solve_statics(model)
    found = residuals(model, static)
    assert found["nodes"] < 1e-8
    assert found["vessel"] < 1e-8
    assert found["fairleads"] < 1e-6
    return static


def test_a_hardly_moved_vessel_keeps_its_pretension() -> None:
    """With waves of 0.1 m only the current's drag moves it: end tensions stay within 2 % of the wanted ones."""
    static = _solved(_tanker(0.1))
    tension = [np.linalg.norm(force[:3]) for force in static.state.end_forces]
    np.testing.assert_allclose(tension, 9e5, rtol=0.02)
    assert abs(static.position[0]) < 0.5
    np.testing.assert_allclose(static.position[[1, 3, 5]], 0.0, atol=1e-6)  # all is symmetric about the centre plane


@pytest.mark.slow
@pytest.mark.parametrize(
    "change", [{"rope_mass": 60.0}, {"factor": 10.0}, {"trim": "as_given"}, {"direction": 90.0}], ids=str
)
@pytest.mark.parametrize("hs", [0.1, 1.0, 10.0])
def test_neighbours_in_small_and_large_seas(hs: float, change: dict[str, Any]) -> None:
    _solved(_tanker(hs, **change))


@pytest.mark.slow
def test_the_offset_grows_evenly_with_the_sea() -> None:
    """The drift force grows with the square of the wave height; so does the offset while it is small."""
    surge = [float(_solved(_tanker(hs)).position[0]) for hs in (0.0125, 0.1, 0.3, 0.6)]
    gain = np.diff(surge) / np.diff(np.square([0.0125, 0.1, 0.3, 0.6]))
    np.testing.assert_allclose(gain, gain[0], rtol=0.05)


@pytest.mark.parametrize(("height", "unstable"), [(1.0, False), (12.0, True)])
def test_a_vessel_that_would_capsize_is_said_to_be_unstable(height: float, unstable: bool) -> None:
    """A centre of gravity above the metacentre; the equilibrium itself is found all the same."""
    data = _tanker(0.1)
    data["vessel"]["hydrostatics"] = {"stiffness": np.diag([0, 0, 7e7, 1.5e10 - 2e9 * height, 1.5e11, 0]).tolist()}
    warnings = _solved(data).warnings
    assert any("unstable in roll" in text for text in warnings) == unstable
