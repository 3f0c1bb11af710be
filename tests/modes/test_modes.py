"""Modes against closed forms and one dense eigenvalue problem; equivalent coefficients against the coupled system."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import jn_zeros

from solver.case import parse_case
from solver.model.build import build
from solver.modes.equivalent import quasi_static
from solver.results.solved import ModesResult
from solver.run import natural_modes, run
from solver.statics.solve import solve_statics
from tests.frequency_domain.conftest import coupled, sea
from tests.systems import STIFFNESS, blocks, dense, moored_box, order, span


def _modes(data: dict[str, Any], count: int = 8, source: Any = None) -> ModesResult:
    data = copy.deepcopy(data)
    data["analyses"] = {"statics": {"tolerance": 1e-10}, "modes": {"count": count}}
    model = build(parse_case(data), source)
    return natural_modes(model, solve_statics(model), None, count)


def test_a_tight_string_has_its_overtones() -> None:
    """ω_n = (nπ/L) √(T/m), in plane and out of plane, with the mass of the water that moves along; second order in size."""
    m = 5.0 + 1000 * np.pi * 0.05**2 / 4  # added mass coefficient 1
    gaps = []
    for elements in (20, 40, 80):
        data = span(100.0, (0, 0, -50), (100.2, 0, -50), elements, mass=5.0, diameter=0.05, EA=1e8)
        data["lines"]["line"]["allow_stretch"] = True
        data["environment"]["water"]["gravity"] = 1e-6
        found = _modes(data, 6)
        T, stretched = 1e8 * (100.2 / 100.0 - 1), 100.2
        # mass per stretched length; the unstretched line carries it
        expected = np.sqrt(T / (m * 100.0 / stretched)) * np.pi / stretched * np.array([1, 1, 2, 2, 3, 3])
        omega = np.array([mode.omega for mode in found.modes])
        gaps.append(np.abs(omega / expected - 1)[:2].max())
        np.testing.assert_allclose(omega[::2], omega[1::2], rtol=1e-6)  # the string does not know its directions
        if elements == 80:
            np.testing.assert_allclose(omega, expected, rtol=1e-3)
    assert 1.8 < -order([20, 40, 80], gaps) < 2.2


def test_a_hanging_chain_swings_at_the_zeros_of_the_bessel_function() -> None:
    """ω_n = ½ j0_n √(g/L); the lower end is free in effect: a very soft tail without weight holds it."""
    L = 100.0
    data = span(L, (0, 0, -900), (0, 0, -5), 100, depth=1000.0, mass=200.0, diameter=1e-3, EA=1e9)
    data["line_types"]["tail"] = {"diameter": 1e-4, "mass": 1e-4, "EA": 1.0}
    data["lines"]["line"]["segments"] = [
        {"type": "tail", "length": 790.0, "elements": 1}, {"type": "wire", "length": L, "elements": 100},
    ]  # fmt: skip
    data["lines"]["line"]["allow_stretch"] = True
    found = _modes(data, 12)
    omega = np.array([mode.omega for mode in found.modes])
    expected = 0.5 * jn_zeros(0, 3) * np.sqrt(9.807 / L)
    for value in expected[:3]:
        assert np.min(np.abs(omega / value - 1)) < 4e-3, (omega, value)


def _matrix(**diagonal: float) -> list[list[float]]:
    names = ("surge", "sway", "heave", "roll", "pitch", "yaw")
    return [[diagonal.get(a, 0.0) if a == b else 0.0 for b in names] for a in names]


def _sprung() -> dict[str, Any]:
    return {
        "slowdrift": 1, "name": "sprung", "environment": {"depth": 100},
        "vessel": {
            "mass": 7.4e6, "centre_of_gravity": [0, 0, 2], "radii_of_gyration": [8, 16, 17],
            "hydrostatics": {"stiffness": STIFFNESS},
            "damping": {"linear": {"surge": 5e4, "yaw": 1e7}},
            "line_coefficients": {"stiffness": _matrix(surge=2e5, sway=3e5, yaw=2e8),
                                  "inertia": _matrix(surge=4e5, yaw=1e8),
                                  "damping": _matrix(surge=3e4, sway=6e4)},
        },
        "analyses": {"modes": {"count": 6}},
    }  # fmt: skip


def test_a_sprung_vessel_has_textbook_periods_and_damping() -> None:
    found = _modes(_sprung(), 6).modes
    by = {mode.label: mode for mode in found}
    m, yaw = 7.4e6, 7.4e6 * 17**2
    for label, mass, stiffness, damping in (
        ("surge", m + 4e5, 2e5, 8e4), ("sway", m, 3e5, 6e4), ("yaw", yaw + 1e8, 2e8, 1e7), ("heave", m, 1.2e7, 0.0),
        ("roll", m * 64, 4e8, 0.0), ("pitch", m * 256, 3.6e9, 0.0),
    ):  # fmt: skip
        mode = by[label]
        assert mode.omega == pytest.approx(np.sqrt(stiffness / mass), rel=1e-12)
        assert mode.damping_vessel + mode.damping_lines == pytest.approx(
            damping / (2 * np.sqrt(stiffness * mass)), rel=1e-10
        )
    assert [mode.period for mode in found] == sorted((mode.period for mode in found), reverse=True)


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
@pytest.mark.parametrize("elements", [4, 12])
def test_coupled_modes_are_those_of_one_dense_system(kinematics: str, elements: int, source) -> None:  # type: ignore[no-untyped-def]
    data = coupled([sea()], elements, 4)
    data["vessel"]["fairlead_kinematics"] = kinematics
    data["analyses"]["modes"] = {"count": 10}
    model = build(parse_case(data), source)
    static = solve_statics(model)
    from solver.frequency_domain.solve import solve_frequency_domain

    result = solve_frequency_domain(model, static, model.case.analyses.frequency_domain)  # type: ignore[arg-type]
    found = natural_modes(model, static, result, 10)
    body, position = static.body, result.static.position
    assert body is not None
    assert model.vessel is not None
    sizes = [g.x.size - 6 for g in result.geometries]
    total = sum(sizes)
    K, M, B = (np.zeros((total + 6,) * 2) for _ in range(3))
    stiffness = body.stiffness(position)
    for g, G, damping, force, first in zip(result.geometries, result.couplings, result.linear.damping,
                                           result.static.state.end_forces, np.cumsum([0, *sizes[:-1]]), strict=True):  # fmt: skip  # noqa: E501
        T = np.zeros((g.x.size, total + 6))
        T[3:-3, first : first + g.x.size - 6] = np.eye(g.x.size - 6)
        T[-3:, total:], T[:3, total:] = G[:3], G[3:]
        n = g.line.multiplicity
        K += n * T.T @ dense(g.K) @ T
        M += n * T.T @ blocks(g.M) @ T
        B += n * T.T @ blocks(damping) @ T
        stiffness = stiffness + n * body.geometric(position, g.line.end_b.arm, force[:3])
    lines = M.copy()
    K[total:, total:] += stiffness
    K = 0.5 * (K + K.T)
    A, radiation = model.vessel.radiation.at(np.array([0.5]))
    own = model.vessel.damping + radiation[0]
    M[total:, total:] += model.vessel.mass + 0.5 * (A[0] + A[0].T)
    values, vectors = eigh(K, M)
    for k, mode in enumerate(found.modes):
        assert mode.omega**2 == pytest.approx(values[k], rel=1e-7)
        phi = mode.shape
        assert phi @ M @ phi == pytest.approx(1.0, rel=1e-9)
        assert (
            np.linalg.norm(K @ phi - mode.omega**2 * M @ phi) < 1e-6 * np.linalg.norm(K @ phi) + 1e-9 * np.abs(K).max()
        )
        gap = np.min(np.abs(np.delete(values, k) / values[k] - 1))
        if gap > 1e-3:
            assert abs(vectors[:, k] @ M @ phi) == pytest.approx(1.0, abs=1e-6)
            assert mode.mass_lines == pytest.approx(vectors[:, k] @ lines @ vectors[:, k], rel=1e-5)
            assert mode.damping_lines == pytest.approx(vectors[:, k] @ B @ vectors[:, k] / (2 * mode.omega), rel=1e-5)
            v = vectors[total:, k]
            assert mode.damping_vessel == pytest.approx(v @ own @ v / (2 * mode.omega), rel=1e-5, abs=1e-12)


def test_each_mode_has_its_own_added_mass(source) -> None:  # type: ignore[no-untyped-def]
    data = coupled([sea()], 5, 4)
    data["vessel"]["hydrodynamics"] = {"data": "box.nc", "radiation": "cummins"}
    data["analyses"] = {"modes": {"count": 8}, "statics": {}}
    model = build(parse_case(data), source)
    static = solve_statics(model)
    found = natural_modes(model, static, None, 8)
    assert model.vessel is not None
    seen = set()
    for mode in found.modes:
        s = mode.shape[-6:]
        own = model.vessel.mass + model.vessel.radiation.at(np.array([mode.omega]))[0][0]
        own = 0.5 * (own + own.T)
        assert s @ own @ s + mode.mass_lines == pytest.approx(1.0, rel=1e-7)
        seen.add(round(mode.period, 6))
    assert len(seen) == len(found.modes), "a mode was found twice"


def test_modes_of_two_alike_lines_are_all_there() -> None:
    found = _modes(moored_box(6, 4), 14)
    periods = np.array([mode.period for mode in found.modes])
    assert periods.size == 14
    assert np.all(np.diff(periods) <= 1e-9)
    gram = np.array([[a.shape @ b.shape for a in found.modes] for b in found.modes])
    size = np.sqrt(np.diag(gram))
    assert np.linalg.matrix_rank(gram / np.outer(size, size), tol=1e-6) == 14


def test_line_shapes_follow_the_vessel_at_the_fairlead() -> None:
    data = moored_box(6, 4)
    found = _modes(data, 6)
    for k, mode in enumerate(found.modes):
        s = mode.shape[-6:]
        for shape, line in zip(found.shapes, data["lines"].values(), strict=True):
            arm = np.array(line["end_b"]["fairlead"])
            np.testing.assert_allclose(shape[k, -1], s[:3] + np.cross(s[3:], arm), atol=1e-9 * np.abs(s).max() * 30)
            np.testing.assert_allclose(shape[k, 0], 0.0, atol=1e-12)


def test_quasi_static_shape_is_in_balance() -> None:
    model = build(parse_case(moored_box(9, 3)), None)
    static = solve_statics(model)
    from solver.model.linear import line_geometry

    g = line_geometry(static.lines[0], static.state.shapes[0])
    shape, stiffness = quasi_static(g)
    force = dense(g.K) @ shape.reshape(-1, 6)
    assert np.abs(force[3:-3]).max() < 1e-9 * np.abs(force).max()
    np.testing.assert_allclose(np.vstack([force[-3:], force[:3]]), stiffness, atol=1e-9 * np.abs(stiffness).max())


def test_an_uncoupled_run_with_the_equivalent_coefficients_keeps_the_slow_modes(source) -> None:  # type: ignore[no-untyped-def]
    """Lines replaced by their 6×6 inertia, damping, stiffness: periods within 1 %, damping within 5 %."""
    data = coupled([sea()], 12, 4)
    data["vessel"]["fairlead_kinematics"] = "linear"
    data["analyses"]["modes"] = {"count": 6}
    whole = run(parse_case(data), source).summary
    coefficients = whole["line_coefficients"]
    alone = copy.deepcopy(data)
    alone["lines"], alone["line_types"] = {}, {}
    alone["vessel"]["line_coefficients"] = {key: coefficients[key] for key in ("inertia", "damping", "stiffness")}
    single = run(parse_case(alone), source).summary
    assert not single["failures"], single["failures"]
    for label in ("surge", "sway", "yaw"):
        a = next(mode for mode in whole["modes"] if mode["label"] == label)
        b = next(mode for mode in single["modes"] if mode["label"] == label)
        assert b["period"] == pytest.approx(a["period"], rel=0.01)
        total_a, total_b = (m["damping_vessel"] + m["damping_lines"] for m in (a, b))
        assert total_b == pytest.approx(total_a, rel=0.05)
    low, low_ = whole["frequency_domain"]["vessel_std"]["lf"], single["frequency_domain"]["vessel_std"]["lf"]
    for label in ("surge", "sway", "yaw"):
        assert low_[label] == pytest.approx(low[label], rel=0.05)
