"""Strains above 10 % of wire and chain are warned of in statics and in both domains; lighter lines may stretch."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.model.build import build
from solver.results.strain import allowed_tension, strain_warnings
from solver.run import run
from tests.systems import span

MASSES = {  # kg/m of a line of 0.1 m in fresh water (7.85 kg/m displaced), and whether it is wire or chain
    "spiral strand": (43.0, True),
    "six-strand wire": (36.0, True),
    "studless chain, nominal diameter": (199.0, True),
    "studless chain, 1.8 × nominal diameter": (61.4, True),
    "polyester rope": (7.9, False),
    "pipe": (13.0, False),
    "just below": (23.5, False),
    "just above": (23.6, True),
}


def _taut(strain: float, mass: float = 50.0, EA: float = 1e7) -> dict[str, Any]:
    """A level line of 100 m, stretched by a share of its length, almost weightless against its tension."""
    data = span(100.0, (0, 0, -50), (100.0 * (1 + strain), 0, -50), 10, mass=mass, EA=EA)
    data["lines"]["line"]["allow_stretch"] = True
    return data


@pytest.mark.parametrize("name", MASSES)
def test_weight_tells_wire_and_chain(name: str) -> None:
    mass, judged = MASSES[name]
    (line,) = build(parse_case(_taut(0.05, mass)), None).lines
    np.testing.assert_allclose(allowed_tension(line), 1e6 if judged else 0.0)


@pytest.mark.parametrize(("strain", "count"), [(0.098, 0), (0.105, 1), (0.437, 1)])
def test_a_strain_in_statics(strain: float, count: int) -> None:
    said = [text for text in run(parse_case(_taut(strain)), None).summary["warnings"] if "strain" in text]
    assert len(said) == count
    if count:
        assert f"the strain is {100 * strain:.3g} % in static equilibrium" in said[0]
        assert "limit 10 % for wire and chain" in said[0]


def test_a_rope_may_stretch() -> None:
    assert not [text for text in run(parse_case(_taut(0.2, 7.9)), None).summary["warnings"] if "strain" in text]


@pytest.mark.parametrize(("amplitude", "said"), [(1.5, False), (4.0, True)])
def test_strains_in_both_domains(amplitude: float, said: bool) -> None:
    """A mean of 8 % and a motion of the end by 1.5 % or 4 % of the length."""
    data = _taut(0.08)
    data["lines"]["line"]["end_b"]["motion"] = {"surge": {"amplitude": amplitude, "period": 20.0}}
    spec = {"step": 0.1, "build_up": 40.0, "duration": 40.0, "output_step": 0.1}
    data["analyses"] = {"frequency_domain": {}, "time_domain": spec}
    summary = run(parse_case(data), None).summary
    assert summary["failures"] == {}
    for where in ("in the frequency domain", "in the time domain"):
        assert any(where in text and "strain" in text for text in summary["warnings"]) == said


def test_the_most_strained_element_is_named() -> None:
    (said,) = strain_warnings("x", [10.0, 20.0, 30.0], np.array([50.0, 30.0, 9.0]), [100.0, 20.0, 0.0], "somewhere")
    assert said.startswith("line 'x', 20 m from end a: the strain is 15 % somewhere")
