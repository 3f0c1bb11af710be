"""Channels to bytes and back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from solver.results.channel import Axis, Channel
from store.arrays import FLOAT32, FLOAT64, decode, encode


def channel(values: np.ndarray, *axes: Axis) -> Channel:
    return Channel(
        "x/y", values, axes or tuple(Axis(f"d{i}", "", np.arange(n)) for i, n in enumerate(values.shape)), "N", "", "wf"
    )


def there_and_back(given: Channel) -> Channel:
    return decode(encode(given), given.name, given.unit, given.description, given.band)


@settings(max_examples=60, deadline=None)
@given(
    arrays(
        np.float32,
        array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=9),
        elements=st.floats(-(2.0**99), 2.0**99, width=32),
    )
)
def test_float32_values_come_back_exactly(values: np.ndarray) -> None:
    back = there_and_back(channel(values.astype(float)))
    np.testing.assert_array_equal(back.values, values)
    assert back.values.shape == values.shape


@pytest.mark.parametrize("scale", [1e-40, 1e60])
def test_values_beyond_float32_stay_float64(scale: float) -> None:
    values = scale * np.array([1.0, 2.0, 3.0])
    assert encode(channel(values)).codec == FLOAT64
    np.testing.assert_array_equal(there_and_back(channel(values)).values, values)
    assert encode(channel(values / scale)).codec == FLOAT32


@pytest.mark.parametrize(
    "axis",
    [
        np.linspace(0, 5026.55, 12567),
        np.arange(0.2, 1.2, 0.005),
        np.geomspace(1e-9, 7, 300),
        np.array([3.0]),
        np.empty(0),
    ],
)
def test_axes_keep_every_bit(axis: np.ndarray) -> None:
    back = there_and_back(channel(np.zeros(axis.size), Axis("t", "s", axis)))
    np.testing.assert_array_equal(back.axes[0].values, axis)
    assert (back.axes[0].name, back.axes[0].unit, back.band, back.unit) == ("t", "s", "wf", "N")


def test_an_evenly_spaced_axis_costs_nothing() -> None:
    even = encode(channel(np.zeros(100_000), Axis("t", "s", np.arange(100_000) * 0.5)))
    assert len(even.axes_payload) < 50


def test_a_smooth_channel_gets_smaller() -> None:
    t = np.arange(20_000) * 0.4
    values = 1e6 + 1e4 * np.sin(0.5 * t)
    assert len(encode(channel(values, Axis("t", "s", t))).payload) < 0.85 * 4 * t.size
