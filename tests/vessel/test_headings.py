"""Headings outside the data: the nearest one within 5 deg, statics at any distance, each with its warning (V29)."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from solver.case import parse_case
from solver.outcome import CaseError, DataError
from solver.vessel.data.interpolate import NEAR, heading_weights, outside
from solver.vessel.drift import Drift
from solver.vessel.fit import fit
from solver.vessel.headings import off_the_headings

from .test_quality import consistent, with_pairs


def one_heading(degrees=0.0):
    data = with_pairs(consistent())
    at = round(degrees / 10)
    drift = data.mean_drift[:, [at]]
    pairs = dataclasses.replace(data.qtf, headings=data.headings[[at]])
    few = {"headings": data.headings[[at]], "excitation": data.excitation[:, [at]]}
    return dataclasses.replace(data, **few, mean_drift=drift, qtf=pairs)


def case(direction, analyses=("statics", "frequency_domain"), drift="newman"):
    wave = {"wave": {"from": 0.2, "to": 1.2, "step": 0.02}, "low": {"to": 0.2, "step": 0.01}}
    return parse_case({
        "slowdrift": 1, "name": "t",
        "environment": {
            "depth": 200, "water": {"density": 1025, "gravity": 9.807},
            "seastates": [{"spectrum": "jonswap", "hs": 3, "tp": 9, "direction": f"{direction} deg"}],
        },
        "vessel": {
            "mass": 1e7, "centre_of_gravity": [0, 0, 0], "radii_of_gyration": [10, 10, 10],
            "hydrodynamics": {"data": "x", "drift": drift}, "hydrostatics": {"displaced_volume": 1e4},
        },
        "analyses": {name: wave if name == "frequency_domain" else {} for name in analyses},
    })  # fmt: skip


@pytest.mark.parametrize("degrees", [0.02, 4.9, 355.1, -3.0])
def test_the_nearest_heading_within_5_degrees_stands_in(degrees):
    data = one_heading()
    omega, heading = data.omega[3:5], math.radians(degrees)
    assert np.array_equal(data.excitation_at(omega, heading), data.excitation_at(omega, 0.0))
    assert np.array_equal(data.mean_drift_at(omega, heading), data.mean_drift_at(omega, 0.0))
    at = data.qtf.omega[:2]
    assert np.array_equal(data.qtf.at(at, at, heading), data.qtf.at(at, at, 0.0))
    found = outside(data.headings, heading)
    assert found is not None
    assert math.degrees(found[1]) == pytest.approx(min(degrees % 360, 360 - degrees % 360))


@pytest.mark.parametrize("degrees", [5.1, 90.0, 354.0])
def test_farther_headings_are_refused(degrees):
    data, heading = one_heading(), math.radians(degrees)
    for ask in (
        lambda: data.excitation_at(data.omega, heading),
        lambda: data.mean_drift_at(data.omega, heading),
        lambda: data.qtf.at(data.qtf.omega, data.qtf.omega, heading),
    ):
        with pytest.raises(DataError, match="waves meet the vessel at"):
            ask()
    assert np.array_equal(data.mean_drift_at(data.omega, heading, far=True), data.mean_drift_at(data.omega, 0.0))


def test_headings_inside_the_data_are_interpolated_as_before():
    headings = np.radians([0.0, 30.0, 60.0])
    assert heading_weights(headings, math.radians(45.0), "a") == pytest.approx((1, 2, 0.5))
    assert outside(headings, math.radians(45.0)) is None
    assert heading_weights(headings, math.radians(63.0), "a") == (2, 2, 0.0)
    assert heading_weights(headings, math.radians(-4.0), "a") == (0, 0, 0.0)
    with pytest.raises(DataError):
        heading_weights(headings, math.radians(63.0), "a", reach=0.0)
    gap = np.radians([0.0, 120.0])  # wider than 90 deg: nothing between
    assert heading_weights(gap, math.radians(116.0), "a") == (1, 1, 0.0)
    with pytest.raises(DataError):
        heading_weights(gap, math.radians(60.0), "a")
    assert math.degrees(NEAR) == pytest.approx(5.0)


@pytest.mark.parametrize("drift", ["newman", "qtf"])
def test_a_case_near_the_heading_is_warned(drift):
    warnings = [text for text in fit(case(3.0, drift=drift), one_heading()) if "outside the headings" in text]
    table = "the QTF" if drift == "qtf" else "the mean drift"
    assert len(warnings) == 2
    assert (
        "waves meet the vessel at 3 deg, outside the headings of the wave force; that of 0 deg is used, 3 deg away"
        in warnings[0]
    )
    assert table in warnings[1]
    assert not [text for text in fit(case(0.0, drift=drift), one_heading()) if "outside the headings" in text]


def test_waves_from_elsewhere_are_refused_and_statics_is_had():
    with pytest.raises(CaseError, match="waves meet the vessel at 40 deg"):
        fit(case(40.0), one_heading())
    said = [text for text in fit(case(40.0, ("statics",)), one_heading()) if "outside the headings" in text]
    assert any(
        "the mean drift; that of 0 deg is used, 40 deg away (threshold 5 deg, which statics takes" in text
        for text in said
    )


def test_the_mean_drift_of_statics_is_that_of_the_nearest_heading_turned_with_the_vessel():
    """At a yaw of -30 deg the force of heading 0 acts along the vessel's own axis."""
    data, omega = one_heading(), np.array([0.5])
    found = Drift(data, "newman", math.radians(-30.0), far=True)(omega, omega, 0.0, 0.0)[0]
    size = data.mean_drift_at(omega, 0.0)[0, 0]
    assert found[:2] == pytest.approx(size * np.array([math.cos(math.pi / 6), -math.sin(math.pi / 6)]))
    with pytest.raises(DataError):
        Drift(data, "newman", math.radians(-30.0))(omega, omega, 0.0, 0.0)


def test_a_static_yaw_out_of_the_headings_is_told():
    (force, drift) = off_the_headings(one_heading(), "newman", [0.0, 0.0], math.radians(-12.0))
    assert (
        "waves meet the vessel, at a static yaw of -12 deg, at 12 deg, outside the headings of the wave force" in force
    )
    assert "12 deg away" in drift
