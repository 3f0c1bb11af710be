"""Places in a case that a study can vary: JSON pointers, and the values a person writes for them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

MOST = 2000  # runs of a study made on the page; larger ones go over REST
_RANGE = re.compile(r"^\s*(\S+)\s*(?:\.\.|to)\s*(\S+)\s+in\s+(\d+)\s*(?:steps)?\s*$")


def places(case: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Every single value of a case by its pointer (RFC 6901), names and versions left out."""
    return [(pointer, value) for pointer, value in _leaves(case) if pointer not in ("/slowdrift", "/name")]


def _leaves(value: Any, pointer: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(inner, f"{pointer}/{_escaped(str(key))}")
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _leaves(inner, f"{pointer}/{index}")
    elif isinstance(value, int | float | str) and not isinstance(value, bool):
        yield pointer, value


def _escaped(key: str) -> str:
    return key.replace("~", "~0").replace("/", "~1")


def said(pointer: str) -> str:
    """A pointer as people read it: line types › wire › drag › normal."""
    parts = [part.replace("~1", "/").replace("~0", "~") for part in pointer.split("/")[1:]]
    return " › ".join(part.replace("_", " ") for part in parts)


def values(text: str) -> list[float | str]:
    """Values with commas (``8, 10, 12 m``: the unit of the last holds for bare numbers before it), or ``8..16 in 5``.

    Raises ValueError with what is wrong.
    """
    found = _RANGE.match(text)
    if found:
        low, high, count = float(found[1]), float(found[2]), int(found[3])
        if not 2 <= count <= 200:
            raise ValueError(f"{count} steps; allowed: 2 to 200")
        return [low + (high - low) * k / (count - 1) for k in range(count)]
    parts = [part.strip() for part in text.split(",") if part.strip()]
    if not parts:
        raise ValueError("no values; write them with commas, or as 8..16 in 5")
    unit = parts[-1].partition(" ")[2].strip()
    return [_value(part, unit) for part in parts]


def _value(part: str, unit: str) -> float | str:
    try:
        number = float(part)
    except ValueError:
        return part
    return f"{part} {unit}" if unit else number


def magnitude(value: Any) -> float | None:
    """The number a cell of the table stands for, its unit aside; None where it is none."""
    if isinstance(value, bool) or value is None:
        return None
    if isinstance(value, int | float):
        return float(value)
    try:
        return float(str(value).split()[0])
    except (ValueError, IndexError):
        return None
