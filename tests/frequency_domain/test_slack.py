"""Where a linear answer does not hold: lines that are slack, or go slack under the dynamic part (docs/theory.md, L17)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.forces import axial
from solver.frequency_domain import solve as frequency
from solver.frequency_domain.solve import solve_frequency_domain
from solver.model.build import build
from solver.outcome import NotConverged
from solver.run import run
from solver.statics.solve import StaticState, solve_statics
from tests.systems import span


def _moved(heave: float, **kind: Any) -> dict[str, Any]:
    data = span(65.0, (0, 0, -40), (52, 0, -3), 20, 80.0, mass=80.0, EA=1e8, drag={"normal": 1.2}, **kind)
    data["lines"]["line"]["end_b"]["motion"] = {"heave": {"amplitude": heave, "period": 6.0}}
    data["analyses"] = {"statics": {}, "frequency_domain": {}}
    return data


def _in_waves(hs: float, tp: float, mass: float) -> dict[str, Any]:
    data = _moved(1.0)
    data["line_types"]["wire"]["mass"] = mass
    del data["lines"]["line"]["end_b"]["motion"]
    data["environment"]["seastates"] = [{"spectrum": "jonswap", "hs": hs, "tp": tp, "gamma": 2, "direction": "0 deg"}]
    return data


@pytest.mark.parametrize("data", [_moved(3.0), _in_waves(10.0, 15.0, 12.0)], ids=["harmonic", "random"])
def test_a_line_that_goes_slack_under_its_dynamic_part_is_said(data: dict[str, Any]) -> None:
    result = run(parse_case(data), None)
    own = result.summary["frequency_domain"]["lines"]["line"]
    mean = np.array(result.summary["statics"]["lines"]["line"]["tension"])
    word = "amplitude" if "tension_amplitude" in own else "most probable maximum in 3 h"
    swing = np.array(own.get("tension_amplitude") or np.array(own["tension_most_probable_max"]) - mean)
    worst = int(np.argmax(swing - mean))
    assert swing[worst] > mean[worst] > 0
    said = [text for text in result.summary["warnings"] if "of its dynamic part" in text]
    assert said == [
        f"line 'line', {own['arc_length'][worst]:.4g} m from end a: the mean tension, {mean[worst] / 1e3:.3g} kN, is below "
        f"the {word} of its dynamic part, {swing[worst] / 1e3:.3g} kN; the line goes slack there, which the frequency domain "
        "does not see: use the time domain"
    ]


@pytest.mark.parametrize("data", [_moved(0.02), _in_waves(0.2, 15.0, 80.0)], ids=["harmonic", "random"])
def test_a_line_that_stays_taut_is_answered_without_a_word(data: dict[str, Any]) -> None:
    assert run(parse_case(data), None).summary["warnings"] == []


def test_a_line_that_may_push_is_measured_by_its_euler_load() -> None:
    said = run(parse_case(_moved(3.0, compression="allowed")), None).summary["warnings"]
    assert len(said) == 1
    assert "with the amplitude of the frequency domain the compression is" in said[0]
    assert "above the Euler load of the element, 0 kN" in said[0]


def _shrunk(static: StaticState, elements: slice) -> StaticState:
    """The equilibrium with some elements a little shorter than their unstretched length, nodes moved towards end a."""
    line, x = static.lines[0], static.state.shapes[0]
    pieces = np.diff(x, axis=0)
    size = np.linalg.norm(pieces, axis=1)
    pieces[elements] *= (0.999 * line.arrays.L / size)[elements, None]
    x[1:] = x[0] + np.cumsum(pieces, axis=0)
    return static


def test_a_line_that_is_slack_in_statics_is_marked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.run.solve_statics", lambda model: _shrunk(solve_statics(model), slice(2, 5)))
    result = run(parse_case(_moved(0.02)), None)
    tension = result.summary["statics"]["lines"]["line"]["tension"]
    assert [t <= 0.0 for t in tension] == [2 <= j < 5 for j in range(20)]
    said = [text for text in result.summary["warnings"] if "the linearised answer" in text]
    assert len(said) == 1
    assert "line 'line': 3 of 20 elements, between 8.125 m and 14.62 m from end a, are slack" in said[0]


def test_a_line_that_is_slack_all_over_is_refused() -> None:
    model = build(parse_case(_moved(0.02)), None)
    static = _shrunk(solve_statics(model), slice(None))
    assert np.all(axial.tension(static.lines[0].arrays, static.state.shapes[0]) < 0)
    spec = model.case.analyses.frequency_domain
    assert spec is not None
    with pytest.raises(NotConverged, match=r"line 'line' is slack over its whole length .* Use the time domain"):
        solve_frequency_domain(model, static, spec)


@pytest.mark.parametrize(
    "error", [ZeroDivisionError("division by zero"), FloatingPointError("overflow"), np.linalg.LinAlgError("Singular matrix"),
              ValueError("array must not contain infs or NaNs")],
)  # fmt: skip
def test_arithmetic_that_breaks_down_is_a_failure_and_a_fault_of_the_program_is_not(
    error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: Any) -> None:
        raise error

    data = _moved(0.02)
    data["analyses"]["modes"] = {"count": 2}
    monkeypatch.setattr(frequency, "linearise", broken)
    result = run(parse_case(data), None)
    assert list(result.failures) == ["frequency_domain", "modes"]
    assert f"(frequency_domain) broke down: {error}." in result.failures["frequency_domain"]
    assert result.summary["statics"]["converged"]
    monkeypatch.setattr("solver.run.solve_statics", broken)
    assert set(run(parse_case(data), None).failures) == {"statics", "frequency_domain", "modes"}
    for fault in (KeyError("x"), TypeError("y"), ValueError("operands could not be broadcast")):
        error = fault
        with pytest.raises(type(fault)):
            run(parse_case(data), None)
