"""The vessel in time: free decay, the memory of radiation, small waves against the frequency domain."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from solver.case import parse_case
from solver.frequency_domain.solve import FrequencyResult, solve_frequency_domain
from solver.model.build import build
from solver.run import run
from solver.statics.solve import solve_statics
from solver.vessel.data import FileSource
from tests.systems import EXAMPLES, Source, example, moored_box
from tests.time_domain.systems import block_of, marched, timed, wilson

Array = np.ndarray


def _on_springs() -> dict[str, Any]:
    """A box held by linear springs, and one slack string that weighs and pulls next to nothing."""
    data = moored_box(4, 1)
    stiffness = np.diag([3e5, 4e5, 0.0, 0.0, 0.0, 9e7])
    data["vessel"]["line_coefficients"] = {"stiffness": stiffness.tolist()}
    data["vessel"]["damping"] = {"linear": {"surge": 1.5e5, "heave": 1e6, "pitch": 2e8, "yaw": 2e7}}
    data["vessel"]["fairlead_kinematics"] = "linear"
    nothing = {"normal": 0, "tangential": 0}
    string = {"diameter": 1e-3, "mass": 2e-3, "EA": 10.0, "EI": 0.0, "drag": nothing, "added_mass": nothing}
    data["line_types"]["chain"] = string
    data["lines"]["line-0"]["end_a"] = {"pinned": [300.0, 9.0, -60.0]}
    data["lines"]["line-0"]["segments"][0]["length"] = 345.0
    data["environment"]["seabed"] = {"node_stiffness": 1.0}
    return data


@pytest.mark.parametrize(("dof", "start"), [(0, 2.0), (2, 0.5), (4, 0.03), (5, 0.1)])
def test_free_decay_on_linear_springs(dof: int, start: float) -> None:
    h, steps = 0.1, 600
    block = block_of(timed(_on_springs(), step=h, build_up=0, duration=steps * h, output_step=h))
    body = block.setup.body
    omega = np.sqrt(body.K[dof, dof] / body.M[dof, dof])
    ratio = body.B[dof, dof] / (2 * omega * body.M[dof, dof])
    assert ratio > 0.001
    block.state.s[0, dof] = start
    block.state.sa[0, dof] = -(omega**2) * start
    points = block.state.x.copy()
    block.go(1)  # the string follows from its first step
    assert np.isfinite(points).all()
    block.go(steps)
    found = block.out[0][:, 0, dof]
    expected = wilson(omega, ratio, h, start, steps)[1:]
    np.testing.assert_allclose(found, expected, atol=2e-4 * start)
    # and the exact decay, within the second order of the scheme
    t = h * np.arange(1, steps + 1)
    fast = omega * np.sqrt(1 - ratio**2)
    exact = start * np.exp(-ratio * omega * t) * (np.cos(fast * t) + ratio * omega / fast * np.sin(fast * t))
    assert np.abs(found - exact).max() < 0.6 * (omega * h) ** 2 * omega * t[-1] * start


def _harmonic(radiation: dict[str, Any], period: float, height: float, drag: bool, **spec: Any) -> dict[str, Any]:
    """The moored box in a regular wave; without drag only the size of rotations is nonlinear."""
    data = moored_box(8, 3, mean_drift="exclude", hydrodynamics={"data": "box.nc", "drift": "none", **radiation})
    data["vessel"]["damping"] = {
        "linear": {"surge": 4e5, "sway": 4e5, "heave": 2e6, "roll": 1e8, "pitch": 5e8, "yaw": 8e7}
    }
    data["environment"]["seastates"] = [{"wave": "regular", "height": height, "period": period, "direction": "200 deg"}]
    if not drag:
        data["line_types"]["chain"]["drag"] = {"normal": 0.0, "tangential": 0.0}
    wave = {"from": 0.3, "to": 1.5, "step": 0.08}
    data["analyses"] = {
        "frequency_domain": {"wave": wave, "low": {"to": 0.3}, "tolerance": 1e-7, "max_iterations": 300}
    }
    step = 0.05
    return timed(data, step=step, build_up=40 * period, duration=10 * period, output_step=step, **spec)


def _linear(data: dict[str, Any], source: Source) -> FrequencyResult:
    model = build(parse_case(data), source)
    spec = model.case.analyses.frequency_domain
    assert spec is not None
    return solve_frequency_domain(model, solve_statics(model), spec)


def _phasor(history: Array, step: float, omega: float) -> Array:
    t = step * np.arange(1, history.shape[0] + 1)
    basis = np.stack([np.ones_like(t), np.cos(omega * t), -np.sin(omega * t)], axis=1)
    found, *_ = np.linalg.lstsq(basis, history.reshape(t.size, -1).astype(float), rcond=None)
    return (found[1] + 1j * found[2]).reshape(history.shape[1:])


@pytest.mark.slow
@pytest.mark.parametrize("period", [6.0, 9.0, 14.0])
@pytest.mark.parametrize("radiation", [{"radiation": "constant", "frequency": 0.5}, {"radiation": "cummins"}])
def test_forced_motion_is_the_transfer_function_in_amplitude_and_phase(
    radiation: dict[str, Any], period: float, source: Source
) -> None:
    data = _harmonic(radiation, period, 0.01, False)
    linear = _linear(data, source)
    assert linear.wave.vessel is not None
    expected = linear.wave.vessel[0, :, 0]
    record, timing = marched(data, source)
    found = _phasor(record.vessel[:, 0], timing.h * timing.every, 2 * np.pi / period)
    for dofs in ((0, 1, 2), (3, 4, 5)):
        size = np.abs(expected[list(dofs)]).max()
        for dof in dofs:
            if np.abs(expected[dof]) > 0.05 * size:
                assert abs(found[dof]) == pytest.approx(abs(expected[dof]), rel=0.01), dof
                assert abs(np.angle(found[dof] / expected[dof])) < 0.01, dof


@pytest.mark.slow
def test_line_tension_of_a_moored_box_in_small_waves(source: Source) -> None:
    data = _harmonic({"radiation": "cummins"}, 9.0, 0.02, True)
    linear = _linear(data, source)
    record, timing = marched(data, source)
    for k in range(3):
        expected = np.abs(linear.wave.tension[k][0, :, 0])
        found = np.abs(_phasor(record.tension[:, :, k, 0], timing.h * timing.every, 2 * np.pi / 9.0))
        gap = np.abs(found / expected - 1)
        assert gap.mean() < 0.02, k
        assert gap.max() < 0.10, k


@pytest.mark.slow
def test_the_storm_fpso_in_a_wave_of_four_centimetres() -> None:
    """Motions within half a per cent and tensions within one; at 0.4 m drag's third power shows in the cancelled surge."""
    period, out = 12.0, 0.2
    data = example("fpso-2000m")
    for line in data["lines"].values():
        line["segments"][0]["elements"] = 20
    data["environment"]["seastates"] = [{"wave": "regular", "height": 0.04, "period": period, "direction": "202.5 deg"}]
    data["analyses"] = {"frequency_domain": {"tolerance": 1e-7, "max_iterations": 300}}
    data = timed(data, step=0.05, build_up=1200.0, duration=240.0, output_step=out, tolerance=1e-8)
    linear = _linear(data, FileSource(EXAMPLES))
    assert linear.wave.vessel is not None
    record, _ = marched(data, FileSource(EXAMPLES))
    omega = 2 * np.pi / period
    found, expected = _phasor(record.vessel[:, 0], out, omega), linear.wave.vessel[0, :, 0]
    np.testing.assert_allclose(np.abs(found), np.abs(expected), rtol=0.005)
    for dofs in (slice(0, 3), slice(3, 6)):  # surge nearly cancels here: its phase is held against the heave
        assert np.abs(found - expected)[dofs].max() < 2e-3 * np.abs(expected)[dofs].max()
    for k in range(4):
        tension = np.abs(linear.wave.tension[k][0, :, 0])
        np.testing.assert_allclose(np.abs(_phasor(record.tension[:, :, k, 0], out, omega)), tension, rtol=0.01)


