"""A MoorDyn deck → a case. Conventions and what cannot be said: docs/moordyn.md."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from typing import Any

from ...case import Case, parse_case
from ...case.environment import Environment
from ...case.text import read_text, write_text
from ...case.vessel import Vessel
from ...outcome import CaseError, FieldError
from .deck import Deck, Faults, parse_deck, parse_number
from .placement import Placement, off_the_bed, tidy
from .report import Report, printable
from .system import Chain, System, build_system

SOIL, BED_DAMPING = 3.0e6, 3.0e5  # MoorDyn's defaults of kBot [Pa/m] and cBot [Pa s/m]
GRAVITY, DENSITY = 9.80665, 1025.0
FILL = "FILL IN"

_OPTIONS = {  # words of an option, lower case -> its meaning here
    "g": "gravity", "gravity": "gravity", "rho": "density", "rhow": "density", "wtrdnsty": "density", "waterdensity": "density",
    "wtrdpth": "depth", "depth": "depth", "wtrdepth": "depth", "kbot": "soil", "kb": "soil", "cbot": "damping", "cb": "damping",
    "frictioncoefficient": "friction", "mu_kt": "friction", "mu_ka": "friction",
    "wavekin": "water", "currents": "water", "current": "water", "waterkin": "water", "seafloorfile": "bathymetry",
}  # fmt: skip
_OF_THE_SOLVER = (
    "echo", "dtm", "dt", "cfl", "tscheme", "writelog", "dtic", "tmaxic", "cdscaleic", "threshic", "icdfac", "icthresh",
    "ictmax", "dtout", "writeunits", "icgendynamic", "disableoutput", "disableouttime", "outswitch", "inertialf",
    "inertialf_rampt", "unifycurrentgrid", "dtwave", "wavekin_rampt", "fricdamp", "cv", "mc", "statdynfricscale",
)  # fmt: skip


@dataclass(frozen=True)
class Imported:
    """What came out of a deck.

    data : the case as plain data. case : the checked case; None while fields are missing. yaml : its text, the report at
    its head as comments. errors : what keeps it from being a case, field by field.
    """

    data: dict[str, Any]
    case: Case | None
    yaml: str
    report: Report
    errors: tuple[FieldError, ...] = ()


def read_deck(
    text: str | bytes, base: str | bytes | None = None, name: str | None = None, pinned: bool = False
) -> Imported:
    """A case from the text of a deck.

    base : text of a case (or only of its `vessel:`) whose vessel, sea and analyses are kept; its lines are replaced.
    Without it, where lines hang on a vessel, the vessel is a template to be filled in, which the check of a case refuses.
    pinned : vessel points are held at their places in the deck, and the case has no vessel; not together with a base.
    Raises CaseError with line numbers of the deck, or with fields of the base.
    """
    if pinned and base is not None:
        raise CaseError([FieldError(("vessel",), "a case with a vessel and pinned ends exclude each other; give one")])
    deck, report, faults = parse_deck(text), Report(), Faults()
    options = _options(deck, faults, report)
    kept = _base(base) if not faults.errors else {}
    system = build_system(deck, faults, report, _depth(options, kept), pinned)
    data: dict[str, Any] = {
        "slowdrift": 1,
        "name": printable(name or "") or kept.get("name") or printable(deck.title).strip("- ")[:200] or "MoorDyn deck",
    }
    if "description" in kept:
        data["description"] = kept["description"]
    data["environment"] = _environment(options, kept, system, report)
    vessel = kept.get("vessel")
    coupled = any(point.kind == "coupled" for point in system.points.values())
    data["vessel"] = vessel if vessel is not None else _template(report) if coupled else None
    data["line_types"] = _types(system)
    renamed = [f"{name} {label}" for name, label in _labels(system).items() if name != label]
    report.assumed.extend(
        f"line type {pair.replace(' ', ' is called ')}, for a case takes plain letters" for pair in renamed
    )
    data |= _lines(system, data["environment"]["depth"], vessel, report)
    if pinned:
        report.assumed.append("coupled points are pinned where they stand in the deck; there is no vessel")
    off_the_bed(system, data["environment"]["depth"], report)
    _bed_damping(options, system, data, report)
    data["analyses"] = kept.get("analyses") or {"statics": {}}
    data = {key: value for key, value in data.items() if value is not None and value != []}
    report.assumed.extend(deck.notes)
    return _finished(data, report)


def _finished(data: dict[str, Any], report: Report) -> Imported:
    case: Case | None = None
    errors: tuple[FieldError, ...] = ()
    try:
        case = parse_case(data)
    except CaseError as error:
        if not report.missing:
            raise
        errors = tuple(error.errors)
    text = write_text(data, default_flow_style=None, width=160)
    return Imported(data, case, report.comment() + text, report, errors)


def _base(text: str | bytes | None) -> dict[str, Any]:
    if text is None:
        return {}
    data = read_text(text)[0]
    if "vessel" not in data and "mass" in data:
        data = {"vessel": data}
    if not isinstance(data.get("vessel"), dict):
        raise CaseError([FieldError(("vessel",), "the case given for the vessel has none")])
    try:  # only to refuse early what a case would refuse too
        Vessel.model_validate(data["vessel"])
    except ValueError:
        whole = {"slowdrift": 1, "name": "vessel", "environment": {"depth": 1}, "analyses": {"statics": {}}}
        parse_case(whole | {"vessel": data["vessel"]})
        raise
    return dict(data)


def _options(deck: Deck, faults: Faults, report: Report) -> dict[str, float]:
    """Options that a case knows, in SI; the others are in the report or in the faults."""
    found: dict[str, float] = {}
    for line, words in deck.raw.get("options", []):
        if len(words) < 2:
            faults.add(line, ("options",), "an option is a value and a name", " ".join(words))
            continue
        value, word = words[0], words[1]
        meaning = _OPTIONS.get(word.lower())
        if meaning is None:
            if word.lower() not in _OF_THE_SOLVER:
                report.dropped.append(f"option {word} (line {line}): not known here")
        elif meaning == "water":
            if value.strip('"') not in ("0", "0.0", "-", "", "none", "None", "Null", "null"):
                report.dropped.append(f"option {word} {value}: sea and current come from the case, not from the deck")
        elif meaning == "bathymetry" or (meaning == "depth" and re.search(r"[A-Za-z/\\]{2,}", value)):
            faults.add(
                line, ("options", word), "a bathymetry file: the seabed of a case is flat; give a depth in m", value
            )
        elif meaning in found and meaning != "friction":
            faults.add(line, ("options", word), "this option is given twice", value)
        else:
            number = parse_number(
                value, line, ("options", word), faults, 1e-9 if meaning in ("gravity", "density") else 0.0
            )
            found[meaning] = max(number, found.get(meaning, 0.0))
    for section, what in (("failure", "the case is the intact mooring"), ("control", "line lengths stay as they are")):
        if deck.raw.get(section):
            report.dropped.append(f"section {section.upper()}: {what}")
    return found


def _depth(options: dict[str, float], kept: dict[str, Any]) -> float | None:
    """That of the deck, else that of the base, where one of them gives it [m]."""
    own = options.get("depth") or (kept.get("environment") or {}).get("depth")
    return None if own is None else _number(own, "depth")


def _environment(options: dict[str, float], kept: dict[str, Any], system: System, report: Report) -> dict[str, Any]:
    environment = dict(kept.get("environment") or {})
    depth = environment.get("depth")
    if options.get("depth"):
        if depth is not None and abs(_number(depth, "depth") - options["depth"]) > 1e-6 * options["depth"]:
            message = f"the case has a depth of {depth}, the deck one of {options['depth']:g} m; make them one"
            raise CaseError([FieldError(("environment", "depth"), message, str(depth))])
        depth = options["depth"]
    elif depth is None:
        deepest = min((point.xyz[2] for point in system.points.values() if point.kind == "fixed"), default=0.0)
        if deepest >= 0:
            raise CaseError(
                [FieldError(("deck", "options", "WtrDpth"), "the deck has no water depth and no anchor to tell it")]
            )
        depth = -deepest
        report.assumed.append(f"depth {depth:g} m, that of the deepest fixed point; the deck gives none")
    water = dict(environment.get("water") or {})
    for key, default in (("density", DENSITY), ("gravity", GRAVITY)):
        if key in options:
            if key in water and abs(_number(water[key], key) - options[key]) > 1e-9 * options[key]:
                report.assumed.append(f"{key} {options[key]:g} of the deck, in place of the case's {water[key]}")
            water[key] = options[key]
        elif key not in water:
            water[key] = default
            report.assumed.append(f"{key} {default:g}; the deck gives none")
    environment |= {"depth": _number(depth, "depth"), "water": water, "seabed": _seabed(options, environment, report)}
    return environment


def _number(value: Any, field: str) -> float:
    """A quantity of the base in SI."""
    if isinstance(value, int | float):
        return float(value)
    part = {"depth": 1.0} | ({"water": {field: value}} if field != "depth" else {"depth": value})
    read = Environment.model_validate(part)
    return float(read.depth if field == "depth" else getattr(read.water, field))


def _seabed(options: dict[str, float], environment: dict[str, Any], report: Report) -> dict[str, Any]:
    seabed = {key: value for key, value in (environment.get("seabed") or {}).items() if key == "transition"}
    seabed["soil"] = options.get("soil", SOIL)
    if "soil" not in options:
        report.assumed.append(f"seabed stiffness {SOIL:g} Pa/m, MoorDyn's default")
    report.assumed.append(
        f"the bed's stiffness grows over {seabed.get('transition', 'half a diameter or more')} (seabed.transition); "
        "MoorDyn's starts at once"
    )
    friction = options.get("friction", 0.0)
    if friction > 0:
        seabed["friction"] = friction
        report.assumed.append(f"seabed friction {friction:g} in every direction; it acts in the time domain only")
    return seabed


def _bed_damping(options: dict[str, float], system: System, data: dict[str, Any], report: Report) -> None:
    """cBot is per area D·l; a case has the damping of one node: the mean over the elements next to end a."""
    cBot = options.get("damping", BED_DAMPING)
    if cBot == 0:
        return
    areas = []
    for chain in system.chains:
        first = chain.links[0]
        areas.append(system.kinds[first.type].diameter * first.length / first.segments)
    mean = sum(areas) / len(areas)
    data["environment"]["seabed"]["damping"] = tidy(cBot * mean)
    said = (
        ""
        if max(areas) - min(areas) < 1e-9 * mean
        else f", mean of {cBot * min(areas):.4g} to {cBot * max(areas):.4g} over the lines"
    )
    report.assumed.append(
        f"seabed damping {cBot * mean:.4g} N s/m at a node: cBot {cBot:g} Pa s/m on diameter × element length{said}"
    )


def _types(system: System) -> dict[str, Any]:
    """MoorDyn's tangential drag acts on the surface πdl, ours on the diameter: factor π. The rest is the same."""
    labels = _labels(system)
    return {
        labels[name]: {
            "diameter": kind.diameter, "mass": kind.mass, "EA": kind.EA, "EI": kind.EI,
            "drag": {"normal": kind.Cdn, "tangential": math.pi * kind.Cdt},
            "added_mass": {"normal": kind.Can, "tangential": kind.Cat},
        }
        for name, kind in system.kinds.items()
    }  # fmt: skip


