"""The case as a whole: its parts, what must hold between them, and its hash."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from ..outcome import CaseError, FieldError
from .analysis import Analyses, TimeDomain
from .environment import Environment, RegularWave
from .lines import Attachment as _Attachment
from .lines import End, Line, LineType, Name, Segment
from .partial import known, read_part
from .quantities import Part
from .section import section_faults
from .vessel import Vessel

MAX_ELEMENTS = 200_000
SCHEMA_VERSION = 1


class Case(Part):
    """One question: a system, its environment and the analyses wanted (schema version 1)."""

    slowdrift: Literal[1]
    """Version of this schema."""
    name: Annotated[str, Field(min_length=1, max_length=200)]
    """Title of the case."""
    description: Annotated[str, Field(max_length=10_000)] = ""
    """Free text."""
    environment: Environment
    """Water, seabed, current and waves."""
    vessel: Vessel | None = None
    """The vessel; without one the lines hang between fixed or moving points."""
    line_types: Annotated[dict[Name, LineType], Field(max_length=200, default_factory=dict)]
    """Cross-sections by name."""
    lines: Annotated[dict[Name, Line], Field(max_length=500, default_factory=dict)]
    """Lines by name."""
    attachments: Annotated[tuple[_Attachment, ...], Field(max_length=5000)] = ()
    """Clump weights and buoys at nodes of lines."""
    analyses: Analyses
    """What is asked; an empty mapping, `{}`, asks with all defaults."""

    def canonical(self) -> str:
        """The case as JSON with sorted keys: SI numbers, angles as `… rad`; reads back to an equal case."""
        return json.dumps(self.model_dump(mode="json", exclude_none=True), sort_keys=True, separators=(",", ":"))

    def content_hash(self) -> str:
        """SHA-256 of the canonical JSON; equal for cases that differ only in spelling or units."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()


def parse_case(data: Any) -> Case:
    """A checked case from plain dicts and lists.

    Raises CaseError naming every field at fault, with its value and the allowed range.
    """
    case, errors = examine_case(data)
    if errors:
        raise CaseError(errors)
    assert case is not None
    return case


MOST_FAULTS = 1000
"""A case with more is not looked at further."""


def too_many(count: int) -> FieldError:
    """Said before the first MOST_FAULTS."""
    return FieldError((), f"{count} faults; these are the first {MOST_FAULTS}: mend them, then check again")


def examine_case(data: Any) -> tuple[Case | None, list[FieldError]]:
    """A case from plain dicts and lists, and all its faults: of its fields, and between them as far as they are known.

    A field at fault is lacking from the case and raises Unread; there is no case where the data are no mapping.
    """
    try:
        case: Case | None = Case.model_validate(data)
        errors: list[FieldError] = []
    except ValidationError as error:
        if error.error_count() > MOST_FAULTS:
            return None, [too_many(error.error_count()), *field_errors(error)]
        errors = field_errors(error)
        case, rules = read_part(Case, data) if isinstance(data, dict) else (None, [])
        places = {item.loc for item in errors}
        errors += [item for item in rules if item.loc not in places]
    except RecursionError:
        return None, [FieldError((), "the case is nested too deeply to be read")]
    if case is not None:
        places = {item.loc for item in errors}
        errors += [item for item in _cross_checks(case) if item.loc not in places]
    return case, errors


def field_errors(error: ValidationError) -> list[FieldError]:
    """The faults of fields, each with its value and the allowed range, at most MOST_FAULTS; without those that only
    follow from another."""
    return _telling([_field_error(item) for item in error.errors(include_url=False)[:MOST_FAULTS]])


_TAGS = {"jonswap", "pierson-moskowitz", "tabulated", "regular"}


def _telling(errors: list[FieldError]) -> list[FieldError]:
    """One error a field, without those that only follow from a fault further in."""
    first = {error.loc: error for error in reversed(errors)}
    inner = {loc[:cut] for loc in first for cut in range(len(loc))}
    return [error for loc, error in reversed(first.items()) if loc not in inner]


