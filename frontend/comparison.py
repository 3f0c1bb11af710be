"""Runs beside each other: the numbers that both have, and where their cases differ. Plain data, no components."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from frontend.format import DOFS, dof_unit

Summary = Mapping[str, Any]
BANDS = ("wf", "lf")
DOMAINS = {"frequency_domain": "frequency domain", "time_domain": "time domain"}


@dataclass(frozen=True)
class Row:
    """One number of every run, None where a run has none, in the unit that is shown."""

    group: str
    name: str
    unit: str
    values: tuple[float | None, ...]

    @property
    def changes(self) -> tuple[float | None, ...]:
        """Relative to the first run; None where that is missing or next to nothing."""
        first = self.values[0]
        largest = max((abs(value) for value in self.values if value is not None), default=0.0)
        if first is None or abs(first) <= 1e-9 * largest or largest == 0.0:
            return (None,) * len(self.values)
        return tuple(None if value is None else value / first - 1.0 for value in self.values)


def rows(summaries: Sequence[Summary]) -> list[Row]:
    """Every number that at least one run has, by group, in the order of an engineer's questions."""
    columns = [dict(_numbers(summary)) for summary in summaries]
    keys = list(dict.fromkeys(key for column in columns for key in column))
    order = list(dict.fromkeys(group for group, _, _ in keys))
    keys.sort(key=lambda key: order.index(key[0]))
    return [Row(*key, tuple(column.get(key) for column in columns)) for key in keys]


Key = tuple[str, str, str]


def _numbers(summary: Summary) -> Iterator[tuple[Key, float]]:
    for make in (_statics, _modes, _motions, _tensions):
        for key, value in make(summary):
            if isinstance(value, int | float) and math.isfinite(value):
                yield key, float(value)


def _statics(summary: Summary) -> Iterator[tuple[Key, Any]]:
    statics = summary.get("statics") or {}
    for dof, value in zip(DOFS, (statics.get("vessel") or {}).get("position") or [], strict=False):
        unit, factor = dof_unit(dof)
        yield ("Static position", dof, unit), value * factor
    for line, made in (statics.get("lines") or {}).items():
        tension = (made.get("end_b") or {}).get("tension")
        if tension is not None:
            yield ("Static tension at end b", line, "kN"), tension / 1e3


def _modes(summary: Summary) -> Iterator[tuple[Key, Any]]:
    """Modes by name, the second of a name as such: their order may differ from run to run."""
    seen: Counter[str] = Counter()
    for mode in summary.get("modes") or []:
        label = mode.get("label") or "mode"
        seen[label] += 1
        name = label if seen[label] == 1 else f"{label} {seen[label]}"
        yield ("Natural period", name, "s"), mode.get("period")
        if mode.get("damping_lines") is not None:
            yield ("Damping by the lines", name, "%"), 100.0 * mode["damping_lines"]


def _motions(summary: Summary) -> Iterator[tuple[Key, Any]]:
    for domain, said in DOMAINS.items():
        spread = (summary.get(domain) or {}).get("vessel_std") or {}
        for band in BANDS:
            for dof in DOFS:
                value = (spread.get(band) or {}).get(dof)
                if value is not None:
                    unit, factor = dof_unit(dof)
                    yield (f"σ of motion, {said}", f"{dof} {band.upper()}", unit), value * factor
        amplitude = (summary.get(domain) or {}).get("vessel_amplitude") or {}
        for dof in DOFS:
            if amplitude.get(dof) is not None:
                unit, factor = dof_unit(dof)
                yield (f"Amplitude of motion, {said}", dof, unit), amplitude[dof] * factor


def _largest(values: Any) -> float | None:
    return max(values, default=None) if isinstance(values, list) else values


def _with_ends(made: Mapping[str, Any], values: Any) -> float | None:
    """The largest tension of a line with its ends; of an older summary, the largest along the line."""
    if values is not None and made.get("largest"):
        return float(made["largest"]["tension"])
    return _largest(values)


def _tensions(summary: Summary) -> Iterator[tuple[Key, Any]]:
    for domain, said in DOMAINS.items():
        for line, made in ((summary.get(domain) or {}).get("lines") or {}).items():
            for band in BANDS:
                value = _largest((made.get("tension_std") or {}).get(band))
                if value is not None:
                    yield (f"Largest σ of tension, {said}", f"{line} {band.upper()}", "kN"), value / 1e3
            for key, words in _EXTREMES.items():
                value = key(made)
                if value is not None:
                    yield (f"{words}, {said}", line, "kN"), value / 1e3
            if made.get("utilisation") is not None:
                yield (f"Utilisation of the breaking load, {said}", line, "%"), 100.0 * made["utilisation"]


_EXTREMES: dict[Callable[[Mapping[str, Any]], float | None], str] = {
    lambda made: _largest(made.get("tension_amplitude")): "Largest amplitude of tension",
    lambda made: _with_ends(made, made.get("tension_most_probable_max")): "Most probable maximum of tension",
    lambda made: (made.get("end_b_tension") or {}).get("max"): "Largest tension at end b",
    lambda made: (made.get("end_a_tension") or {}).get("max"): "Largest tension at end a",
    lambda made: (made.get("anchor_vertical") or {}).get("max"): "Largest vertical force on the anchor",
}


def differences(cases: Sequence[Mapping[str, Any]]) -> list[tuple[str, tuple[Any, ...]]]:
    """Where the cases differ: the path of each value and what each case has there (None for nothing)."""
    flat = [dict(_flat(case)) for case in cases]
    paths = list(dict.fromkeys(path for one in flat for path in one))
    found = [(path, tuple(one.get(path) for one in flat)) for path in paths]
    return [(path, values) for path, values in found if any(value != values[0] for value in values[1:])]


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Leaves by path; a short list of numbers stays one value."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _flat(inner, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and not all(isinstance(item, int | float) for item in value):
        for index, inner in enumerate(value):
            yield from _flat(inner, f"{path}.{index}")
    else:
        yield path, tuple(value) if isinstance(value, list) else value