def _labels(system: System) -> dict[str, str]:
    """Names of line types as a case takes them, each its own."""
    found: dict[str, str] = {}
    for name in system.kinds:
        plain = re.sub(r"[^A-Za-z0-9 _.\-]", "_", name).lstrip(" _.-")[:50] or "type"
        label, count = plain, 2
        while label in found.values():
            label, count = f"{plain}-{count}", count + 1
        found[name] = label
    return found


def _lines(system: System, depth: float, vessel: Any, report: Report) -> dict[str, Any]:
    """Lines and attachments; lines that are equal in everything become one with a multiplicity."""
    place = Placement(depth, vessel, system.points.values(), report)
    labels = _labels(system)
    lines: dict[str, Any] = {}
    attachments: list[dict[str, Any]] = []
    seen: dict[str, str] = {}
    for chain in system.chains:
        name = f"line-{min(chain.links, key=lambda link: link.row.line).id}"
        if chain.start.kind == chain.end.kind == "coupled":
            report.assumed.append(
                f"{name} runs from the vessel to itself, points {chain.start.id} and {chain.end.id}, "
                f"{math.dist(chain.start.xyz, chain.end.xyz):.4g} m apart; if they are on two vessels, the case is wrong"
            )
        loads = _loads(chain)
        spec = _line(chain, place, labels)
        key = json.dumps([spec, loads], sort_keys=True)
        ids = "+".join(link.id for link in chain.links)
        if key in seen:
            lines[seen[key]]["multiplicity"] = lines[seen[key]].get("multiplicity", 1) + 1
            report.read.append(f"line {ids}: the same as {seen[key]}, counted in its multiplicity")
            continue
        seen[key], lines[name] = name, spec
        attachments.extend({"line": name, **load} for load in loads)
        report.read.append(
            f"line {ids} as {name}: {chain.length:g} m, {sum(link.segments for link in chain.links)} elements"
        )
    return {"lines": lines, "attachments": attachments}


