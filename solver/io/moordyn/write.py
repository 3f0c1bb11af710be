"""A case → a MoorDyn v2 deck. Conventions and what cannot be said: docs/moordyn.md."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ...case import Case, end_point
from ...case.lines import End, Line, LineType
from ...case.section import section
from ...outcome import CaseError, FieldError
from .report import Report, printable

Xyz = tuple[float, float, float]
DEFAULT_SOIL = 100e3  # N/m3, of a case that says nothing about its bed
STABLE = 0.2  # of the largest step that an explicit scheme takes in the stiffest element


@dataclass(frozen=True)
class Placed:
    """What statics found of a line: the places of its ends [m, earth axes] and its unstretched length [m]."""

    end_a: Xyz
    end_b: Xyz
    length: float

    @staticmethod
    def of(summary: Mapping[str, Any]) -> dict[str, Placed]:
        """From the summary of a run that has statics (docs/summary.md), by line."""
        lines = summary["statics"]["lines"]
        places = {name: [tuple(line[key]["position"]) for key in ("end_a", "end_b")] for name, line in lines.items()}
        return {name: Placed(places[name][0], places[name][1], line["length"]) for name, line in lines.items()}


@dataclass(frozen=True)
class Written:
    text: str
    report: Report


@dataclass
class _Tables:
    """Rows of the deck. Points that are equal and held are written once."""

    points: list[tuple[str, Xyz, tuple[float, float, float, float]]] = field(default_factory=list)
    lines: list[tuple[str, int, int, float, int]] = field(default_factory=list)

    def held(self, kind: str, xyz: Xyz) -> int:
        row = (kind, xyz, (0.0, 0.0, 0.0, 0.0))
        if row not in self.points:
            self.points.append(row)
        return self.points.index(row) + 1

    def free(self, xyz: Xyz, load: tuple[float, float, float, float]) -> int:
        self.points.append(("Free", xyz, load))
        return len(self.points)


def write_deck(case: Case, placed: Mapping[str, Placed] | None = None) -> Written:
    """The lines of a case as a deck, its coordinates in earth axes with the vessel in its design position.

    placed : by line, what statics found; needed where an anchor or a length follows from a pretension (then CaseError).
    """
    report, tables = Report(), _Tables()
    if not case.lines:
        raise CaseError([FieldError(("lines",), "a deck needs at least one line; the case has none")])
    for name, line in case.lines.items():
        _line(case, name, line, (placed or {}).get(name), tables, report)
    soil, damping = _bed(case, report)
    _dropped(case, report)
    water = case.environment.water
    options = [
        (_step(case, soil, damping), "dtM", "time step (s)"), (water.gravity, "g", "gravity (m/s^2)"),
        (water.density, "rho", "water density (kg/m^3)"), (case.environment.depth, "WtrDpth", "water depth (m)"),
        (soil, "kBot", "bottom stiffness (Pa/m)"), (damping, "cBot", "bottom damping (Pa-s/m)"),
    ]  # fmt: skip
    if case.environment.seabed.friction:
        options.append((case.environment.seabed.friction, "FrictionCoefficient", "seabed friction (-)"))
    return Written(_text(case, tables, options, report), report)


def _text(case: Case, tables: _Tables, options: list[tuple[float, str, str]], report: Report) -> str:
    out = ["--------------------- MoorDyn Input File ---------------------", _plain(case.name)]
    out += report.comment("").splitlines()
    out += [
        _heading("LINE TYPES"),
        "Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx",
        "(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)",
    ]
    words = _words(case)
    for name, kind in case.line_types.items():
        diameter = _diameter(case, name)
        wide = section(kind, case.environment.water).drag_diameter / diameter
        values = (diameter, kind.mass, kind.EA, -1.0, kind.EI, wide * kind.drag.normal, kind.added_mass.normal,
                  wide * kind.drag.tangential / math.pi, kind.added_mass.tangential)  # fmt: skip
        if diameter != kind.diameter or wide != 1.0:
            report.assumed.append(
                f"line_types.{name}: Diam {diameter:.6g} m is that of its displaced volume (diameter {kind.diameter:g} m); "
                f"Cd and CdAx times {wide:.6g}, so that its drag is the same"
            )
        out.append(" ".join([words[name], *map(_number, values)]))
    out += [_heading("POINTS"), "ID Attachment X Y Z Mass Volume CdA Ca", "(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)"]
    for index, (attachment, xyz, load) in enumerate(tables.points, 1):
        out.append(" ".join([str(index), attachment, *map(_number, (*xyz, *load))]))
    out += [_heading("LINES"), "ID LineType AttachA AttachB UnstrLen NumSegs Outputs", "(#) (-) (#) (#) (m) (-) (-)"]
    for index, (type_, a, b, length, count) in enumerate(tables.lines, 1):
        out.append(f"{index} {words[type_]} {a} {b} {_number(length)} {count} -")
    out.append(_heading("OPTIONS"))
    out += [f"{_number(value)} {word} - {text}" for value, word, text in options]
    out += [_heading("OUTPUTS"), *(f"FairTen{index}" for index in range(1, len(tables.lines) + 1))]
    return "\n".join([*out, "--------------------- need this line ---------------------", ""])


def _diameter(case: Case, name: str) -> float:
    """MoorDyn's one diameter of a line type: that of the solid cylinder of its displaced volume [m]."""
    found = section(case.line_types[name], case.environment.water).wet_diameter
    if found <= 0:
        message = "MoorDyn knows no line type without displaced volume; give a volume above 0"
        raise CaseError([FieldError(("line_types", name, "volume"), message)])
    return found


