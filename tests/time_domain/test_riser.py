"""The hanging riser (Low & Langley 2006, section 5) in time, beside two independent codes and the frequency domain.

The independent time integration took deep water. Case 2 in the example's 100 m has water velocities 2.7 % off at its
lower end (kd = 4), and 7 % less half-range in the mean over the line: both are held here.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from solver.frequency_domain.solve import solve_frequency_domain
from solver.time_domain.ensemble import march_ensemble
from solver.time_domain.statistics import first_harmonic
from tests.time_domain.systems import PERIODS, prepared, riser

Array = np.ndarray
DEEP = 1e4
#: periods of build-up until the steady state: little drag, long transients
BUILD_UP = {1.0: 8, 0.3: 8, 0.1: 40, 0.03: 120}


@cache
def _both(name: str, factor: float, depth: float) -> tuple[Array, Array, Array]:
    """Element tensions (n, N) and end tension (n,) of the steady state, and the frequency domain's amplitudes (N,) [N]."""
    period = PERIODS[name]
    build_up = period * (BUILD_UP[factor] if name == "case2" else 8)
    model, static, spec = prepared(riser(name, factor, depth=depth, build_up=build_up))
    frequency = model.case.analyses.frequency_domain
    assert frequency is not None
    linear = solve_frequency_domain(model, static, frequency)
    record, _ = march_ensemble(model, static, spec, [1])
    return record.tension[:, :, 0, 0].astype(float), record.ends[:, 0, 0, 0], np.abs(linear.wave.tension[0][0, :, 0])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "element", "end"), [("case1", (41.18, 51.80), (41.65, 52.30)), ("case2", (42.15, 52.33), (42.5, 52.85))]
)
@pytest.mark.parametrize("depth", [100.0, DEEP])
def test_range_of_the_top_tension(
    name: str, element: tuple[float, float], end: tuple[float, float], depth: float
) -> None:
    tension, reaction, _ = _both(name, 1.0, depth)
    np.testing.assert_allclose([reaction.min() / 1e3, reaction.max() / 1e3], end, atol=0.35)
    exact = 0.01 if depth == DEEP or name == "case1" else 0.1
    np.testing.assert_allclose([tension[:, -1].min() / 1e3, tension[:, -1].max() / 1e3], element, atol=exact)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "depth", "expected"), [("case1", 100.0, 2.39), ("case2", DEEP, 1.97), ("case2", 100.0, 1.825)]
)
def test_half_range_in_the_mean_over_the_line(name: str, depth: float, expected: float) -> None:
    tension, _, _ = _both(name, 1.0, depth)
    assert 0.5 * np.ptp(tension, axis=0).mean() / 1e3 == pytest.approx(expected, abs=0.006)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "factor", "half_range", "harmonic"),
    [
        ("case1", 1.0, 24.5, 11.7), ("case1", 0.3, 9.1, 4.2), ("case1", 0.1, 4.5, 1.3), ("case1", 0.03, 3.3, 0.45),
        ("case2", 1.0, 12.2, 0.8), ("case2", 0.3, 21.9, 1.1), ("case2", 0.1, 27.8, 0.8), ("case2", 0.03, 13.7, 0.4),
    ],
)  # fmt: skip
def test_gap_between_the_domains_by_amplitude(name: str, factor: float, half_range: float, harmonic: float) -> None:
    """Mean over the line [%], against an independent pair of solvers."""
    tension, _, linear = _both(name, factor, DEEP)
    half = 0.5 * np.ptp(tension, axis=0)
    first = first_harmonic(tension, 0.05, 2 * np.pi / PERIODS[name])
    assert 100 * np.abs(linear / half - 1).mean() == pytest.approx(half_range, abs=0.35)
    assert 100 * np.abs(linear / first - 1).mean() == pytest.approx(harmonic, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "depth"), [("case1", 100.0), ("case2", 100.0), ("case2", DEEP)])
def test_at_a_tenth_the_first_harmonic_is_the_frequency_domains(name: str, depth: float) -> None:
    tension, _, linear = _both(name, 0.1, depth)
    gap = np.abs(linear / first_harmonic(tension, 0.05, 2 * np.pi / PERIODS[name]) - 1)
    assert gap.mean() < 0.02
    assert gap.max() < 0.10
