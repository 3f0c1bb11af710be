"""Vessel and lines together: stiffness, symmetry, turning, trim, and the stiffness of pretension under rotation."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from solver.model.body import rotation
from solver.model.linear import line_geometry
from solver.modes.equivalent import quasi_static
from solver.statics.newton import State, equilibrium, vessel_coupling
from tests.systems import STIFFNESS, dense, moored_box, solved


def _tangent(static, model) -> np.ndarray:  # type: ignore[no-untyped-def]
    """Stiffness of everything against vessel motion, by condensation of dense line matrices."""
    body, position = static.body, static.position
    total = body.stiffness(position)
    for line, x, force in zip(static.lines, static.state.shapes, static.state.end_forces, strict=True):
        K = dense(line_geometry(line, x).K)
        inner = np.arange(3, K.shape[0] - 3)
        ends = np.r_[np.arange(K.shape[0] - 3, K.shape[0]), np.arange(3)]
        Kc = K[np.ix_(ends, ends)] - K[np.ix_(ends, inner)] @ np.linalg.solve(
            K[np.ix_(inner, inner)], K[np.ix_(inner, ends)]
        )
        G = vessel_coupling(line, body, position)
        total = total + line.multiplicity * (G.T @ Kc @ G + body.geometric(position, line.end_b.arm, force[:3]))
    return total


@pytest.mark.parametrize("kinematics", ["finite", "linear"])
def test_a_small_constant_load_is_stiffness_times_offset(kinematics: str) -> None:
    model, rest = solved(moored_box(fairlead_kinematics=kinematics))
    K = _tangent(rest, model)
    for dof, load in (("surge", 2e3), ("sway", 2e3), ("yaw", 2e4), ("heave", 1e4), ("roll", 1e5), ("pitch", 1e6)):
        _, moved = solved(moored_box(fairlead_kinematics=kinematics, constant_load={dof: load}))
        expected = np.linalg.solve(K, load * np.eye(6)[["surge", "sway", "heave", "roll", "pitch", "yaw"].index(dof)])
        np.testing.assert_allclose(moved.position, expected, atol=3e-3 * np.abs(expected).max(), err_msg=dof)


def test_the_offset_nears_the_linear_one_with_first_order() -> None:
    model, rest = solved(moored_box())
    K = _tangent(rest, model)
    gaps = []
    for load in (4e4, 2e4, 1e4):
        _, moved = solved(moored_box(constant_load={"surge": load, "sway": 0.5 * load}))
        expected = np.linalg.solve(K, [load, 0.5 * load, 0, 0, 0, 0])
        gaps.append(np.abs(moved.position[:2] / expected[:2] - 1).max())
    assert gaps[2] < 0.6 * gaps[1] < 0.36 * gaps[0] * 1.2


@pytest.mark.parametrize("yaw_moment", [0.0, 6e6])
def test_k_g_is_the_derivative_of_the_turned_fairlead_loads(yaw_moment: float) -> None:
    """Loads on the vessel, each line solved anew with its fairlead rigidly turned, against K_lines + K_g."""
    _, static = solved(moored_box(8, 3, constant_load={"surge": 3e5, "yaw": yaw_moment}))
    body, position = static.body, static.position
    assert body is not None
    exact = np.zeros((6, 6))
    for line, x, force in zip(static.lines, static.state.shapes, static.state.end_forces, strict=True):
        _, Kc = quasi_static(line_geometry(line, x))
        G = vessel_coupling(line, body, position)
        exact += line.multiplicity * (G.T @ Kc @ G + body.geometric(position, line.end_b.arm, force[:3]))

    def load(step: np.ndarray) -> np.ndarray:
        out = np.zeros(6)
        for line, x in zip(static.lines, static.state.shapes, strict=True):
            arm = rotation(step[3:]) @ rotation(position[3:]) @ line.end_b.arm
            shape = x.copy()
            shape[-1] = body.cg + position[:3] + step[:3] + arm
            held = equilibrium([line], State([shape], np.zeros(6)), [np.zeros_like(x)], None, 1e-12, 200)
            f = held.end_forces[0][:3]
            out += line.multiplicity * np.concatenate([f, np.cross(arm, f)])
        return out

    for dof, h in enumerate([1e-3] * 3 + [1e-5] * 3):
        step = h * np.eye(6)[dof]
        numeric = -(load(step) - load(-step)) / (2 * h)
        scale = np.abs(np.diag(exact)).max() if dof > 2 else np.abs(exact[:, :3]).max()
        np.testing.assert_allclose(exact[:, dof], numeric, atol=2e-6 * scale, err_msg=str(dof))
    if yaw_moment:
        assert abs(position[5]) > 0.01


def test_linear_kinematics_leave_k_g_out() -> None:
    _, static = solved(moored_box(fairlead_kinematics="linear"))
    assert static.body is not None
    assert not np.any(static.body.geometric(static.position, np.ones(3), np.ones(3)))


def test_a_symmetric_mooring_stays_in_place_and_pulls_alike() -> None:
    _, static = solved(moored_box())
    assert np.abs(static.position).max() < 1e-7
    forces = np.array([np.abs(f[:3]) for f in static.state.end_forces])
    np.testing.assert_allclose(forces, np.broadcast_to(forces[0], forces.shape), rtol=1e-7)


def test_balanced_trim_holds_the_draft_and_as_given_lets_the_lines_pull_it_down() -> None:
    _, balanced = solved(moored_box())
    pull = sum(line.multiplicity * f[2] for line, f in zip(balanced.lines, balanced.state.end_forces, strict=True))
    data = moored_box(trim="as_given")
    data["vessel"]["hydrostatics"]["displaced_volume"] = 7.4e6 / 1025.0
    _, given = solved(data)
    assert pull < -1e5
    assert given.position[2] == pytest.approx(pull / STIFFNESS[2][2], rel=0.05)  # lines hang slacker as it sinks
    body = given.body
    assert body is not None
    residual = body.load(given.position)
    for line, f in zip(given.lines, given.state.end_forces, strict=True):
        residual = residual + line.multiplicity * vessel_coupling(line, body, given.position).T @ f
    assert np.abs(residual).max() < 1e-3 * abs(pull)


def _turned(data: dict[str, Any], turn: float) -> dict[str, Any]:
    data = copy.deepcopy(data)
    data["vessel"]["heading"] = f"{turn} deg"
    for line in data["lines"].values():
        anchor = line["end_a"]["anchor"]
        anchor["azimuth"] = f"{float(anchor['azimuth'].split()[0]) + turn} deg"
    if "current" in data["environment"]:
        data["environment"]["current"]["direction"] = (
            f"{float(data['environment']['current']['direction'].split()[0]) + turn} deg"
        )
    load = data["vessel"].get("constant_load")
    if load:
        a = np.radians(turn)
        for x, y in (("surge", "sway"), ("roll", "pitch")):
            p, q = load.get(x, 0.0), load.get(y, 0.0)
            load[x], load[y] = np.cos(a) * p - np.sin(a) * q, np.sin(a) * p + np.cos(a) * q
    return data


@pytest.mark.parametrize("turn", [0.0, 30.0, 145.0])
def test_turning_heading_azimuths_current_and_load_leaves_the_vessels_own_answer(turn: float) -> None:
    data = moored_box(constant_load={"surge": 2e5, "sway": 4e5, "yaw": 3e6})
    data["environment"]["current"] = {"depths": [0, 100], "speeds": [1.0, 0.4], "direction": "70 deg"}
    _, plain = solved(data)
    _, turned = solved(_turned(data, turn))
    np.testing.assert_allclose(turned.position, plain.position, rtol=1e-6, atol=1e-8)
    for a, b in zip(plain.state.end_forces, turned.state.end_forces, strict=True):
        np.testing.assert_allclose(b, a, atol=1e-7 * np.abs(a).max())


def test_a_line_between_two_fairleads_pulls_on_both() -> None:
    data = moored_box()
    data["lines"]["between"] = {
        "segments": [{"type": "chain", "length": 40, "elements": 16}],
        "end_a": {"fairlead": [-10, 9, -4]}, "end_b": {"fairlead": [12, 9, -4]},
    }  # fmt: skip
    _, with_line = solved(data)
    _, without = solved(moored_box())
    w = (140 - 1025 * np.pi * 0.12**2 / 4) * 9.80665 * 40
    f = with_line.state.end_forces[-1]
    assert f[2] + f[5] == pytest.approx(-w, rel=1e-6)
    assert np.abs(f[:2] + f[3:5]).max() < 1e-6 * w
    np.testing.assert_allclose(
        with_line.position, without.position, atol=1e-6
    )  # inner forces; the trim holds its weight


def test_multiplicity_is_so_many_lines() -> None:
    load = {"surge": 3e5, "sway": 1e5}
    _, two = solved(moored_box(8, 3, constant_load=load))
    data = moored_box(8, 3, constant_load=load)
    for name, line in list(data["lines"].items()):
        line["multiplicity"] = 1
        data["lines"][f"{name}-again"] = copy.deepcopy(line)
    _, single = solved(data)
    np.testing.assert_allclose(single.position, two.position, rtol=1e-7, atol=1e-9)
