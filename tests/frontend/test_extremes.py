"""The distribution of maxima: against Gumbel's own closed forms and SciPy's sampler."""

from __future__ import annotations

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from plotly.utils import PlotlyJSONEncoder
from scipy.stats import gumbel_r

from frontend.figures.extremes import EULER, fractile, gumbel, paper
from frontend.format import number, percent
from frontend.panels import extremes as panel


def test_moments_give_back_the_distribution_they_come_from() -> None:
    values = gumbel_r.rvs(loc=5000, scale=200, size=200_000, random_state=7)
    location, scale = gumbel(values)
    assert location == pytest.approx(5000, rel=1e-3)
    assert scale == pytest.approx(200, rel=1e-2)


@pytest.mark.parametrize("probability", [0.1, math.exp(-1), 0.5, 0.9, 0.99])
def test_fractiles_are_scipys(probability: float) -> None:
    assert fractile(10.0, 2.0, probability) == pytest.approx(gumbel_r.ppf(probability, loc=10.0, scale=2.0))


def test_the_mean_lies_eulers_constant_scales_above_the_most_probable() -> None:
    location, scale = gumbel([1.0, 2.0, 4.0])
    assert location + EULER * scale == pytest.approx(7 / 3)
    assert scale == pytest.approx(math.sqrt(6) / math.pi * np.std([1, 2, 4], ddof=1))


def test_the_fit_is_a_straight_line_on_gumbel_paper() -> None:
    location, scale = gumbel([1.0, 2.0, 4.0])
    dots, fit = paper([4.0, 1.0, 2.0], "x", "kN")["data"]
    assert list(dots["x"]) == [1, 2, 4]
    assert dots["y"] == pytest.approx(-np.log(-np.log(np.array([0.25, 0.5, 0.75]))))
    assert fit["x"] == pytest.approx(location + scale * np.asarray(fit["y"]))


def test_the_table_says_the_storm_and_both_domains() -> None:
    """Moved to a storm e times as long, the most probable largest rises by one scale."""
    summary = {
        "time_domain": {
            "duration": 1000.0,
            "lines": {"a": {"end_b_max_per_seed": [1e6, 2e6, 4e6]}, "b": {"end_b_max_per_seed": [1e6]}},
        },
        "frequency_domain": {"storm_duration": 1000.0 * math.e, "lines": {"a": {"tension_most_probable_max": [1e6, 3e6]}}},
    }  # fmt: skip
    results = SimpleNamespace(summary=summary)
    assert panel.per_seed(results) == {"a": [1000, 2000, 4000]}  # type: ignore[arg-type]
    location, scale = gumbel([1000, 2000, 4000])
    drawn = json.dumps(panel.render(results, "surge"), cls=PlotlyJSONEncoder, ensure_ascii=False)  # type: ignore[arg-type]
    for value in (location, location + scale):
        assert number(value, 4) in drawn
    assert percent(3000 / (location + scale)) in drawn
    assert panel.render(SimpleNamespace(summary={}), "surge") == []  # type: ignore[arg-type]
