"""Line dynamics beside MoorDyn and published histories: chain with a heaving top, and the paper's riser in six motions.

Sources of what is stored here: FloatingArrayDesign/MoorDyn, BSD-3-Clause, tests/Mooring/QuasiStatic and
tests/Mooring/lowe_and_langley_2006 (ranges of the reference histories; decks as their numbers).
"""

from __future__ import annotations

import contextlib
import copy
import math
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from solver.case import parse_case
from solver.forces import axial
from solver.model.build import build
from solver.results.line_values import grounded_length
from solver.run import run
from solver.statics.catenary import solve_catenary
from solver.statics.solve import solve_statics

try:
    import moordyn
except ImportError:
    moordyn = None

Array = np.ndarray
EXAMPLES = Path(__file__).parents[1] / "examples"
Range = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Chain:
    """One chain: depth, where its anchor lies and its length [m]; reference ranges [kN] by heave amplitude [m]."""

    depth: float
    anchor: float
    length: float
    elements: int
    fairlead: dict[float, Range]
    bottom: dict[float, Range]


CHAINS = (
    Chain(50, 400, 410, 82, {2: (899.2, 1093.2), 5: (368.4, 1563.7)}, {2: (778.1, 877.7), 5: (484.7, 1153.0)}),
    Chain(200, 700, 760, 152, {2: (1828.4, 2305.0), 5: (1027.8, 3070.4)}, {2: (1319.8, 1482.2), 5: (867.1, 1984.6)}),
    Chain(600, 1500, 1700, 170, {2: (4466.2, 5970.5), 5: (2820.8, 7565.5)}, {2: (3105.2, 3438.5), 5: (1825.7, 4673.6)}),
)
PERIOD = 10.0
DIAMETER, MASS, EA, CD, CD_AXIAL = 0.252, 390.0, 1.674e9, 1.37, 0.64
SOIL, BED_DAMPING, FRICTION = 1e5, 1e4, 0.5  # Pa/m, Pa s/m, as in the decks
#: the riser's six cases: range of the top tension of the digitised plots, and of a run of MoorDyn where there is one [kN]
RISER: dict[int, tuple[str, Range, Range | None]] = {
    1: ("top moved in surge", (41.48, 52.24), (41.64, 52.28)),
    2: ("top moved in sway", (44.29, 49.12), (44.44, 49.16)),
    3: ("top moved in heave", (36.78, 57.78), None),
    4: ("wave along the riser's plane", (42.01, 53.15), (42.39, 52.85)),
    5: ("wave at 45 deg to it", (41.09, 53.32), (41.14, 53.16)),
    6: ("wave across it", (40.05, 52.73), None),
}


def section() -> str:
    """The section of docs/validation.md on single lines in motion."""
    return f"""## Lines in motion

### Chain whose top heaves

Chain of {1e3 * DIAMETER:g} mm, {MASS:g} kg/m, EA {EA / 1e9:g} GN, whose top at the surface heaves by ±2 and ±5 m in
{PERIOD:g} s; the bed has {SOIL:g} Pa/m and {BED_DAMPING:g} Pa s/m, friction {FRICTION:g}. The reference is the stored
history of the public MoorDyn test of this chain (made with another code); MoorDyn is run here from the same numbers.
Range of tension at the end, kN.

{chain_table()}

Slowdrift without friction and MoorDyn agree at the fairlead and at the anchor: MoorDyn's friction hardly acts on a
chain that lies still. The ranges of the reference's anchor tension show friction at work, and Slowdrift with friction
comes near them. Both codes exceed the reference's maxima at the fairlead in the large motion: the reference differs
there in drag or damping.

### Riser, six cases

The paper's riser with its top moved by 10 m in 27 s in three directions, and in waves of 10 m and 10 s from three
directions. "Digitised" is read off the published plots, within about 0.3 kN; MoorDyn: RK4, 0.5 ms. Range of the
tension at the top end, kN.

{riser_table()}

## Anchor, bed and slack lines

### A chain that lies on the bed

850 m of chain (0.3 m, 600 kg/m) between an anchor and a point 186 m above it and 772 m away, some 530 m of it on the
bed. "Anchor": the largest difference between the reaction at the anchor and the force of the end element less half its
weight. "Length": the largest difference of the length on the bed from the elastic catenary's. Both over the resting
depths 0.2, 0.01 and 0.0001 m, and with the default transition, 0.005, 0.1 and 1 m.

{bed_table()}

The same chain at 1:70 has the same end forces and the same length on the bed, times the scale, within
{100 * scale_difference():.2g} %.

### Lines that go slack

Chain of 890 m whose anchor lies 190 m nearer than it need (depth 300 m), and 400 m hanging from the surface to an
anchor 300 m away at 100 m: no compression, so the top carries the weight of the chain that hangs.

{slack_table()}"""


