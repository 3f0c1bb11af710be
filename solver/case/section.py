"""The cross-section of a line in the water of a case: displaced volume, weight in water (docs/theory.md, L6)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..outcome import FieldError

if TYPE_CHECKING:
    from .case import Case
    from .environment import Water
    from .lines import LineType


@dataclass(frozen=True)
class Section:
    """volume : displaced, per unit length [m3/m]; wet_diameter : of the solid cylinder of that volume [m]; drag_diameter [m];
    weight_in_water : per unit length, fully wet [N/m]."""

    volume: float
    wet_diameter: float
    drag_diameter: float
    weight_in_water: float


def section(kind: LineType, water: Water) -> Section:
    """A line type in a water: displaced volume by `volume`, by `submerged_weight`, or a solid cylinder (L6)."""
    density, gravity = float(water.density), float(water.gravity)
    if kind.submerged_weight is not None:
        volume = (kind.mass * gravity - kind.submerged_weight) / (density * gravity)
    elif kind.volume is not None:
        volume = float(kind.volume)
    else:
        volume = 0.25 * math.pi * kind.diameter * kind.diameter
    wet = float(kind.diameter) if is_solid(kind) else math.sqrt(4 * max(volume, 0.0) / math.pi)
    drag = float(kind.diameter if kind.drag_diameter is None else kind.drag_diameter)
    return Section(volume, wet, drag, kind.mass * gravity - density * gravity * volume)


def is_solid(kind: LineType) -> bool:
    """Whether a type is taken for a solid cylinder of its nominal diameter."""
    return kind.volume is None and kind.submerged_weight is None


def section_faults(case: Case) -> Iterator[FieldError]:
    """Line types that weigh more in water than in air."""
    gravity = float(case.environment.water.gravity)
    for name, kind in case.line_types.items():
        if kind.submerged_weight is not None and kind.submerged_weight > kind.mass * gravity * (1 + 1e-12):
            yield FieldError(
                ("line_types", name, "submerged_weight"),
                f"{kind.submerged_weight:g} N/m is more than the weight in air; allowed: ≤ {kind.mass * gravity:.6g} N/m",
                f"{kind.submerged_weight:g}",
            )


def line_weight_in_water(case: Case, name: str, length: float) -> float:
    """Weight of a whole line in water, all of it under water, without its attachments [N].

    length : its unstretched length [m], a segment marked `find` included.
    """
    segments = case.lines[name].segments
    known = sum(float(each.length) for each in segments if each.length != "find")
    lengths = [length - known if each.length == "find" else float(each.length) for each in segments]
    water = case.environment.water
    weights = [section(case.line_types[each.type], water).weight_in_water for each in segments]
    return sum(weight * part for weight, part in zip(weights, lengths, strict=True))


def floating_types(case: Case) -> list[str]:
    """A warning for each line type in use that floats because it is taken for a solid cylinder."""
    used = {segment.type for line in case.lines.values() for segment in line.segments}
    found = []
    for name, kind in case.line_types.items():
        weight = section(kind, case.environment.water).weight_in_water
        if name in used and is_solid(kind) and weight < 0:
            found.append(
                f"line type {name!r} floats: as a solid cylinder of {kind.diameter:g} m it weighs {weight:.4g} N/m in water; "
                "give `volume` or `submerged_weight` (also where it is meant to float)"
            )
    return found


def floating_lines(case: Case, lengths: Mapping[str, float]) -> list[str]:
    """A warning for each line that floats as a whole, attachments counted, by its unstretched length [m].

    A line with a type that `floating_types` warns of is not warned of again.
    """
    water = case.environment.water
    found = []
    for name, length in lengths.items():
        kinds = [case.line_types[each.type] for each in case.lines[name].segments]
        if any(is_solid(kind) and section(kind, water).weight_in_water < 0 for kind in kinds):
            continue
        hung = [item for item in case.attachments if item.line == name]
        weight = line_weight_in_water(case, name, length)
        weight += float(water.gravity) * sum(item.mass - water.density * item.volume for item in hung)
        if weight < 0:
            found.append(
                f"line {name!r} floats as a whole: {weight / 1e3:.4g} kN in water with its attachments; "
                "check mass, `volume` and `submerged_weight` of its types"
            )
    return found


def known_lengths(case: Case) -> dict[str, float]:
    """Lines whose unstretched length is given, not found."""
    return {name: line.length for name, line in case.lines.items() if line.length is not None}
