"""Quantities along a line, from end a (anchor, bottom) to end b (top, fairlead)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from frontend.figures.base import ARC_LENGTH, Figure, axis, axis_values, curve, figure, scaled, titled
from frontend.theme import BAND_COLOUR, BAND_NAME, CYCLE

DASHES = ("solid", "dash", "dot", "dashdot", "longdash")
BAND_DASH = {"wf": "solid", "lf": "dash", "total": "dot"}


def bands_along(title: str, bands: Mapping[str, dict[str, Any]], height: int = 320) -> Figure:
    """One line, its bands `wf`, `lf`, `total` together."""
    data, unit = [], ""
    for key, channel in bands.items():
        values, unit = scaled(channel)
        data.append(curve(axis_values(channel), values, BAND_NAME[key], BAND_COLOUR[key], unit, BAND_DASH[key]))
    vertical = axis(titled(title, unit), rangemode="tozero")
    return figure(data, height, xaxis=axis(ARC_LENGTH, rangemode="tozero"), yaxis=vertical)


def domains_along(title: str, curves: Mapping[str, dict[str, Any]], height: int = 320) -> Figure:
    """One quantity of one line from several computations, by the words of the legend."""
    made = lines_along(title, curves, zero=True, height=height)
    return made | {"layout": made["layout"] | {"showlegend": True}}


def lines_along(title: str, lines: Mapping[str, dict[str, Any]], zero: bool = False, height: int = 320) -> Figure:
    """One quantity, several lines together: colour and dash tell them apart."""
    data, unit = [], ""
    for index, (name, channel) in enumerate(lines.items()):
        values, unit = scaled(channel)
        colour, dash = CYCLE[index % len(CYCLE)], DASHES[index % len(DASHES)]
        data.append(curve(axis_values(channel), values, name, colour, unit, dash))
    vertical = axis(titled(title, unit), rangemode="tozero" if zero else "normal")
    horizontal = axis(ARC_LENGTH, rangemode="tozero")
    return figure(data, height, legend=len(lines) > 1, xaxis=horizontal, yaxis=vertical)