def bed_table() -> str:
    rows = []
    for elements in (50, 170):
        length = 850.0 / elements
        found = [hung(resting, transition, elements) for resting in (0.2, 0.01, 1e-4) for transition in TRANSITIONS]
        anchor, laid = (max(abs(one[k]) for one in found) for k in (0, 1))
        rows.append([f"{elements} of {length:.3g} m", f"{anchor:.1e}", f"{laid:.1f}"])
    return _table(("elements", "anchor, kN", "length, m"), rows)


TRANSITIONS = (None, 0.005, 0.1, 1.0)


def bed_case(soil: float, transition: float | None, elements: int, scale: float = 1.0) -> dict[str, Any]:
    """The chain on the bed, lengths divided by `scale`, forces by its third power."""
    seabed = {"soil": soil} | ({} if transition is None else {"transition": transition / scale})
    return {
        "slowdrift": 1, "name": "chain on the bed",
        "environment": {"depth": 200.0 / scale, "water": {"density": 1025.0, "gravity": 9.80665}, "seabed": seabed},
        "line_types": {"chain": {"diameter": 0.3 / scale, "mass": 600.0 / scale**2, "EA": 3e9 / scale**3}},
        "lines": {"a": {"segments": [{"type": "chain", "length": 850.0 / scale, "elements": elements}],
                        "end_a": {"anchor": {"point": [-830 / scale, 0]}},
                        "end_b": {"pinned": [-58 / scale, 0, -14 / scale]}}},
        "analyses": {"statics": {}},
    }  # fmt: skip


WEIGHT = (600.0 - 1025.0 * math.pi * 0.3**2 / 4) * 9.80665  # of the chain in water [N/m]


def hung(resting: float, transition: float | None, elements: int) -> tuple[float, float]:
    """Difference of the anchor's reaction from the end element's force [kN], and of the length on the bed [m]."""
    model = build(parse_case(bed_case(WEIGHT / (0.3 * resting), transition, elements)), None)
    static = solve_statics(model)
    line, x = static.lines[0], static.state.shapes[0]
    first = axial.tension(line.arrays, x)[0] * (x[1] - x[0]) / np.linalg.norm(x[1] - x[0])
    wanted = first - [0.0, 0.0, 0.5 * WEIGHT * 850.0 / elements]
    closed = solve_catenary(772.0, 186.0, 850.0, WEIGHT, 3e9, True)
    assert closed is not None
    reaction = float(np.abs(static.state.end_forces[0][3:] - wanted).max())
    return 1e-3 * reaction, grounded_length(line, x) - closed.grounded


def scale_difference() -> float:
    """Largest difference between the chain at 1:1 and at 1:70, as a share."""
    one, small = (
        run(parse_case(bed_case(3e6, None, 50, scale)), None).summary["statics"]["lines"]["a"] for scale in (1.0, 70.0)
    )
    pairs = [(small[end]["tension"] * 70.0**3, one[end]["tension"]) for end in ("end_a", "end_b")]
    pairs.append((small["grounded_length"] * 70.0, one["grounded_length"]))
    return max(abs(found / wanted - 1) for found, wanted in pairs)


def slack_table() -> str:
    rows = []
    for words, depth, length, elements, away, anchor in (
        ("890 m, anchor on the bed", 300.0, 890.0, 40, 400.0, -300.0),
        ("400 m, as long as its way", 100.0, 400.0, 200, 300.0, -100.0),
    ):
        data = span(length, away, anchor, depth, elements)
        line = run(parse_case(data), None).summary["statics"]["lines"]["line"]
        weight = 1e-3 * (data["line_types"]["chain"]["mass"] - 1025.0 * math.pi * 0.18**2 / 4) * 9.80665
        forces = [1e-3 * value for value in line["end_b"]["force"]]
        rows.append([
            words, f"{line['end_b']['tension'] / 1e3:.1f}", f"{weight * depth:.1f}", f"{abs(forces[0]):.2f}",
            f"{min(line['tension']) / 1e3:.2f}",
        ])  # fmt: skip
    head = ("chain", "top tension, kN", "weight × depth, kN", "horizontal force, kN", "least element, kN")
    return _table(head, rows)


