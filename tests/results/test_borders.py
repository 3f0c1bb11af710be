"""Statistics, channels and parts at their borders: few crossings, one bad value, what goes through bytes."""

from __future__ import annotations

import numpy as np
import pytest

from solver.case import parse_case
from solver.model.build import build
from solver.results.channel import Axis, Channel
from solver.results.part import Part
from solver.results.statistics import combined_maximum, most_probable_maximum, significant
from solver.results.summary import provenance
from tests.results.values.linear import jonswap
from tests.systems import span


def test_a_maximum_is_at_least_the_standard_deviation() -> None:
    """Half a wave in the duration, or none, leaves σ; a thousand give σ √(2 ln 1000); nothing stays nothing."""
    omega = 0.5
    sigma, waves = np.array([2.0, 2.0, 2.0, 0.0]), np.array([0.5, 1000.0, 1.2, 5.0])
    for number, expected in zip(waves, (2.0, 2.0 * np.sqrt(2 * np.log(1000.0)), 2.0, 0.0), strict=True):
        duration = number * 2 * np.pi / omega
        own = sigma[list(waves).index(number)]
        assert most_probable_maximum(own, own**2 * omega**2, duration) == pytest.approx(expected, rel=1e-9)


def test_maxima_of_two_bands() -> None:
    """5 with twice 1 against 3 with twice 4: the second."""
    assert combined_maximum(np.array(4.0), np.array(5.0), np.array(1.0), np.array(3.0)) == 11.0
    assert combined_maximum(np.array(1.0), np.array(9.0), np.array(1.0), np.array(3.0)) == 11.0
    assert significant(np.array(1.5)) == 3.0


def _channel(values: np.ndarray) -> Channel:
    axes = (Axis("omega", "rad/s", np.array([0.1, 0.2])), Axis("arc_length", "m", np.arange(3.0)))
    return Channel("frequency/line/a/tension", values, axes, "N2 s/rad", "words", "lf")


def test_one_value_that_is_not_finite_is_refused() -> None:
    values = np.arange(6.0).reshape(2, 3)
    assert _channel(values).dims == ("omega", "arc_length")
    for bad in (np.nan, np.inf):
        with pytest.raises(ValueError, match="not every value is finite"):
            _channel(np.where(values == 4.0, bad, values))
    with pytest.raises(ValueError, match="shape"):
        _channel(values.T)


def test_a_part_comes_back_from_its_bytes() -> None:
    part = Part({"a": {"b": [1.5, None]}}, (_channel(np.arange(6.0).reshape(2, 3)),), {"x": np.arange(4)})
    back = Part.from_bytes(part.to_bytes())
    (channel,), (one,) = back.channels, part.channels
    assert back.summary == part.summary
    assert (channel.name, channel.unit, channel.description, channel.band) == (
        one.name,
        one.unit,
        one.description,
        one.band,
    )
    np.testing.assert_array_equal(channel.values, one.values)
    assert [(axis.name, axis.unit, list(axis.values)) for axis in channel.axes] == [
        (axis.name, axis.unit, list(axis.values)) for axis in one.axes
    ]
    np.testing.assert_array_equal(back.arrays["x"], np.arange(4))


def test_provenance_without_a_frequency_domain_takes_its_default_band() -> None:
    """0.2 to 1.2 rad/s; the peak period is that of the first system."""
    data = span(110.0, (0, 0, -80), (60, 0, -5))
    data["environment"]["seastates"] = [
        {"spectrum": "jonswap", "hs": 3.0, "tp": 5.5, "gamma": 2.0, "direction": "0 deg"},
        {"spectrum": "jonswap", "hs": 1.0, "tp": 12.0, "gamma": 1.0, "direction": "0 deg"},
    ]
    found = provenance(build(parse_case(data), None))
    omega = np.linspace(0.2, 1.2, 100_001)
    inside = [
        4 * np.sqrt(np.trapezoid(jonswap(omega, hs, 2 * np.pi / tp, gamma), omega))
        for hs, tp, gamma in ((3.0, 5.5, 2.0), (1.0, 12.0, 1.0))
    ]
    assert [one["hs_in_band"] for one in found["seastates"]] == pytest.approx(inside, rel=1e-5)
    assert found["hs_in_band"] == pytest.approx(np.hypot(*inside), rel=1e-5)
    assert (found["tp"], [one["tp"] for one in found["seastates"]]) == (5.5, [5.5, 12.0])
    assert inside[0] < 2.7  # the band cuts much of it
