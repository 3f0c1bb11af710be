"""What a line does on the seabed in statics: anchor load, length on the bed, independence of scale (L13, L19-L21)."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.forces import axial
from solver.forces.seabed import spring_forces
from solver.results.line_values import contact_shares, grounded_length, node_weights
from solver.run import run
from solver.statics.catenary import solve_catenary
from tests.systems import solved

G, RHO = 9.80665, 1025.0


def chain(soil: float | None = None, transition: float | None = None, elements: int = 50) -> dict[str, Any]:
    """850 m of heavy chain in 200 m of water, of which some 530 m lie on the bed."""
    seabed = {name: value for name, value in (("soil", soil), ("transition", transition)) if value is not None}
    return {
        "slowdrift": 1, "name": "chain on the bed",
        "environment": {"depth": 200.0, "water": {"density": RHO, "gravity": G}, "seabed": seabed},
        "line_types": {"chain": {"diameter": 0.3, "mass": 600.0, "EA": 3e9}},
        "lines": {"a": {"segments": [{"type": "chain", "length": 850.0, "elements": elements}],
                        "end_a": {"anchor": {"point": [-830, 0]}}, "end_b": {"pinned": [-58, 0, -14]}}},
        "analyses": {"statics": {}},
    }  # fmt: skip


WEIGHT = (600.0 - RHO * np.pi * 0.3**2 / 4) * G


@pytest.mark.parametrize("elements", [50, 170])
@pytest.mark.parametrize("transition", [0.005, 0.1, 1.0, None])
@pytest.mark.parametrize("resting", [0.2, 0.01, 1e-4])  # depth to which the chain sinks, m
def test_anchor_load_and_laid_length_for_any_soil_and_transition(
    resting: float, transition: float | None, elements: int
) -> None:
    _, static = solved(chain(WEIGHT / (0.3 * resting), transition, elements))
    line, shape = static.lines[0], static.state.shapes[0]
    closed = solve_catenary(772.0, 186.0, 850.0, WEIGHT, 3e9, True)
    assert closed is not None
    first = axial.tension(line.arrays, shape)[0] * (shape[1] - shape[0]) / np.linalg.norm(shape[1] - shape[0])
    half = 0.5 * WEIGHT * 850.0 / elements
    np.testing.assert_allclose(static.state.end_forces[0][3:], first - [0, 0, half], atol=1e-3)
    assert first[0] == pytest.approx(closed.horizontal, rel=0.01)
    assert static.state.end_forces[0][5] < 0.0  # the anchor is not lifted
    assert grounded_length(line, shape) == pytest.approx(closed.grounded, abs=850.0 / elements)
    assert -(static.state.end_forces[0][2] + static.state.end_forces[0][5]) == pytest.approx(
        WEIGHT * 850.0 - spring_forces(line.arrays, shape).sum(), rel=1e-9
    )


def test_nodes_at_rest_lie_where_a_linear_spring_would_hold_them() -> None:
    for resting, transition in ((0.2, 0.01), (0.01, 0.5), (0.05, None)):
        _, static = solved(chain(WEIGHT / (0.3 * resting), transition))
        assert static.state.shapes[0][10, 2] + 200.0 == pytest.approx(-resting, rel=1e-3)


def test_default_transition_is_the_resting_depth_and_at_least_half_a_diameter() -> None:
    for resting, expected in ((0.4, 0.4), (0.01, 0.15)):
        _, static = solved(chain(WEIGHT / (0.3 * resting)))
        np.testing.assert_allclose(1.0 / static.lines[0].arrays.a2, expected, rtol=1e-12)


def test_model_scale_and_full_scale_are_one_answer() -> None:
    full, scale = chain(3e6), 70.0
    small = copy.deepcopy(full)
    small["environment"]["depth"] /= scale
    small["line_types"]["chain"] = {"diameter": 0.3 / scale, "mass": 600.0 / scale**2, "EA": 3e9 / scale**3}
    small["lines"]["a"]["segments"][0]["length"] /= scale
    small["lines"]["a"]["end_a"] = {"anchor": {"point": [-830 / scale, 0]}}
    small["lines"]["a"]["end_b"] = {"pinned": [-58 / scale, 0, -14 / scale]}
    found = [run(parse_case(data), None).summary["statics"]["lines"]["a"] for data in (full, small)]
    for end in ("end_a", "end_b"):
        np.testing.assert_allclose(
            np.array(found[1][end]["force"]) * scale**3, found[0][end]["force"], rtol=0.005, atol=50.0
        )
    assert found[1]["grounded_length"] * scale == pytest.approx(found[0]["grounded_length"], rel=0.005)


def test_vertical_tendon_keeps_its_pretension_at_the_bed() -> None:
    """End reaction of a tendon = tension of its end element ± half the element's weight, however stiff the bed."""
    data = chain(1e8, 1.0, 10)
    data["line_types"]["chain"]["EA"] = 1e9
    data["lines"]["a"] = {
        "segments": [{"type": "chain", "length": 180.0, "elements": 10}],
        "end_a": {"pinned": [0, 0, -200]}, "end_b": {"pinned": [0, 0, -14]}, "allow_stretch": True,
    }  # fmt: skip
    _, static = solved(data)
    tension = axial.tension(static.lines[0].arrays, static.state.shapes[0])
    half = 0.5 * WEIGHT * 18.0
    assert static.state.end_forces[0][5] == pytest.approx(tension[0] - half, rel=1e-9)
    assert -static.state.end_forces[0][2] == pytest.approx(tension[-1] + half, rel=1e-9)


def test_line_that_hangs_free_of_the_bed_has_nothing_on_it() -> None:
    data = chain(3e6)
    data["environment"]["depth"] = 900.0
    data["lines"]["a"]["end_a"] = {"pinned": [-400, 0, -200]}
    _, static = solved(data)
    assert grounded_length(static.lines[0], static.state.shapes[0]) == 0.0


def test_line_of_two_types_lies_with_each_its_own_weight() -> None:
    """Light rope in the middle of a chain: each node's share is judged by its own weight."""
    data = chain(3e6)
    data["line_types"]["rope"] = {"diameter": 0.2, "mass": 40.0, "EA": 3e8}
    data["lines"]["a"]["segments"] = [
        {"type": "chain", "length": 300.0, "elements": 20}, {"type": "rope", "length": 150.0, "elements": 10},
        {"type": "chain", "length": 400.0, "elements": 25},
    ]  # fmt: skip
    _, static = solved(data)
    line, shape = static.lines[0], static.state.shapes[0]
    share = contact_shares(line, shape)
    assert np.all(share[:25] > 0.99)  # chain and the first rope nodes lie
    assert np.all((share >= 0) & (share <= 1))
    assert node_weights(line)[25] == pytest.approx((40.0 - RHO * np.pi * 0.2**2 / 4) * G * 15.0, rel=1e-9)
