"""What to say of waves whose headings the data do not enclose (V29)."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from .data import HydrodynamicData
from .data.interpolate import NEAR, TURN, outside

Array = np.ndarray


def off_the_headings(
    data: HydrodynamicData, drift: str, directions: Iterable[float], yaw: float = 0.0
) -> tuple[str, ...]:
    """A sentence for each table and wave direction [rad] outside its headings, of a vessel at a static yaw [rad].

    drift : the choice of a case; without one, mean drift and QTF are not looked at.
    """
    tables = [("the wave force", data.headings)]
    if drift.startswith("newman") and data.mean_drift is not None:
        tables.append(("the mean drift", data.drift_headings))
    if drift == "qtf" and data.qtf is not None:
        tables.append(("the QTF", data.qtf.headings))
    return tuple(
        sentence
        for direction in dict.fromkeys(directions)
        for what, headings in tables
        if (sentence := _sentence(data.name, what, headings, direction - yaw, yaw)) is not None
    )


def _sentence(name: str, what: str, headings: Array, heading: float, yaw: float) -> str | None:
    found = outside(headings, heading)
    if found is None:
        return None
    used, distance = found
    turned = f", at a static yaw of {math.degrees(yaw):.3g} deg," if abs(yaw) > 1e-4 else ""
    limit = "" if distance <= NEAR else ", which statics takes and analyses in waves refuse"
    return (
        f"{name}: waves meet the vessel{turned} at {math.degrees(heading % TURN):.4g} deg, outside the headings of {what}; "
        f"that of {math.degrees(used):.4g} deg is used, {math.degrees(distance):.3g} deg away (threshold "
        f"{math.degrees(NEAR):.3g} deg{limit}); compute that heading"
    )
