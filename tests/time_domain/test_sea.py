"""One seed's sea: what the tables hold against sums written out."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from solver.kernels.arrays import MEAN, Sea
from solver.kernels.waves import water_at
from solver.outcome import DataError
from solver.time_domain.block import Run
from solver.time_domain.sea import Components, low_border
from solver.time_domain.water import POINTS
from solver.vessel.drift import Drift, drift_spectrum
from solver.waves.kinematics import velocity
from solver.waves.spectra import spectrum
from tests.frequency_domain.test_bands import with_qtf
from tests.systems import Source
from tests.time_domain.systems import prepared
from tests.time_domain.test_ensemble import _box

Array = np.ndarray


@pytest.fixture(scope="module")
def run(source: Source) -> Run:
    return Run(*prepared(_box(duration=200.0), source))


def _waves(run: Run) -> Components:
    assert run.waves is not None
    return run.waves


def _sea(table: Array, step: float) -> Sea:
    """Nothing but a table of water."""
    empty = np.zeros((0, 4))
    return Sea(
        np.zeros((1, 1, 6)), 1.0, table, 0, step, MEAN, 1, empty[:, :2], empty, 100.0, 1.0, table[0, :, :3].copy()
    )


def test_components_repeat_after_the_kept_record(run: Run) -> None:
    waves = _waves(run)
    assert waves.period == pytest.approx(run.time.duration)
    np.testing.assert_allclose(waves.omega / waves.step, np.round(waves.omega / waves.step), atol=1e-9)
    assert waves.omega[0] >= 0.3 - 1e-9
    assert waves.omega[-1] <= 1.5 + 1e-9


def test_fixed_amplitudes_have_the_spectrums_variance_exactly(run: Run) -> None:
    waves = _waves(run)
    A = waves.amplitudes(3, False)
    seas = run.model.case.environment.random
    for k, sea in enumerate(seas):
        np.testing.assert_allclose(0.5 * np.abs(A[k]) ** 2, spectrum(waves.omega, sea) * waves.step, rtol=1e-12)


def test_random_amplitudes_have_it_in_the_mean(run: Run) -> None:
    waves = _waves(run)
    power = np.mean([0.5 * np.abs(waves.amplitudes(seed, True)) ** 2 for seed in range(600)], axis=0)
    total = np.array([density.sum() * waves.step for density in waves.densities])
    np.testing.assert_allclose(power.sum(axis=1), total, rtol=0.05)


def test_a_seed_is_a_sea_of_its_own(run: Run) -> None:
    waves = _waves(run)
    np.testing.assert_array_equal(waves.amplitudes(5, False), waves.amplitudes(5, False))
    phases = np.angle([waves.amplitudes(seed, False) for seed in range(40)])
    assert np.abs(np.exp(1j * phases).mean()) < 0.03
    cross = np.exp(1j * (phases[1:, 0] - phases[:-1, 0])).mean()
    assert abs(cross) < 0.1
    assert np.abs(np.exp(1j * (phases[:, 0] - phases[:, 1])).mean()) < 0.1  # systems have phases of their own


def test_force_of_the_waves_has_the_variance_of_its_spectrum_exactly(run: Run) -> None:
    assert run.vessel is not None
    waves = _waves(run)
    run.vessel.sums, kept = {}, run.vessel.sums
    force = run.vessel.table(waves.amplitudes(1, False))
    run.vessel.sums = kept
    # two systems share their frequencies: their cross term has the phases of the seed
    A = waves.amplitudes(1, False)
    phasor = sum(X * a[:, None] for X, a in zip(run.vessel.first_order, A, strict=True))
    np.testing.assert_allclose(force.var(axis=0), 0.5 * (np.abs(phasor) ** 2).sum(axis=0), rtol=1e-10)
    single = waves.densities[0][:, None] * np.abs(run.vessel.first_order[0]) ** 2 * waves.step
    one = run.vessel.first_order[0] * A[0][:, None]
    np.testing.assert_allclose(0.5 * (np.abs(one) ** 2).sum(axis=0), single.sum(axis=0), rtol=1e-12)


def test_slow_drift_by_fft_is_the_double_sum(run: Run) -> None:
    assert run.vessel is not None
    assert run.model.vessel is not None
    waves = _waves(run)
    A = waves.amplitudes(2, False)
    first, run.vessel.first_order = run.vessel.first_order, [0.0 * X for X in run.vessel.first_order]
    table = run.vessel.table(A)
    run.vessel.first_order = first
    t2 = Drift(run.model.vessel.data, run.model.vessel.drift, float(run.static.position[5]))
    m, n = np.meshgrid(np.arange(waves.omega.size), np.arange(waves.omega.size), indexing="ij")
    low = (m != n) & (np.abs(m - n) * waves.step <= 0.3 + 1e-9)
    times = run.vessel.step * np.array([0, 17, 400, 1333])
    expected = np.zeros((times.size, 6))
    for i, one in enumerate(waves.directions):
        for k, other in enumerate(waves.directions):
            T = t2(waves.omega[m[low]], waves.omega[n[low]], one, other)
            pair = A[i][m[low]] * np.conj(A[k][n[low]])
            turn = np.exp(1j * times[:, None] * (waves.omega[m[low]] - waves.omega[n[low]]))
            expected += ((turn * pair) @ T).real
    np.testing.assert_allclose(table[[0, 17, 400, 1333]], expected, atol=1e-9 * np.abs(table).max())


def test_water_is_the_sum_of_its_components_to_the_tables_error(run: Run) -> None:
    """Twelve points per shortest wave and a cubic: 0.18 % of that wave, far less of the sea."""
    assert run.water is not None
    waves, A = _waves(run), _waves(run).amplitudes(1, False)
    table = run.water.table(0, A, np.arange(run.water.count))
    x = run.static.lines[0].nodes - 1 - run.water.first
    Q = 1
    out = np.zeros((table.shape[1], 6, Q))
    sea = _sea(np.ascontiguousarray(table[..., None]), run.water.step)
    points = run.static.state.shapes[0]
    environment = run.model.case.environment
    U = [velocity(waves.omega, d, points, environment.depth, environment.water.gravity) for d in waves.directions]
    worst, size = np.zeros(6), np.zeros(6)
    for t in np.random.default_rng(0).uniform(-50, 250, 300):
        water_at(sea, t, 1.0, out)
        u = sum(np.einsum("w,wpk->pk", a * np.exp(1j * waves.omega * t), part) for a, part in zip(A, U, strict=True))
        du = sum(
            np.einsum("w,wpk->pk", 1j * waves.omega * a * np.exp(1j * waves.omega * t), part)
            for a, part in zip(A, U, strict=True)
        )
        exact = np.concatenate([np.real(u), np.real(du)], axis=1)[run.water.first :]
        worst = np.maximum(worst, np.abs(out[x, :, 0] - exact[x]))
        size = np.maximum(size, np.abs(exact[x]))
    assert np.all(worst[:3] < 5e-4 * size[:3].max())
    assert np.all(worst[3:] < 2e-3 * size[3:].max())


@pytest.mark.parametrize("share", [1.0, 0.5])
def test_error_of_the_cubic_is_as_stated(share: float) -> None:
    """0.024 (ωΔt)⁴ of a component, at the worst place."""
    w = share * 2 * math.pi / POINTS  # Δt = 1
    n = np.arange(480)
    table = np.zeros((480, 1, 6, 1))
    table[:, 0, 0, 0] = np.cos(2 * math.pi * round(480 * w / (2 * math.pi)) / 480 * n)
    sea, out = _sea(table, 1.0), np.zeros((1, 6, 1))
    worst = 0.0
    for t in np.arange(100.0, 140.0, 0.125):
        water_at(sea, t, 1.0, out)
        worst = max(worst, abs(out[0, 0, 0] - math.cos(w * t)))
    assert worst <= 0.024 * w**4 + 1e-12
    assert worst > 0.015 * w**4


# --- a full QTF: differences beyond the border of the bands


def _with_pairs(border: float, **frequency: Any) -> dict[str, Any]:
    data = _box(duration=300.0)
    data["vessel"]["hydrodynamics"]["drift"] = "qtf"
    data["analyses"]["frequency_domain"] |= {"low": {"to": border}, **frequency}
    return data


def test_slow_drift_of_a_full_qtf_is_the_double_sum(source: Source) -> None:
    """Two systems of different directions, differences up to 0.7 rad/s, the border at 0.4."""
    run = Run(*prepared(_with_pairs(0.4, difference={"to": 0.7}), with_qtf(source)))
    assert run.vessel is not None
    assert run.model.vessel is not None
    waves = _waves(run)
    A = waves.amplitudes(2, False)
    G = run.vessel.difference(A)
    assert G.shape[0] == int(0.7 / waves.step + 1e-9) + 1
    force = Drift(run.model.vessel.data, "qtf", float(run.static.position[5]))
    for k in (1, 5, int(0.4 / waves.step) + 3, G.shape[0] - 1):
        n = np.arange(waves.omega.size - k)
        expected = np.zeros(6, dtype=complex)
        for i, one in enumerate(waves.directions):
            for j, other in enumerate(waves.directions):
                T = force(waves.omega[n + k], waves.omega[n], one, other)
                expected += (A[i][n + k] * np.conj(A[j][n])) @ T
        np.testing.assert_allclose(G[k], expected, rtol=1e-9, atol=1e-9 * np.abs(G).max())


@pytest.mark.parametrize("drift", ["newman", "qtf"])
def test_slow_drift_ends_at_the_border_only_without_a_full_qtf(drift: str, source: Source) -> None:
    data = _with_pairs(0.4)
    data["vessel"]["hydrodynamics"]["drift"] = drift
    run = Run(*prepared(data, with_qtf(source)))
    assert run.vessel is not None
    waves = _waves(run)
    last = run.vessel.difference(waves.amplitudes(1, False)).shape[0] - 1
    assert last * waves.step == pytest.approx(
        0.4 if drift == "newman" else waves.omega[-1] - waves.omega[0], abs=waves.step
    )
    assert low_border(run.model) == 0.4


def test_force_above_the_border_has_the_variance_of_its_spectrum(source: Source) -> None:
    """Mean over seeds of ½|2 G_k|² against ∫ S_FF dω of (V26), below and above the border."""
    data = _with_pairs(0.3)
    data["environment"]["seastates"] = data["environment"]["seastates"][:1]
    data["environment"].pop("current")
    run = Run(*prepared(data, with_qtf(source)))
    assert run.vessel is not None
    assert run.model.vessel is not None
    waves = _waves(run)
    G = np.array([run.vessel.difference(waves.amplitudes(seed, True)) for seed in range(400)])
    k = waves.step * np.arange(G.shape[1])
    power = 2.0 * (np.abs(G) ** 2).mean(axis=0)
    force = Drift(run.model.vessel.data, "qtf", float(run.static.position[5]))
    sea = run.model.case.environment.random[0]
    systems = [(lambda omega: spectrum(omega, sea), waves.directions[0])]
    S = np.einsum("kii->ki", drift_spectrum(k[1:], systems, force, *run.model.vessel.band).real)
    for inside in (k[1:] <= 0.3, (k[1:] > 0.3) & (k[1:] < 0.8)):
        found, expected = power[1:][inside].sum(axis=0), waves.step * S[inside].sum(axis=0)
        np.testing.assert_allclose(found, expected, rtol=0.06)


def test_pairs_that_are_not_known_are_refused(source: Source) -> None:
    data = _with_pairs(0.4, difference={"to": 0.7})
    with pytest.raises(DataError, match=r"up to 0.4 rad/s.*difference.to"):
        Run(*prepared(data, with_qtf(source, reach=0.5)))
