"""The values of a run that tables of studies show, kept beside its summary when it ends.

A summary has 10 to 200 kB; to read ten thousand of them for one table takes most of a minute. What is kept has the
names that a table's columns have (docs/rest.md), and 1 to 5 kB.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

DOMAINS = ("frequency_domain", "time_domain")
MODES, MODE_PARTS = 8, ("label", "period", "damping_lines")
MOST_CHARACTERS = 20_000
"""More are not kept; a table then reads the summary."""
_EXTREME = re.compile(r"^(max|min)\((.+)\)$")
_PART = r"[^.()]+"
_KEPT = re.compile(
    rf"^(?:(?:{'|'.join(DOMAINS)})\.vessel_std\.{_PART}\.{_PART}"
    rf"|max\((?:{'|'.join(DOMAINS)})\.lines\.{_PART}\.(?:tension_std\.{_PART}|tension_max)\)"
    rf"|modes\.[0-{MODES - 1}]\.(?:{'|'.join(MODE_PARTS)}))$"
)


def is_kept(name: str) -> bool:
    """Whether a run that has figures has the value of this name among them, if it has it at all."""
    return bool(_KEPT.match(name))


def figures_of(summary: Mapping[str, Any]) -> dict[str, Any]:
    """The values by name, in the order of a table's columns."""
    names = [*usual(summary), *(f"modes.{k}.{part}" for k in range(MODES) for part in MODE_PARTS)]
    found = {name: plain(taken(summary, name)) for name in names if is_kept(name)}
    return {name: value for name, value in found.items() if value is not None}


def figures_text(summary: Mapping[str, Any]) -> str | None:
    """As JSON; None where there are too many."""
    text = json.dumps(figures_of(summary))
    return text if len(text) <= MOST_CHARACTERS else None


def usual(summary: Mapping[str, Any]) -> list[str]:
    """Names of a table's columns where none are asked for: standard deviations of the vessel and largest tensions."""
    names: list[str] = []
    for domain in DOMAINS:
        found = summary.get(domain) or {}
        for band, values in (found.get("vessel_std") or {}).items():
            names += [f"{domain}.vessel_std.{band}.{dof}" for dof in values]
        for line, values in (found.get("lines") or {}).items():
            names += [f"max({domain}.lines.{line}.tension_std.{band})" for band in values.get("tension_std") or {}]
            if "tension_max" in values:
                names.append(f"max({domain}.lines.{line}.tension_max)")
    return names


def parsed(name: str) -> tuple[list[str], Callable[[list[Any]], Any] | None]:
    """The path in a name, and which extreme of what is there is meant."""
    extreme = _EXTREME.match(name)
    path = (extreme.group(2) if extreme else name).split(".")
    return path, {"max": max, "min": min}[extreme.group(1)] if extreme else None


def taken(summary: Any, name: str) -> Any:
    """What is at a dotted path, or the extreme of the numbers there; None where there is nothing."""
    path, pick = parsed(name)
    value = _at(summary, path)
    if pick is None:
        return value
    numbers = list(_numbers(value))
    return pick(numbers) if numbers else None


def plain(value: Any) -> Any:
    """A single value; what is not one is text."""
    return value if value is None or isinstance(value, bool | int | float | str) else json.dumps(value)


def _at(value: Any, path: Sequence[str]) -> Any:
    for part in path:
        if isinstance(value, Mapping):
            value = value.get(part)
        elif isinstance(value, list) and part.isascii() and part.isdigit() and int(part) < len(value):
            value = value[int(part)]
        else:
            return None
    return value


def _numbers(value: Any) -> Iterator[float]:
    if isinstance(value, list):
        for each in value:
            yield from _numbers(each)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield value
