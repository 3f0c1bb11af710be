"""Catalogue of line types: mass, volume, stiffness, strength and coefficients as functions of the nominal diameter.

The numbers are data (the YAML files beside this module), each with its source and whether it was read there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import yaml

UNITS = {
    "mass": "kg/m", "volume": "m3/m", "breaking_load": "N", "EA": "N", "drag.normal": "", "drag.tangential": "",
    "added_mass.normal": "", "added_mass.tangential": "", "dynamic_EA.a": "N", "dynamic_EA.b": "",
}  # fmt: skip
"""SI unit of every value an entry may have."""
STIFFNESSES = ("e301", "orcaflex")
_SI = {"N": 1.0, "kN": 1e3, "kg/m": 1.0}
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_SIGNS = {0: "", 1: " d", 2: " d²", 3: " d³"}


@dataclass(frozen=True)
class Value:
    """One number of an entry at a diameter, SI, with its formula and where it is from."""

    value: float
    unit: str
    formula: str
    source: str
    status: str


@dataclass(frozen=True)
class Entry:
    """One kind of line. diameter : the range [m] in which its values hold; stiffnesses : choices of EA, the default first."""

    name: str
    title: str
    diameter: tuple[float, float]
    stiffnesses: tuple[str, ...]
    laws: dict[str, Any]
    sources: dict[str, str]

    def at(self, diameter: float, stiffness: str | None = None) -> dict[str, Value]:
        """Every value at a diameter [m], by name as in UNITS. Raises ValueError outside the range, or for another choice."""
        self.check(diameter)
        chosen = self.choice(stiffness)
        found: dict[str, Value] = {}
        for key, law in _flat(self.laws, chosen):
            known = {name: value.value for name, value in found.items()}
            source = self.sources[law["source"]]
            number = float(f"{_evaluate(law, diameter, known):.12g}")
            found[key] = Value(number, UNITS[key], _formula(law), source, law["status"])
        return found

    def check(self, diameter: float) -> None:
        low, high = self.diameter
        if not low * (1 - 1e-9) <= diameter <= high * (1 + 1e-9):
            raise ValueError(
                f"{diameter:g} m is outside the range of {self.name}; allowed: {1e3 * low:g} to {1e3 * high:g} mm; "
                "for another size give mass, EA and the others instead of `catalogue`"
            )

    def choice(self, stiffness: str | None) -> str | None:
        """The choice of EA in use. Raises ValueError for one that the entry has not."""
        if stiffness is None:
            return self.stiffnesses[0] if self.stiffnesses else None
        if stiffness not in self.stiffnesses:
            if not self.stiffnesses:
                raise ValueError(f"{self.name} has one EA only; leave `stiffness` out")
            raise ValueError(f"no stiffness {stiffness!r} in the catalogue; allowed: {' or '.join(self.stiffnesses)}")
        return stiffness


@cache
def entries() -> dict[str, Entry]:
    """All entries by name."""
    found: dict[str, Entry] = {}
    for path in sorted(Path(__file__).parent.glob("*.yaml")):
        data = yaml.load(path.read_text(encoding="utf-8"), Loader=_LOADER)
        for name, raw in data["entries"].items():
            laws = dict(raw)
            low, high = laws.pop("diameter")
            choices = () if "source" in laws["EA"] else tuple(choice for choice in STIFFNESSES if choice in laws["EA"])
            found[name] = Entry(name, laws.pop("title"), (low, high), choices, laws, data["sources"])
    return found


def entry(name: str) -> Entry:
    """The entry of a name. Raises ValueError with the known names."""
    if name not in entries():
        raise ValueError(f"there is no {name!r} in the catalogue; known: {', '.join(entries())}")
    return entries()[name]


def line_type_values(name: str, diameter: float, stiffness: str | None = None) -> dict[str, Any]:
    """What an entry gives a line type at a nominal diameter [m], SI: mass, volume, EA, breaking_load, drag, added_mass."""
    out: dict[str, Any] = {}
    for key, value in entry(name).at(diameter, stiffness).items():
        group, _, part = key.partition(".")
        if group == "dynamic_EA":
            continue
        if part:
            out.setdefault(group, {})[part] = value.value
        else:
            out[group] = value.value
    return out


def _flat(laws: dict[str, Any], stiffness: str | None) -> Iterator[tuple[str, Any]]:
    """Laws by name as in UNITS and in its order: what others are made `of` comes first."""
    for key in UNITS:
        group, _, part = key.partition(".")
        law = laws.get(group)
        if law is not None and part:
            law = law.get(part)
        elif law is not None and "source" not in law:
            law = law[stiffness]
        if law is not None:
            yield key, law


def _evaluate(law: dict[str, Any], diameter: float, known: dict[str, float]) -> float:
    if "value" in law:
        return float(law["value"])
    if "section" in law:
        return 0.25 * math.pi * (law["section"] * diameter) ** 2
    if "of" in law:
        return float(law.get("factor", 1.0) * known[law["of"]] / law.get("density", 1.0))
    d = diameter * (1e3 if law["d"] == "mm" else 1.0)
    total = sum(coefficient * d**power for power, coefficient in law["powers"].items())
    bars = 0.5 * math.pi * diameter**2 if "times" in law else 1.0
    return float(law.get("factor", 1.0) * total * bars * _SI[law["unit"]])


def _formula(law: dict[str, Any]) -> str:
    """The law as an engineer would write it; empty for a constant."""
    if "value" in law:
        return ""
    if "section" in law:
        return f"π/4 ({law['section']:g} d)²"
    if "of" in law:
        divided = f" / {law['density']:g} kg/m3" if "density" in law else ""
        return (f"{law['factor']:g} × " if "factor" in law else "") + law["of"].replace("_", " ") + divided
    terms = [f"{coefficient:g}{_SIGNS[power]}" for power, coefficient in law["powers"].items()]
    text = " + ".join(terms).replace("+ -", "- ")
    text = f"{law['factor']:g} ({text})" if "factor" in law else text
    if "times" in law:
        text = f"E π d²/2, E = {text} N/m2"
        return f"{text}, d in {law['d']}" if len(terms) > 1 else text
    return f"{text} {law['unit']}, d in {law['d']}"
