"""Retardation functions against a memory known in closed form, and what is said when the data fall short."""

import dataclasses

import numpy as np
import pytest

from solver.case.vessel import Hydrodynamics
from solver.outcome import DataError
from solver.vessel.data import read_bytes
from solver.vessel.radiation import make_radiation, misfit, retardation
from solver.vessel.rigid import turned

from . import synthetic

# K(t) = K0 e^{-at} (cos bt + s sin bt - r), with ∫K = 0 and K'(0) = 0 as a body's memory has
A, B = 0.18, 0.7
R = 2 * A**2 / (2 * A**2 + B**2)
S = A * (1 - R) / B
PEAK = np.diag([1.0, 3.0, 5.0, 4e2, 3e3, 9e2]) * 1e6
PEAK[1, 3] = PEAK[3, 1] = -2e7
INFINITE = 40.0 * PEAK
CUMMINS = Hydrodynamics(data="x.nc", radiation="cummins")


def memory(t):
    return np.exp(-A * t) * (np.cos(B * t) + S * np.sin(B * t) - R)


def law(omega):
    """A(ω), B(ω) of that memory, (W, 6, 6), by its Laplace transform."""
    s = 1j * np.asarray(omega)
    image = ((s + A) + S * B) / ((s + A) ** 2 + B**2) - R / (s + A)
    return INFINITE + (image.imag / omega)[:, None, None] * PEAK, image.real[:, None, None] * PEAK


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    return read_bytes(synthetic.to_bytes(synthetic.dataset(), tmp_path_factory.mktemp("radiation")), "barge.nc")


def with_law(base, omega, infinite=True):
    added_mass, damping = law(omega)
    zero = law(np.array([1e-6]))[0][0]
    resized = np.repeat(base.excitation[:1], omega.size, axis=0)
    return dataclasses.replace(
        base, omega=omega, added_mass=added_mass, damping=damping, excitation=resized, mean_drift=None,
        added_mass_zero=zero, added_mass_infinite=INFINITE if infinite else None,
    )  # fmt: skip


@pytest.fixture(scope="module")
def wide(base):
    return with_law(base, np.arange(1, 101) * 0.02)


def test_the_memory_is_recovered(wide):
    kernel, warnings = retardation(wide)
    assert warnings == ()
    body = kernel.times < 0.8 * kernel.times[-1]
    gap = kernel.kernel[body, 2, 2] / PEAK[2, 2] - memory(kernel.times[body])
    assert np.abs(gap).max() < 0.01  # the damping beyond 2 rad/s is a guess: it holds 1 % of K(0)
    assert np.abs(gap[kernel.times[body] > 4]).max() < 2e-3
    assert np.allclose(kernel.kernel[-1], 0.0)
    assert np.allclose(kernel.kernel[:, 1, 3] * PEAK[1, 1], kernel.kernel[:, 1, 1] * PEAK[1, 3])


def test_the_transform_back_gives_the_law(wide):
    radiation = make_radiation(CUMMINS, wide, low=0.05, high=1.2)
    assert radiation.warnings == ()
    assert radiation.misfit < 0.01
    omega = np.linspace(0.05, 1.2, 77)
    for ours, theirs in zip(radiation.at(omega), law(omega), strict=True):
        assert np.abs((ours - theirs)[:, 2, 2]).max() < 0.01 * np.abs(theirs[:, 2, 2]).max()


def test_the_transform_is_that_of_the_very_kernel(wide):
    """Both domains share K(t): A', B' equal fine quadrature over the piecewise-linear kernel, from ω = 0 up."""
    kernel, _ = retardation(wide)
    t = np.linspace(0.0, kernel.times[-1], 50 * (kernel.times.size - 1) + 1)
    k = kernel.at(t)[:, 2, 2]
    for omega in (1e-4, 0.01, 0.5, 2.0, 5.0):
        added_mass, damping = (part[0, 2, 2] for part in kernel.transform(np.array([omega])))
        assert damping == pytest.approx(np.trapezoid(k * np.cos(omega * t), t), abs=1e-6 * np.abs(k).sum() * t[1])
        sine = np.trapezoid(k * np.sin(omega * t), t) / omega
        assert added_mass - INFINITE[2, 2] == pytest.approx(-sine, abs=1e-6 * INFINITE[2, 2])
    zero = kernel.transform(np.array([0.0]))[0][0, 2, 2]
    assert zero - INFINITE[2, 2] == pytest.approx(-np.trapezoid(k * t, t), rel=1e-5)


def test_force_on_a_harmonic_motion_by_direct_convolution(wide):
    kernel, _ = retardation(wide)
    omega, t = 0.6, 1000.0
    tau = np.linspace(0.0, kernel.times[-1], 20 * (kernel.times.size - 1) + 1)
    memory_force = np.trapezoid(kernel.at(tau)[:, 1, 1] * np.cos(omega * (t - tau)), tau)
    added_mass, damping = (part[0, 1, 1] for part in kernel.transform(np.array([omega])))
    expected = damping * np.cos(omega * t) - omega * (added_mass - INFINITE[1, 1]) * np.sin(omega * t)
    assert memory_force == pytest.approx(expected, rel=1e-5)


def test_missing_infinite_added_mass_follows_from_ogilvie_and_is_said(base):
    kernel, warnings = retardation(with_law(base, np.arange(1, 101) * 0.02, infinite=False))
    assert np.allclose(kernel.added_mass_infinite, INFINITE, rtol=2e-3)
    assert "omega = inf" in warnings[0]


def test_data_cut_too_low_warn_with_the_dof_the_value_and_the_remedy(base):
    short = with_law(base, np.arange(1, 26) * 0.02)
    radiation = make_radiation(CUMMINS, short, low=0.05, high=0.5)
    assert radiation.misfit > 0.02
    assert "sway" in radiation.warnings[0]
    assert "threshold 2 %" in radiation.warnings[0]
    assert "higher" in radiation.warnings[0]
    kernel, _ = retardation(short)
    assert max(misfit(kernel, short, 0.05, 0.5).values()) == pytest.approx(radiation.misfit)
    assert misfit(kernel, short, 5.0, 6.0) == {}


def test_constant_matrices_are_those_of_one_frequency(wide):
    constant = make_radiation(Hydrodynamics(data="x.nc", radiation="constant", frequency=0.34), wide)
    added_mass, damping = constant.at(np.array([0.01, 0.7]))
    assert np.allclose(added_mass, wide.radiation_at(np.array([0.34]))[0])
    assert np.allclose(damping[1], law(np.array([0.34]))[1][0], rtol=1e-3, atol=1.0)
    with pytest.raises(DataError, match="above the highest frequency"):
        make_radiation(Hydrodynamics(data="x.nc", radiation="constant", frequency=3.0), wide)
    none = make_radiation(None, None).at(np.array([0.5]))
    assert not np.any(none)


def test_frequencies_far_beyond_the_sea_cost_no_memory(base):
    kernel, _ = retardation(with_law(base, np.linspace(1.0, 4000.0, 50)))
    assert kernel.times.size < 200_000


@pytest.mark.parametrize("choice", [CUMMINS, Hydrodynamics(data="x.nc", radiation="constant", frequency=0.34)])
def test_yaw_turns_the_matrices(wide, choice):
    omega = np.array([0.3, 0.8])
    for ours, plain in zip(
        make_radiation(choice, wide, 0.6).at(omega), make_radiation(choice, wide).at(omega), strict=True
    ):
        assert np.allclose(ours, turned(plain, 0.6))