def _field_error(item: Any) -> FieldError:
    loc = tuple(part for part in item["loc"] if part not in _TAGS and not str(part).startswith("literal["))
    loc = tuple(part for part in loc if not str(part).startswith(("function-", "constrained-", "float", "tuple[")))
    value = item.get("input")
    shown = "" if isinstance(value, dict | list) else repr(value)[:80]
    message = item["msg"].removeprefix("Value error, ")
    context = item.get("ctx", {})
    if item["type"] == "extra_forbidden":
        message = "this key is not known here; check its spelling and its place"
        shown = ""
    elif item["type"] == "missing":
        message, shown = "this field is required", ""
    elif any(key in context for key in ("gt", "ge", "lt", "le")):
        signs = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}
        allowed = " and ".join(f"{signs[key]} {context[key]:g}" for key in signs if key in context)
        message = f"{shown} is out of range; allowed: {allowed}"
    elif item["type"] == "finite_number":
        message = f"{shown} is not a finite number"
    return FieldError(loc, message, shown)


def _cross_checks(case: Case) -> Iterator[FieldError]:
    """Faults between fields; a check that needs a field which could not be read is left out."""
    for check in (_whole, _vessel, section_faults, _elements, _lines, _attachments, _breaking, _sea, _time_domain):
        yield from known(check, case)


def _whole(case: Case) -> Iterator[FieldError]:
    if case.vessel is None and not case.lines:
        yield FieldError((), "the case has neither a vessel nor lines; give at least one")


def _vessel(case: Case) -> Iterator[FieldError]:
    vessel = case.vessel
    if vessel is None or vessel.hydrodynamics is not None:
        return
    loc = ("vessel", "hydrodynamics")
    if vessel.hydrostatics.stiffness is None:
        yield FieldError(
            loc,
            "a vessel needs hydrodynamic data, or at least hydrostatics.stiffness to hold it in heave, roll and pitch",
        )
    elif case.environment.seastates:
        yield FieldError(loc, "waves act on the vessel only through hydrodynamic data")


def _elements(case: Case) -> Iterator[FieldError]:
    elements = sum(segment.elements or 0 for line in case.lines.values() for segment in line.segments)
    if elements > MAX_ELEMENTS:
        yield FieldError(("lines",), f"{elements} elements in all; allowed: at most {MAX_ELEMENTS}")


def _lines(case: Case) -> Iterator[FieldError]:
    for name, line in case.lines.items():
        yield from known(_segments, case, ("lines", name), line)
        for end_name in ("end_a", "end_b"):
            yield from known(_fairlead, case, ("lines", name, end_name), line, end_name)
            yield from known(_depth_of_end, case, ("lines", name, end_name), line, end_name)
        yield from known(_reach, case, ("lines", name), line)


def _segments(case: Case, loc: tuple[str | int, ...], line: Line) -> Iterator[FieldError]:
    for index, segment in enumerate(line.segments):
        yield from known(_type, case, (*loc, "segments", index, "type"), segment)
        yield from known(_count, (*loc, "segments", index, "element_length"), segment)


def _type(case: Case, loc: tuple[str | int, ...], segment: Segment) -> Iterator[FieldError]:
    if segment.type not in case.line_types:
        there = ", ".join(case.line_types) or "none"
        yield FieldError(loc, f"no line type {segment.type!r}; known: {there}", segment.type)


def _count(loc: tuple[str | int, ...], segment: Segment) -> Iterator[FieldError]:
    if segment.element_length is not None and segment.length != "find":
        count = math.ceil(segment.length / segment.element_length)
        if count > 5000:
            yield FieldError(loc, f"gives {count} elements; allowed: ≤ 5000")


def _reach(case: Case, loc: tuple[str | int, ...], line: Line) -> Iterator[FieldError]:
    a, b = end_point(case, line.end_a), end_point(case, line.end_b)
    if a is not None and a == b:
        yield FieldError(loc, "both ends are at the same point")
    if a is not None and b is not None and line.length is not None and not line.allow_stretch:
        distance = math.dist(a, b)
        if distance >= line.length:
            yield FieldError(
                (*loc, "segments"),
                f"the line is {line.length:g} m long but its ends are {distance:.6g} m apart; "
                f"allowed: longer than {distance:.6g} m, or allow_stretch: true",
                f"{line.length:g}",
            )


