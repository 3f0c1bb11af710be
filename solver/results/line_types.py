"""What the summary says of line types: mass, weight in water, and what the catalogue gave."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from ..case import Case
from ..case.catalogued import taken_values
from ..case.lines import LineType
from ..case.section import section


def line_types_summary(case: Case) -> dict[str, Any]:
    """Every line type by name, SI: per unit length, weight in water fully wet (docs/summary.md)."""
    return {name: _line_type(case, kind) for name, kind in case.line_types.items()}


def _line_type(case: Case, kind: LineType) -> dict[str, Any]:
    shape = section(kind, case.environment.water)
    out: dict[str, Any] = {
        "diameter": kind.diameter, "drag_diameter": shape.drag_diameter, "mass": kind.mass, "volume": shape.volume,
        "weight_in_water": shape.weight_in_water, "EA": kind.EA,
    }  # fmt: skip
    if kind.breaking_load is not None:
        out["breaking_load"] = kind.breaking_load
    if kind.catalogue_values is not None:
        values = {key: asdict(value) for key, value in taken_values(kind.catalogue_values).items()}
        out["catalogue"] = {"name": kind.catalogue, "values": values}
    return out