def span(length: float, away: float, anchor: float, depth: float, elements: int) -> dict[str, Any]:
    """A chain of 0.18 m from an anchor to the surface."""
    return {
        "slowdrift": 1, "name": "slack chain",
        "environment": {"depth": depth, "water": {"density": 1025.0, "gravity": 9.80665}},
        "line_types": {"chain": {"diameter": 0.18, "mass": 200.0, "EA": 8e8}},
        "lines": {"line": {"segments": [{"type": "chain", "length": length, "elements": elements}],
                           "end_a": {"pinned": [-away, 0, anchor]}, "end_b": {"pinned": [0, 0, 0]}}},
        "analyses": {"statics": {}},
    }  # fmt: skip


def _table(head: tuple[str, ...], rows: list[list[str]]) -> str:
    lines = [list(head), ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _shown(found: Range | None) -> str:
    return "-" if found is None else f"{found[0]:.1f} to {found[1]:.1f}"


def chain_table() -> str:
    rows = []
    for chain in CHAINS:
        for heave in (2.0, 5.0):
            free, rubbed = ours(chain, heave, 0.0), ours(chain, heave, FRICTION)
            theirs = with_moordyn(chain, heave)
            for end, reference in (("fairlead", chain.fairlead), ("anchor", chain.bottom)):
                rows.append([
                    f"{chain.depth:g} m, ±{heave:g} m", end, _shown(free[end]), _shown(rubbed[end]),
                    _shown(theirs[end] if theirs else None), _shown(reference[heave]),
                ])  # fmt: skip
    return _table(("case", "end", "Slowdrift, no friction", "Slowdrift, friction 0.5", "MoorDyn", "reference"), rows)


def chain_case(chain: Chain, heave: float, friction: float, step: float = 0.02) -> dict[str, Any]:
    """The chain as a case: end b heaves, six periods of build-up, two kept."""
    element = chain.length / chain.elements
    return {
        "slowdrift": 1, "name": "chain whose top heaves",
        "environment": {
            "depth": chain.depth, "water": {"density": 1025.0, "gravity": 9.80665},
            "seabed": {"soil": SOIL, "damping": BED_DAMPING * DIAMETER * element, "friction": friction},
        },
        "line_types": {"chain": {
            "diameter": DIAMETER, "mass": MASS, "EA": EA, "drag": {"normal": CD, "tangential": math.pi * CD_AXIAL},
            "added_mass": {"normal": 1.0, "tangential": 0.0},
        }},
        "lines": {"chain": {
            "segments": [{"type": "chain", "length": chain.length, "elements": chain.elements}],
            "end_a": {"pinned": [chain.anchor, 0, -chain.depth]},
            "end_b": {"pinned": [0, 0, 0], "motion": {"heave": {"amplitude": heave, "period": PERIOD}}},
        }},
        "analyses": {"time_domain": {
            "step": step, "build_up": 6 * PERIOD, "duration": 2 * PERIOD, "output_step": step
        }},
    }  # fmt: skip


@cache
def ours(chain: Chain, heave: float, friction: float) -> dict[str, Range]:
    """Ranges of tension at both ends [kN]."""
    case = parse_case(chain_case(chain, heave, friction))  # a range is known from every step
    summary = run(case, None, threads=1).summary
    if "time_domain" in summary["failures"]:
        raise RuntimeError(summary["failures"]["time_domain"])
    line = summary["time_domain"]["lines"]["chain"]
    return {
        name: (1e-3 * line[key]["min"], 1e-3 * line[key]["max"])
        for name, key in (("fairlead", "end_b_tension"), ("anchor", "end_a_tension"))
    }


def deck(chain: Chain) -> str:
    """The chain as an input file of MoorDyn."""
    return "\n".join([
        "---- LINE TYPES", "TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx",
        "(name) (m) (kg/m) (N) (-) (-) (-) (-) (-) (-)",
        f"chain {DIAMETER} {MASS} {EA} -1.0 0 {CD} 1.0 {CD_AXIAL} 0.0",
        "---- POINTS", "ID Type X Y Z Mass Volume CdA Ca", "(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)",
        f"1 Fixed {chain.anchor} 0 {-chain.depth} 0 0 0 0", "2 Coupled 0 0 0 0 0 0 0",
        "---- LINES", "ID LineType AttachA AttachB UnstrLen NumSegs Outputs", "(#) (-) (-) (-) (m) (-) (-)",
        f"1 chain 1 2 {chain.length} {chain.elements} -",
        "---- OPTIONS", "0 writeLog", "0.001 dtM", f"{SOIL} kBot", f"{BED_DAMPING} cBot", "1025.0 WtrDnsty",
        f"{chain.depth} WtrDpth", "1.0 dtIC", "200.0 TmaxIC", "4.0 CdScaleIC", "1e-3 threshIC",
        f"{FRICTION} FrictionCoefficient",
        "---- END",
    ])  # fmt: skip


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Without what MoorDyn prints."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


@cache
def with_moordyn(chain: Chain, heave: float) -> dict[str, Range] | None:
    """The same ranges by MoorDyn [kN]; None where it is not installed."""
    if moordyn is None:
        return None
    with tempfile.TemporaryDirectory() as folder, _silent():
        path = Path(folder) / "chain.txt"
        path.write_text(deck(chain))
        system = moordyn.Create(str(path))
        moordyn.Init(system, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0])
        line = moordyn.GetLine(system, 1)
        time, step, ends = 0.0, 0.1, []
        for _ in range(round(8 * PERIOD / step)):
            time, ends = _advance(system, line, time, step, heave, ends)
        moordyn.Close(system)
    kept = np.array(ends[-round(2 * PERIOD / step) :]) / 1e3
    return {"fairlead": (kept[:, 1].min(), kept[:, 1].max()), "anchor": (kept[:, 0].min(), kept[:, 0].max())}


