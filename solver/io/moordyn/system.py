"""A deck's tables checked and joined up: line types, points, and chains of lines from one held end to the other."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from .deck import Deck, Faults, Row, number
from .report import Report

FIXED = ("fixed", "fix", "anchor")
COUPLED = ("vessel", "ves", "vess", "coupled", "cpld")
FREE = ("free", "point", "connect", "con", "conn")
ON_THE_BED = ("seabed", "ground", "floor")  # in place of a number of z, as MoorDyn-F takes it
SEVERAL = "model the mooring of each in a case of its own, or hold all ends where they are (pinned)"
LONGEST_HULL = 500.0  # m: the longest ship and barge built are shorter


@dataclass(frozen=True)
class Kind:
    """A line type: docs/moordyn.md has the conventions. Cdt on the surface πdl, as MoorDyn takes it."""

    diameter: float
    mass: float
    EA: float
    EI: float
    Cdn: float
    Can: float
    Cdt: float
    Cat: float


@dataclass(frozen=True)
class Point:
    """A point: `fixed`, `coupled` or `free`, at xyz [m] in the deck's axes."""

    id: str
    row: Row
    kind: str
    xyz: tuple[float, float, float]
    mass: float
    volume: float
    CdA: float
    Ca: float

    @property
    def is_loaded(self) -> bool:
        return any((self.mass, self.volume, self.CdA))


@dataclass(frozen=True)
class DeckLine:
    id: str
    row: Row
    type: str
    a: str
    b: str
    length: float
    segments: int


@dataclass(frozen=True)
class Chain:
    """Lines in a row between two held points: `links` from `start` to `end`, `joints` the free points between them."""

    start: Point
    end: Point
    links: tuple[DeckLine, ...]
    joints: tuple[Point, ...]

    @property
    def length(self) -> float:
        return sum(link.length for link in self.links)

    def turned(self) -> Chain:
        return Chain(self.end, self.start, self.links[::-1], self.joints[::-1])


@dataclass
class System:
    kinds: dict[str, Kind] = field(default_factory=dict)
    points: dict[str, Point] = field(default_factory=dict)
    lines: list[DeckLine] = field(default_factory=list)
    line_ids: set[str] = field(default_factory=set)
    chains: list[Chain] = field(default_factory=list)


def build_system(
    deck: Deck, faults: Faults, report: Report, depth: float | None = None, pinned: bool = False
) -> System:
    """The mooring of a deck. Raises CaseError with every fault found, each with its line.

    depth : of the water [m], for points that are put on the seabed by a word; pinned : coupled points are held where
    they are, so that several vessels need no refusal.
    """
    system = System()
    _refused_sections(deck, faults)
    for row in deck.rows.get("types", []):
        _kind(system, row, faults, report)
    bodies = _bodies(deck, faults, pinned)
    for row in deck.rows.get("points", []):
        _point(system, row, bodies, faults, report, depth, pinned)
    for row in deck.rows.get("lines", []):
        _line(system, row, faults)
    if not system.lines and not faults.errors:
        faults.add(deck.lines.get("lines"), ("lines",), "the deck has no lines; is it a MoorDyn deck?")
    faults.stop()
    _one_hull(system, faults)
    _chains(system, faults)
    faults.stop()
    return system


def _one_hull(system: System, faults: Faults) -> None:
    """Coupled points farther apart than any hull is long belong to several vessels, which a case does not have."""
    used = {end for line in system.lines for end in (line.a, line.b)}
    points = [point for name, point in system.points.items() if point.kind == "coupled" and name in used]
    if not points:
        return
    other, one, apart = far_apart(points)
    if apart > LONGEST_HULL:
        message = (
            f"coupled points {other.id} and {one.id} are {apart:.4g} m apart; allowed on one vessel: {LONGEST_HULL:g} m. "
            f"A case has one vessel; {SEVERAL}"
        )
        faults.add(one.row.line, ("points", one.id), message, f"{apart:.4g}")


def far_apart(points: Sequence[Point]) -> tuple[Point, Point, float]:
    """Two points of the largest distance, and it [m]: the farthest from the mean, and the farthest from that one."""
    middle = [sum(values) / len(points) for values in zip(*(point.xyz for point in points), strict=True)]
    one = max(points, key=lambda point: math.dist(point.xyz, middle))
    other = max(points, key=lambda point: math.dist(point.xyz, one.xyz))
    one, other = sorted((one, other), key=lambda point: point.row.line)
    return one, other, math.dist(one.xyz, other.xyz)


