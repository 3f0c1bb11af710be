"""Small motion: the frequency domain against a nonlinear time integration written here (implicit Newmark, full Newton).

As the amplitude shrinks, the first harmonic of the nonlinear steady state nears the linear answer; with a current the
drag is smooth about its mean, so that the gap falls with the second power (component-wise linearisation of drag across
an oblique current would not: the vector form is used there).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.forces import drag
from solver.forces.inertia import blocks as mass_blocks
from solver.frequency_domain.solve import FrequencyResult, solve_frequency_domain
from solver.kernels.line import WIDTH
from solver.model.build import build
from solver.model.system import forces, stiffness
from solver.statics.solve import solve_statics
from solver.waves.kinematics import velocity
from tests.systems import blocks, dense, order, span

PERIOD = 8.0
CYCLES, STEPS = 10, 80


def _case(kind: str, amplitude: float) -> dict[str, Any]:
    data = span(170, (0, 0, -55), (100, 20, -5), 8, mass=60, diameter=0.2, EA=2e6, drag={"normal": 1.2, "tangential": 0.1},
                added_mass={"normal": 1.0, "tangential": 0.1})  # fmt: skip
    data["analyses"] = {"frequency_domain": {"linearisation": "vector", "tolerance": 1e-9, "max_iterations": 400}}
    if kind.startswith("wave"):
        data["environment"]["seastates"] = [
            {"wave": "regular", "height": 2 * amplitude, "period": PERIOD, "direction": "30 deg"}
        ]
    else:
        data["lines"]["line"]["end_b"]["motion"] = {
            "surge": {"amplitude": amplitude, "period": PERIOD},
            "heave": {"amplitude": 0.5 * amplitude, "period": PERIOD, "phase": "60 deg"},
        }  # fmt: skip
    if kind.endswith("current"):
        data["environment"]["current"] = {"depths": [0, 60], "speeds": [1.2, 0.5], "direction": "75 deg"}
    return data


def _linear(data: dict[str, Any]) -> FrequencyResult:
    model = build(parse_case(data), None)
    spec = model.case.analyses.frequency_domain
    assert spec is not None
    return solve_frequency_domain(model, solve_statics(model), spec)


def _harmonics(data: dict[str, Any], about: FrequencyResult) -> tuple[np.ndarray, np.ndarray]:
    """Mean (N+1, 3) and first harmonic, complex (N+1, 3), of the nonlinear steady state of all nodes.

    Mass and water kinematics at the static position, as linearised; everything else nonlinear, periodic for good.
    """
    arrays, x0 = about.geometries[0].line.arrays, about.geometries[0].x
    omega = 2 * np.pi / PERIOD
    M_, C_ = mass_blocks(arrays, x0)
    M, C = blocks(M_), blocks(C_)
    ends = about.driver.wave.loads.ends[0]
    phasor = ends[0, :, 0] if ends is not None else np.zeros(6, dtype=complex)
    seas = data["environment"].get("seastates")
    u_ = np.zeros(x0.shape, dtype=complex)
    if seas:
        u_ = 0.5 * seas[0]["height"] * velocity(np.array([omega]), np.radians(30.0), x0, 100.0, 9.807)[0]
    inner = np.arange(3, x0.size - 3)
    h = PERIOD / STEPS
    x, v, a = x0.copy(), np.zeros_like(x0), np.zeros_like(x0)
    total = np.zeros((STEPS, *x0.shape))
    still = np.zeros_like(x0)
    for step in range(1, CYCLES * STEPS + 1):
        t = step * h
        ramp = min(t / (3 * PERIOD), 1.0) ** 2 * (3 - 2 * min(t / (3 * PERIOD), 1.0))
        turn = ramp * np.exp(1j * omega * t)
        u, du = (u_ * turn).real, (1j * omega * u_ * turn).real
        end = (phasor * turn).real
        xn = x + h * v + 0.25 * h * h * a  # average acceleration
        guess = xn + 0.25 * h * h * a
        guess[-1], guess[0] = x0[-1] + end[:3], x0[0] + end[3:]
        ve = (1j * omega * phasor * turn).real
        for _ in range(30):
            an = (guess - xn) * 4 / (h * h)
            vn = v + 0.5 * h * (a + an)
            vn[-1], vn[0] = ve[:3], ve[3:]
            F = forces(arrays, guess, vn, u, still).ravel() + C @ du.ravel() - M @ an.ravel()
            K, B = stiffness(arrays, guess, True), np.zeros((x0.size, WIDTH))
            drag.tangent(arrays, guess, vn, u, np.zeros_like(K), B)
            J = dense(K) + 4 / (h * h) * M + 2 / h * dense(B)
            step_ = np.linalg.solve(J[np.ix_(inner, inner)], F[inner])
            guess.ravel()[inner] += step_
            if np.abs(step_).max() < 1e-11:
                break
        an = (guess - xn) * 4 / (h * h)
        an[-1], an[0] = 0.0, 0.0
        v = v + 0.5 * h * (a + an)
        x, a = guess, an
        v[-1], v[0] = ve[:3], ve[3:]
        if step > (CYCLES - 1) * STEPS:
            total[(step - 1) % STEPS] = x
    phases = np.exp(-1j * omega * h * np.arange(1, STEPS + 1))
    return total.mean(axis=0), 2 * np.einsum("t,tip->ip", phases, total - total.mean(axis=0)) / STEPS


def _displacement(result: FrequencyResult, discrete: bool) -> np.ndarray:
    """Complex node displacements, recovered from a dense solve of the converged linear system.

    discrete : with the velocity iŵy and acceleration -ŵ²y that the scheme's steps give, ŵ = (2/h) tan ωh/2, so that
    the step does not hide the limit; without, the tensions of the analysis itself are checked.
    """
    g, B = result.geometries[0], result.linear.damping[0]
    omega = 2 * np.pi / PERIOD
    scheme = 2 * STEPS / PERIOD * np.tan(np.pi / STEPS) if discrete else omega
    D = dense(g.K) - scheme**2 * blocks(g.M) + 1j * scheme * blocks(B)
    water = result.driver.wave.loads.water[0]
    u = (water.real + 1j * water.imag)[0, ..., 0].ravel() if water.real.shape[0] else np.zeros(g.x.size)
    load = (blocks(B) + 1j * omega * blocks(g.C)) @ u
    y = np.zeros(g.x.size, dtype=complex)
    ends = result.driver.wave.loads.ends[0]
    if ends is not None:
        y[-3:], y[:3] = ends[0, :3, 0], ends[0, 3:, 0]
    inner = np.arange(3, g.x.size - 3)
    y[inner] = np.linalg.solve(D[np.ix_(inner, inner)], load[inner] - D[inner] @ y)
    if not discrete:
        t = np.diff(g.x, axis=0) / np.linalg.norm(np.diff(g.x, axis=0), axis=1)[:, None]
        tension = np.einsum("jp,jp->j", t, np.diff(y.reshape(-1, 3), axis=0)) * g.line.arrays.EA / g.line.arrays.L
        np.testing.assert_allclose(result.wave.tension[0][0, :, 0], tension, atol=1e-8 * np.abs(tension).max())
    return y.reshape(-1, 3)


def _gap(data: dict[str, Any]) -> float:
    linear = _linear(data)
    _, first = _harmonics(data, linear)
    plain, stepped = _displacement(linear, False), _displacement(linear, True)
    assert np.abs(plain - stepped).max() < 1e-2 * np.abs(plain).max()
    return float(np.abs(first - stepped)[1:-1].max() / np.abs(plain).max())


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["motion current", "wave current"])
def test_small_motion_in_a_current_nears_the_nonlinear_first_harmonic(kind: str) -> None:
    amplitudes = [0.8, 0.4, 0.2, 0.1]
    gaps = [_gap(_case(kind, amplitude)) for amplitude in amplitudes]
    assert order(amplitudes, gaps) > 0.9, gaps
    assert gaps[-1] < 3e-4, gaps


@pytest.mark.parametrize("kind", ["motion", "wave"])
def test_in_still_water_the_describing_function_serves(kind: str) -> None:
    """Without a current the drag of small motion stays quadratic: its third harmonic is left out, a few percent."""
    data = _case(kind, 0.1)
    data["line_types"]["wire"]["drag"] = {"normal": 12.0, "tangential": 1.0}
    assert _gap(data) < 0.03