def _advance(
    system: Any, line: Any, time: float, step: float, heave: float, ends: list[Any]
) -> tuple[float, list[Any]]:
    """One coupling step, the heave growing over the first period."""
    omega = 2 * math.pi / PERIOD
    grown = min(time / PERIOD, 1.0)
    rate = heave * (
        grown * omega * math.cos(omega * time) + (math.sin(omega * time) / PERIOD if time < PERIOD else 0.0)
    )
    position = heave * grown * math.sin(omega * time)
    moordyn.Step(system, [0.0, 0.0, position], [0.0, 0.0, rate], time, step)
    tension = [float(np.linalg.norm(moordyn.GetLineNodeTen(line, node))) for node in (0, moordyn.GetLineN(line))]
    return time + step, [*ends, tension]


def riser_case(number: int) -> dict[str, Any]:
    """One of the riser's six cases."""
    data: dict[str, Any] = copy.deepcopy(
        yaml.safe_load((EXAMPLES / f"hanging-riser-case{1 if number <= 3 else 2}.yaml").read_text(encoding="utf-8"))
    )
    if number <= 3:
        motion = data["lines"]["riser"]["end_b"]["motion"]
        data["lines"]["riser"]["end_b"]["motion"] = {("surge", "sway", "heave")[number - 1]: motion["surge"]}
    else:
        data["environment"]["seastates"][0]["direction"] = f"{(0, 45, 90)[number - 4]} deg"
    data["analyses"] = {"time_domain": data["analyses"]["time_domain"]}
    return data


@cache
def riser_range(number: int) -> Range:
    """Range of the tension at the riser's top end [kN]."""
    summary = run(parse_case(riser_case(number)), None, threads=1).summary
    if "time_domain" in summary["failures"]:
        raise RuntimeError(summary["failures"]["time_domain"])
    found = summary["time_domain"]["lines"]["riser"]["end_b_tension"]
    return 1e-3 * found["min"], 1e-3 * found["max"]


def riser_table() -> str:
    rows = []
    for number, (words, digitised, theirs) in RISER.items():
        found = riser_range(number)
        rows.append([str(number), words, *(
            "-" if one is None else f"{one[0]:.2f} to {one[1]:.2f}" for one in (found, theirs, digitised)
        )])  # fmt: skip
    return _table(("case", "what moves", "Slowdrift", "MoorDyn", "digitised"), rows)


if __name__ == "__main__":
    print(section())
