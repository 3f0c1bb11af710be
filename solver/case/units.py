"""Units at the door: a quantity with a suffix becomes a plain SI number, and back.

Inside the solver there are no units: SI and radians everywhere (docs/theory.md, Conventions). A bare number is SI,
except for an angle, where a bare number is refused because degrees and radians are both habits of the field.
"""

from __future__ import annotations

import math
import re

G_STANDARD = 9.80665
FOOT = 0.3048
POUND = 0.45359237

#: dimension -> (SI unit, {suffix: factor to SI})
UNITS: dict[str, tuple[str, dict[str, float]]] = {
    "length": ("m", {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "ft": FOOT, "in": FOOT / 12}),
    "force": (
        "N",
        {
            "N": 1.0,
            "kN": 1e3,
            "MN": 1e6,
            "GN": 1e9,
            "tf": 1e3 * G_STANDARD,
            "lbf": POUND * G_STANDARD,
            "kip": 1e3 * POUND * G_STANDARD,
        },
    ),
    "moment": ("N m", {"N m": 1.0, "kN m": 1e3, "MN m": 1e6, "GN m": 1e9}),
    "bending": ("N m2", {"N m2": 1.0, "kN m2": 1e3, "MN m2": 1e6, "GN m2": 1e9}),
    "mass": ("kg", {"kg": 1.0, "t": 1e3, "te": 1e3, "lb": POUND}),
    "line_mass": ("kg/m", {"kg/m": 1.0, "t/m": 1e3, "lb/ft": POUND / FOOT}),
    "inertia": ("kg m2", {"kg m2": 1.0, "t m2": 1e3}),
    "density": ("kg/m3", {"kg/m3": 1.0, "t/m3": 1e3}),
    "time": ("s", {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0, "hr": 3600.0}),
    "speed": ("m/s", {"m/s": 1.0, "cm/s": 1e-2, "km/h": 1 / 3.6, "kn": 1852 / 3600, "knot": 1852 / 3600, "ft/s": FOOT}),
    "acceleration": ("m/s2", {"m/s2": 1.0}),
    "angle": ("rad", {"rad": 1.0, "deg": math.pi / 180, "°": math.pi / 180}),
    "angular_frequency": ("rad/s", {"rad/s": 1.0, "Hz": 2 * math.pi, "deg/s": math.pi / 180}),
    "stiffness": ("N/m", {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6}),
    "soil": ("N/m3", {"N/m3": 1.0, "kN/m3": 1e3, "MN/m3": 1e6}),
    "line_damping": ("N s/m", {"N s/m": 1.0, "kN s/m": 1e3, "MN s/m": 1e6}),
    "area": ("m2", {"m2": 1.0, "ft2": FOOT**2}),
    "volume": ("m3", {"m3": 1.0, "L": 1e-3}),
    "line_volume": ("m3/m", {"m3/m": 1.0, "L/m": 1e-3}),
    "line_weight": (
        "N/m",
        {"N/m": 1.0, "kN/m": 1e3, "kgf/m": G_STANDARD, "lbf/ft": POUND * G_STANDARD / FOOT},
    ),
    "area_moment": ("m4", {"m4": 1.0}),
    "spectral": ("m2 s/rad", {"m2 s/rad": 1.0}),
}

_NUMBER = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")


def _suffix(text: str) -> str:
    """Spellings of one unit brought to one: `kN/m³`, `kN/m^3`, `kN·m**2`, `kN*m` → `kN/m3`, `kN m2`, `kN m`."""
    text = text.replace("²", "2").replace("³", "3").replace("⁴", "4").replace("**", "").replace("^", "")
    return re.sub(r"\s*[·*.]\s*|\s+", " ", text).replace(" /", "/").replace("/ ", "/")


def parse(value: object, dimension: str) -> float:
    """The SI value of a number or of a text such as ``"4370 kN"``.

    Raises ValueError with the value and the accepted units in the sentence.
    """
    _, table = UNITS[dimension]
    allowed = ", ".join(table)
    if isinstance(value, bool) or value is None:
        raise ValueError(f"must be a number or a text with a unit ({allowed})")
    if isinstance(value, int | float):
        if dimension == "angle":
            shown = str(value)[:24]
            raise ValueError(f"{shown} is a bare number; an angle needs its unit: '{shown} deg' or '{shown} rad'")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    elif isinstance(value, str):
        number = _parse_text(value, dimension, table, allowed)
    else:
        raise ValueError(f"must be a number or a text with a unit ({allowed})")
    if not math.isfinite(number):
        raise ValueError(f"{str(value)[:40]} is not a finite number")
    return number


def _parse_text(value: str, dimension: str, table: dict[str, float], allowed: str) -> float:
    match = _NUMBER.match(value[:80])
    if match is None or len(value) > 80:
        raise ValueError(f"{value[:80]!r} is not a number with a unit ({allowed})")
    suffix = _suffix(match.group(2))
    if suffix == "":
        if dimension == "angle":
            raise ValueError(f"{value!r} is a bare number; an angle needs its unit: '{value} deg' or '{value} rad'")
        return float(match.group(1))
    if suffix not in table:
        raise ValueError(f"unit {match.group(2)!r} is not known here; use one of: {allowed}")
    if table[suffix] == 1.0:
        return float(match.group(1))
    return float(f"{float(match.group(1)) * table[suffix]:.15g}")  # 1570 cm is 15.7 m to the last bit
