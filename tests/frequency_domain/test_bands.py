"""First- and second-order response as two processes whose bands overlap: strips, sums, borders, and both domains."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from solver.case import DOF, parse_case
from solver.case.analysis import LowBand, WaveBand
from solver.frequency_domain.band import difference_strips, wave_strips
from solver.frequency_domain.solve import FrequencyResult, solve_frequency_domain
from solver.kernels.band import LANES
from solver.model.build import Model, build
from solver.results.solved import Solved
from solver.run import run
from solver.statics.solve import solve_statics
from solver.vessel.data import QTF
from solver.vessel.rigid import turning
from solver.waves.spectra import spectrum
from tests.frequency_domain.conftest import coupled, sea
from tests.frequency_domain.test_transfer import Dense
from tests.systems import Source
from tests.time_domain.systems import timed

Array = np.ndarray
REAL = np.array([2.0, 0.5, 6.0, 3.0, 40.0, 10.0]) * 1e3
IMAG = np.array([1.0, 0.0, -8.0, 2.0, 30.0, 0.0]) * 1e3


def t2(m: Array, n: Array) -> Array:
    """A Hermitian T2 that bilinear interpolation gives back exactly, (..., 6)."""
    return REAL * (1 + m + n + m * n)[..., None] + 1j * IMAG * (m - n)[..., None]


def with_qtf(source: Source, reach: float = np.inf) -> Source:
    """The box with a full QTF, alike in all headings; pairs further apart than `reach` are not known."""
    omega = np.arange(0.2, 1.65, 0.1)
    values = np.repeat(t2(omega[:, None], omega[None, :])[None], 4, axis=0)
    values[:, np.abs(omega[:, None] - omega[None, :]) > reach + 1e-9] = np.nan
    return Source(dataclasses.replace(source.data, qtf=QTF(omega, np.radians([0.0, 90.0, 180.0, 270.0]), values)))


def box(drift: str = "qtf", border: float = 0.5, hs: float = 4.0, tp: float = 9.0, **frequency: Any) -> dict[str, Any]:
    """The box whose heave and pitch, near 0.7 rad/s, lie inside the wave band."""
    fd = {"wave": {"from": 0.3, "to": 1.5, "step": 0.02}, "low": {"to": border, "step": 0.0025}, **frequency}
    data = coupled([sea(hs, tp)], **fd)
    data["vessel"]["hydrodynamics"]["drift"] = drift
    data["vessel"]["damping"] = {
        "linear": {"surge": 2e5, "sway": 2e5, "heave": 1e6, "roll": 1e8, "pitch": 1e8, "yaw": 4e7}
    }
    return data


def _solve(data: dict[str, Any], source: Source) -> tuple[Model, FrequencyResult, Solved]:
    model = build(parse_case(data), source)
    static, spec = solve_statics(model), model.case.analyses.frequency_domain
    assert spec is not None
    result = solve_frequency_domain(model, static, spec)
    return model, result, Solved(model, result.static, result)


# --- strips


def test_strips_of_bands_that_do_not_overlap() -> None:
    low = difference_strips(LowBand(to=0.2, step=0.00125), 0.2, 0.005)
    np.testing.assert_array_equal(low.omega[: low.count], 0.00125 * np.arange(1, 161))
    np.testing.assert_array_equal(low.widths, np.full(160, 0.00125))
    wave = wave_strips(WaveBand(from_=0.2, to=1.2, step=0.005), 0.2)
    np.testing.assert_array_equal(wave.omega[: wave.count], 0.2 + 1.0 / 200 * (np.arange(200) + 0.5))
    assert (low.below, wave.below) == (160, 0)
    assert wave_strips(WaveBand(from_=0.3, to=1.2), 0.2).below == 0  # a gap between the bands


@pytest.mark.parametrize("border", [0.37, 0.3719, 0.25])
def test_strips_have_an_edge_at_the_border(border: float) -> None:
    low = difference_strips(LowBand(to=border, step=0.00125), 1.2, 0.005)
    wave = wave_strips(WaveBand(from_=0.25, to=1.6, step=0.005), border)
    assert low.widths[: low.below].sum() == pytest.approx(border - 0.5 * 0.00125)
    assert low.widths.sum() == pytest.approx(1.2 - 0.5 * 0.00125)
    assert wave.widths[: wave.below].sum() == pytest.approx(border - 0.25)
    assert wave.widths.sum() == pytest.approx(1.35)
    for strips in (low, wave):
        assert strips.omega.size % LANES == 0
        assert np.all(np.diff(strips.omega[: strips.count]) > 0)
        assert np.all(strips.omega[: strips.below] <= border)
        assert np.all(strips.omega[strips.below : strips.count] > border)


def test_a_wave_band_all_below_the_border_is_low_frequency() -> None:
    wave = wave_strips(WaveBand(from_=0.2, to=0.4, step=0.01), 0.5)
    assert wave.below == wave.count == 20


# --- both processes against sums written out


def _second_order(model: Model, result: FrequencyResult, omega: Array, step: float) -> Array:
    """Spectra of the six motions under the slow drift force at omega (K,), from dense matrices and a double sum: (K, 6)."""
    assert model.vessel is not None
    whole = Dense(result, result.linear.damping)  # type: ignore[arg-type]
    own = result.driver.own(model, result.static, omega, result.linear.vessel)
    assert own is not None
    low, high = model.vessel.band
    storm = model.case.environment.random[0]
    none = [np.zeros((0, 0)) for _ in result.geometries]
    turn = turning(float(result.static.position[5]))
    out = np.empty((omega.size, 6))
    for k, difference in enumerate(omega):
        mu = np.arange(low + 0.5 * step, high - difference, step)
        weight = 8.0 * step * spectrum(mu + difference, storm) * spectrum(mu, storm)
        T = t2(mu + difference, mu) @ turn.T
        S = np.einsum("m,mi,mj->ij", weight, T, T.conj())
        H = whole.solve(difference, own[k], np.eye(6, dtype=complex), none)[-6:]
        out[k] = np.einsum("ip,pq,iq->i", H, S, H.conj()).real
    return out


@pytest.mark.slow
def test_a_mode_in_the_wave_band_against_a_direct_sum(source: Source) -> None:
    model, result, solved = _solve(box(), with_qtf(source))
    spectra = solved.vessel_spectra
    assert spectra is not None
    width = np.concatenate([np.full(50, 0.002), np.full(110, 0.01)])
    omega = np.cumsum(width) - 0.5 * width
    slow = _second_order(model, result, omega, 0.002)
    np.testing.assert_allclose(np.sqrt(solved.variance(spectra, "second_order")), np.sqrt(width @ slow), rtol=0.01)
    assert result.wave.vessel is not None
    at = solved.omega_wave
    edges = np.concatenate([[0.3], 0.5 * (at[1:] + at[:-1]), [1.5]])
    fast = (
        spectrum(at, model.case.environment.random[0])
        * np.abs(result.wave.vessel[0, :, : at.size]) ** 2
        * np.diff(edges)
    )
    for band, above in (("lf", False), ("wf", True)):
        inside = width * ((omega > 0.5) == above)
        total = inside @ slow + fast[:, (at > 0.5) == above].sum(axis=1)
        np.testing.assert_allclose(np.sqrt(solved.moments(spectra, band)), np.sqrt(total), rtol=0.01)
        moment = (inside * omega**2) @ slow + (fast * at**2)[:, (at > 0.5) == above].sum(axis=1)
        np.testing.assert_allclose(solved.moments(spectra, band, 2), moment, rtol=0.02)
    heave = slow[:, DOF.index("heave")]
    assert (width * (omega > 0.5)) @ heave > 0.5 * (
        width @ heave
    )  # most of it was left out when slow drift ended at the border


def test_bands_that_do_not_overlap_have_the_sums_of_their_own_strips(source: Source) -> None:
    """Newman's approximation, and a full QTF whose differences end at the border: σ as it was before bands could overlap."""
    for drift, data in (("newman", source), ("qtf", with_qtf(source))):
        asked = box(drift, 0.3, difference={"to": 0.3}) if drift == "qtf" else box(drift, 0.3)
        model, result, solved = _solve(asked, data)
        assert result.low is not None
        assert result.driver.low is not None
        assert model.vessel is not None
        assert model.vessel.difference_to == 0.3
        spectra = solved.vessel_spectra
        assert spectra is not None
        for band, response, part in (("wf", result.wave, result.driver.wave), ("lf", result.low, result.driver.low)):
            assert response.vessel is not None
            sigma = np.sqrt(np.einsum("rw,riw->i", part.loads.weight, np.abs(response.vessel) ** 2))
            np.testing.assert_allclose(np.sqrt(solved.moments(spectra, band)), sigma, rtol=1e-12)
            origin = "first_order" if band == "wf" else "second_order"
            np.testing.assert_allclose(np.sqrt(solved.variance(spectra, origin)), sigma, rtol=1e-12)
        np.testing.assert_array_equal(solved.omega, np.concatenate([solved.omega_low, solved.omega_wave]))