def _line(chain: Chain, place: Placement, labels: dict[str, str]) -> dict[str, Any]:
    segments = [{"type": labels[link.type], "length": link.length, "elements": link.segments} for link in chain.links]
    spec: dict[str, Any] = {"segments": segments, "end_a": place.end(chain.start), "end_b": place.end(chain.end)}
    if math.dist(chain.start.xyz, chain.end.xyz) >= chain.length:
        spec["allow_stretch"] = True
    return spec


def _loads(chain: Chain) -> list[dict[str, Any]]:
    arc, found = 0.0, []
    for link, joint in zip(chain.links[:-1], chain.joints, strict=True):
        arc += link.length
        if joint.is_loaded:
            load = {"mass": joint.mass, "volume": joint.volume, "drag_area": joint.CdA, "added_mass": joint.Ca}
            found.append({"arc_length": tidy(arc), **load})
    return found


def _template(report: Report) -> dict[str, Any]:
    report.missing.extend(
        [
            "vessel.mass, vessel.centre_of_gravity, vessel.radii_of_gyration (or inertia): a deck does not know the vessel",
            "vessel.hydrodynamics.data, or vessel.hydrostatics.stiffness in its place",
            "the fairleads of the lines: relative to the centre of gravity, so subtract it from the deck's coordinates "
            "(read the deck again with a case that has the vessel, and this is done for you)",
        ]
    )
    return {
        "mass": f"{FILL} (kg)", "centre_of_gravity": f"{FILL} ([x, y, z] from the deck's reference)",
        "radii_of_gyration": f"{FILL} ([roll, pitch, yaw], m)", "hydrodynamics": {"data": f"{FILL} (a file or data set)"},
    }  # fmt: skip
