"""Slow drift with a complex Hermitian T2 of several DOF: its spectrum and mean against the force it describes."""

import dataclasses

import numpy as np
import pytest

from solver.case.environment import Jonswap
from solver.outcome import DataError
from solver.vessel.data import QTF, read_bytes
from solver.vessel.drift import (
    Drift,
    collect,
    difference_table,
    drift_spectrum,
    mean_drift_force,
    mean_drift_regular,
    psd_factor,
    slow_drift,
)
from solver.waves.spectra import spectrum

from . import synthetic

LOW, HIGH = 0.2, 1.2
SEA = Jonswap(spectrum="jonswap", hs=8.0, tp=11.0, gamma=2, direction="0 deg")


def storm(omega):
    return spectrum(omega, SEA) * ((omega >= LOW) & (omega <= HIGH))


def swell(omega):
    return 0.4 * spectrum(omega * 0.8, SEA) * ((omega >= LOW) & (omega <= HIGH))


def complex_t2(m, n, direction_m, direction_n):
    """T2(m, n) = T2(n, m)* with phases that differ from DOF to DOF, so that S_FF has complex off-diagonals."""
    m, n = np.broadcast_arrays(m, n)
    scale = np.array([1.0, 0.7, 0.3, 2.0, 1.5, 5.0])
    lag = np.array([0.0, 9.0, -14.0, 4.0, -6.0, 20.0])
    bend = np.array([1.0, 0.5, 2.0, 1.5, 0.0, 1.0])
    turn = np.array([1.0, 0.5, 0.0, 0.3, 0.8, -0.6])
    aspect = 1 + 0.5 * turn * (np.cos(direction_m) + np.cos(direction_n))
    return scale * aspect * (1 + bend * (m * n)[..., None]) * np.exp(1j * lag * (m - n)[..., None])


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    return read_bytes(synthetic.to_bytes(synthetic.dataset(), tmp_path_factory.mktemp("drift")), "drift.nc")


def amplitudes(rng, omega, spectra, step):
    size = np.sqrt(2 * step * np.array([s(omega) for s in spectra]))
    return size * np.exp(2j * np.pi * rng.random(size.shape))


def test_collection_by_difference_is_the_double_sum():
    step, rng = 0.02, np.random.default_rng(1)
    omega = LOW + step * (0.5 + np.arange(40))
    systems, directions = [storm, swell], [0.3, 2.0]
    a = amplitudes(rng, omega, systems, step)
    g = slow_drift(omega, a, directions, complex_t2, 39)
    for t in (0.0, 13.7, 400.1):
        direct = np.zeros(6)
        for p in range(2):
            for q in range(2):
                table = complex_t2(omega[:, None], omega[None, :], directions[p], directions[q])
                phase = np.exp(1j * (omega[:, None] - omega[None, :]) * t)
                direct += np.einsum("m,n,mn,mnd->d", a[p], a[q].conj(), phase, table).real
        folded = g[0].real + 2 * (g[1:] * np.exp(1j * np.arange(1, 40)[:, None] * step * t)).real.sum(axis=0)
        assert np.allclose(folded, direct, rtol=1e-10)


def _simulated(systems, directions, seeds, step=0.005):
    """Cross-spectral matrix (K, 6, 6), its standard error, mean force and its standard error, over realisations."""
    omega = LOW + step * (0.5 + np.arange(round((HIGH - LOW) / step)))
    last, rng = 60, np.random.default_rng(11)
    tables = [[difference_table(omega, complex_t2, p, q, last) for q in directions] for p in directions]
    cross, means = [], []
    for _ in range(seeds):
        a = amplitudes(rng, omega, systems, step)
        g = sum(collect(tables[p][q], a[p], a[q]) for p in range(len(systems)) for q in range(len(systems)))
        force = 2 * g[1:]  # complex amplitude of e^{+i k step t}; E|F|² = 2 S dω
        cross.append(force[:, :, None] * force[:, None, :].conj() / (2 * step))
        means.append(g[0].real)
    cross, means = np.array(cross), np.array(means)
    k = step * np.arange(1, last + 1)
    return k, cross, means


