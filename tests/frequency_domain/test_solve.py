"""The whole analysis: what its answers must obey whatever the numbers are."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from solver.case import DOF, parse_case
from solver.check import check
from solver.frequency_domain.linearise import sigmas
from solver.frequency_domain.solve import FrequencyResult, solve_frequency_domain
from solver.model.body import rotation
from solver.model.build import build
from solver.outcome import CaseError, NotConverged
from solver.run import run
from solver.statics.solve import solve_statics
from solver.vessel.rigid import turning
from tests.frequency_domain.conftest import coupled, sea
from tests.systems import Source, example


def _solve(data: dict[str, Any], source: Any = None) -> FrequencyResult:
    model = build(parse_case(data), source)
    spec = model.case.analyses.frequency_domain
    assert spec is not None
    return solve_frequency_domain(model, solve_statics(model), spec)


def _std(result: FrequencyResult) -> tuple[np.ndarray, np.ndarray]:
    """σ of the six motions, wave and slow."""
    found = []
    for response, band in ((result.wave, result.driver.wave), (result.low, result.driver.low)):
        assert response is not None
        assert response.vessel is not None
        assert band is not None
        found.append(np.sqrt(np.einsum("rw,riw->i", band.loads.weight, np.abs(response.vessel) ** 2)))
    return found[0], found[1]


@pytest.mark.parametrize("linearisation", ["component", "vector"])
def test_a_mirrored_sea_gives_the_mirrored_answer(linearisation: str, mirrored) -> None:  # type: ignore[no-untyped-def]
    """Four lines alike about y = 0, data made even in surge, heave, pitch and odd in the rest; current and drift too."""

    def both(direction: float) -> FrequencyResult:
        data = coupled([sea(direction=direction)], lines=4, linearisation=linearisation)
        data["environment"]["current"] = {"depths": [0], "speeds": [0.6], "direction": f"{direction / 2} deg"}
        data["vessel"]["mean_drift"] = "include"
        return _solve(data, mirrored)

    one, other = both(157.5), both(-157.5)
    np.testing.assert_allclose(other.static.position * [1, -1, 1, -1, 1, -1], one.static.position, atol=1e-7)
    for a, b in zip(_std(one), _std(other), strict=True):
        np.testing.assert_allclose(b, a, rtol=1e-6, atol=1e-9)
    for port, starboard in ((0, 3), (1, 2), (2, 1), (3, 0)):
        a, b = np.abs(one.wave.tension[port]), np.abs(other.wave.tension[starboard])
        np.testing.assert_allclose(b, a, atol=1e-6 * a.max())


@pytest.mark.parametrize("turn", [40.0, 165.0])
def test_turning_everything_about_the_vertical_leaves_the_vessels_answer(turn: float, source) -> None:  # type: ignore[no-untyped-def]
    data = coupled([sea(), sea(2.0, 7.0, 130.0)], linearisation="vector")
    data["vessel"]["mean_drift"] = "include"
    data["environment"]["current"] = {"depths": [0, 100], "speeds": [0.8, 0.3], "direction": "70 deg"}
    turned = copy.deepcopy(data)
    turned["vessel"]["heading"] = f"{turn} deg"
    for line in turned["lines"].values():
        anchor = line["end_a"]["anchor"]
        anchor["azimuth"] = f"{float(anchor['azimuth'].split()[0]) + turn} deg"
    for part in (*turned["environment"]["seastates"], turned["environment"]["current"]):
        part["direction"] = f"{float(part['direction'].split()[0]) + turn} deg"
    one, other = _solve(data, source), _solve(turned, source)
    np.testing.assert_allclose(other.static.position, one.static.position, rtol=1e-6, atol=1e-7)
    for a, b in zip(_std(one), _std(other), strict=True):
        np.testing.assert_allclose(b, a, rtol=1e-6)
    for a, b in zip(one.wave.tension, other.wave.tension, strict=True):
        np.testing.assert_allclose(np.abs(b), np.abs(a), atol=1e-6 * np.abs(a).max())


def test_multiplicity_is_so_many_coincident_lines(source) -> None:  # type: ignore[no-untyped-def]
    together = coupled([sea()])
    apart = copy.deepcopy(together)
    for name, line in list(apart["lines"].items()):
        line["multiplicity"] = 1
        apart["lines"][f"{name}-again"] = copy.deepcopy(line)
    one, two = _solve(together, source), _solve(apart, source)
    for a, b in zip(_std(one), _std(two), strict=True):
        np.testing.assert_allclose(b, a, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(two.wave.tension[0], one.wave.tension[0], atol=1e-9 * np.abs(one.wave.tension[0]).max())


def test_two_halves_of_a_sea_are_the_sea(source) -> None:  # type: ignore[no-untyped-def]
    """S = S/2 + S/2 from one direction: every σ the same, the slow drift across the halves included."""
    half = sea(4.0 / np.sqrt(2))
    one, two = _solve(coupled([sea(4.0)]), source), _solve(coupled([half, dict(half)]), source)
    for a, b in zip(_std(one), _std(two), strict=True):
        np.testing.assert_allclose(b, a, rtol=1e-5)


def test_wave_systems_superpose_under_frozen_drag(source) -> None:  # type: ignore[no-untyped-def]
    """With drag and slow drift switched off the system is linear: variances of two seas add."""

    def still(seas: list[dict[str, Any]]) -> dict[str, Any]:
        data = coupled(seas)
        data["line_types"]["chain"]["drag"] = {"normal": 0, "tangential": 0}
        data["environment"]["seabed"]["damping"] = 100.0
        data["vessel"]["hydrodynamics"]["drift"] = "none"
        return data

    def variance(seas: list[dict[str, Any]]) -> np.ndarray:
        result = _solve(still(seas), source)
        assert result.low is None
        assert result.wave.vessel is not None
        return np.einsum("rw,riw->i", result.driver.wave.loads.weight, np.abs(result.wave.vessel) ** 2)

    a, b = sea(3.0, 9.0, 200.0), sea(2.0, 7.0, 130.0)
    np.testing.assert_allclose(variance([a, b]), variance([a]) + variance([b]), rtol=1e-10)


def test_twice_the_sea_is_less_than_twice_the_motion_of_a_dragged_line() -> None:
    data = example("hanging-riser-case2")
    data["environment"]["seastates"] = [sea(2.0, 9.0, 0.0)]
    data["analyses"] = {
        "frequency_domain": {"wave": {"from": 0.3, "to": 1.5, "step": 0.1}, "low": {"to": 0.3, "step": 0.1}}
    }
    small = _solve(data)
    data["environment"]["seastates"] = [sea(4.0, 9.0, 0.0)]
    large = _solve(data)
    ratio = large.linear.damping[0][10:60, 2, 2] / small.linear.damping[0][10:60, 2, 2]
    assert np.all((ratio > 1.3) & (ratio < 2.5))  # damping grows with the sea, near in proportion


def test_low_velocities_add_damping_and_can_be_left_out(source) -> None:  # type: ignore[no-untyped-def]
    with_low = _solve(coupled([sea()]), source)
    without = _solve(coupled([sea()], include_low_velocities=False), source)
    gain = [np.trace(a.sum(axis=0)) / np.trace(b.sum(axis=0)) for a, b in zip(with_low.linear.damping, without.linear.damping,
                                                                         strict=True)]  # fmt: skip
    assert min(gain) > 1.0
    wave_only = np.concatenate([c.ravel() for c in without.wave.covariance])
    assert np.isfinite(wave_only).all()
    assert without.low is not None  # the slow response is still given
    assert _std(without)[1][0] > _std(with_low)[1][0]


def test_the_answer_is_the_fixed_point_of_its_own_linearisation(source) -> None:  # type: ignore[no-untyped-def]
    from solver.frequency_domain.linearise import DragState, linearise

    result = _solve(coupled([sea()], tolerance=1e-8), source)
    assert result.low is not None
    state = DragState([a + b for a, b in zip(result.wave.covariance, result.low.covariance, strict=True)], np.zeros(6))
    again = linearise(result.geometries, state, np.zeros(6), True, False)
    for a, b in zip(result.linear.damping, again.damping, strict=True):
        np.testing.assert_allclose(b, a, atol=1e-6 * np.abs(a).max())
    assert sigmas(result.geometries, state).max() > 0.1


def test_iterations_are_reported_and_a_tighter_tolerance_takes_more(source) -> None:  # type: ignore[no-untyped-def]
    loose, tight = (_solve(coupled([sea()], tolerance=t), source) for t in (1e-2, 1e-8))
    assert 1 < loose.iterations < tight.iterations < 60
    assert loose.last_change < 1e-2
    assert tight.last_change < 1e-8
    for a, b in zip(_std(loose), _std(tight), strict=True):
        np.testing.assert_allclose(a, b, rtol=0.02)


def test_no_convergence_is_a_failure_that_says_so(source) -> None:  # type: ignore[no-untyped-def]
    data = coupled([sea()], max_iterations=2)
    with pytest.raises(NotConverged, match=r"did not settle in 2 iterations.*max_iterations") as caught:
        _solve(data, source)
    assert caught.value.analysis == "frequency_domain"
    result = run(parse_case(data), source)
    assert "did not settle" in result.summary["failures"]["frequency_domain"]
    assert "frequency_domain" not in result.summary


def test_regular_and_random_together_are_refused() -> None:
    data = example("hanging-riser-case2")
    data["environment"]["seastates"].append(sea())
    with pytest.raises(CaseError, match="cannot mix"):
        parse_case(data)


@pytest.mark.parametrize("linearisation", ["component", "vector"])
def test_vessels_quadratic_damping_is_linearised_with_its_velocity_along_its_own_axes(
    linearisation: str, source
) -> None:  # type: ignore[no-untyped-def]
    data = coupled([sea()], linearisation=linearisation, tolerance=1e-7)
    data["vessel"]["damping"]["quadratic"] = {"surge": 2e5, "roll": 1e8}
    result = _solve(data, source)
    variance = np.zeros(6)
    for response, band in ((result.wave, result.driver.wave), (result.low, result.driver.low)):
        assert response is not None
        assert response.vessel is not None
        assert band is not None
        velocity = (
            np.einsum("ji,rjw->riw", turning(float(result.static.position[5])), response.vessel) * band.strips.omega
        )
        variance += np.einsum("rw,riw->i", band.loads.weight, np.abs(velocity) ** 2)
    expected = np.sqrt(8 / np.pi * variance) * [2e5, 0, 0, 1e8, 0, 0]
    np.testing.assert_allclose(result.linear.vessel, expected, rtol=1e-5)


def test_finer_strips_change_little(source) -> None:  # type: ignore[no-untyped-def]
    coarse, fine = coupled([sea()]), coupled([sea()])
    coarse["analyses"]["frequency_domain"].update(
        wave={"from": 0.3, "to": 1.5, "step": 0.01}, low={"to": 0.3, "step": 0.005}
    )
    fine["analyses"]["frequency_domain"].update(
        wave={"from": 0.3, "to": 1.5, "step": 0.005}, low={"to": 0.3, "step": 0.0025}
    )
    for a, b in zip(_std(_solve(coarse, source)), _std(_solve(fine, source)), strict=True):
        np.testing.assert_allclose(a, b, rtol=0.01)


def test_a_fairlead_moves_as_the_vessel_carries_it(source: Any) -> None:
    """The nodes' motion RAO at end b is the vessel's RAO moved to the fairlead: u + θ × r, on its own headings too."""
    data = coupled([sea()])
    data["vessel"]["heading"], data["analyses"]["statics"] = "30 deg", {}
    case = parse_case(data)
    result = run(case, source, threads=1)
    channels = {channel.name: channel for channel in result.channels}
    standing = rotation(np.asarray(result.summary["statics"]["vessel"]["position"][3:]))

    def complex_of(stem: str) -> tuple[np.ndarray, np.ndarray]:
        amplitude, phase = channels[f"{stem}_amplitude"], channels[f"{stem}_phase"]
        return amplitude.axes[0].values, amplitude.values * np.exp(1j * phase.values)

    turned = np.array(
        [[np.cos(np.pi / 6), -np.sin(np.pi / 6), 0], [np.sin(np.pi / 6), np.cos(np.pi / 6), 0], [0, 0, 1]]
    )
    omega, _ = complex_of("frequency/vessel/surge_rao")
    s = np.array([complex_of(f"frequency/vessel/{dof}_rao")[1] for dof in DOF])
    for name, line in case.lines.items():
        at, moved = complex_of(f"frequency/line/{name}/motion_rao")
        picks = np.searchsorted(omega, at - 1e-9)
        u, angle = s[:3, picks].T, s[3:, picks].T
        arm = standing @ np.asarray(line.end_b.fairlead, dtype=float)
        carried = (u + np.cross(angle, arm)) @ turned.T
        np.testing.assert_allclose(moved[:, -1], carried, atol=2e-6 * np.abs(carried).max())
        assert np.abs(moved[:, 0]).max() < 1e-12  # the anchor stands still


def test_a_run_says_what_the_check_of_its_case_says(source: Source) -> None:
    data = coupled([sea(tp=25.0)], elements=4)
    said = check(parse_case(data), source)
    assert any("the wave band 0.3 to 1.5 rad/s holds Hs" in text for text in said)
    warnings = run(parse_case(data), source, threads=1).summary["warnings"]
    assert set(said) <= set(warnings)
    assert len(set(warnings)) == len(warnings)