def _fairlead(case: Case, loc: tuple[str | int, ...], line: Line, end_name: str) -> Iterator[FieldError]:
    if getattr(line, end_name).fairlead is not None and case.vessel is None:
        yield FieldError((*loc, "fairlead"), "the case has no vessel to carry a fairlead; use pinned")


def _depth_of_end(case: Case, loc: tuple[str | int, ...], line: Line, end_name: str) -> Iterator[FieldError]:
    end: End = getattr(line, end_name)
    depth = case.environment.depth
    if end.pinned is not None and end.pinned[2] < -depth - 1e-6:
        yield FieldError((*loc, "pinned", 2), f"{end.pinned[2]:g} m is below the seabed; allowed: ≥ {-depth:g}")
    if end.anchor is not None and end.anchor.point is not None and len(end.anchor.point) == 3:
        z = end.anchor.point[2]
        if z < -depth - 1e-6:
            yield FieldError((*loc, "anchor", "point", 2), f"{z:g} m is below the seabed; allowed: ≥ {-depth:g}")


def end_point(case: Case, end: End) -> tuple[float, float, float] | None:
    """Earth-fixed position [m] of an end in the design position; None for an anchor still to be placed."""
    if end.pinned is not None:
        return end.pinned
    if end.fairlead is not None and case.vessel is not None:
        (px, py, pz), (gx, gy, gz) = end.fairlead, case.vessel.centre_of_gravity
        c, s = math.cos(case.vessel.heading), math.sin(case.vessel.heading)
        return (c * (gx + px) - s * (gy + py), s * (gx + px) + c * (gy + py), gz + pz)
    if end.anchor is not None and end.anchor.point is not None:
        point = end.anchor.point
        return (point[0], point[1], point[2] if len(point) == 3 else -case.environment.depth)
    return None


def _attachments(case: Case) -> Iterator[FieldError]:
    for index, item in enumerate(case.attachments):
        yield from known(_attachment, case, ("attachments", index), item)


def _attachment(case: Case, loc: tuple[str | int, ...], item: _Attachment) -> Iterator[FieldError]:
    line = case.lines.get(item.line)
    if line is None:
        there = ", ".join(case.lines) or "none"
        yield FieldError((*loc, "line"), f"no line {item.line!r}; known: {there}", item.line)
    elif line.length is not None and not 0 < item.arc_length < line.length:
        yield FieldError(
            (*loc, "arc_length"),
            f"{item.arc_length:g} m is not inside the line; allowed: between 0 and {line.length:g} m, ends excluded",
            f"{item.arc_length:g}",
        )


def harmonic_frequencies(case: Case) -> list[tuple[tuple[str | int, ...], float]]:
    """Where and how fast [rad/s] something moves harmonically: regular waves and prescribed motions."""
    found: list[tuple[tuple[str | int, ...], float]] = []
    for index, sea in enumerate(case.environment.seastates):
        if isinstance(sea, RegularWave):
            found.append((("environment", "seastates", index, "period"), 2 * math.pi / sea.period))
    for name, line in case.lines.items():
        for end_name in ("end_a", "end_b"):
            motion = getattr(line, end_name).motion
            for axis, harmonic in (motion.harmonics() if motion else {}).items():
                key = ("surge", "sway", "heave")[axis]
                found.append((("lines", name, end_name, "motion", key, "period"), 2 * math.pi / harmonic.period))
    return found


def _breaking(case: Case) -> Iterator[FieldError]:
    for index, sea in enumerate(case.environment.seastates):
        if isinstance(sea, RegularWave):
            yield from known(_breaks, ("environment", "seastates", index, "height"), sea)


def _breaks(loc: tuple[str | int, ...], sea: RegularWave) -> Iterator[FieldError]:
    limit = 0.142 * 1.5613 * sea.period**2
    if sea.height > limit:
        yield FieldError(
            loc,
            f"{sea.height:g} m breaks at a period of {sea.period:g} s; allowed: below {limit:.3g} m",
            f"{sea.height:g}",
        )


