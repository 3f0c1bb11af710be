"""Equilibrium of lines: the paper's riser, balance of forces, and the shapes that a mooring comes in."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from solver.forces import REGISTRY, axial
from solver.model.system import forces
from tests.systems import riser, solved, span

G = 9.807


def test_paper_riser_within_0_02_kn() -> None:
    """Low & Langley's Table 2, in-house and Orcaflex columns; end tension is the size of the end reaction."""
    _, static = solved(riser())
    end_b, end_a = static.state.end_forces[0][:3], static.state.end_forces[0][3:]
    assert np.linalg.norm(end_b) / 1e3 == pytest.approx(47.11, abs=0.02)
    assert np.linalg.norm(end_a) / 1e3 == pytest.approx(26.60, abs=0.02)
    assert -end_b[2] / 1e3 == pytest.approx(45.71, abs=0.02)
    assert -end_b[0] / 1e3 == pytest.approx(11.40, abs=0.02)
    assert -end_a[2] / 1e3 == pytest.approx(24.04, abs=0.02)


def test_paper_riser_without_bending_is_the_other_check() -> None:
    """validation.md §1: with EI = 0 11.472, 45.722 and 24.028 kN."""
    data = riser()
    data["line_types"]["riser"]["EI"] = 0
    _, static = solved(data)
    force = static.state.end_forces[0] / 1e3
    np.testing.assert_allclose([-force[0], -force[2], -force[5]], [11.472, 45.722, 24.028], atol=1e-3)


def _shapes() -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    found["slack U"] = span(170, (0, 0, -5), (10, 0, -5), 40)
    found["deep U with bending"] = span(170, (0, 0, -5), (30, 0, -5), 60, EI=5e4)
    found["nearly vertical"] = span(90.5, (0, 0, -95), (1, 0, -5), 30)
    found["vertical, hanging"] = span(90.2, (0, 0, -95), (0, 0, -5), 30)
    found["taut"] = span(135.0, (0, 0, -95), (100, 0, -5), 30)
    found["taut, stretched"] = span(120.0, (0, 0, -95), (100, 0, -5), 30, EA=5e6)
    found["taut, stretched"]["lines"]["line"]["allow_stretch"] = True
    found["level and tight"] = span(100.5, (0, 0, -50), (100, 0, -50), 30)
    found["on the bed"] = span(210, (0, 0, -100), (150, 0, -5), 60)
    found["on the bed"]["environment"]["seabed"] = {"node_stiffness": 2e4, "transition": 0.2}
    found["mostly on a hard bed"] = span(300, (0, 0, -100), (250, 0, -5), 60)
    found["mostly on a hard bed"]["environment"]["seabed"] = {"node_stiffness": 1e6, "transition": 0.05}
    found["buoyant line"] = span(150, (0, 0, -90), (80, 0, -60), 40, mass=2.0, diameter=0.2)
    found["both ends on the bed"] = span(120, (0, 0, -100), (100, 0, -100), 30)
    found["out of plane"] = span(170, (3, -40, -70), (60, 55, -5), 40, EI=1e4)
    found["through the surface"] = span(130, (0, 0, -95), (60, 0, 12), 40, EI=1e3)
    found["upside down"] = span(170, (0, 0, -5), (100, 0, -55), 40)
    wave = span(200, (0, 0, -100), (90, 0, -3), 10)
    wave["line_types"] = {"riser": {"diameter": 0.3, "mass": 120, "EA": 4e8, "EI": 4e4},
                          "buoyant": {"diameter": 0.6, "mass": 200, "EA": 4e8, "EI": 4e4}}  # fmt: skip
    wave["lines"]["line"]["segments"] = [
        {"type": "riser", "length": 80, "elements": 30}, {"type": "buoyant", "length": 40, "elements": 20},
        {"type": "riser", "length": 80, "elements": 30},
    ]  # fmt: skip
    wave["environment"]["seabed"] = {"soil": 1e5}
    found["lazy wave"] = wave
    clump = span(150, (0, 0, -95), (100, 0, -5), 30)
    clump["attachments"] = [{"line": "line", "arc_length": 60, "mass": 5000, "volume": 0.6, "drag_area": 1}]
    found["clump weight"] = clump
    buoy = span(150, (0, 0, -95), (100, 0, -5), 30)
    buoy["attachments"] = [{"line": "line", "arc_length": 90, "mass": 500, "volume": 4.0}]
    found["buoy under water"] = buoy
    chain = span(300, (0, 0, -100), (220, 30, -5), 10)
    chain["line_types"] = {"chain": {"diameter": 0.2, "mass": 250, "EA": 9e8},
                           "rope": {"diameter": 0.15, "mass": 20, "EA": 3e7}}  # fmt: skip
    chain["lines"]["line"]["segments"] = [
        {"type": "chain", "length": 120, "element_length": 4}, {"type": "rope", "length": 100, "elements": 10},
        {"type": "chain", "length": 80, "element_length": 3},
    ]  # fmt: skip
    found["chain, rope, chain"] = chain
    for name in ("slack U", "taut", "lazy wave", "on the bed"):
        current = copy.deepcopy(found[name])
        current["environment"]["current"] = {"depths": [0, 60], "speeds": [1.2, 0.3], "direction": "60 deg"}
        found[f"{name}, current"] = current
    steel = span(170, (0, 0, -55), (100, 0, -5), 100, EA=9e9, EI=5e7, mass=80)
    found["steel pipe"] = steel
    return found