def _heading(words: str) -> str:
    return f"---------------------- {words} ----------------------"


def _plain(text: str) -> str:
    return printable(text).lstrip("- ") or "case"


def _words(case: Case) -> dict[str, str]:
    """Names of line types without blanks, each its own."""
    found: dict[str, str] = {}
    for name in case.line_types:
        plain = name.replace(" ", "_")
        word, count = plain, 2
        while word in found.values() or (word != name and word in case.line_types):
            word, count = f"{plain}-{count}", count + 1
        found[name] = word
    return found


def _number(value: float) -> str:
    return f"{value + 0.0:.15g}"


def _line(case: Case, name: str, line: Line, found: Placed | None, tables: _Tables, report: Report) -> None:
    a, b = _end_points(case, name, line, found)
    pieces = _pieces(case, name, line, found)
    total = sum(length for _, length, _, _ in pieces)
    first = len(tables.lines) + 1
    for _ in range(line.multiplicity):
        here, arc = tables.held(*a), 0.0
        for index, (type_, length, count, load) in enumerate(pieces):
            arc += length
            share = arc / total
            there = tuple(p + share * (q - p) for p, q in zip(a[1], b[1], strict=True))
            last = index == len(pieces) - 1
            point = (
                tables.held(*b)
                if last
                else tables.free((there[0], there[1], max(there[2], -case.environment.depth)), load)
            )
            tables.lines.append((type_, here, point, length, count))
            here = point
    last_id = len(tables.lines)
    copies = f" ({line.multiplicity} equal ones)" if line.multiplicity > 1 else ""
    report.read.append(f"{name} is line {first}" + (f" to {last_id}" if last_id > first else "") + copies)


