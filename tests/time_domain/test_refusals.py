"""What must not come back as a number: each ends in a sentence that says what is wrong and where."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.outcome import CaseError, NotConverged
from solver.vessel.data import FileSource
from tests.systems import EXAMPLES, example, span
from tests.time_domain.systems import marched, timed


def _riser(amplitude: float, period: float, h: float, **kind: Any) -> dict[str, Any]:
    data = example("hanging-riser-case1")
    data["lines"]["riser"]["segments"][0]["elements"] = 34
    data["lines"]["riser"]["end_b"]["motion"]["surge"].update(amplitude=amplitude, period=period)
    data["line_types"]["riser"].update(kind)
    return timed(data, step=h, build_up=4 * period, duration=4 * period, output_step=h)


def _bed(stiffness: float, transition: float, h: float) -> dict[str, Any]:
    data = span(420.0, (0, 0, -100), (380, 0, -5), 20, mass=140.0, diameter=0.12, EA=6e8, EI=2e4)
    data["environment"]["seabed"] = {"node_stiffness": stiffness, "transition": transition}
    data["lines"]["line"]["end_b"]["motion"] = {"heave": {"amplitude": 5.0, "period": 12.0}}
    return timed(data, step=h, build_up=60.0, duration=60.0, output_step=h)


def test_a_step_far_too_large_for_the_motion() -> None:
    with pytest.raises(CaseError, match=r"3 s is too coarse for a period of 27 s; allowed: ≤ 2\.7 s"):
        marched(_riser(10.0, 27.0, 3.0))


@pytest.mark.parametrize("h", [2.0, 5.0])
def test_a_step_far_too_large_for_the_storm(h: float) -> None:
    data = example("fpso-2000m")
    for line in data["lines"].values():
        line["segments"][0]["elements"] = 10
    with pytest.raises(CaseError, match=r"too coarse for a period of 5\.2"):
        marched(timed(data, step=h, build_up=100.0, duration=400.0, output_step=h), FileSource(EXAMPLES))


@pytest.mark.parametrize(("amplitude", "h"), [(30.0, 0.05), (30.0, 0.01), (60.0, 0.05)])
def test_a_line_that_snaps_slack_and_folds(amplitude: float, h: float) -> None:
    with pytest.raises(NotConverged, match="folds by more than 75 degrees at one node at t = -"):
        marched(_riser(amplitude, 10.0, h))


def test_a_line_of_next_to_no_mass() -> None:
    """Its buoyancy is that of the riser: nothing but the step holds it."""
    with pytest.raises(NotConverged, match=r"does not converge at t = -.* even in sixteenths of 0\.05 s"):
        marched(_riser(10.0, 27.0, 0.05, mass=1e-6, added_mass={"normal": 0.0, "tangential": 0.0}))


@pytest.mark.parametrize(("amplitude", "EI", "said"), [(120.0, 120.8e3, "folds"), (300.0, 0.0, "strain above 50 %")])
def test_a_motion_far_beyond_the_line(amplitude: float, EI: float, said: str) -> None:
    with pytest.raises(NotConverged, match=said):
        marched(_riser(amplitude, 27.0, 0.05, EI=EI))


def test_a_bed_far_too_stiff_for_the_step() -> None:
    """Marched on, tension would run to ±1.5 MN; with a step of 2 ms it is -0.35 to 0.51 MN."""
    with pytest.raises(NotConverged):
        marched(_bed(2e9, 0.01, 0.05))


def test_a_step_too_large_for_a_snapping_line() -> None:
    """The largest tension would come out as 186 kN; with steps from 5 to 50 ms it is 121 kN."""
    with pytest.raises(NotConverged):
        marched(_riser(10.0, 8.0, 0.5))


def test_with_a_step_that_resolves_it_the_snapping_line_is_answered() -> None:
    tension = [marched(_riser(10.0, 8.0, h))[0].highest.max() for h in (0.04, 0.02)]
    assert tension[0] == pytest.approx(tension[1], rel=0.01)
    assert tension[1] == pytest.approx(121e3, rel=0.01)


def test_a_record_too_short_for_any_component() -> None:
    data = example("hanging-riser-case2")
    data["environment"]["seastates"] = [{"spectrum": "jonswap", "hs": 3, "tp": 9, "gamma": 2, "direction": "0 deg"}]
    with pytest.raises(CaseError, match="use a longer duration"):
        marched(timed(data, step=0.1, build_up=2.0, duration=4.0, output_step=0.1))


def test_numbers_of_what_is_answered_are_finite() -> None:
    record, _ = marched(_riser(10.0, 27.0, 0.2))
    for values in (record.tension, record.ends, record.lowest, record.highest):
        assert np.all(np.isfinite(values))