SHAPES = _shapes()


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_finds_its_equilibrium(name: str) -> None:
    """Every node is in balance by the forces themselves, and the reactions carry weight, bed and drag."""
    _, static = solved(SHAPES[name])
    (line,), (x,) = static.lines, static.state.shapes
    still = np.zeros_like(x)
    F = forces(line.arrays, x, still, still, still)
    scale = np.abs(axial.tension(line.arrays, x)).max()
    assert np.abs(F[1:-1]).max() < 3e-9 * max(scale, np.spacing(100.0) * (line.arrays.EA / line.arrays.L).max() * 1e9)
    outer = np.zeros(3)
    for kind in ("weight", "drag", "seabed"):
        part = np.zeros_like(x)
        REGISTRY[kind].force(line.arrays, x, still, still, still, part)
        outer += part.sum(axis=0)
    reactions = -static.state.end_forces[0]
    total = reactions[:3] + reactions[3:] + outer
    assert np.abs(total).max() < 1e-7 * max(scale, 1.0)
    if np.abs(line.arrays.current_v).max() == 0 and name != "out of plane" and "rope" not in name:
        assert np.abs(x[:, 1]).max() < 1e-9  # nothing acts across the plane


def test_reactions_carry_weight_less_buoyancy_and_attachments_by_hand() -> None:
    _, static = solved(SHAPES["clump weight"])
    w = (50.0 - 1000 * np.pi * 0.1**2 / 4) * G * 150.0 + (5000 - 600) * G
    assert -(static.state.end_forces[0][2] + static.state.end_forces[0][5]) == pytest.approx(w, rel=1e-9)


def test_dry_part_has_its_dry_weight() -> None:
    _, static = solved(SHAPES["through the surface"])
    (line,), (x,) = static.lines, static.state.shapes
    d = np.diff(x, axis=0)
    dry = 0.0
    for j in range(d.shape[0]):  # unstretched length above z = 0, each element straight
        z0, z1 = sorted((x[j, 2], x[j + 1, 2]))
        dry += line.arrays.L[j] * (1.0 if z0 > 0 else 0.0 if z1 < 0 else z1 / (z1 - z0))
    assert 5.0 < dry < 30.0
    w = G * (50.0 * 130.0 - 1000 * np.pi * 0.1**2 / 4 * (130.0 - dry))
    assert -(static.state.end_forces[0][2] + static.state.end_forces[0][5]) == pytest.approx(w, rel=1e-9)


def test_a_lazy_wave_has_its_hog_and_its_sag() -> None:
    _, static = solved(SHAPES["lazy wave"])
    z = static.state.shapes[0][:, 2]
    rises = np.sign(np.diff(z)[np.abs(np.diff(z)) > 1e-2])
    turns = int(np.sum(np.diff(rises) != 0))
    assert turns >= 2, "no wave"
    tension = axial.tension(static.lines[0].arrays, static.state.shapes[0])
    assert np.all(tension > 0)