@pytest.mark.parametrize("systems", [([storm], [0.4]), ([storm, swell], [0.4, 2.2])], ids=["one", "two"])
def test_spectrum_and_mean_of_the_realised_force(systems):
    spectra, directions = systems
    k, cross, means = _simulated(spectra, directions, 1500)
    exact = drift_spectrum(k, list(zip(spectra, directions, strict=True)), complex_t2, LOW, HIGH)
    scale = np.sqrt(np.einsum("kii,kjj->kij", exact, exact).real)
    off = np.abs((exact.imag / scale)[:, 0, 1:]).max()
    assert off > 0.3  # the off-diagonals are truly complex
    # each entry within 5 standard errors at every frequency (2 160 real numbers), and their mean square near one
    error = cross.mean(axis=0) - exact
    z = np.concatenate([
        (part(error) / np.maximum(part(cross).std(axis=0, ddof=1) / np.sqrt(len(cross)), 1e-12 * scale)).ravel()
        for part in (np.real, np.imag)
    ])  # fmt: skip
    z = z[np.abs(z) > 0]
    assert np.abs(z).max() < 5.0
    assert 0.7 < np.mean(z**2) < 1.3
    # summed over frequency: the covariance, within 2 % of the variances
    total = np.abs(error.sum(axis=0)) / np.sqrt(np.outer(*(2 * [np.einsum("kii->i", exact).real])))
    assert total.max() < 0.02
    # the transposed order of arguments, T2(mu, omega + mu), is far outside
    wrong = drift_spectrum(
        k, list(zip(spectra, directions, strict=True)), lambda m, n, p, q: complex_t2(n, m, p, q), LOW, HIGH
    )
    assert np.allclose(wrong[:, 0, 0], exact[:, 0, 0])
    missed = np.abs((cross.mean(axis=0) - wrong).sum(axis=0)) / np.sqrt(
        np.outer(*(2 * [np.einsum("kii->i", exact).real]))
    )
    assert missed.max() > 0.3
    # mean force
    mean = mean_drift_force(list(zip(spectra, directions, strict=True)), complex_t2, LOW, HIGH)
    spread = means.std(axis=0, ddof=1) / np.sqrt(len(means))
    assert np.all(np.abs(means.mean(axis=0) - mean) < 4 * spread + 2e-3 * np.abs(mean))


def test_spectrum_does_not_hang_on_its_panels():
    k = np.arange(1, 161) * 0.00125
    one = drift_spectrum(k, [(storm, 0.4)], complex_t2, LOW, HIGH)
    fine = drift_spectrum(k, [(storm, 0.4)], complex_t2, LOW, HIGH, step=0.0005)
    assert np.abs(one - fine).max(axis=0) == pytest.approx(0.0, abs=1e-4 * np.abs(fine).max())
    assert np.abs(drift_spectrum(np.array([1.5]), [(storm, 0.4)], complex_t2, LOW, HIGH)).max() == 0.0


def test_newman_keeps_the_diagonal_and_turns_with_the_vessel(data):
    w = np.array([0.35, 0.6, 0.95])
    for kind in ("newman", "newman-geometric"):
        t2 = Drift(data, kind)
        assert np.allclose(t2(w, w, 1.0, 1.0), data.mean_drift_at(w, 1.0))
        assert np.allclose(t2(w, w[::-1], 1.0, 1.0), t2(w[::-1], w, 1.0, 1.0))
        turned = Drift(data, kind, yaw=0.7)(w, w, 1.7, 1.7)
        plain = t2(w, w, 1.0, 1.0)
        assert np.allclose(turned[:, 0], np.cos(0.7) * plain[:, 0] - np.sin(0.7) * plain[:, 1])
        assert np.allclose(turned[:, 5], plain[:, 5])
    newman, geometric = Drift(data, "newman"), Drift(data, "newman-geometric")
    m, n = np.array([0.4]), np.array([0.9])
    d = data.mean_drift_at(np.array([0.4, 0.9]), np.pi / 2)[:, 1]
    assert newman(m, n, np.pi / 2, np.pi / 2)[0, 1] == pytest.approx(d.mean())
    assert geometric(m, n, np.pi / 2, np.pi / 2)[0, 1] == pytest.approx(np.sqrt(d.prod()))
    assert geometric(m, n, 0.1, 3.0)[0, 0] == 0.0  # the signs differ
    both = 0.5 * (data.mean_drift_at(m, 0.1) + data.mean_drift_at(n, 3.0))
    assert np.allclose(newman(m, n, 0.1, 3.0), both)
    assert newman.warnings([0.1, 0.1 + 2 * np.pi]) == ()
    assert "different directions" in newman.warnings([0.1, 3.0])[0]


