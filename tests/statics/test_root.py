"""The bracketed root finder: functions with hard shapes, its promise about calls, what it refuses, and its one user."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from solver.case import parse_case
from solver.model.build import build
from solver.outcome import NotConverged
from solver.statics import pretension
from solver.statics.root import Root, find_root
from tests.systems import span

SHAPES = {  # and where they change sign
    "straight": (lambda x: 3.0 * x - 1.0, 1 / 3),
    "catenary-like": (lambda x: 1.0 / (1.2 - x) - 2.0, 0.7),
    "steep": (lambda x: math.exp(30.0 * x) - 1e6, math.log(1e6) / 30.0),
    "flat": (lambda x: (x - 0.3) ** 9, 0.3),
    "kink": (lambda x: max(x - 0.7, 0.0) * 50.0 + x - 0.4, 0.4),
    "jump": (lambda x: math.copysign(1.0, x - 0.61), 0.61),
    "large": (lambda x: 1e300 * (x - 0.123), 0.123),
    "tiny": (lambda x: 1e-300 * (x - 0.123), 0.123),
}


def search(function, low, high, tolerance):
    calls = []

    def counted(x):
        calls.append(x)
        return function(x)

    found = find_root(counted, low, high, tolerance, function(low), function(high))
    assert found.calls == len(calls)
    assert all(low <= x <= high for x in calls)
    return found


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_change_of_sign_is_found_within_the_tolerance(shape, sign):
    function, place = SHAPES[shape]
    found = search(lambda x: sign * function(x), 0.0, 1.0, 1e-9)
    assert found.value == pytest.approx(place, rel=0, abs=1.001e-9)
    assert found.width <= 2.001e-9
    assert found.calls <= math.ceil(math.log2(1.0 / 2e-9)) + 1


def test_a_smooth_function_takes_few_calls():
    assert search(SHAPES["catenary-like"][0], 0.0, 1.0, 1e-9).calls <= 10


@given(st.floats(-1e4, 1e4), st.floats(1e-3, 1e4), st.floats(0.0, 1.0), st.floats(0.1, 9.0), st.floats(1e-9, 1.0))
def test_it_never_takes_more_calls_than_bisection_and_one(low, width, share, power, tolerance):
    high = low + width
    place = low + share * width
    at = lambda x: math.copysign(abs(x - place) ** power, x - place)  # noqa: E731
    found = search(at, low, high, tolerance)
    assert abs(found.value - place) <= tolerance * (1 + 1e-9) + 4 * math.ulp(max(abs(low), abs(high)))
    assert found.calls <= max(math.ceil(math.log2(width / (2 * tolerance))), 0) + 1


def test_a_root_at_an_end_needs_no_call():
    assert find_root(math.sin, 0.0, 1.0, 1e-9, 0.0, math.sin(1.0)) == Root(0.0, 0, 0.0)
    assert find_root(math.cos, 0.0, 1.0, 1e-9, 1.0, 0.0) == Root(1.0, 0, 0.0)


def test_a_tolerance_of_nothing_ends_at_round_off():
    assert search(math.cos, 1.0, 2.0, 0.0).value == pytest.approx(np.pi / 2, abs=1e-15)


def test_what_cannot_be_found_is_said():
    with pytest.raises(NotConverged, match="no change of sign between 1 and 2"):
        find_root(math.exp, 1.0, 2.0, 1e-9, math.exp(1.0), math.exp(2.0))
    with pytest.raises(NotConverged, match="no change of sign"):
        find_root(math.exp, 1.0, 2.0, 1e-9, math.nan, 1.0)
    with pytest.raises(NotConverged, match="no value at"):
        find_root(lambda x: math.nan, 1.0, 2.0, 1e-9, -1.0, 1.0)


# --- the search for a pretension

ANCHOR = {"azimuth": "30 deg", "pretension": 1.2e6}
FOUND = {
    "radius": (2600.0, ANCHOR, 12),
    "length": ("find", {"point": [2200.0, 300.0, -800.0], "pretension": 1.2e6}, 12),
}


def line_of(length, anchor, elements):
    data = span(1.0, (0, 0, -800), (0, 0, -10), elements, depth=800.0)
    line = data["lines"]["line"]
    line["segments"][0]["length"] = length
    line["end_a"] = {"anchor": anchor}
    case = parse_case(data)
    return case, build(case, None).lines[0]


@pytest.mark.parametrize("what", FOUND)
def test_the_wanted_tension_is_met_as_with_another_root_finder(what, monkeypatch):
    case, line = line_of(*FOUND[what])
    ours, state = pretension.place(case, line, 0.0, 1e-9, 2000)
    assert pretension.top_tension(ours, state) == pytest.approx(1.2e6, rel=1e-8)
    cold = pretension.held(ours, None, 1e-10, 2000)
    assert pretension.top_tension(ours, cold) == pytest.approx(1.2e6, rel=1e-8)
    monkeypatch.setattr(
        pretension,
        "find_root",
        lambda f, low, high, *_: SimpleNamespace(value=brentq(f, low, high, rtol=1e-10, xtol=1e-6)),
    )
    theirs, _ = pretension.place(case, line, 0.0, 1e-9, 2000)
    assert ours.length == pytest.approx(theirs.length, rel=1e-9)
    assert ours.end_a.point == pytest.approx(theirs.end_a.point, rel=1e-8)
