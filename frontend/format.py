"""Numbers for people: metres, degrees and kilonewtons, three figures, and times one can say."""

from __future__ import annotations

import math
from datetime import datetime
from typing import Any

DEG = 180.0 / math.pi
DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
ROTATIONS = ("roll", "pitch", "yaw")
MISSING = "–"

# SI unit -> (unit that a person reads, factor)
SHOWN = {
    "N": ("kN", 1e-3),
    "N m": ("kN m", 1e-3),
    "N2 s/rad": ("kN²·s/rad", 1e-6),
    "N/m": ("kN/m", 1e-3),
    "rad": ("deg", DEG),
    "rad/m": ("deg/m", DEG),
    "rad2 s/rad": ("deg²·s/rad", DEG**2),
    "m2 s/rad": ("m²·s/rad", 1.0),
    "1/m": ("1/km", 1e3),
}


def shown(unit: str) -> tuple[str, float]:
    """The unit that a page shows for an SI unit, and the factor to it."""
    return SHOWN.get(unit.replace("^", "").replace("²", "2").replace("·", " "), (unit, 1.0))


def dof_unit(dof: str) -> tuple[str, float]:
    return ("deg", DEG) if dof in ROTATIONS else ("m", 1.0)


def number(value: Any, digits: int = 3) -> str:
    """`digits` significant figures without exponents in the everyday range: 0.0123, 4.57, 1 234."""
    if value is None or not isinstance(value, int | float) or not math.isfinite(value):
        return MISSING
    if value == 0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if size < -4 or size > 6:
        return f"{value:.{digits - 1}e}"
    text = f"{value:,.{max(digits - 1 - size, 0)}f}".replace(",", "\u2009")
    return text.replace("-", "\u2212")


def percent(ratio: Any) -> str:
    """Three figures, two decimals at most: 36.7 %, 4.91 %, 0.66 %, < 0.01 %."""
    if not isinstance(ratio, int | float) or not math.isfinite(ratio):
        return MISSING
    share = 100.0 * ratio
    if abs(share) < 1e-9:
        return "0 %"
    if abs(share) < 0.01:
        return "< 0.01 %"
    return f"{share:.2f} %" if abs(share) < 1 else f"{number(share)} %"


def parse_time(text: str | None) -> datetime | None:
    return datetime.fromisoformat(text.replace("Z", "+00:00")) if text else None


def moment(text: str | None) -> str:
    """2026-03-01 14:05:09 UTC, whatever the fraction of a second."""
    when = parse_time(text)
    return when.strftime("%Y-%m-%d %H:%M:%S UTC") if when else MISSING


def seconds(value: float | None) -> str:
    """A duration as one says it: 0.8 s, 12 s, 3 min 20 s, 2 h 05 min."""
    if value is None:
        return MISSING
    if value < 10:
        return f"{value:.1f} s"
    if value < 60:
        return f"{value:.0f} s"
    minutes, rest = divmod(round(value), 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if minutes else f"{hours} h"


def duration(run: dict[str, Any]) -> str:
    start, end = parse_time(run.get("started_at")), parse_time(run.get("finished_at"))
    return seconds((end - start).total_seconds()) if start and end else MISSING


def analysis_name(name: str) -> str:
    return name.replace("_", " ")
