"""A history over time: one response of one seed, the part of it that is on the screen."""

from __future__ import annotations

from typing import Any

from frontend.figures.base import Figure, axis, axis_values, curve, figure, scaled, titled
from frontend.theme import BLUE

TIME = "time after the build-up [s]"
THIN = {"color": BLUE, "width": 1.1}


def history(channel: dict[str, Any], name: str, height: int = 380, span: tuple[float, float] | None = None) -> Figure:
    """Zooming is along time only: the other axis follows what is seen. `span`: the stretch to show at first [s]."""
    values, unit = scaled(channel)
    drawn = curve(axis_values(channel), values, name, BLUE, unit) | {"line": THIN}
    seen_at_first = {"range": list(span)} if span else {"autorange": True, "rangemode": "tozero"}
    return figure(
        [drawn], height, legend=False, xaxis=axis(TIME, **seen_at_first),
        yaxis=axis(titled(name, unit), fixedrange=True), dragmode="zoom", hovermode="closest",
    )  # fmt: skip


def seen(change: dict[str, Any] | None) -> tuple[float, float] | str | None:
    """What a change of the picture's layout shows of time: from and to, `all` of it, or None when it says nothing."""
    change = change or {}
    ends = [change.get(f"xaxis.range[{index}]") for index in (0, 1)]
    if change.get("xaxis.range"):
        ends = list(change["xaxis.range"])
    if all(isinstance(end, int | float) for end in ends):
        low, high = sorted(float(str(end)) for end in ends)
        return low, high
    return "all" if change.get("xaxis.autorange") else None
