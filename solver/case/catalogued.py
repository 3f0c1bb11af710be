"""A line type taken from the catalogue: what is given by hand stands, the catalogue fills in the rest and is recorded.

The record (`catalogue_values`) travels with the stored case, so that a later catalogue changes no stored case; a record
made for another entry, diameter or stiffness is made anew (docs/decisions/0055-catalogue.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, Field

from ..catalogue import Value, entries, entry, line_type_values
from .quantities import Coefficient, LineMass, LineVolume, Part, PositiveForce, PositiveLength
from .units import parse

if TYPE_CHECKING:
    from .case import Case

IN_PLACE = {"mass": 1.0, "EA": 1.0}
"""Stand-ins where the entry or the diameter is wrong, so that only their own fault is reported."""


class PartlyGiven(Part):
    """Coefficients of which the catalogue gave those that are here."""

    normal: Coefficient | None = None
    """Across the line."""
    tangential: Coefficient | None = None
    """Along the line."""


class CatalogueValues(Part):
    """What the catalogue gave a line type when the case was read; written by the program, not by hand."""

    catalogue: str
    """The entry they are of."""
    diameter: PositiveLength
    """The nominal diameter they are for."""
    stiffness: str | None = None
    """The choice of EA they are for."""
    mass: LineMass | None = None
    """Dry mass per unit length."""
    EA: PositiveForce | None = None
    """Axial stiffness."""
    volume: LineVolume | None = None
    """Displaced volume per unit length."""
    breaking_load: PositiveForce | None = None
    """Minimum breaking load."""
    drag: PartlyGiven | None = None
    """Drag coefficients."""
    added_mass: PartlyGiven | None = None
    """Added mass coefficients."""


CatalogueName = Annotated[
    str, AfterValidator(lambda name: entry(name).name), Field(json_schema_extra={"enum": sorted(entries())})
]


def unless_catalogue(schema: dict[str, Any]) -> None:
    """JSON Schema: mass and EA are needed only where no catalogue gives them."""
    schema["required"] = ["diameter"]
    schema["anyOf"] = [{"required": ["catalogue"]}, {"required": ["mass", "EA"]}]
    for key in ("mass", "EA"):
        schema["properties"][key]["x-required-unless"] = "catalogue"


def fill_in(data: Any) -> Any:
    """The fields of a line type with those of its catalogue entry; unchanged where it names none."""
    if not isinstance(data, dict) or data.get("catalogue") is None:
        return data
    given = {key: value for key, value in data.items() if value is not None and key != "catalogue_values"}
    name, stiffness = data["catalogue"], data.get("stiffness")
    try:
        diameter = parse(data.get("diameter"), "length")
        now = line_type_values(name, diameter, stiffness)
    except (ValueError, TypeError):
        return IN_PLACE | given  # the validators of catalogue, stiffness and diameter say what is wrong
    now = _filled(_recorded(data.get("catalogue_values"), name, diameter, stiffness), now)[0]
    if "submerged_weight" in given:
        now.pop("volume", None)
    whole, taken = _filled(given, now)
    return whole | {"catalogue_values": {"catalogue": name, "diameter": diameter, "stiffness": stiffness, **taken}}


def _recorded(record: Any, name: str, diameter: float, stiffness: str | None) -> dict[str, Any]:
    """The values of a record, if it is of this entry, diameter and stiffness."""
    if not isinstance(record, dict) or record.get("catalogue") != name or record.get("stiffness") != stiffness:
        return {}
    try:
        if parse(record.get("diameter"), "length") != diameter:
            return {}
    except ValueError:
        return {}
    return {key: value for key, value in record.items() if key not in ("catalogue", "diameter", "stiffness")}


def _filled(given: dict[str, Any], values: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Both together, what is given first, and what was taken from `values`."""
    whole, taken = dict(given), {}
    for key, value in values.items():
        if key not in whole:
            whole[key] = taken[key] = value
        elif isinstance(value, dict) and isinstance(whole[key], dict):
            whole[key], part = _filled(whole[key], value)
            if part:
                taken[key] = part
    return whole, taken


def without(written: dict[str, Any], taken: CatalogueValues | None) -> dict[str, Any]:
    """A line type as written out, without the values that stand in its record."""
    if taken is None:
        return written
    left = dict(written)
    for key in ("mass", "EA", "volume", "breaking_load"):
        if getattr(taken, key) is not None:
            left.pop(key, None)
    for key in ("drag", "added_mass"):
        part = getattr(taken, key)
        if part is not None:
            left[key] = {name: value for name, value in left[key].items() if getattr(part, name) is None}
    return left


def taken_values(taken: CatalogueValues) -> dict[str, Value]:
    """What a record holds, by name as in the catalogue (`mass`, `drag.normal`), with formula, source and status.

    The status of a number that this version's catalogue has otherwise is `stored`.
    """
    now = entry(taken.catalogue).at(taken.diameter, taken.stiffness)
    found = {}
    for key, value in now.items():
        group, _, part = key.partition(".")
        number = getattr(taken, group, None)
        if number is not None and part:
            number = getattr(number, part)
        if number is not None:
            same = abs(number - value.value) <= 1e-9 * abs(value.value)
            found[key] = (
                value if same else Value(number, value.unit, "", "the catalogue of an earlier version", "stored")
            )
    return found


def catalogue_warnings(case: Case) -> Iterator[str]:
    """Line types whose catalogue values are not verified, or are other ones than this version's."""
    for name, kind in case.line_types.items():
        if kind.catalogue_values is None:
            continue
        for key, value in taken_values(kind.catalogue_values).items():
            if value.status == "unverified":
                yield (
                    f"line type {name!r}: {key} of {kind.catalogue} is unverified ({value.source}): {value.value:g} "
                    f"{value.unit}; check it, or give {key.partition('.')[0]} yourself"
                )
            elif value.status == "stored":
                yield (
                    f"line type {name!r}: {key} is {value.value:g} {value.unit} as stored with the case, the catalogue has "
                    "another value now; remove `catalogue_values` to take that one"
                )