def _end_points(case: Case, name: str, line: Line, found: Placed | None) -> tuple[tuple[str, Xyz], tuple[str, Xyz]]:
    points = {key: end_point(case, getattr(line, key)) for key in ("end_a", "end_b")}
    for key, other in (("end_a", "end_b"), ("end_b", "end_a")):
        anchor, away = getattr(line, key).anchor, points[other]
        if points[key] is not None or anchor is None:
            continue
        if anchor.radius is not None and away is not None:
            x, y = (
                away[0] + anchor.radius * math.cos(anchor.azimuth),
                away[1] + anchor.radius * math.sin(anchor.azimuth),
            )
            points[key] = (x, y, -case.environment.depth)
        elif found is not None:
            points[key] = getattr(found, key)
        else:
            message = "the place of this anchor follows from its pretension; run statics first"
            raise CaseError(
                [FieldError(("lines", name, key, "anchor", "pretension"), message, f"{anchor.pretension:g}")]
            )
    return (_attachment(line.end_a), _rounded(points["end_a"])), (_attachment(line.end_b), _rounded(points["end_b"]))


def _attachment(end: End) -> str:
    return "Coupled" if end.fairlead is not None or end.motion is not None else "Fixed"


def _rounded(point: Xyz | None) -> Xyz:
    assert point is not None
    x, y, z = (float(f"{value:.12g}") if abs(value) > 1e-9 else 0.0 for value in point)
    return x, y, z


Piece = tuple[str, float, int, tuple[float, float, float, float]]


def _pieces(case: Case, name: str, line: Line, found: Placed | None) -> list[Piece]:
    """A line cut at its joints and attachments: type, length, elements and the load at the far end of each piece."""
    known = sum(float(segment.length) for segment in line.segments if segment.length != "find")
    pieces: list[Piece] = []
    start = 0.0
    for index, segment in enumerate(line.segments):
        if segment.length == "find":
            if found is None:
                message = "this length follows from the pretension; run statics first"
                raise CaseError([FieldError(("lines", name, "segments", index, "length"), message, "find")])
            length = found.length - known
        else:
            length = float(segment.length)
        count = segment.elements or math.ceil(length / float(segment.element_length or length) - 1e-9)
        step, done = length / count, 0
        for node, load in sorted(_loads(case, name, start, step, count, index == len(line.segments) - 1).items()):
            pieces.append((segment.type, (node - done) * step, node - done, load))
            done = node
        if done < count:
            pieces.append((segment.type, (count - done) * step, count - done, (0.0, 0.0, 0.0, 0.0)))
        start += length
    return pieces


def _loads(
    case: Case, name: str, start: float, step: float, count: int, last: bool
) -> dict[int, tuple[float, float, float, float]]:
    """Attachments by the node of a segment they hang on (1 … count), summed: mass, volume, CdA, Ca."""
    found: dict[int, tuple[float, float, float, float]] = {}
    for item in case.attachments:
        node = round((item.arc_length - start) / step) if item.line == name else 0
        if not 1 <= node <= count - last:
            continue
        mass, volume, area, Ca = found.get(node, (0.0, 0.0, 0.0, 0.0))
        displaced = volume + item.volume
        Ca = (volume * Ca + item.volume * item.added_mass) / displaced if displaced > 0 else item.added_mass
        found[node] = (mass + item.mass, displaced, area + item.drag_area, Ca)
    return found


def _areas(case: Case, nominal: bool = False) -> list[float]:
    """Diameter, as written or `nominal`, × element length next to end a of every line [m2]."""
    found = []
    names = [line.segments[0].type for line in case.lines.values()]
    wide = {name: case.line_types[name].diameter if nominal else _diameter(case, name) for name in names}
    for line in case.lines.values():
        segment = line.segments[0]
        if segment.length == "find":
            continue
        length = float(segment.length)
        count = segment.elements or math.ceil(length / float(segment.element_length or length) - 1e-9)
        found.append(wide[segment.type] * length / count)
    return found or [wide[name] for name in names]