def test_variances_of_both_origins_are_those_of_both_bands(source: Source) -> None:
    summary = run(parse_case(box()), with_qtf(source), threads=1).summary["frequency_domain"]
    for dof in DOF:
        by_band = [summary["vessel_std"][band][dof] ** 2 for band in ("wf", "lf")]
        by_origin = [summary["origin_std"][origin][dof] ** 2 for origin in ("first_order", "second_order")]
        assert sum(by_band) == pytest.approx(sum(by_origin), rel=1e-12)
    for line in summary["lines"].values():
        by_band = [np.square(line["tension_std"][band]) for band in ("wf", "lf")]
        by_origin = [np.square(line["tension_origin_std"][origin]) for origin in ("first_order", "second_order")]
        np.testing.assert_allclose(sum(by_band), sum(by_origin), rtol=1e-12)


def test_the_channel_of_both_orders_rises_and_holds_both(source: Source) -> None:
    result = run(parse_case(box()), with_qtf(source), threads=1)
    channels = {channel.name: channel for channel in result.channels}
    for name in ("frequency/vessel/heave", "frequency/line/line-1/top_tension"):
        both, first, second = (channels[name + end] for end in ("", "_first_order", "_second_order"))
        omega = both.axes[0].values
        assert np.all(np.diff(omega) > 0)
        assert set(first.axes[0].values) | set(second.axes[0].values) == set(omega)
        at = np.interp(omega, second.axes[0].values, second.values, left=0.0, right=0.0)
        at += np.interp(omega, first.axes[0].values, first.values, left=0.0, right=0.0)
        np.testing.assert_allclose(both.values, at, rtol=1e-12)
    # the middle of the first wave strip is 0.01 rad/s above the end of the band
    heave = channels["frequency/vessel/heave"]
    variance = sum(result.summary["frequency_domain"]["vessel_std"][band]["heave"] ** 2 for band in ("wf", "lf"))
    assert np.trapezoid(heave.values, heave.axes[0].values) == pytest.approx(variance, rel=0.01)
    elevation = channels["frequency/wave/elevation"]
    assert elevation.values[elevation.axes[0].values < 0.3].max() == 0.0


