"""YAML and JSON of a case are one thing: nothing is lost from one to the other, to the last bit."""

from __future__ import annotations

import json
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.case import Case, load_case, parse_case, to_yaml

from .decks import ROOT
from .test_moordyn_write import cases

EXAMPLES = sorted((ROOT / "examples").glob("*.yaml"))
HARD = [
    "1e5",
    "1.E5",
    "-.5",
    "+.5e-1",
    "0123456789012345678901",
    "1:30",
    "yes",
    "~",
    "<<",
    "a: b",
    "1\x85",
    "\u2028",
    "01",
]
finite = st.floats(min_value=1e-12, max_value=1e12, allow_nan=False, allow_infinity=False)
angle = st.floats(-7.0, 7.0).map(lambda value: f"{value!r} rad")


def _there_and_back(case: Case) -> None:
    as_json = case.canonical()
    as_yaml = to_yaml(case)
    for text in (as_json, as_yaml, to_yaml(load_case(as_json)), load_case(as_yaml).canonical()):
        again = load_case(text)
        assert again == case
        assert again.canonical() == as_json
        assert again.content_hash() == case.content_hash()
    assert parse_case(json.loads(as_json)) == case
    assert yaml.safe_load(as_yaml) == json.loads(as_json)


@pytest.mark.parametrize("path", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_examples(path: Any) -> None:
    _there_and_back(load_case(path.read_bytes()))


@pytest.mark.parametrize("text", HARD)
def test_texts_that_look_like_something_else(text: str) -> None:
    data = json.loads(load_case((ROOT / "examples" / "hanging-riser-case1.yaml").read_bytes()).canonical())
    _there_and_back(parse_case(data | {"description": text}))


@pytest.mark.parametrize("name", ["1e5", "1E5", "0e0", "01", "yes", "null", "12345678901234567890"])
def test_names_that_look_like_something_else(name: str) -> None:
    data = json.loads(load_case((ROOT / "examples" / "hanging-riser-case1.yaml").read_bytes()).canonical())
    (line,) = data["lines"].values()
    case = parse_case(data | {"name": name, "lines": {name: line}})
    assert list(load_case(to_yaml(case)).lines) == [name]
    _there_and_back(case)


@st.composite
def seas(draw: st.DrawFn) -> dict[str, Any]:
    kind = draw(st.integers(0, 2))
    if kind == 0:
        return {
            "wave": "regular",
            "height": draw(st.floats(0.01, 1.0)),
            "period": draw(st.floats(5, 30)),
            "direction": draw(angle),
        }
    if kind == 1:
        hs, tp = draw(st.floats(0.01, 5.0)), draw(st.floats(6, 20))
        return {"spectrum": "jonswap", "hs": hs, "tp": tp, "gamma": draw(st.floats(1, 10)), "direction": draw(angle)}
    frequencies = sorted(draw(st.sets(st.floats(0.1, 3.0), min_size=2, max_size=6)))
    densities = draw(st.lists(st.floats(0.001, 9.0), min_size=len(frequencies), max_size=len(frequencies)))
    return {"spectrum": "tabulated", "frequencies": frequencies, "densities": densities, "direction": draw(angle)}


@st.composite
def whole_cases(draw: st.DrawFn) -> dict[str, Any]:
    """Cases with every kind of sea, names and texts of any letters, numbers of any size and all bits."""
    data: dict[str, Any] = draw(cases())
    data["name"] = draw(st.text(min_size=1, max_size=50).filter(lambda text: text.isprintable()))
    data["description"] = draw(st.text(max_size=200).filter(lambda text: text.isprintable() or text.isspace()))
    data["vessel"]["mass"] = draw(finite)
    data["vessel"]["heading"] = draw(angle)
    data["vessel"]["constant_load"] = {"surge": draw(finite), "yaw": -draw(finite)}
    data["environment"]["current"] = {
        "depths": [0, 50.5], "speeds": [draw(finite), -draw(finite)], "direction": draw(angle),
    }  # fmt: skip
    data["vessel"].pop("hydrodynamics", None)
    for kind in data["line_types"].values():
        kind["EA"] = draw(finite)
    if draw(st.booleans()):
        data["vessel"]["hydrodynamics"] = {"data": "x.nc", "radiation": "constant", "frequency": draw(finite)}
        data["environment"]["seastates"] = [draw(seas())]
    data["analyses"] = {
        "statics": {"tolerance": draw(st.floats(1e-15, 1e-2))},
        "modes": {"count": draw(st.integers(1, 200))},
    }
    return data


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(whole_cases())
def test_made_cases(data: dict[str, Any]) -> None:
    _there_and_back(parse_case(data))
