"""The scheme: exact relations on linear systems, second order, no hidden dissipation, prescribed ends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.model.system import stiffness
from solver.time_domain.block import Block
from tests.systems import dense, order, span
from tests.time_domain.systems import block_of, damping_of_the_scheme, marched, riser, string, timed, wilson

Array = np.ndarray


def _tight(block: Block) -> Block:
    """Converge each step to round-off, so that only the scheme is seen."""
    block.run.limits[:2] *= 1e-5
    return block


def _histories(block: Block, steps: int, look: Any) -> Array:
    out = [look(block)]
    for _ in range(steps):
        block.go(1)
        out.append(look(block))
    return np.array(out)


@pytest.mark.parametrize(("mode", "h"), [(1, 0.05), (1, 0.4), (3, 0.2)])
def test_small_motion_of_a_string_follows_the_scheme_exactly(mode: int, h: float) -> None:
    """A string of N elements and tension T has ω_k = 2 √(T/(m l)) sin(kπ/2N); each mode is a scalar recursion."""
    N, stretch, size = 10, 0.01, 1e-4
    block = _tight(block_of(timed(string(N, stretch), step=h, build_up=0, duration=1000 * h, output_step=h)))
    line = block.run.static.lines[0].arrays
    tension, length = line.EA[0] * stretch, 100.0 / N
    omega = 2 * np.sqrt(tension / (line.node_mass[1] * length)) * np.sin(mode * np.pi / (2 * N))
    shape = np.sin(mode * np.pi * np.arange(N + 1) / N)
    block.state.x[:, 1, 0] += size * shape
    block.state.a[:, 1, 0] = -(omega**2) * size * shape
    middle = int(np.argmax(np.abs(shape)))
    found = _histories(block, 200, lambda b: float(b.state.x[middle, 1, 0]))
    expected = wilson(omega, 0.0, h, size * shape[middle], 200)
    np.testing.assert_allclose(found, expected, atol=2e-5 * size)


def test_damping_ratio_and_period_of_the_scheme_are_of_second_and_third_order() -> None:
    steps = np.array([0.4, 0.2, 0.1, 0.05])
    ratios, growths = np.array([damping_of_the_scheme(1.0, h) for h in steps]).T
    assert order(steps, ratios) == pytest.approx(3.0, abs=0.15)
    assert order(steps, growths) == pytest.approx(2.0, abs=0.1)


def _pendulum(h: float, size: float, angle: float = 0.0, periods: float = 4.0) -> tuple[Array, float, float]:
    """Energy over time of a drag-free line that swings about its two ends in its slowest mode, by `size` [m].

    Returns the energy [J], the period [s] and the energy of the swing. The mode is that of the dense linear system; with an
    angle the whole line is turned about its ends instead, and let go.
    """
    data = span(30.0, (0, 0, -50), (20, 0, -50), 12, 100.0, mass=60.0, diameter=0.1, EA=2e6, EI=0.0,
                drag={"normal": 0, "tangential": 0}, added_mass={"normal": 0, "tangential": 0})  # fmt: skip
    block = _tight(block_of(timed(data, step=h, build_up=0, duration=10000 * h, output_step=h)))
    line, x = block.run.static.lines[0].arrays, block.state.x
    K = dense(stiffness(line, np.ascontiguousarray(x[..., 0]), True))[3:-3, 3:-3]
    values, shapes = np.linalg.eigh(K / line.node_mass[1])
    shape = shapes[:, 0].reshape(-1, 3)
    assert np.abs(shape[:, [0, 2]]).max() < 1e-6  # out of the plane
    y = size * shape[:, 1] / np.abs(shape[:, 1]).max()
    block.state.a[1:-1, 1, 0] = -values[0] * y
    weight = line.w_dry[0] - line.b_wet[0]

    def energy(b: Block) -> float:
        x, v = b.state.x[..., 0], b.state.v[..., 0]
        stretch = np.linalg.norm(np.diff(x, axis=0), axis=1) - line.L
        elastic = 0.5 * (line.EA / line.L * stretch**2).sum()
        return float(elastic + 0.5 * (line.node_mass[:, None] * v**2).sum() + weight * x[1:-1, 2].sum())

    rest = energy(block)
    if angle:
        drop = x[:, 2, 0] + 50.0
        x[:, 1, 0], x[:, 2, 0] = -np.sin(angle) * drop, -50.0 + np.cos(angle) * drop
        block.state.a[:] = 0.0
    else:
        x[1:-1, 1, 0] += y
    period = 2 * np.pi / np.sqrt(values[0])
    found = _histories(block, int(periods * period / h), energy)
    return found - rest, float(period), float(found[0] - rest)


def test_a_drag_free_pendulum_loses_energy_as_the_scheme_is_known_to() -> None:
    for h in (0.2, 0.1):
        energy, period, swing = _pendulum(h, 0.02)
        ratio, growth = damping_of_the_scheme(2 * np.pi / period, h)
        turns = h * (energy.size - 1) / (period * (1 + growth))
        known = 1 - np.exp(-4 * np.pi * ratio * turns)
        assert (energy[0] - energy[-1]) / swing == pytest.approx(known, rel=0.05)


@pytest.mark.slow
def test_what_a_wide_swing_loses_vanishes_with_the_step() -> None:
    """At 25 degrees it also moves along itself, faster; what that loses falls with the step, and nothing is gained."""
    lost = []
    for h in (0.05, 0.025, 0.0125):
        energy, _, swing = _pendulum(h, 0.0, np.radians(25.0))
        assert energy.max() < energy[0] + 2e-3 * swing
        lost.append((energy[0] - energy[-1]) / swing)
    assert lost[0] < 0.02
    assert order([0.05, 0.025, 0.0125], lost) > 1.8


def _end_positions(h: float, drag: float, time: float = 6.0) -> Array:
    """Nodes at a time of a line whose top moves, from rest and without ramp kinks; EA low so that all motion is resolved."""
    data = span(60.0, (0, 0, -50), (40, 0, -20), 8, mass=60.0, diameter=0.2, EA=5e4, EI=0.0,
                drag={"normal": drag, "tangential": 0.2 * drag})  # fmt: skip
    data["lines"]["line"]["end_b"]["motion"] = {"surge": {"amplitude": 1.5, "period": 8.0},
                                                "heave": {"amplitude": 1.0, "period": 8.0, "phase": "50 deg"}}  # fmt: skip
    block = _tight(block_of(timed(data, step=h, build_up=8.0, duration=time, output_step=time)))
    block.go(block.run.total)
    return block.state.x[..., 0].copy()


@pytest.mark.slow
@pytest.mark.parametrize("drag", [0.0, 1.2])
def test_second_order_by_regression(drag: float) -> None:
    steps = [0.08, 0.04, 0.02, 0.01]
    fine, finer = _end_positions(0.0025, drag), _end_positions(0.00125, drag)
    exact = finer + (finer - fine) / 3
    errors = [np.abs(_end_positions(h, drag) - exact).max() for h in steps]
    assert order(steps, errors) == pytest.approx(2.0, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["case1", "case2"])
def test_halving_the_step_changes_nothing_that_matters(name: str) -> None:
    (one, _), (other, _) = marched(riser(name, step=0.04)), marched(riser(name, step=0.02))
    for k in (0, 40, -1):
        a, b = one.tension[:, k, 0, 0], other.tension[:, k, 0, 0]
        assert abs(np.ptp(a) / np.ptp(b) - 1) < (1e-3 if k == -1 else 3e-3)
        assert abs(a.mean() / b.mean() - 1) < 1e-3


def test_prescribed_ends_are_written_not_integrated() -> None:
    data = string(6)
    data["lines"]["line"]["end_b"]["motion"] = {"sway": {"amplitude": 0.5, "period": 5.0, "phase": "30 deg"}}
    h = 0.05
    block = block_of(timed(data, step=h, build_up=10.0, duration=100.0, output_step=h))
    block.go(1400)
    w, t = 2 * np.pi / 5.0, 1400 * h - 10.0
    phase = w * t + np.pi / 6
    x, v, a = (part[-1, 1, 0] for part in (block.state.x, block.state.v, block.state.a))
    expected = 0.5 * np.array([np.cos(phase), -w * np.sin(phase), -w * w * np.cos(phase)])
    np.testing.assert_allclose([x, v, a], expected, atol=1e-12)
    np.testing.assert_array_equal(block.state.x[0, :, 0], [0, 0, -50])


def test_a_line_at_rest_stays_at_rest() -> None:
    data = span(150.0, (0, 0, -100), (90, 20, -5), 15, mass=60.0, EI=2e4)
    record, _ = marched(timed(data, step=0.1, build_up=0, duration=60.0, output_step=1.0))
    spread = np.ptp(record.tension, axis=0) / record.tension.max()
    assert spread.max() < 1e-6
