"""Quality checks: content with data that obey Haskind, Kramers and Kronig, and each fault found with its size."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from solver.vessel.data import QTF, HydrodynamicData
from solver.vessel.quality import quality, quality_warnings
from solver.vessel.quality.forces import group_velocity
from solver.vessel.quality.radiation import isolated, off_the_line
from solver.vessel.radiation import retardation
from solver.waves.dispersion import wave_number

RHO, G, C33 = 1025.0, 9.807, 2.0e7


def consistent(depth=np.inf, omega=None, count=36) -> HydrodynamicData:
    """Forces of a smooth body, the damping that Haskind's relation gives of them, the added mass that this damping has."""
    omega = np.arange(0.05, 3.01, 0.05) if omega is None else omega
    headings = np.arange(count) * 2 * np.pi / count
    k = np.asarray(wave_number(omega, depth, G))
    heave = C33 * np.exp(-2.0 * k)
    beta, one = headings[None, :], np.ones_like(headings)[None, :]
    size = {0: 2.0 * k, 1: 3.0 * k, 2: np.ones_like(k), 3: 8.0 * k, 4: 20.0 * k, 5: 40.0 * k**2}
    shape = {
        0: 1j * np.cos(beta),
        1: 1j * np.sin(beta),
        2: one,
        3: 1j * np.sin(beta),
        4: 1j * np.cos(beta),
        5: np.sin(2 * beta),
    }
    force = np.stack([(heave * size[i])[:, None] * shape[i] for i in range(6)], axis=2).astype(complex)
    factor = k / (8 * np.pi * RHO * G * group_velocity(omega, k, depth))
    damping = factor[:, None, None] * np.einsum("whi,whj->wij", force, force.conj()).real * 2 * np.pi / count
    stiffness = np.diag([0.0, 0.0, C33, 3e9, 9e9, 0.0])
    infinite = np.diag([1e6, 2e6, 3e6, 1e8, 4e8, 2e8]) * 5
    data = HydrodynamicData(
        name="smooth", content_hash="", omega=omega, headings=headings, added_mass=np.zeros_like(damping),
        damping=damping, excitation=force, added_mass_zero=None, added_mass_infinite=infinite, excitation_zero=None,
        mean_drift=None, hydrostatic_stiffness=stiffness, displaced_volume=None, centre_of_buoyancy=None,
        centre_of_mass=np.zeros(3), reference_point=np.zeros(3), density=RHO, gravity=G, depth=depth,
    )  # fmt: skip
    return dataclasses.replace(data, added_mass=retardation(data)[0].transform(omega)[0])


def of(data, name):
    return next(check for check in quality(data) if check.name == name)


@pytest.mark.parametrize("depth", [np.inf, 40.0])
def test_consistent_data_are_left_alone(depth):
    data = consistent(depth)
    states = {check.name: check.state for check in quality(data)}
    assert quality_warnings(data, 0.0, np.inf) == ()
    assert [name for name, state in states.items() if state == "skipped"] == ["qtf-hermitian", "qtf-diagonal"]
    assert of(data, "haskind").value < 1e-6
    assert of(data, "kramers-kronig").value < 0.02


def test_group_velocity_is_the_slope_of_the_dispersion():
    omega, h = np.array([0.3, 0.8, 1.5]), 1e-5
    for depth in (np.inf, 20.0, 100.0):
        slope = 2 * h / (wave_number(omega + h, depth, G) - wave_number(omega - h, depth, G))
        assert np.allclose(group_velocity(omega, np.asarray(wave_number(omega, depth, G)), depth), slope, rtol=1e-8)


def test_a_wrong_length_or_density_shows_in_haskinds_relation():
    """Forces go with L², damping with L³: ULEN 10 % off leaves a factor of 1.1."""
    data = consistent()
    wrong = dataclasses.replace(data, damping=data.damping * 1.1**3, excitation=data.excitation * 1.1**2)
    found = of(wrong, "haskind")
    assert found.state == "warning"
    assert found.value == pytest.approx((1.1**4 - 1.1**3) / 1.1**4, rel=1e-3)
    assert "ULEN" in found.message
    assert of(dataclasses.replace(data, density=RHO / 1.2), "haskind").state == "warning"


def test_forces_over_half_the_circle_cannot_be_integrated():
    data = consistent()
    half = dataclasses.replace(data, headings=data.headings[:19], excitation=data.excitation[:, :19])
    assert of(half, "haskind").state == "skipped"
    assert of(half, "headings").state == "warning"
    assert "0 to 180 deg" in of(half, "headings").message


def test_few_headings_are_no_proof_against_the_data():
    """A force that turns quickly with the heading is not judged by an integral that cannot follow it."""
    data = consistent()
    quick = data.excitation * np.exp(1j * 30 * data.omega[:, None, None] ** 2 * np.cos(data.headings)[None, :, None])
    assert of(dataclasses.replace(data, excitation=quick), "haskind").state in ("ok", "skipped")
    assert of(consistent(count=6), "headings").state == "warning"