def test_free_decay_with_quadratic_damping_and_finite_fairleads_against_an_ode_solver(source: Source) -> None:
    """A box on one taut, weightless line and springs, released far out in sway and yaw: scipy's DOP853 on six equations."""
    data = _on_springs()
    data["vessel"]["fairlead_kinematics"] = "finite"
    data["vessel"]["damping"]["quadratic"] = {"surge": 3e5, "sway": 6e5, "yaw": 5e8}
    data["lines"]["line-0"]["segments"][0] |= {"length": 328.0, "elements": 1}
    data["lines"]["line-0"]["allow_stretch"] = True
    data["line_types"]["chain"]["EA"] = 4e7
    h, steps = 0.02, 2000
    block = block_of(timed(data, step=h, build_up=0, duration=steps * h, output_step=h))
    body, lines = block.setup.body, block.setup.lines
    anchor, arrays = block.state.x[0, :, 0].copy(), block.run.static.lines[0].arrays
    point, arm = body.point[:, 0].copy(), lines.arm[:, 0].copy()

    def load(s: Array, v: Array) -> Array:
        r = Rotation.from_rotvec(s[3:]).apply(arm)
        d = anchor - (point + s[:3] + r - arm)
        length = np.linalg.norm(d)
        pull = arrays.EA[0] * max(length / arrays.L[0] - 1, 0.0) * d / length  # slack, it does not push
        pull[2] -= 0.5 * (arrays.w_dry[0] - arrays.b_wet[0])
        line = 2 * np.concatenate([pull, np.cross(r, pull)])
        return np.asarray(line + body.steady - body.K @ s - body.B @ v - body.quadratic * np.abs(v) * v)

    inverse = np.linalg.inv(body.M)
    start = np.array([0.0, 6.0, 0.0, 0.0, 0.0, 0.25])
    block.state.s[0] = start
    block.state.sa[0] = inverse @ load(start, np.zeros(6))
    found = solve_ivp(
        lambda _t, y: np.concatenate([y[6:], inverse @ load(y[:6], y[6:])]), (0, steps * h),
        np.concatenate([start, np.zeros(6)]), "DOP853", rtol=1e-9, atol=1e-9, t_eval=h * np.arange(1, steps + 1),
    )  # fmt: skip
    block.go(steps)
    gap = np.abs(block.out[0][:, 0] - found.y[:6].T).max(axis=0)
    size = np.abs(found.y[:6]).max(axis=1)
    assert size[0] > 0.05  # the turning arm pulls it along
    for dofs in (slice(0, 3), slice(3, 6)):
        assert gap[dofs].max() < 5e-3 * size[dofs].max()


def test_quadratic_damping_that_a_static_yaw_does_not_turn_is_said() -> None:
    for surge, load, count in ((1e5, 4e6, 1), (8e5, 4e6, 0), (1e5, 4e5, 0)):
        data = _on_springs()
        data["vessel"]["damping"]["quadratic"] = {"surge": surge, "sway": 8e5}
        data["vessel"]["constant_load"] = {"yaw": load}
        data["analyses"] = {}
        result = run(parse_case(timed(data, step=0.1, build_up=0, duration=1, output_step=0.1)), None, threads=1)
        assert result.failures == {}
        assert len([text for text in result.summary["warnings"] if "damping.quadratic" in text]) == count
