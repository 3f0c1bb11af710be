"""Mass and centre of gravity against the data, and a current that leaves the hull alone: what is warned of."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.case.environment import Environment
from solver.case.vessel import Vessel
from solver.check import check
from solver.run import run
from solver.vessel.balance import balance_warnings
from solver.vessel.data import FileSource
from tests.systems import EXAMPLES, example, moored_box

G = 9.807
HELD = 1025.0 * 240 * 46 * 10  # of the barge of the FPSO example [kg]
SOURCE = FileSource(EXAMPLES)
needs_barge = pytest.mark.skipif(not (EXAMPLES / "barge-240x46x10.nc").exists(), reason="needs the barge's data")


def fpso(**vessel: Any) -> dict[str, Any]:
    case = example("fpso-2000m")
    case["analyses"] = {"statics": {}}
    case["vessel"] |= vessel
    return case


def told(case: dict[str, Any]) -> list[str]:
    """Warnings of a run about mass and centre, the check's among them once."""
    found: list[str] = run(parse_case(case), SOURCE).summary["warnings"]
    assert len(found) == len(set(found))
    return [text for text in found if text.startswith("vessel.")]


@needs_barge
@pytest.mark.parametrize("name", ["fpso-2000m", "fpso-2000m-design"])
def test_the_examples_are_not_warned_of(name: str) -> None:
    """110 000 t in a hull of 113 160 t under lines that pull 9 690 t: the mass of the paper leaves the lines out."""
    case = example(name)
    case["analyses"] = {"statics": {}}
    assert told(case) == []


@needs_barge
@pytest.mark.parametrize(
    ("mass", "warned"),
    [
        (1.06 * HELD, True), (1.04 * HELD, False), (0.96 * HELD, False),
        (0.87 * HELD, True),  # 4.4 % below even with the lines
        (HELD - 9.69e6, False),  # balanced by the lines' pull: 8.6 % below without them
    ],
)  # fmt: skip
@pytest.mark.parametrize("trim", ["balanced", "as_given"])
def test_a_mass_far_from_the_displaced_mass(mass: float, warned: bool, trim: str) -> None:
    found = told(fpso(mass=mass, trim=trim))
    assert len(found) == warned
    if warned:
        assert f"vessel.mass is {mass:.5g} kg, its hull displaces 1.1316e+08 kg" in found[0]
        assert f"{100 * (mass / HELD - 1):+.3g} % (threshold 5 %)" in found[0]
        assert ("trim: balanced makes up for it" in found[0]) is (trim == "balanced")


@needs_barge
@pytest.mark.parametrize(
    ("centre", "axis"),
    [([3.4, 0, 5], None), ([3.6, 0, 5], "x"), ([-3.6, 0, 5], "x"), ([0, 0.6, 5], None), ([0, 0.7, 5], "y")],
)
def test_a_centre_of_gravity_beside_the_centre_of_buoyancy(centre: list[float], axis: str | None) -> None:
    """5 % of 240 m/√12 = 69.3 m and of 46 m/√12 = 13.3 m."""
    found = told(fpso(centre_of_gravity=centre))
    assert len(found) == (axis is not None)
    if axis is not None:
        assert found[0].startswith(f"vessel.centre_of_gravity: {axis} is {max(centre[:2], key=abs):.4g} m")
        assert ("69.38 m" if axis == "x" else "13.3 m") in found[0]


@needs_barge
def test_the_check_says_what_no_line_explains() -> None:
    heavy, light = parse_case(fpso(mass=1.06 * HELD)), parse_case(fpso(mass=0.87 * HELD))
    assert [text for text in check(heavy, SOURCE) if text.startswith("vessel.mass")]
    assert not [text for text in check(light, SOURCE) if text.startswith("vessel.mass")]  # lines may pull the rest
    free = fpso(mass=0.87 * HELD, centre_of_gravity=[4.0, 0, 5])
    free["lines"], free["line_types"] = {}, {}
    found = [text.split()[0] for text in check(parse_case(free), SOURCE) if text.startswith("vessel.")]
    assert found == ["vessel.mass", "vessel.centre_of_gravity:"]


VESSEL = {"mass": 1.0e6, "centre_of_gravity": [0, 0, 0], "radii_of_gyration": [5, 5, 5]}


def of_pull(mass: float, pull: float | None) -> bool:
    hydrostatics = {"displaced_volume": 1.0e6 / 1025}
    vessel = Vessel.model_validate(VESSEL | {"mass": mass, "hydrostatics": hydrostatics})
    environment = Environment.model_validate({"depth": 100, "water": {"gravity": G}})
    load = None if pull is None else np.array([0, 0, -pull * G, 0, 0, 0])
    return bool(balance_warnings(vessel, None, environment, load))


@pytest.mark.parametrize(
    ("mass", "pull", "warned"),
    [
        (0.94e6, 0.0, True), (0.96e6, 0.0, False), (1.06e6, 0.0, True), (1.04e6, 0.0, False),
        (0.70e6, 0.30e6, False), (0.70e6, 0.27e6, True), (0.70e6, 0.33e6, True),  # a tension leg platform
        (0.98e6, 0.10e6, False),  # the mass leaves the lines out
        (1.06e6, 0.05e6, True), (1.06e6, None, True), (0.70e6, None, False),
    ],
)  # fmt: skip
def test_the_lines_may_close_the_gap(mass: float, pull: float | None, warned: bool) -> None:
    assert of_pull(mass, pull) is warned


def test_without_a_displaced_volume_nothing_is_said() -> None:
    assert (
        balance_warnings(Vessel.model_validate(VESSEL), None, Environment.model_validate({"depth": 100}), np.zeros(6))
        == []
    )


def currents(speed: float, **load: float) -> list[str]:
    case = moored_box(constant_load=load)
    case["environment"]["current"] = {"depths": [0, 100], "speeds": [speed, 0.0], "direction": "0 deg"}
    parsed = parse_case(case)
    told = [text for text in check(parsed, FileSource(Path())) if "vessel.constant_load" in text]
    assert [text for text in run(parsed, None).summary["warnings"] if "vessel.constant_load" in text] == told
    return told


def test_a_current_without_a_load_on_the_hull() -> None:
    [found] = currents(1.0)
    assert found.startswith("environment.current acts on the lines only, not on the hull")
    assert currents(1.0, surge=1e5) == []
    assert currents(1.0, heave=1e5) == [found]
    assert currents(0.0) == []


def test_a_current_on_lines_without_a_vessel() -> None:
    case = example("hanging-riser-case1")
    case["environment"]["current"] = {"depths": [0], "speeds": [1.0], "direction": "0 deg"}
    assert not [text for text in check(parse_case(case), None) if "hull" in text]
