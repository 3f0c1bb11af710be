"""Ordinary moorings, drawn at random: every one finds its equilibrium, and forces written anew say that it is one."""

from __future__ import annotations

import numpy as np
import pytest

from solver.case import parse_case
from solver.model.build import build
from solver.outcome import CaseError
from solver.statics.solve import solve_statics
from tests.statics.independent import impossible, nodal_forces, residuals
from tests.sweep import KINDS, ScaledBarge, system

QUICK = 12
BLOCK = 11


def _check(index: int) -> None:
    data = system(index)
    model = build(parse_case(data), ScaledBarge(data))
    static = solve_statics(model)
    found = residuals(model, static)
    assert found["nodes"] < 1e-8, (index, found)
    assert found["vessel"] < 1e-8, (index, found)
    assert found["fairleads"] < 1e-6, (index, found)
    for line, force in zip(static.lines, static.state.end_forces, strict=True):
        if line.wanted is not None:
            assert np.isfinite(force).all()


@pytest.mark.parametrize("index", range(QUICK))
def test_a_system_of_the_sweep_is_in_equilibrium(index: int) -> None:
    _check(index)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(QUICK, 100, BLOCK))
def test_more_systems_of_the_sweep_are_in_equilibrium(first: int) -> None:
    for index in range(first, min(first + BLOCK, 100)):
        _check(index)


def test_a_pretension_below_the_weight_that_hangs_is_refused_with_that_weight() -> None:
    """System 566 wants 5.53 MN at the top of a line of which 5.63 MN hang; the proof is written anew from the case."""
    data = system(566)
    assert impossible(data) == "m10"
    with pytest.raises(
        CaseError, match=r"lines\.m10\.end_a\.anchor\.pretension: 5\.52766e\+06 N .* more than 5\.628e\+06 N"
    ):
        solve_statics(build(parse_case(data), ScaledBarge(data)))


def test_few_systems_of_the_sweep_have_no_solution() -> None:
    assert [index for index in range(1000) if impossible(system(index))] == [566]


def test_the_sweep_covers_its_ranges() -> None:
    cases = [system(index) for index in range(600)]
    depths = np.array([case["environment"]["depth"] for case in cases])
    hs = np.array([case["environment"]["seastates"][0]["hs"] for case in cases])
    speeds = np.array([case["environment"]["current"]["speeds"][0] for case in cases])
    assert np.all(np.histogram(np.log(depths), np.log(np.geomspace(30, 3000, 6)))[0] > 90)
    assert np.all(np.histogram(hs, np.linspace(0.1, 16, 6))[0] > 90)
    assert np.all(np.histogram(speeds, np.linspace(0, 2, 6))[0] > 90)
    assert {len(case["lines"]) for case in cases} == set(range(4, 17))
    assert {case["vessel"]["trim"] for case in cases} == {"balanced", "as_given"}
    assert len({case["name"].rsplit(" ", 1)[0] for case in cases}) == len(KINDS)


def test_the_independent_check_sees_a_node_that_is_moved() -> None:
    """A millimetre across, in the middle of a line, is no equilibrium any more."""
    data = system(0)
    model = build(parse_case(data), ScaledBarge(data))
    static = solve_statics(model)
    line, shape = static.lines[0], static.state.shapes[0].copy()
    before, tension, _ = nodal_forces(model.case, model.frame, line, shape)
    shape[line.nodes // 2, 2] += 1e-3
    after, _, _ = nodal_forces(model.case, model.frame, line, shape)
    assert np.abs(before[1:-1]).max() < 1e-8 * tension.max() < 1e-6 * np.abs(after[1:-1]).max()