def _refused_sections(deck: Deck, faults: Faults) -> None:
    reasons = {
        "rods": "rods are rigid bodies of their own, which a case cannot say; the answer would change without them",
        "external loads": "loads and damping on points and bodies are not part of a case; the answer would change",
    }
    for section, reason in reasons.items():
        for line, words in deck.raw.get(section, []):
            faults.add(line, (section, words[0]), reason, " ".join(words))


def _kind(system: System, row: Row, faults: Faults, report: Report) -> None:
    name = row["name"]
    if name in system.kinds:
        faults.add(row.line, ("types", name), "this line type is given twice", name)
        return
    EA = row["EA"]
    if "|" in EA:
        message = (
            "a static and a dynamic stiffness (EA|EA_D): a case has one; put the one that serves the question in the deck "
            "(static for offsets and low frequencies, dynamic for wave frequencies) or run both"
        )
        faults.add(row.line, ("types", name, "EA"), message, EA)
        return
    for column in ("EA", "BA", "EI"):
        if not row.cells.get(column, "0").replace("|", "").lstrip("+-").replace(".", "", 1)[:1].isdigit():
            message = "a table of a nonlinear law in a file of its own: a case has one number; put the tangent stiffness there"
            faults.add(row.line, ("types", name, column), message, row[column])
            return

    def take(column: str, low: float = 0.0, high: float = math.inf) -> float:
        return number(row, column, faults, "types", low, high)

    if "Cl" in row.cells and take("Cl") > 0:
        message = "vortex-induced vibration (Cl > 0) is not part of a case; set it to 0 to read the deck without it"
        faults.add(row.line, ("types", name, "Cl"), message, row["Cl"])
    EI = take("EI") if "EI" in row.cells else 0.0
    kind = Kind(
        take("diameter", 1e-6), take("mass", 1e-9), take("EA", 1e-3), EI, take("Cdn", 0, 100), take("Can", 0, 100),
        take("Cdt", 0, 100 / math.pi), take("Cat", 0, 100),
    )  # fmt: skip
    system.kinds[name] = kind
    if row["BA"].lstrip("+-").strip("0.") != "":
        report.dropped.append(
            f"line type {name}: internal damping BA/-zeta {row['BA']}; it damps axial vibration of single segments, "
            "which the implicit scheme here does not need"
        )


def _bodies(deck: Deck, faults: Faults, pinned: bool) -> dict[str, tuple[str, tuple[float, float, float]]]:
    """Bodies that move with the vessel or not at all, by number: kind and place."""
    found: dict[str, tuple[str, tuple[float, float, float]]] = {}
    for row in deck.rows.get("bodies", []):
        kind = _kind_of(row["kind"])
        if kind == "coupled" and not pinned and any(other == "coupled" for other, _ in found.values()):
            message = f"a second coupled body is a second vessel (MoorDyn gives each six degrees of freedom); {SEVERAL}"
            faults.add(row.line, ("bodies", row["id"]), message, row["kind"])
        if kind in (None, "free"):
            message = "a body that moves on its own is a second vessel; a case has one. Model its mooring in a case of its own"
            faults.add(row.line, ("bodies", row["id"]), message, row["kind"])
            kind = "fixed"  # refused already; its points need no refusal of their own
        x, y, z, *angles = (
            number(row, key, faults, "bodies", -1e6, 1e6) for key in ("x", "y", "z", "roll", "pitch", "yaw")
        )
        if any(angles):
            faults.add(row.line, ("bodies", row["id"]), "a turned body: give its points in the vessel's axes instead")
        found[row["id"]] = (str(kind), (x, y, z))
    return found


def _kind_of(word: str) -> str | None:
    word = word.lower()
    for kind, words in (("fixed", FIXED), ("coupled", COUPLED), ("free", FREE)):
        if word in words:
            return kind
    return None


