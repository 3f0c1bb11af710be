"""The catalogue of line types as the command line and REST show it."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from ..catalogue import entries, entry
from ..outcome import CaseError, FieldError
from .units import G_STANDARD, parse


def list_entries() -> list[dict[str, Any]]:
    """All entries: name, title, range of diameters [m], choices of EA, and the values that are not verified."""
    return [_head(name) for name in entries()]


def _head(name: str) -> dict[str, Any]:
    one = entry(name)
    middle = one.at(0.5 * sum(one.diameter))
    return {
        "name": one.name, "title": one.title, "diameter_range": list(one.diameter), "stiffnesses": list(one.stiffnesses),
        "unverified": [key for key, value in middle.items() if value.status != "verified"],
    }  # fmt: skip


def describe(
    name: str, diameter: object = None, stiffness: str | None = None, density: object = 1025.0
) -> dict[str, Any]:
    """An entry with its values at a diameter, and its weight in water [N/m].

    diameter, density : numbers in SI or texts with a unit. Without a diameter: as in the list. Raises CaseError, its
    location the argument at fault.
    """
    _at("name", entry, name)
    if diameter is None:
        return _head(name)
    size = _at("diameter", parse, diameter, "length")
    _at("diameter", entry(name).check, size)
    chosen = _at("stiffness", entry(name).choice, stiffness)
    water = _at("density", _density, density)
    values = entry(name).at(size, chosen)
    return {
        **_head(name), "diameter": size, "stiffness": chosen, "water_density": water,
        "weight_in_water": G_STANDARD * (values["mass"].value - water * values["volume"].value),
        "values": {key: asdict(value) for key, value in values.items()},
    }  # fmt: skip


def _density(value: object) -> float:
    density = parse(value, "density")
    if density <= 0:
        raise ValueError(f"{density:g} kg/m3 is out of range; allowed: > 0")
    return density


def _at(argument: str, function: Any, *values: Any) -> Any:
    try:
        return function(*values)
    except ValueError as error:
        raise CaseError([FieldError((argument,), str(error), str(values[0])[:80])]) from None