def _sea(case: Case) -> Iterator[FieldError]:
    """What the frequency domain does not take."""
    frequency_domain = case.analyses.frequency_domain
    if frequency_domain is None:
        return
    harmonics = harmonic_frequencies(case)
    if harmonics and case.environment.random:
        yield FieldError(
            harmonics[0][0][:-1],
            "the frequency domain cannot mix regular waves or prescribed motion with a random sea; "
            "run them as two cases, or in the time domain",
        )
    if not harmonics and not case.environment.random:
        yield FieldError(
            ("analyses", "frequency_domain"),
            "nothing moves: give environment.seastates or a prescribed motion, or leave frequency_domain out",
        )
    for loc, frequency in harmonics[1:]:
        if abs(frequency - harmonics[0][1]) > 1e-9 * frequency:
            yield FieldError(
                loc,
                f"the frequency domain takes one period for all regular waves and motions; "
                f"{'.'.join(map(str, harmonics[0][0]))} has {2 * math.pi / harmonics[0][1]:g} s",
                f"{2 * math.pi / frequency:g}",
            )


def _time_domain(case: Case) -> Iterator[FieldError]:
    """What the time domain does not take."""
    spec = case.analyses.time_domain
    if spec is None:
        return
    loc = ("analyses", "time_domain")
    for check in (_output_step, _duration, _steps, _stored):
        yield from known(check, loc, spec)
    for about in (_has_lines, _fairleads, _one_period):
        yield from known(about, case)


def _output_step(loc: tuple[str, ...], spec: TimeDomain) -> Iterator[FieldError]:
    every = round(spec.output_step / spec.step)
    if every < 1 or abs(every * spec.step - spec.output_step) > 1e-6 * spec.output_step:
        yield FieldError(
            (*loc, "output_step"),
            f"{spec.output_step:g} s is no multiple of the step; allowed: {spec.step:g}, {2 * spec.step:g}, … s",
            f"{spec.output_step:g}",
        )


def _duration(loc: tuple[str, ...], spec: TimeDomain) -> Iterator[FieldError]:
    if spec.duration < spec.output_step:
        yield FieldError(
            (*loc, "duration"), f"{spec.duration:g} s is shorter than output_step; allowed: ≥ {spec.output_step:g}"
        )


def _steps(loc: tuple[str, ...], spec: TimeDomain) -> Iterator[FieldError]:
    steps = spec.seeds * (spec.build_up + spec.duration) / spec.step
    if steps > 1e10:
        yield FieldError(loc, f"{steps:.2g} steps over all seeds; allowed: at most 1e10")


def _stored(loc: tuple[str, ...], spec: TimeDomain) -> Iterator[FieldError]:
    stored = spec.duration / spec.output_step
    if stored > 2e6:
        yield FieldError(
            (*loc, "output_step"),
            f"{stored:.3g} values of every history; allowed: at most 2e6, use a longer output_step",
        )


def _has_lines(case: Case) -> Iterator[FieldError]:
    if not case.lines:
        yield FieldError(("analyses", "time_domain"), "the time domain needs at least one line")


def _fairleads(case: Case) -> Iterator[FieldError]:
    for name, line in case.lines.items():
        yield from known(_one_fairlead, ("lines", name, "end_a", "fairlead"), line)


def _one_fairlead(loc: tuple[str, ...], line: Line) -> Iterator[FieldError]:
    if line.end_a.fairlead is not None and line.end_b.fairlead is not None:
        yield FieldError(loc, "the time domain takes a fairlead at one end of a line only")


def _one_period(case: Case) -> Iterator[FieldError]:
    waves = [sea.period for sea in case.environment.regular]
    if waves and max(waves) - min(waves) > 1e-9 * max(waves):
        yield FieldError(("environment", "seastates"), "the time domain takes regular waves of one period")
    motions = [item for item in harmonic_frequencies(case) if item[0][0] == "lines"]
    for where, omega in motions[1:]:
        if abs(omega - motions[0][1]) > 1e-9 * omega:
            yield FieldError(
                where,
                f"the time domain takes one period for all motions; the first has {2 * math.pi / motions[0][1]:g} s",
            )