def _point(
    system: System,
    row: Row,
    bodies: dict[str, tuple[str, tuple[float, float, float]]],
    faults: Faults,
    report: Report,
    depth: float | None,
    pinned: bool,
) -> None:
    name, word = row["id"], row["kind"]
    if name in system.points:
        faults.add(row.line, ("points", name), "this point is given twice", name)
        return
    kind, shift = _kind_of(word), (0.0, 0.0, 0.0)
    if word.lower().startswith("body") and word[4:] in bodies:
        kind, shift = bodies[word[4:]]
    if kind is None:
        message = (
            f"{word!r} is not known as an attachment; known: Fixed, Coupled or Vessel, Free, and bodies of the deck"
        )
        if re.fullmatch(r"t(urbine)?\d+", word.lower()):
            message = f"{word!r} is a turbine of FAST.Farm, whose decks hold several vessels; {SEVERAL}"
        faults.add(row.line, ("points", name), message, word)
        return
    x, y = (number(row, key, faults, "points", -1e6, 1e6) for key in ("x", "y"))
    z = _height(row, faults, depth, attached=word.lower().startswith("body"))
    load = {key: number(row, key, faults, "points", 0.0) for key in ("mass", "volume", "CdA")}
    Ca = number(row, "Ca", faults, "points", 0.0, 100.0)
    for key in ("FX", "FY", "FZ"):
        if key in row.cells and number(row, key, faults, "points") != 0.0:
            message = "a steady force at a point is not part of a case; use vessel.constant_load, or an attachment"
            faults.add(row.line, ("points", name, key), message, row[key])
    if pinned and kind == "coupled":
        kind = "fixed"
    point = Point(name, row, kind, (x + shift[0], y + shift[1], z + shift[2]), **load, Ca=Ca)
    system.points[name] = point
    if point.is_loaded and kind != "free":
        what = "it does not move" if kind == "fixed" else "count it in vessel.mass and the vessel's data"
        report.dropped.append(f"point {name}: mass, volume or drag area at a {kind} point; {what}")


def _height(row: Row, faults: Faults, depth: float | None, attached: bool) -> float:
    """z of a point [m]: a number, or the depth for a word such as `seabed`; NaN with a fault."""
    if not any(word in row["z"].lower() for word in ON_THE_BED):
        return number(row, "z", faults, "points", -1e6, 1e6)
    if depth is None or attached:
        why = "of a body's point z is from the body" if attached else "the deck gives no WtrDpth"
        faults.add(row.line, ("points", row["id"], "z"), f"z is {row['z'][:20]}, but {why}; give it in m", row["z"])
        return math.nan
    return -depth


def _line(system: System, row: Row, faults: Faults) -> None:
    name = row["id"]
    if name in system.line_ids:
        faults.add(row.line, ("lines", name), "this line is given twice", name)
        return
    system.line_ids.add(name)
    if row["type"] not in system.kinds and not faults.errors:
        known = ", ".join(system.kinds) or "none"
        faults.add(row.line, ("lines", name, "type"), f"no line type {row['type']!r}; known: {known}", row["type"])
    for end in ("a", "b"):
        if row[end] not in system.points and not faults.errors:
            known = ", ".join(list(system.points)[:20]) or "none"
            faults.add(row.line, ("lines", name, end), f"no point {row[end]!r}; known: {known}", row[end])
    if row["a"] == row["b"]:
        faults.add(row.line, ("lines", name), "both ends are at the same point", row["a"])
    length = number(row, "length", faults, "lines", 1e-3, 1e6)
    segments = number(row, "segments", faults, "lines", 1, 5000)
    if segments == segments and segments != int(segments):
        faults.add(row.line, ("lines", name, "segments"), "the number of segments must be whole", row["segments"])
        return
    system.lines.append(
        DeckLine(name, row, row["type"], row["a"], row["b"], length, int(segments or 0) if segments == segments else 0)
    )


def _chains(system: System, faults: Faults) -> None:
    """Join lines that meet at free points into one line of several segments."""
    at: dict[str, list[DeckLine]] = {name: [] for name in system.points}
    for line in system.lines:
        at[line.a].append(line)
        at[line.b].append(line)
    for name, lines in at.items():
        point = system.points[name]
        if point.kind == "free" and lines and len(lines) != 2:
            joined = ", ".join(line.id for line in lines)
            message = (
                f"{len(lines)} line(s) end at this free point ({joined}); allowed: 2. A case has lines between held ends, "
                "so a bridle or a loose end cannot be said"
            )
            faults.add(point.row.line, ("points", name), message)
    faults.stop()
    used: set[str] = set()
    for line in system.lines:
        if line.id in used:
            continue
        for start in (line.a, line.b):
            if system.points[start].kind != "free":
                system.chains.append(_walk(system, at, line, start, used))
                break
    loose = [line for line in system.lines if line.id not in used]
    for line in loose:
        faults.add(line.row.line, ("lines", line.id), "the line belongs to a ring of free points with no held end")


def _walk(system: System, at: dict[str, list[DeckLine]], line: DeckLine, start: str, used: set[str]) -> Chain:
    links, joints, here = [], [], start
    while True:
        used.add(line.id)
        links.append(line)
        here = line.b if line.a == here else line.a
        if system.points[here].kind != "free":
            break
        joints.append(system.points[here])
        one, two = at[here]
        line = two if one is line else one
    chain = Chain(system.points[start], system.points[here], tuple(links), tuple(joints))
    if chain.start.kind == chain.end.kind:
        return chain if chain.start.xyz[2] <= chain.end.xyz[2] else chain.turned()
    return chain if chain.end.kind == "coupled" else chain.turned()