@pytest.mark.parametrize("drift", ["newman", "qtf"])
def test_half_the_default_step_changes_no_sigma_by_one_percent(drift: str, source: Source) -> None:
    data = with_qtf(source)
    whole, half = (_solve(box(drift, **extra), data)[2] for extra in ({}, {"difference": {"step": 0.0025}}))
    for origin in ("first_order", "second_order"):
        one, other = (np.sqrt(s.variance(s.vessel_spectra, origin)) for s in (whole, half))  # type: ignore[arg-type]
        np.testing.assert_allclose(other, one, rtol=0.01)
    assert (whole.omega_low.size == half.omega_low.size) == (drift == "newman")


def test_the_border_moves_variance_from_band_to_band_only(source: Source) -> None:
    """Where the border lies changes neither origin nor their sum."""
    found = []
    for border in (0.3, 0.5, 0.8):
        data = box(border=border, wave={"from": 0.3, "to": 1.5, "step": 0.005})
        solved = _solve(data, with_qtf(source))[2]
        assert solved.vessel_spectra is not None
        origins = [solved.variance(solved.vessel_spectra, origin) for origin in ("first_order", "second_order")]
        found.append([*np.sqrt(origins), np.sqrt(solved.moments(solved.vessel_spectra, "lf"))])
    for one in found[1:]:
        np.testing.assert_allclose(one[0], found[0][0], rtol=2e-3)
        np.testing.assert_allclose(one[1], found[0][1], rtol=5e-3)
    assert np.all(found[0][2] < found[1][2])
    assert np.all(found[1][2] < found[2][2])


