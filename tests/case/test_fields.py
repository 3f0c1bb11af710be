"""What is wrong with a case is said at its field, with the value and the allowed range."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from solver.case import load_case, parse_case
from solver.outcome import CaseError

EXAMPLES = Path(__file__).parents[2] / "examples"
RISER = yaml.safe_load((EXAMPLES / "hanging-riser-case2.yaml").read_text())
RISER["environment"]["depth"] = "100 m"
FPSO = yaml.safe_load((EXAMPLES / "fpso-2000m.yaml").read_text())
FPSO["vessel"]["hydrodynamics"] = {"data": "x.nc", "radiation": "constant", "frequency": 0.34, "drift": "newman"}
SEA = {"spectrum": "jonswap", "hs": "5 m", "tp": "10 s", "direction": "0 deg"}
WAVE = {"wave": "regular", "height": "2 m", "period": "10 s", "direction": "0 deg"}
TABLE_SEA = {"spectrum": "tabulated", "frequencies": [1, 2], "densities": [1, 1], "direction": "0 deg"}
DROP = object()


def _changed(base: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    case = copy.deepcopy(base)
    *parents, last = [int(key) if key.isdigit() else key for key in path.split("/")]
    node: Any = case
    for key in parents:
        node = node[key] if isinstance(node, list) else node.setdefault(key, {})
    if value is DROP:
        del node[last]
    elif last == "+":
        node.append(value)
    else:
        node[last] = value
    return case


S = "lines/riser/segments/0"
R = "lines.riser.segments.0"
A = "lines/bow-port/end_a/anchor"
# base, path, new value, field that must be named, words that must be in the message
TABLE: list[tuple[dict[str, Any], str, Any, str, tuple[str, ...]]] = [
    (RISER, f"{S}/length", "-170 m", f"{R}.length", ("-170", "> 0")),
    (RISER, f"{S}/length", 0, f"{R}.length", ("0", "> 0")),
    (RISER, f"{S}/length", "110 m", "lines.riser.segments", ("110", "111.803", "allow_stretch")),
    (RISER, f"{S}/length", float("nan"), f"{R}.length", ("nan", "finite")),
    (RISER, f"{S}/length", float("inf"), f"{R}.length", ("inf", "finite")),
    (RISER, f"{S}/length", "170 kN", f"{R}.length", ("kN", "use one of")),
    (RISER, f"{S}/length", "find", "lines.riser", ("length: find", "pretension")),
    (RISER, f"{S}/elements", 0, f"{R}.elements", ("0", "≥ 1")),
    (RISER, f"{S}/elements", 5001, f"{R}.elements", ("5001", "≤ 5000")),
    (RISER, f"{S}/elements", DROP, R, ("elements and element_length",)),
    (RISER, f"{S}/element_length", "2 m", R, ("exactly one",)),
    (RISER, f"{S}/type", "rizer", f"{R}.type", ("rizer", "riser")),
    (RISER, f"{S}/lenght", "1 m", f"{R}.lenght", ("not known",)),
    (RISER, "lines/riser/segments", [], "lines.riser.segments", ("at least 1",)),
    (RISER, "lines/riser/multiplicity", 0, "lines.riser.multiplicity", ("0", "≥ 1")),
    (RISER, "lines/riser/end_b/fairlead", [0, 0, 0], "lines.riser.end_b", ("exactly one",)),
    (RISER, "lines/riser/end_b", {"fairlead": [0, 0, 0]}, "lines.riser.end_b.fairlead", ("no vessel",)),
    (RISER, "lines/riser/end_b", {}, "lines.riser.end_b", ("fairlead, anchor, pinned",)),
    (RISER, "lines/riser/end_b", {"anchor": {"point": [1, 2]}, "motion": {"surge": {"amplitude": 1, "period": 9}}},
     "lines.riser.end_b", ("pinned",)),
    (RISER, "lines/riser/end_b/motion", {}, "lines.riser.end_b.motion", ("surge, sway, heave",)),
    (RISER, "lines/riser/end_b/motion", {"surge": {"amplitude": "1 m", "period": "9 s"}},
     "lines.riser.end_b.motion.surge.period", ("one period", "10 s")),
    (RISER, "lines/riser/end_a/pinned", [0, 0, -101], "lines.riser.end_a.pinned.2", ("-101", "≥ -100")),
    (RISER, "lines/riser/end_a/pinned", [100, 0, -5], "lines.riser", ("same point",)),
    (RISER, "lines/riser/end_a/pinned", [0, 0], "lines.riser.end_a.pinned.2", ("required",)),
    (RISER, "lines/riser/end_a", {"anchor": {"point": [0, 0, -200]}}, "lines.riser.end_a.anchor.point.2", ("-200", "≥ -100")),
    (RISER, "environment/depth", "-5 m", "environment.depth", ("-5", "> 0")),
    (RISER, "environment/depth", True, "environment.depth", ("number",)),
    (RISER, "environment/depth", 10**400, "environment.depth", ("finite",)),
    (RISER, "environment/water", {"density": "0 kg/m3"}, "environment.water.density", ("0", "> 0")),
    (RISER, "environment/seabed", {"soil": 1e5, "node_stiffness": 1e3}, "environment.seabed", ("not both",)),
    (RISER, "environment/current", {"depths": [0, 10], "speeds": [1], "direction": "0 deg"}, "environment.current",
     ("2 depths",)),
    (RISER, "environment/current", {"depths": [10, 0], "speeds": [1, 1], "direction": "0 deg"}, "environment.current",
     ("rise",)),
    (RISER, "environment/current", {"depths": [0], "speeds": [1], "direction": 30}, "environment.current.direction",
     ("30", "bare number", "deg")),
    (RISER, "environment/seastates/0/height", "25 m", "environment.seastates.0.height", ("25", "breaks", "22.2")),
    (RISER, "environment/seastates/0/direction", 0, "environment.seastates.0.direction", ("bare number",)),
    (RISER, "environment/seastates", [{**SEA, "tz": "8 s"}], "environment.seastates.0", ("tz and tp",)),
    (RISER, "environment/seastates", [{k: v for k, v in SEA.items() if k != "tp"}], "environment.seastates.0", ("tz and tp",)),
    (RISER, "environment/seastates", [{**SEA, "hs": "30 m"}], "environment.seastates.0", ("30", "breaks", "22.2")),
    (RISER, "environment/seastates", [{**SEA, "gamma": 0.5}], "environment.seastates.0.gamma", ("0.5", "≥ 1")),
    (RISER, "environment/seastates", [{**SEA, "spectrum": "johnswap"}], "environment.seastates.0", ("jonswap", "regular")),
    (RISER, "environment/seastates", [{"hs": 1}], "environment.seastates.0", ("spectrum",)),
    (RISER, "environment/seastates", [SEA, WAVE], "environment.seastates.1", ("mix", "two cases")),
    (RISER, "environment/seastates", [WAVE, {**WAVE, "period": "9 s"}], "environment.seastates.1.period",
     ("one period",)),
    (RISER, "environment/seastates", [], "analyses.frequency_domain", ("nothing moves",)),
    (RISER, "environment/seastates", [{**TABLE_SEA, "frequencies": [1, 1]}],
     "environment.seastates.0", ("rise",)),
    (RISER, "environment/seastates", [{**TABLE_SEA, "densities": [1]}],
     "environment.seastates.0.densities", ("at least 2",)),
    (RISER, "environment/seastates", [{**TABLE_SEA, "densities": [0, 0]}],
     "environment.seastates.0", ("zero",)),
    (RISER, "line_types/riser/EA", "-1 MN", "line_types.riser.EA", ("-1 MN", "> 0")),
    (RISER, "line_types/riser/drag", {"normal": -1}, "line_types.riser.drag.normal", ("-1", "≥ 0")),
    (RISER, "line_types/riser/mass", DROP, "line_types.riser.mass", ("required",)),
    (RISER, "line_types/riser/EI", [1], "line_types.riser.EI", ("number",)),
    (RISER, "attachments", [{"line": "x", "arc_length": 3}], "attachments.0.line", ("'x'", "riser")),
    (RISER, "attachments", [{"line": "riser", "arc_length": "170 m"}], "attachments.0.arc_length",
     ("170", "between 0 and 170")),
    (RISER, "attachments", [{"line": "riser", "arc_length": 10, "mass": -3}], "attachments.0.mass", ("-3", "≥ 0")),
    (RISER, "analyses", {}, "analyses", ("at least one",)),
    (RISER, "analyses/frequency_domain", {"wave": {"from": 1, "to": 0.5}}, "analyses.frequency_domain.wave", ("0.5", "above")),
    (RISER, "analyses/frequency_domain", {"difference": {"to": 0.1}}, "analyses.frequency_domain", ("0.1", "≥ 0.2")),
    (RISER, "analyses/frequency_domain", {"difference": {"step": 1e-9}}, "analyses.frequency_domain", ("20 000",)),
    (RISER, "analyses/frequency_domain", {"wave": {"step": 1e-9}}, "analyses.frequency_domain.wave", ("20 000",)),
    (RISER, "analyses/frequency_domain", {"low": {"step": 1}}, "analyses.frequency_domain.low", ("wider",)),
    (RISER, "analyses/frequency_domain", {"tolerance": 0}, "analyses.frequency_domain.tolerance", ("0", "> 0")),
    (RISER, "analyses/modes", {"count": 0}, "analyses.modes.count", ("0", "≥ 1")),
    (RISER, "slowdrift", 2, "slowdrift", ("1",)),
    (RISER, "name", "", "name", ("at least 1",)),
    (RISER, "colour", "blue", "colour", ("not known",)),
    (RISER, "environment", DROP, "environment", ("required",)),
    (RISER, "lines", {}, "(case)", ("neither a vessel nor lines",)),
    (FPSO, f"{A}/radius", "2000 m", "lines.bow-port", ("length: find",)),
    (FPSO, f"{A}/pretension", DROP, "lines.bow-port.end_a.anchor", ("radius or a pretension",)),
    (FPSO, f"{A}/azimuth", DROP, "lines.bow-port.end_a.anchor", ("azimuth",)),
    (FPSO, f"{A}/point", [2000, 2000], "lines.bow-port.end_a.anchor", ("not both",)),
    (FPSO, f"{A}/azimuth", 45, "lines.bow-port.end_a.anchor.azimuth", ("bare number",)),
    (FPSO, "lines/bow-port/segments/0/length", "find", "lines.bow-port", ("point or a radius",)),
    (FPSO, "lines/bow-port/end_b", {"anchor": {"point": [0, 0]}}, "lines.bow-port", ("both as points",)),
    (FPSO, "vessel/mass", "-1 t", "vessel.mass", ("-1 t", "> 0")),
    (FPSO, "vessel/inertia", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "vessel", ("exactly one",)),
    (FPSO, "vessel/radii_of_gyration", DROP, "vessel", ("exactly one",)),
    (FPSO, "vessel/hydrodynamics/frequency", DROP, "vessel.hydrodynamics", ("frequency",)),
    (FPSO, "vessel/hydrodynamics/radiation", "cummins", "vessel.hydrodynamics", ("leave it out",)),
    (FPSO, "vessel/hydrodynamics", DROP, "vessel.hydrodynamics", ("hydrodynamic data",)),
    (FPSO, "vessel/damping/linear/surge", -1, "vessel.damping.linear.surge", ("-1", "≥ 0")),
    (FPSO, "vessel/trim", "level", "vessel.trim", ("balanced",)),
]  # fmt: skip


@pytest.mark.parametrize(
    ("base", "path", "value", "field", "words"), TABLE, ids=[f"{t[1]}-{i}" for i, t in enumerate(TABLE)]
)
def test_a_fault_is_named_at_its_field(base, path, value, field, words) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(CaseError) as caught:
        parse_case(_changed(base, path, value))
    found = {error.field: error for error in caught.value.errors}
    assert field in found, f"named: {list(found)}"
    for word in words:
        assert word in found[field].message, found[field].message


def test_several_faults_are_all_named_at_once() -> None:
    case = _changed(_changed(_changed(RISER, f"{S}/length", -1), "environment/depth", "x"), "colour", 1)
    with pytest.raises(CaseError) as caught:
        parse_case(case)
    assert {error.field for error in caught.value.errors} >= {f"{R}.length", "environment.depth", "colour"}


def test_a_taut_line_is_a_case_when_stretch_is_allowed() -> None:
    case = _changed(_changed(RISER, f"{S}/length", "110 m"), "lines/riser/allow_stretch", True)
    assert parse_case(case).lines["riser"].length == 110.0


@pytest.mark.parametrize("gap", [1e-6, -1e-6])
def test_the_reach_of_a_line_is_judged_to_the_millimetre(gap: float) -> None:
    case = _changed(RISER, f"{S}/length", math.dist((0, 0, -55), (100, 0, -5)) + gap)
    if gap > 0:
        parse_case(case)
        return
    with pytest.raises(CaseError, match="allow_stretch"):
        parse_case(case)


def test_regular_and_random_waves_may_mix_where_no_response_is_asked() -> None:
    case = _changed(_changed(RISER, "environment/seastates", [SEA, WAVE]), "analyses", {"statics": {}})
    assert len(parse_case(case).environment.seastates) == 2


def test_prescribed_motion_and_random_sea_are_refused_together() -> None:
    case = _changed(RISER, "environment/seastates", [SEA])
    case = _changed(case, "lines/riser/end_b/motion", {"surge": {"amplitude": "1 m", "period": "9 s"}})
    with pytest.raises(CaseError, match="cannot mix"):
        parse_case(case)


def test_a_case_cannot_be_changed() -> None:
    case = parse_case(RISER)
    with pytest.raises(Exception, match="frozen"):
        case.name = "other"  # type: ignore[misc]


def test_the_fault_of_a_text_has_its_line() -> None:
    text = (EXAMPLES / "fpso-2000m.yaml").read_text().replace("azimuth: 135 deg", "azimuth: 135")
    with pytest.raises(CaseError) as caught:
        load_case(text)
    assert caught.value.errors[0].line == 1 + text[: text.index("azimuth: 135,")].count("\n")
