"""The pictures beside the form: against the solver's own spectra, and against closed forms."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from plotly.utils import PlotlyJSONEncoder

from frontend.editor.preview import facts
from frontend.editor.text import EditError
from frontend.figures import preview
from frontend.figures.sea import described, jonswap, sea_figure
from solver.case import parse_case
from solver.waves.spectra import SPECTRA


@pytest.mark.parametrize("gamma", [1.0, 2.0, 3.3, 7.0])
def test_the_sea_drawn_is_the_sea_computed(gamma: float) -> None:
    """Against solver/waves, whose members are tested by their own integrals."""
    omega = np.linspace(0.3, 2.0, 200)
    sea: dict[str, Any] = {"spectrum": "jonswap", "hs": "6 m", "tz": "8 s", "gamma": gamma, "direction": "180 deg"}
    lines = {
        "a": {
            "segments": [{"type": "w", "length": 80, "elements": 4}],
            "end_a": {"pinned": [0, 0, -50]},
            "end_b": {"pinned": [40, 0, 0]},
        }
    }
    types = {"w": {"diameter": 0.1, "mass": 100, "EA": 1e8}}
    case = parse_case({"slowdrift": 1, "name": "x", "environment": {"depth": 100, "seastates": [sea]}, "line_types": types,
                       "lines": lines, "analyses": {"statics": {}}})  # fmt: skip
    [system] = case.environment.random
    expected = SPECTRA["jonswap"](omega, system)
    drawn = jonswap(omega, 6.0, 8.0 * math.sqrt((11 + gamma) / (5 + gamma)), gamma)
    assert drawn == pytest.approx(expected, rel=2e-3, abs=1e-6)


def test_the_area_under_a_spectrum_is_a_sixteenth_of_hs_squared() -> None:
    omega = np.linspace(1e-3, 60, 200_000)
    assert np.trapezoid(jonswap(omega, 4.0, 10.0, 3.3), omega) == pytest.approx(1.0, rel=1e-3)


def test_units_of_the_sea_are_the_engineers() -> None:
    base = {"spectrum": "pierson-moskowitz", "hs": "10 ft", "tp": "0.2 min", "direction": "3.14 rad"}
    assert described(base)[2] == "pierson-moskowitz, Hs 3.048 m, Tp 12 s"
    for wrong in ({"hs": "10 bananas"}, {"tp": "x"}, {"hs": "-1 m"}):
        with pytest.raises(EditError):
            described(base | wrong)


def test_two_systems_are_drawn_with_their_sum() -> None:
    sea = {"spectrum": "jonswap", "hs": "3 m", "tp": "10 s", "direction": "0 deg"}
    made = sea_figure(
        [sea, sea | {"tp": "14 s"}, {"wave": "regular", "height": "2 m", "period": "9 s", "direction": "0 deg"}]
    )
    names = [trace["name"] for trace in made["data"]]
    assert names[-1] == "together"
    first, second, whole = (made["data"][i] for i in (0, 1, 3))
    at = np.interp(0.6, whole["x"], whole["y"])
    assert at == pytest.approx(
        np.interp(0.6, first["x"], first["y"]) + np.interp(0.6, second["x"], second["y"]), rel=1e-2
    )


SHAPE = {
    "statics": {
        "lines": {"a": {"grounded_length": 50.0}, "b": {"grounded_length": 0.0}},
        "vessel": {"position": [3, 4, 0, 0, 0, 0]},
    },
    "lines": {
        "a": {"arc_length": [0, 100, 200], "position": [[100, 100, -50], [50, 50, -50], [0, 0, 0]]},
        "b": {"arc_length": [0, 100], "position": [[-100, 0, -50], [0, 0, 0]]},
    },
}  # fmt: skip
TREE = {
    "environment": {"depth": "50 m", "seastates": [{"direction": "90 deg"}], "current": {"direction": "0 deg"}},
    "lines": {},
}


def test_touchdown_is_where_the_grounded_length_ends() -> None:
    points = preview.touchdowns(SHAPE)
    assert list(points) == ["a"]
    assert points["a"] == pytest.approx([75, 75, -50])


def test_touchdown_of_a_line_whose_end_b_lies_on_the_bed() -> None:
    line = SHAPE["lines"]["a"]
    turned = {"arc_length": line["arc_length"], "position": line["position"][::-1]}
    points = preview.touchdowns({**SHAPE, "lines": {"a": turned}})
    assert points["a"] == pytest.approx([75, 75, -50])
    notes = preview.plan({**SHAPE, "lines": {"a": turned}}, TREE)["layout"]["annotations"]
    assert (notes[0]["text"], notes[0]["x"]) == ("45.0°", 100.0)


def test_the_plan_says_azimuths_and_directions() -> None:
    notes = preview.plan(SHAPE, TREE)["layout"]["annotations"]
    assert [n["text"] for n in notes] == ["45.0°", "180.0°", "waves", "current"]
    waves = notes[2]
    assert waves["x"] == pytest.approx(waves["ax"])  # to +y: the arrow points up
    assert waves["y"] > waves["ay"]


def test_facts_say_what_lines_and_types_weigh_in_water() -> None:
    line = {"end_a": {"tension": 1e5}, "end_b": {"tension": 2e5}, "grounded_length": 10.0, "weight_in_water": 345600.0}
    kind = {"mass": 286.56, "weight_in_water": 2443.26, "EA": 1.1649e9}
    found = facts({"statics": {"lines": {"leg": line}}, "line_types": {"chain": kind}})
    text = json.dumps(found, cls=PlotlyJSONEncoder, ensure_ascii=False)
    for words in ("in water [kN]", "345.6", "in water [N/m]", "2\u2009443", "1\u2009165"):
        assert words in text, words
    assert facts({"statics": {"lines": {}}}) is None
    assert facts({"statics": {"lines": {"leg": {}}}}) is not None  # an answer of an earlier version
