"""Regular waves in a random sea: components of one grid, so that what is linear is the sum of both."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.outcome import CaseError
from solver.run import run
from solver.time_domain.block import Run
from solver.vessel.drift import Drift
from tests.systems import Source, moored_box
from tests.time_domain.systems import marched, prepared, timed

PERIOD = 7.3  # s: no whole fraction of the record
RANDOM = {"spectrum": "jonswap", "hs": 2e-4, "tp": 9, "gamma": 2, "direction": "200 deg"}
REGULAR = {"wave": "regular", "height": 3e-4, "period": PERIOD, "direction": "150 deg", "phase": "40 deg"}
STEP = 2 * math.pi / PERIOD / 8  # the fraction of its frequency next to 2π/60


def _box(seas: list[dict[str, Any]], drift: str = "none", **spec: Any) -> dict[str, Any]:
    data = moored_box(6, 3, hydrodynamics={"data": "box.nc", "radiation": "constant", "frequency": 0.6, "drift": drift})
    data["vessel"]["damping"] = {"linear": {"surge": 5e4, "sway": 8e4, "yaw": 1e7}}
    data["line_types"]["chain"]["drag"] = {"normal": 0.0, "tangential": 0.0}
    data["environment"]["seastates"] = copy.deepcopy(seas)
    data["analyses"] = {}
    return timed(data, **{"step": 0.1, "build_up": 20.0, "duration": 60.0, "output_step": 0.5, **spec})


@pytest.fixture(scope="module")
def mixed(source: Source) -> Run:
    return Run(*prepared(_box([REGULAR, RANDOM], "newman"), source))


def test_the_regular_wave_is_one_component_of_the_grid(mixed: Run) -> None:
    waves = mixed.waves
    assert waves is not None
    assert waves.step == pytest.approx(STEP, rel=1e-12)  # found from the duration of 60 s
    A = waves.amplitudes(1, False)
    index = int(np.argmax(np.abs(A[0])))
    assert waves.omega[index] == pytest.approx(2 * math.pi / PERIOD, rel=1e-12)
    assert A[0, index] == pytest.approx(1.5e-4 * np.exp(1j * math.radians(40)), rel=1e-12)
    assert np.count_nonzero(A[0]) == 1
    np.testing.assert_allclose(0.5 * np.abs(A[1]) ** 2, waves.densities[1] * waves.step, rtol=1e-12)


def test_a_swell_below_the_band_widens_the_grid_and_not_the_random_sea(source: Source, mixed: Run) -> None:
    swell = {**REGULAR, "period": 25.0}
    other = Run(*prepared(_box([swell, RANDOM], wave_step=STEP * PERIOD / 25.0 * 3), source)).waves
    assert other is not None
    assert other.omega[0] == pytest.approx(2 * math.pi / 25.0)
    inside = (other.omega > 0.2 - 1e-9) & (other.omega < 1.2 + 1e-9)
    assert np.all((np.abs(other.amplitudes(4, False)[1]) > 0) == inside)


def test_the_common_slow_drift_of_two_directions_is_said_to_be_a_guess(source: Source) -> None:
    _, static, _ = prepared(_box([REGULAR, RANDOM], "newman"), source)
    assert len([text for text in static.warnings if "different directions" in text]) == 1
    for seas, drift in (([REGULAR, RANDOM], "none"), ([{**REGULAR, "direction": "200 deg"}, RANDOM], "newman")):
        _, static, _ = prepared(_box(seas, drift), source)
        assert not [text for text in static.warnings if "different directions" in text]


def test_its_slow_drift_with_the_random_waves_is_the_double_sum(mixed: Run) -> None:
    assert mixed.vessel is not None
    assert mixed.model.vessel is not None
    waves = mixed.waves
    assert waves is not None
    A = waves.amplitudes(2, False)
    first, mixed.vessel.first_order = mixed.vessel.first_order, [0.0 * X for X in mixed.vessel.first_order]
    table = mixed.vessel.table(A)
    random_only = mixed.vessel.table(A * np.array([[0.0], [1.0]]))
    mixed.vessel.first_order = first
    t2 = Drift(mixed.model.vessel.data, mixed.model.vessel.drift, float(mixed.static.position[5]))
    own = int(np.argmax(np.abs(A[0])))
    low = [n for n in range(waves.omega.size) if n != own and abs(n - own) * waves.step <= 0.2 + 1e-9]
    times = mixed.vessel.step * np.array([0, 17, 200, 431])
    cross = np.zeros((times.size, 6))
    for n in low:
        T = t2(waves.omega[own], waves.omega[n], waves.directions[0], waves.directions[1])
        turn = np.exp(1j * times * (waves.omega[own] - waves.omega[n]))
        cross += 2 * (A[0, own] * np.conj(A[1, n]) * turn[:, None] * T).real
    assert np.abs(cross).max() > 0.05 * np.abs(random_only).max()
    np.testing.assert_allclose((table - random_only)[[0, 17, 200, 431]], cross, atol=1e-9 * np.abs(table).max())


def test_the_linear_response_is_the_sum_of_both(source: Source) -> None:
    """Waves of tenths of a millimetre, no drag: what is left of the lines' nonlinearity is far below a thousandth."""
    both, random, regular = (
        marched(_box(seas, wave_step=STEP, tolerance=1e-10), source, (3,))[0].vessel[:, 0]
        for seas in ([REGULAR, RANDOM], [RANDOM], [REGULAR])
    )
    size = np.abs(both).max(axis=0)
    assert np.all(np.abs(regular).max(axis=0) > 0.05 * size)
    assert np.all(np.abs(random).max(axis=0) > 0.05 * size)
    assert np.all(np.abs(both - random - regular).max(axis=0) < 1e-3 * size)


def test_the_result_has_spectra_and_the_first_harmonic(source: Source) -> None:
    data = _box([RANDOM, REGULAR])
    data["analyses"]["statics"] = {}
    result = run(parse_case(data), source)
    names = {channel.name for channel in result.channels}
    assert {"time/vessel/heave_spectrum", "time/line/line-0/tension_first_harmonic"} <= names
    assert result.summary["time_domain"]["vessel_std"]["wf"]["heave"] > 0


def test_regular_waves_of_two_periods_are_refused() -> None:
    with pytest.raises(CaseError, match="regular waves of one period"):
        parse_case(_box([RANDOM, REGULAR, {**REGULAR, "period": 9.0}]))


def test_the_frequency_domain_still_refuses_the_mix() -> None:
    data = _box([RANDOM, REGULAR])
    data["analyses"]["frequency_domain"] = {}
    with pytest.raises(CaseError, match="cannot mix"):
        parse_case(data)
