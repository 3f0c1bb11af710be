"""The compare page: numbers with their differences, where cases differ, curves of runs and domains on one axis."""

from __future__ import annotations

import copy
import json
from typing import Any

import flask
import plotly.utils
import pytest

from frontend.comparison import differences, rows
from frontend.pages import compare
from tests.frontend import fake_results


def _text(component: Any) -> str:
    return json.dumps(component, cls=plotly.utils.PlotlyJSONEncoder, ensure_ascii=False)


def test_rows_have_every_runs_number_and_its_change() -> None:
    first, second = (copy.deepcopy(fake_results.fpso_summary(name)) for name in "ab")
    second["frequency_domain"]["vessel_std"]["wf"]["surge"] *= 1.25
    found = {(row.group, row.name): row for row in rows([first, second])}
    row = found["σ of motion, frequency domain", "surge WF"]
    assert row.unit == "m"
    assert row.values[1] == pytest.approx(1.25 * (row.values[0] or 0))
    assert row.changes == (0.0, pytest.approx(0.25))
    assert all(r.changes[1] in (0.0, None) for key, r in found.items() if key[1] != "surge WF")


def test_modes_are_matched_by_name_not_by_place() -> None:
    first, second = (copy.deepcopy(fake_results.fpso_summary(name)) for name in "ab")
    second["modes"] = list(reversed(second["modes"]))
    for row in rows([first, second]):
        assert row.changes[1] in (0.0, None), row


def test_a_number_that_a_run_lacks_is_no_difference() -> None:
    first, second = (copy.deepcopy(fake_results.fpso_summary(name)) for name in "ab")
    del second["frequency_domain"]
    found = {(row.group, row.name): row for row in rows([first, second])}
    assert found["σ of motion, frequency domain", "surge WF"].values[1] is None
    assert found["σ of motion, frequency domain", "surge WF"].changes[1] is None


def test_differences_name_the_place() -> None:
    one = {"name": "x", "environment": {"depth": 100.0, "seastates": [{"hs": 8.0}]}, "cg": [0, 0, 1]}
    two = {"name": "x", "environment": {"depth": 100.0, "seastates": [{"hs": 9.0}, {"hs": 1.0}]}, "cg": [0, 0, 2]}
    assert differences([one, two]) == [
        ("environment.seastates.0.hs", (8.0, 9.0)),
        ("cg", ((0, 0, 1), (0, 0, 2))),
        ("environment.seastates.1.hs", (None, 1.0)),
    ]
    assert differences([one, one]) == []


def test_page_draws_runs_and_domains_together(
    request_context: flask.Flask, timed_run: dict[str, Any], vessel_run: dict[str, Any]
) -> None:
    drawn, used = compare.panel([timed_run["id"], vessel_run["id"]], {"domain": "both", "line": "stern-port"})
    text = _text(drawn)
    assert used == {"domain": "both", "line": "stern-port"}
    for said in ("A: FPSO 2000 m, frequency domain", "A: FPSO 2000 m, time domain", "B: FPSO 2000 m, frequency domain"):
        assert said in text
    assert "B: FPSO 2000 m, time domain" not in text  # that run has none
    assert "Tension at end b, stern-port" in text
    assert "The cases are the same." in text
    assert "σ of tension, domains side by side" in text


def test_a_run_without_results_is_said(request_context: flask.Flask, vessel_run: dict[str, Any]) -> None:
    drawn, _ = compare.panel(["nosuchrun"], {})
    assert "No such" in _text(drawn) or "not found" in _text(drawn).lower() or "404" in _text(drawn)


def test_layout_keeps_at_most_six_runs_from_the_address(request_context: flask.Flask) -> None:
    made = compare.layout(runs=",".join(f"r{i}" for i in range(9)), line="x", other="y")
    text = _text(made)
    assert '"r5"' in text
    assert '"r6"' not in text
    assert '{"line": "x"}' in text
