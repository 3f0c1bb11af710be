"""Response amplitude operators: amplitude above, phase below, on one frequency axis."""

from __future__ import annotations

from typing import Any

from frontend.figures.base import FREQUENCY, Figure, axis, axis_values, curve, figure, scaled, titled
from frontend.theme import BLUE, VERMILION

TURN = [-180, -90, 0, 90, 180]


def rao(amplitude: dict[str, Any], phase: dict[str, Any] | None, height: int = 340) -> Figure:
    values, unit = scaled(amplitude)
    data = [curve(axis_values(amplitude), values, "amplitude", BLUE, unit)]
    vertical = axis(titled("amplitude", unit), rangemode="tozero", domain=[0.4, 1.0] if phase else [0.0, 1.0])
    if not phase:
        return figure(data, height, legend=False, xaxis=axis(FREQUENCY), yaxis=vertical)
    turned, angle = scaled(phase)
    data.append(curve(axis_values(phase), turned, "phase", VERMILION, angle) | {"yaxis": "y2"})
    below = axis(titled("phase", angle), range=[-190, 190], tickvals=TURN, domain=[0.0, 0.32])
    return figure(
        data, height, legend=False, xaxis=axis(FREQUENCY, anchor="y2"), yaxis=vertical, yaxis2=below
    )  # fmt: skip