def test_asymmetry_and_negative_damping():
    data = consistent()
    bad = data.added_mass.copy()
    bad[7, 0, 4] += 0.05 * np.sqrt(np.abs(bad[:, 0, 0]).max() * np.abs(bad[:, 4, 4]).max())
    found = of(dataclasses.replace(data, added_mass=bad), "reciprocity")
    assert found.value == pytest.approx(0.05)
    assert f"{data.omega[7]:.4g} rad/s" in found.message
    negative = data.damping.copy()
    peak = negative[:, 2, 2].max()
    negative[3, 2, 2] = -0.03 * peak
    found = of(dataclasses.replace(data, damping=negative), "damping")
    assert found.state == "warning"
    assert "heave is negative at 0.2 rad/s" in found.message
    coupled = data.damping.copy()  # each diagonal positive, yet a mixed motion gains energy
    coupled[:, 0, 2] = coupled[:, 2, 0] = 1.2 * np.sqrt(coupled[:, 0, 0] * coupled[:, 2, 2])
    assert of(dataclasses.replace(data, damping=coupled), "damping").state == "warning"


def test_added_mass_that_does_not_follow_from_the_damping():
    data = consistent()
    found = of(dataclasses.replace(data, added_mass=data.added_mass * 1.2), "kramers-kronig")
    assert found.state == "warning"
    assert found.value == pytest.approx(1 - 1 / 1.2, abs=0.03)
    other = dataclasses.replace(data, added_mass_infinite=1.3 * data.added_mass_infinite)
    assert of(other, "kramers-kronig").state == "warning"
    assert of(consistent(omega=np.linspace(0.2, 2, 6)), "kramers-kronig").state == "skipped"


def test_a_spike_is_told_from_a_coarse_peak():
    data = consistent()
    spiked = data.added_mass.copy()
    spiked[30, 2, 2] += 0.2 * np.abs(spiked[:, 2, 2]).max()
    found = of(dataclasses.replace(data, added_mass=spiked), "spikes")
    assert found.state == "warning"
    assert f"heave at {data.omega[30]:.4g} rad/s" in found.message
    coarse = consistent(omega=np.arange(0.1, 3.01, 0.35))
    assert of(coarse, "spacing").state == "warning"
    assert of(coarse, "spacing").value > of(coarse, "spacing").threshold > 2 * of(data, "spacing").value


def test_off_the_line_and_isolated_by_hand():
    omega = np.array([0.0, 1.0, 3.0, 4.0])
    assert np.allclose(off_the_line(omega, np.array([0.0, 1.0, 3.0, 4.0])), 0.0)
    assert np.allclose(off_the_line(omega, np.array([0.0, 2.0, 3.0, 4.0])), [0.25, (3 - 10 / 3) / 4])
    gap = np.full(30, 1e-3)
    gap[15], gap[14], gap[16] = 0.2, -0.1, -0.1
    assert np.flatnonzero(isolated(gap)).tolist() == [15] or 15 in np.flatnonzero(isolated(gap))


def test_only_the_band_of_the_waves_is_judged():
    data = consistent()
    spiked = data.added_mass.copy()
    spiked[-5, 2, 2] += 0.3 * np.abs(spiked[:, 2, 2]).max()
    late = dataclasses.replace(data, added_mass=spiked)
    assert any("stands out" in text for text in quality_warnings(late, 0.0, np.inf))
    assert quality_warnings(late, 0.2, 1.2) == ()


def test_the_long_wave_limit():
    data = consistent()
    found = of(dataclasses.replace(data, excitation=data.excitation * 1.5), "long-wave")
    assert found.state == "warning"
    assert found.value == pytest.approx(0.5, abs=0.03)


def with_pairs(data, scale=1.0):
    omega = np.linspace(0.2, 1.2, 11)
    values = np.zeros((1, 11, 11, 6), complex)
    values[0, ..., 0] = 1e4 * np.minimum.outer(omega, omega) + 1e3j * np.subtract.outer(omega, omega)
    drift = np.zeros((data.omega.size, data.headings.size, 6))
    drift[..., 0] = scale * 1e4 * data.omega[:, None]
    return dataclasses.replace(data, mean_drift=drift, qtf=QTF(omega, np.zeros(1), values))


def test_a_qtf_against_its_mirror_and_the_mean_drift():
    data = with_pairs(consistent())
    assert of(data, "qtf-hermitian").value == 0.0
    assert of(data, "qtf-diagonal").value < 1e-12
    off = of(with_pairs(consistent(), 1.25), "qtf-diagonal")
    assert off.state == "warning"
    assert off.value == pytest.approx(0.2, abs=0.01)
    skew = data.qtf.values.copy()
    skew[0, 3, 5, 0] *= 1 + 5e-4
    found = of(dataclasses.replace(data, qtf=dataclasses.replace(data.qtf, values=skew)), "qtf-hermitian")
    assert found.state == "warning"
    assert found.value < 1e-3


def test_the_irregular_frequency_of_a_barge_without_a_lid():
    """Heave of the example's barge solved without a lid: the added mass jumps at 1.06 to 1.08 rad/s (the CSV says how)."""
    omega, added, damping = np.loadtxt(Path(__file__).with_name("barge-without-lid.csv"), delimiter=",", skiprows=2).T
    plain = consistent(omega=omega)
    matrices = [np.array(table) for table in (plain.added_mass, plain.damping)]
    for table, values in zip(matrices, (added, damping), strict=True):
        table[:, 2, 2] = values
    data = dataclasses.replace(plain, added_mass=matrices[0], damping=matrices[1])
    found = of(data, "spikes")
    assert found.state == "warning"
    assert found.value == pytest.approx(0.077, abs=0.002)
    assert "added mass of heave at 1.06 rad/s" in found.message
    assert "lid" in found.message
    healthy = (omega < 1.0) | (omega > 1.12)  # the same data without the frequencies that are spoilt
    assert np.abs(off_the_line(omega[healthy], added[healthy])).max() < 0.01