def _bed(case: Case, report: Report) -> tuple[float, float]:
    """kBot [Pa/m] and cBot [Pa s/m], which MoorDyn takes per area, from what a case says of one node."""
    seabed, areas = case.environment.seabed, _areas(case)
    mean = sum(areas) / len(areas)
    per_node = seabed.node_stiffness is not None
    if (per_node or seabed.damping) and max(areas) - min(areas) > 1e-9 * mean:
        report.assumed.append(
            f"seabed per area from that of a node, over diameter × element length: mean {mean:.4g} of {min(areas):.4g} to "
            f"{max(areas):.4g} m2"
        )
    soil = seabed.node_stiffness / mean if seabed.node_stiffness is not None else _soil(case, areas, report)
    over = "its default" if seabed.transition is None else f"{seabed.transition:g} m"
    report.dropped.append(f"seabed.transition {over}: MoorDyn's bed begins at once")
    if seabed.friction:
        report.dropped.append(f"seabed.friction_speed {seabed.friction_speed:g} m/s: MoorDyn has FricDamp in its place")
    return soil, seabed.damping / mean


def _soil(case: Case, areas: list[float], report: Report) -> float:
    """kBot that gives the soil's stiffness on the nominal diameter, where MoorDyn takes its own."""
    soil, nominal = case.environment.seabed.soil or DEFAULT_SOIL, _areas(case, nominal=True)
    ratios = [own / written for own, written in zip(nominal, areas, strict=True)]
    mean = sum(ratios) / len(ratios)
    if mean != 1.0:
        spread = "" if max(ratios) - min(ratios) < 1e-9 else f", the mean of {min(ratios):.4g} to {max(ratios):.4g}"
        report.assumed.append(
            f"kBot is seabed.soil times {mean:.6g}{spread}: the soil acts on the nominal diameter, MoorDyn's on Diam"
        )
    return soil * mean


def _step(case: Case, soil: float, damping: float) -> float:
    """A step that MoorDyn's explicit scheme bears: axial waves, internal damping and the bed [s]."""
    steps = []
    for line in case.lines.values():
        for segment in line.segments:
            kind = case.line_types[segment.type]
            length = float(segment.length) if segment.length != "find" else 100.0
            count = segment.elements or math.ceil(length / float(segment.element_length or length) - 1e-9)
            steps.append(_longest(kind, _diameter(case, segment.type), length / count, soil, damping))
    return float(f"{STABLE * min(steps):.1g}")


def _longest(kind: LineType, diameter: float, length: float, soil: float, damping: float) -> float:
    area = diameter / kind.mass  # m² per kg of lying line
    rates = [math.sqrt(kind.EA / kind.mass) / length, 0.5 * math.sqrt(soil * area), 0.5 * damping * area]
    rates.append(2.0 * math.sqrt(kind.EI / kind.mass) / length**2)
    return 1.0 / max(rates)


def _dropped(case: Case, report: Report) -> None:
    report.assumed.append(
        "internal damping of the lines -1 (critical in each segment), which MoorDyn's explicit scheme needs"
    )
    report.assumed.append(
        "initial places of free points on the straight line between the ends; MoorDyn finds their equilibrium"
    )
    if case.vessel is not None:
        report.dropped.append("vessel: mass, hydrodynamics, loads; whoever couples MoorDyn moves the Coupled points")
    if case.environment.seastates:
        report.dropped.append(
            "seastates: give the waves to MoorDyn's own options (WaveKin, WaterKin) or to the coupled code"
        )
    if case.environment.current is not None:
        report.dropped.append("current: give it to MoorDyn's own options (Currents, WaterKin)")
    for name, kind in case.line_types.items():
        if kind.breaking_load is not None:
            report.dropped.append(f"line_types.{name}.breaking_load")
        if kind.compression == "allowed":
            report.dropped.append(f"line_types.{name}.compression: allowed; MoorDyn's lines carry no compression")
    for name, line in case.lines.items():
        for key in ("end_a", "end_b"):
            if getattr(line, key).motion is not None:
                report.dropped.append(
                    f"lines.{name}.{key}.motion: the program that drives MoorDyn has to move this Coupled point"
                )
    report.dropped.append("analyses, and the names of lines (MoorDyn numbers them)")
