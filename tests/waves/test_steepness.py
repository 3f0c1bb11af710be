"""Waves steeper than they can be are warned of, with the number and the limit, before anything is computed."""

from __future__ import annotations

import math
from typing import Any

import pytest

from solver.case import parse_case
from solver.case.environment import Environment
from solver.check import check
from solver.waves.steepness import breaking_height, steepness_limit, steepness_warnings
from tests.systems import example

G = 9.80665


def _said(sea: dict[str, Any], depth: float = 1000.0, gravity: float = G) -> list[str]:
    data = {"depth": depth, "water": {"gravity": gravity}, "seastates": [{"direction": "0 deg", **sea}]}
    return list(steepness_warnings(Environment.model_validate(data)))


@pytest.mark.parametrize(("period", "limit"), [
    (5.0, 1 / 15), (8.0, 1 / 15), (11.5, (1 / 15 + 1 / 25) / 2), (15.0, 1 / 25), (20.0, 1 / 25),
])  # fmt: skip
def test_the_limit_of_a_random_sea(period: float, limit: float) -> None:
    assert steepness_limit(period) == pytest.approx(limit, rel=1e-12)


def test_the_storm_that_ran_is_warned_of() -> None:
    """Hs 17 m with Tp 10 s: 0.109 where seas have at most 0.059."""
    (said,) = _said({"spectrum": "jonswap", "hs": 17, "tp": 10})
    assert said.startswith("environment.seastates.0: Hs 17 m with Tp 10 s has a steepness 2πHs/(gTp²) of 0.109")
    assert "limit 0.059, which is Hs 9.22 m" in said


@pytest.mark.parametrize("tp", [6.0, 8.0, 12.0, 15.0, 18.0])
@pytest.mark.parametrize("kind", ["jonswap", "pierson-moskowitz"])
def test_just_below_the_limit_nothing_is_said_and_just_above_it_is(tp: float, kind: str) -> None:
    highest = steepness_limit(tp) * G * tp**2 / (2 * math.pi)
    assert _said({"spectrum": kind, "hs": 0.999 * highest, "tp": tp}) == []
    assert len(_said({"spectrum": kind, "hs": 1.001 * highest, "tp": tp})) == 1


def test_a_mean_period_counts_by_its_peak_period() -> None:
    """Tp = Tz √((11+γ)/(5+γ)): the example's storm, Hs 15.7 m and Tz 13.5 s, is no steeper than 0.030."""
    assert _said({"spectrum": "jonswap", "hs": 15.7, "tz": 13.5, "gamma": 2}) == []
    assert len(_said({"spectrum": "jonswap", "hs": 15.7, "tz": 11.0, "gamma": 2})) == 1


@pytest.mark.parametrize(("hs", "count"), [(6.0, 0), (14.0, 1)])
def test_a_table_counts_by_its_own_height_and_peak(hs: float, count: int) -> None:
    """A narrow triangle at 2π/10 rad/s with the area Hs²/16."""
    peak, half = 2 * math.pi / 10, 0.02
    table = {"frequencies": [peak - half, peak, peak + half], "densities": [0.0, hs**2 / 16 / half, 0.0]}
    found = _said({"spectrum": "tabulated", **table})
    assert len(found) == count
    if count:
        assert "Hs 14 m with Tp 10 s" in found[0]


@pytest.mark.parametrize(("period", "depth", "height"), [
    (10.0, 1000.0, 0.142 * G * 100.0 / (2 * math.pi)),  # deep: λ = gT²/2π
    (20.0, 2.0, 0.142 * 2 * math.pi * 2.0),  # shallow: tanh kd = kd, a height of 0.89 d
])  # fmt: skip
def test_the_height_at_which_a_regular_wave_breaks(period: float, depth: float, height: float) -> None:
    assert breaking_height(period, depth, G) == pytest.approx(height, rel=0.02)


@pytest.mark.parametrize(("period", "depth"), [(10.0, 1000.0), (8.0, 20.0), (12.0, 10.0)])
def test_a_regular_wave_just_below_and_just_above_breaking(period: float, depth: float) -> None:
    highest = breaking_height(period, depth, G)
    regular = {"wave": "regular", "period": period}
    assert _said({**regular, "height": 0.999 * highest}, depth) == []
    (said,) = _said({**regular, "height": 1.001 * highest}, depth)
    assert f"before it breaks, {highest:.3g} m" in said


def test_the_check_of_a_case_says_it() -> None:
    data = example("hanging-riser-case2")
    assert check(parse_case(data), None) == []
    data["environment"].update(depth="60 m")
    data["environment"]["seastates"][0].update(height=50.0, period=20.0)
    (said,) = check(parse_case(data), None)
    assert "a regular wave of 50 m and 20 s in a depth of 60 m" in said
    data["environment"]["seastates"] = [{"spectrum": "jonswap", "hs": 17, "tp": 10, "direction": "0 deg"}]
    (said,) = check(parse_case(data), None)
    assert "Hs 17 m with Tp 10 s" in said