@pytest.mark.parametrize("turn", [35.0, 200.0])
@pytest.mark.parametrize("name", ["lazy wave, current", "on the bed, current", "chain, rope, chain", "out of plane"])
def test_turning_the_case_turns_the_answer(name: str, turn: float) -> None:
    a = np.radians(turn)
    R = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    data = copy.deepcopy(SHAPES[name])
    for end in ("end_a", "end_b"):
        data["lines"]["line"][end]["pinned"] = (R @ data["lines"]["line"][end]["pinned"]).tolist()
    if "current" in data["environment"]:
        data["environment"]["current"]["direction"] = f"{60 + turn} deg"
    _, plain = solved(SHAPES[name])
    _, turned = solved(data)
    np.testing.assert_allclose(turned.state.shapes[0], plain.state.shapes[0] @ R.T, atol=1e-6)
    force = plain.state.end_forces[0].reshape(2, 3) @ R.T
    np.testing.assert_allclose(turned.state.end_forces[0].reshape(2, 3), force, atol=1e-8 * np.abs(force).max() * 10)


def test_a_line_in_a_current_is_the_loaded_string() -> None:
    """dT/ds + w + f_n = 0 with drag on the normal velocity, solved by collocation, cross current and inextensible."""
    L, w, speed = 170.0, (50.0 - 1000 * np.pi * 0.1**2 / 4) * G, 1.5
    V = speed * np.array([np.cos(0.9), np.sin(0.9), 0.0])

    def rhs(_s, y):  # type: ignore[no-untyped-def]
        T = y[3:]
        t = T / np.linalg.norm(T, axis=0)
        vn = V[:, None] - (V @ t) * t
        drag = 0.5 * 1000 * 0.1 * np.linalg.norm(vn, axis=0) * vn
        return np.concatenate([t * (1 + np.linalg.norm(T, axis=0) / 5e8), -drag + np.array([0, 0, w])[:, None]])

    a, b = np.array([0, 0, -55.0]), np.array([100.0, 0, -5.0])
    s = np.linspace(0, L, 200)
    data = span(L, a, b, 160)
    data["environment"]["current"] = {"depths": [0], "speeds": [speed], "direction": f"{0.9!r} rad"}
    _, static = solved(data)
    x = static.state.shapes[0]
    arc = static.lines[0].node_arc
    T = (
        axial.tension(static.lines[0].arrays, x)[:, None]
        * np.diff(x, axis=0)
        / np.linalg.norm(np.diff(x, axis=0), axis=1)[:, None]
    )
    guess = np.stack([np.interp(s, arc, x[:, p]) for p in range(3)] +
                     [np.interp(s, 0.5 * (arc[1:] + arc[:-1]), T[:, p]) for p in range(3)])  # fmt: skip
    exact = solve_bvp(rhs, lambda p, q: np.concatenate([p[:3] - a, q[:3] - b]), s, guess * 1.02, tol=1e-8)
    assert exact.success
    np.testing.assert_allclose(x, exact.sol(arc)[:3].T, atol=0.02)
    top = exact.y[3:, -1]
    np.testing.assert_allclose(-static.state.end_forces[0][:3], top, atol=2e-3 * np.linalg.norm(top))
    assert np.abs(x[:, 1]).max() > 1.0  # the current does bend it across


def test_a_symmetric_line_hangs_symmetrically() -> None:
    _, static = solved(span(170, (0, 0, -5), (100, 0, -5), 41, EI=3e4))
    x = static.state.shapes[0]
    np.testing.assert_allclose(x[:, 2], x[::-1, 2], atol=1e-7)
    np.testing.assert_allclose(x[:, 0] + x[::-1, 0], 100.0, atol=1e-7)


def test_upside_down_is_the_same_line() -> None:
    _, up = solved(span(170, (0, 0, -55), (100, 0, -5), 40))
    _, down = solved(span(170, (100, 0, -5), (0, 0, -55), 40))
    np.testing.assert_allclose(up.state.shapes[0], down.state.shapes[0][::-1], atol=1e-6)