def test_slow_velocities_above_the_border_add_drag(source: Source) -> None:
    data = with_qtf(source)
    whole = _solve(box(border=0.3), data)[1]
    short = _solve(box(border=0.3, difference={"to": 0.3}), data)[1]
    gain = [np.trace(a.sum(axis=0)) / np.trace(b.sum(axis=0)) for a, b in
            zip(whole.linear.damping, short.linear.damping, strict=True)]  # fmt: skip
    assert min(gain) > 1.0


# --- what the data give, and what is said


def test_differences_go_as_far_as_the_data(source: Source) -> None:
    for reach, to, expected in ((np.inf, None, 1.2), (0.5, None, 0.4), (np.inf, 0.7, 0.7), (0.5, 0.35, 0.35)):
        asked = box(border=0.3, **({} if to is None else {"difference": {"to": to}}))
        model, result, _ = _solve(asked, with_qtf(source, reach))
        assert model.vessel is not None
        assert model.vessel.difference_to == pytest.approx(expected)
        assert result.driver.low is not None
        assert result.driver.low.strips.widths.sum() == pytest.approx(expected - 0.00125)


def _said(data: dict[str, Any], source: Source) -> list[str]:
    return [text for text in run(parse_case(data), source, threads=1).summary["warnings"] if "slow drift" in text]


def test_a_mode_beyond_newmans_border_is_said(source: Source) -> None:
    """Heave, near 0.8 rad/s: in waves of 5 s it answers to slow drift, in waves of 9 s to the waves."""
    data = with_qtf(source)
    found = _said(box("newman", 0.3, 2.0, 5.0), data)
    heave = next(text for text in found if "mode of heave" in text)
    for words in ("low.to = 0.3 rad/s", "drift: qtf", "threshold 5 %"):
        assert words in heave
    assert "mode of heave" not in " ".join(_said(box("newman", 0.3), data))
    assert _said(box("qtf", 0.3, 2.0, 5.0), data) == []
    assert _said(box("none", 0.3, 2.0, 5.0), data) == []
    short = " ".join(_said(box("qtf", 0.3, 2.0, 5.0, difference={"to": 0.4}), data))
    assert "raise analyses.frequency_domain.difference.to" in short
    surge = _said(box("newman", 0.01), data)
    assert any("low.to = 0.01" in text for text in surge)


def test_a_difference_band_that_newman_does_not_use_is_said(source: Source) -> None:
    warnings = run(parse_case(box("newman", 0.3, difference={"to": 0.6})), source, threads=1).summary["warnings"]
    assert any("difference has no effect with drift: newman" in text for text in warnings)


# --- time domain


@pytest.mark.slow
def test_both_domains_part_the_same_response_by_frequency(source: Source) -> None:
    """A small sea and no drag: the time domain is the linear system, and half of slow heave lies above the border."""
    data = box(border=0.4, hs=1.0, wave={"from": 0.3, "to": 1.5, "step": 0.005})
    data["vessel"]["damping"]["linear"] = {
        "surge": 6e5,
        "sway": 6e5,
        "heave": 2e6,
        "roll": 1e8,
        "pitch": 6e8,
        "yaw": 1e8,
    }
    data["line_types"]["chain"]["drag"] = {"normal": 0.05, "tangential": 0.0}
    qtf = with_qtf(source).data.qtf
    assert qtf is not None
    larger = dataclasses.replace(
        source.data, qtf=dataclasses.replace(qtf, values=150 * qtf.values * [0, 0, 1, 0, 1, 0])
    )
    data = timed(data, step=0.1, build_up=300.0, duration=1200.0, seeds=2, output_step=0.5)
    summary = run(parse_case(data), Source(larger), threads=1).summary
    assert summary["failures"] == {}
    time, same = summary["time_domain"]["vessel_std"], summary["frequency_domain"]["same_waves"]["vessel_std"]
    for band in ("wf", "lf"):
        for dof in ("heave", "pitch"):
            assert time[band][dof] == pytest.approx(same[band][dof], rel=0.03), (band, dof)
    origin = summary["frequency_domain"]["origin_std"]
    assert origin["second_order"]["heave"] > 0.3 * origin["first_order"]["heave"]
