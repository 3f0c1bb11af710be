"""VolturnUS-S, its public WAMIT data and deck: natural periods, and a storm in both domains (docs/validation-volturnus.md)."""

from __future__ import annotations

import json
import math
from functools import cache
from typing import Any

import pytest
from scipy.optimize import fsolve

from solver.case import Case, load_case, parse_case
from solver.io.moordyn import read_deck
from solver.run import run, select
from solver.vessel.data import FileSource

from .decks import ROOT, volturnus

EXAMPLE = ROOT / "examples" / "volturnus-s.yaml"
RAFT = {"surge": 128.4, "heave": 20.4, "pitch": 27.5}
"""Natural periods [s] of RAFT with these WAMIT data about the unloaded position, its own mass model and lines."""
REPORT = {"heave": 20.4, "pitch": 27.8, "yaw": 90.9}
"""Allen et al. (2020), NREL/TP-5000-76773, without wind; its surge, 142.9 s, is about an offset position."""


@cache
def _periods(diameter: float) -> dict[str, float]:
    case = load_case(EXAMPLE.read_bytes())
    data = json.loads(case.canonical())
    data["line_types"]["chain"]["diameter"] = diameter
    data["environment"]["seastates"] = []
    data["analyses"] = {"statics": {}, "modes": {"count": 14}}
    summary = run(parse_case(data), FileSource(volturnus()), threads=1).summary
    found: dict[str, float] = {"K11": summary["line_coefficients"]["stiffness"][0][0]}
    for mode in summary["modes"]:
        found.setdefault(mode["label"], mode["period"])
    return found


@pytest.mark.parametrize("motion", RAFT)
def test_periods_with_the_chain_of_raft(motion: str) -> None:
    """RAFT's example displaces the chain by its nominal 0.185 m, so it is 10 % heavier in water than the deck's."""
    assert _periods(0.185)[motion] == pytest.approx(RAFT[motion], rel=0.03)


@pytest.mark.parametrize("motion", REPORT)
def test_periods_of_the_design_report_with_the_chain_of_the_deck(motion: str) -> None:
    assert _periods(0.333)[motion] == pytest.approx(REPORT[motion], rel=0.03)


def test_the_surge_period_of_the_deck_is_that_of_its_catenary() -> None:
    """Stiffness of three elastic catenaries with a flat bed, and the mass with A11(0), lines by their share."""
    w, EA, L = (685 - 1025 * math.pi / 4 * 0.333**2) * 9.80665, 3.27e9, 850.0

    def horizontal(reach: float) -> float:
        def gap(p: Any) -> list[float]:
            H, V = p[0] * 1e6, p[1] * 1e6
            x = L - V / w + H / w * math.asinh(V / H) + H * L / EA
            return [x - reach, H / w * (math.hypot(1, V / H) - 1) + V * V / (2 * EA * w) - 186.0]

        return float(fsolve(gap, [1.35, 2.0], xtol=1e-13)[0]) * 1e6

    reach, step = 837.6 - 58, 0.01
    along = (horizontal(reach + step) - horizontal(reach - step)) / (2 * step)
    K11 = along + 2 * (0.25 * along + 0.75 * horizontal(reach) / reach)
    found = _periods(0.333)
    assert found["K11"] == pytest.approx(K11, rel=0.04)  # elements of 17 m
    period = 2 * math.pi * math.sqrt(1.02 * (20.108e6 + 1.2334e4 * 1025) / K11)
    assert found["surge"] == pytest.approx(period, rel=0.02)


def test_the_lines_of_the_example_are_those_of_the_deck() -> None:
    base = load_case(EXAMPLE.read_bytes())
    found = read_deck((volturnus() / "umainesemi_MoorDyn.dat").read_bytes(), base.canonical()).case
    assert found is not None
    assert list(found.lines.values()) == [_typed(line, "main") for line in base.lines.values()]
    assert found.environment.seabed == base.environment.seabed
    ours, theirs = base.line_types["chain"], found.line_types["main"]
    assert theirs.drag.tangential == pytest.approx(ours.drag.tangential, rel=1e-4)
    assert theirs.model_copy(update={"drag": ours.drag}) == ours


def _typed(line: Any, name: str) -> Any:
    return line.model_copy(update={"segments": tuple(s.model_copy(update={"type": name}) for s in line.segments)})


@pytest.mark.slow
def test_a_storm_in_both_domains() -> None:
    """Two seeds of half an hour; six seeds of an hour are in docs/validation-volturnus.md."""
    summary = run(_short(), FileSource(volturnus()), threads=2).summary
    assert summary["failures"] == {}
    time, frequency = summary["time_domain"], summary["frequency_domain"]
    for motion in ("surge", "heave", "pitch"):
        same = frequency["same_waves"]["vessel_std"]  # second order, which differs from seed to seed, is in both bands
        assert same["wf"][motion] == pytest.approx(time["vessel_std"]["wf"][motion], rel=0.02)
        assert same["lf"][motion] == pytest.approx(time["vessel_std"]["lf"][motion], rel=0.2)
        first = frequency["origin_std"]["first_order"][motion]
        assert first < time["vessel_std"]["wf"][motion] * 1.01
    heave = frequency["origin_std"]["first_order"]["heave"]
    assert time["vessel_std"]["wf"]["heave"] > 1.015 * heave  # 0.281 m of second order beside 1.287 m
    for line in ("head", "port", "starboard"):
        theirs = time["lines"][line]["tension_std"]["wf"][-1]
        assert frequency["lines"][line]["tension_std"]["wf"][-1] == pytest.approx(theirs, rel=0.1)


def _slow_heave(**difference: float) -> dict[str, float]:
    """σ of heave by origin and by band, the waves from astern as in the example."""
    data = json.loads(load_case(EXAMPLE.read_bytes()).canonical())
    data["analyses"]["frequency_domain"]["difference"] |= difference
    summary = run(select(parse_case(data), ("frequency_domain",)), FileSource(volturnus()), threads=1).summary
    found = summary["frequency_domain"]
    assert bool([text for text in summary["warnings"] if "mode of heave" in text]) == ("to" in difference)
    origins = {origin: found["origin_std"][origin]["heave"] for origin in ("first_order", "second_order")}
    return origins | {band: found["vessel_std"][band]["heave"] for band in ("wf", "lf")}


@pytest.mark.slow
def test_slow_heave_does_not_end_at_the_border() -> None:
    """Resonance at 0.305 rad/s lies above the border, 0.25 rad/s, and inside the wave band."""
    cut, whole, fine = _slow_heave(to=0.25), _slow_heave(), _slow_heave(step=0.0025)
    assert cut["second_order"] == pytest.approx(cut["lf"], rel=1e-12)
    assert cut["wf"] == pytest.approx(cut["first_order"], rel=1e-12)
    assert whole["second_order"] > 2.5 * cut["second_order"]
    assert whole["second_order"] == pytest.approx(0.302, rel=0.02)
    assert whole["lf"] == pytest.approx(cut["lf"], rel=0.02)
    assert whole["wf"] ** 2 + whole["lf"] ** 2 == pytest.approx(whole["first_order"] ** 2 + whole["second_order"] ** 2)
    for key in whole:
        assert fine[key] == pytest.approx(whole[key], rel=0.01)


def _short() -> Case:
    data = json.loads(load_case(EXAMPLE.read_bytes()).canonical())
    data["analyses"]["time_domain"] |= {"seeds": 2, "duration": 1800.0, "build_up": 600.0}
    return select(parse_case(data), ("frequency_domain", "time_domain"))