def test_full_qtf_takes_the_mean_over_two_directions(data):
    omega, headings = np.linspace(0.1, 1.4, 27), np.array([0.0, 1.0])
    m, n = np.meshgrid(omega, omega, indexing="ij")
    table = np.stack([complex_t2(m, n, beta, beta) for beta in headings])
    t2 = Drift(dataclasses.replace(data, qtf=QTF(omega, headings, table)), "qtf")
    assert "different directions" in t2.warnings([0.0, 1.0])[0]
    a, b = omega[[3, 8]], omega[[9, 4]]
    assert np.allclose(t2(a, b, 0.0, 0.0), complex_t2(a, b, 0.0, 0.0))
    mixed = 0.5 * (complex_t2(a, b, 0.0, 0.0) + complex_t2(a, b, 1.0, 1.0))
    assert np.allclose(t2(a, b, 0.0, 1.0), mixed)
    assert np.allclose(t2(a, b, 0.0, 1.0), t2(b, a, 1.0, 0.0).conj())
    with pytest.raises(DataError, match="no full QTF"):
        Drift(data, "qtf")
    with pytest.raises(DataError, match="mean_drift_force"):
        Drift(dataclasses.replace(data, mean_drift=None), "newman")
    assert not Drift(None, "none")(a, b, 0.0, 0.0).any()


def test_pairs_of_unlike_headings_are_all_that_must_be_known(data):
    omega, headings = np.linspace(0.1, 1.4, 27), np.array([0.0, 0.5, 1.0])
    m, n = np.meshgrid(omega, omega, indexing="ij")
    table = np.stack([complex_t2(m, n, beta, beta) for beta in headings])
    cross = {(0, 2): complex_t2(m, n, 0.0, 1.0), (1, 2): complex_t2(m, n, 0.5, 1.0)}
    t2 = Drift(dataclasses.replace(data, qtf=QTF(omega, headings, table, cross=cross)), "qtf")
    assert t2.warnings([0.25, 1.0]) == ()  # a wave with itself takes the table of one heading
    assert "different directions" in t2.warnings([0.0, 0.5])[0]


def test_mean_force_in_regular_waves(data):
    t2 = Drift(data, "newman")
    lone = mean_drift_regular([(0.6, 3.0j, 0.0)], t2)
    assert np.allclose(lone, 9 * data.mean_drift_at(np.array(0.6), 0.0))
    apart = mean_drift_regular([(0.6, 3.0, 0.0), (0.7, 2.0, np.pi / 2)], t2)
    assert np.allclose(apart, lone + 4 * data.mean_drift_at(np.array(0.7), np.pi / 2))
    doubled = mean_drift_regular([(0.6, 1.5, 0.0), (0.6, 1.5, 0.0)], t2)
    assert np.allclose(doubled, lone)


def test_factor_gives_back_the_matrix_whatever_the_units():
    exact = drift_spectrum(np.array([0.01, 0.1]), [(storm, 0.4)], complex_t2, LOW, HIGH)
    units = np.array([1, 1, 1, 1e6, 1e6, 1e6])
    exact = exact * np.outer(units, units)
    factor = psd_factor(exact)
    assert np.allclose(
        factor @ factor.conj().transpose(0, 2, 1) / np.outer(units, units), exact / np.outer(units, units)
    )
    vector = np.array([1.0, 1j, 0, 0, 0, 2.0])
    lone = np.outer(vector, vector.conj())[None]
    assert psd_factor(lone).shape == (1, 6, 1)
    assert psd_factor(np.zeros((3, 6, 6), complex)).shape == (3, 6, 0)
    with pytest.raises(ValueError, match="semi-definite"):
        psd_factor(lone - 0.01 * np.eye(6))
