"""Several runs, or both domains of them, on the same axes: colour tells runs apart, dashes the domains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from frontend.figures.base import FREQUENCY, Figure, axis, axis_values, curve, figure, note, scaled, titled
from frontend.figures.spectra import Band, energetic, split
from frontend.theme import CYCLE

DASH = {"frequency": "solid", "time": "dot"}
STUDY_DASHES = ("solid", "dash", "dot")
LF_WF = {"lf": "low frequency", "wf": "wave frequency"}


@dataclass(frozen=True)
class Curve:
    """A channel and how it is told from the others."""

    name: str
    run: int
    domain: str
    channel: dict[str, Any]

    @property
    def style(self) -> dict[str, Any]:
        return {"colour": CYCLE[self.run % len(CYCLE)], "dash": DASH[self.domain]}


def spectra_of(curves: Sequence[Curve], at: float, height: int = 300) -> Figure:
    """One response of all curves, slow drift and waves on axes of their own. `at` is the border of the bands [rad/s]."""
    data, bands, unit = [], [], ""
    for drawn in curves:
        values, unit = scaled(drawn.channel)
        cut = split(axis_values(drawn.channel), values, at)
        bands.append((drawn, {band.key: band for band in cut}))
    keys = [key for key in ("lf", "wf") if any(key in own for _, own in bands)]
    width, notes = (1.0 if len(keys) == 1 else 0.42), []
    layout: dict[str, Any] = {}
    for column, key in enumerate(keys):
        number = "" if column == 0 else str(column + 1)
        own = [(drawn, band[key]) for drawn, band in bands if key in band]
        data += [_drawn(drawn, band, unit, number, column == 0) for drawn, band in own]
        left = column * (1.0 - width)
        span = _together([energetic(band) for _, band in own])
        layout[f"xaxis{number}"] = axis(
            FREQUENCY, range=span, nticks=5, domain=[left, left + width], anchor=f"y{number}"
        )
        title = titled("S", unit) if column == 0 else ""
        layout[f"yaxis{number}"] = axis(title, rangemode="tozero", nticks=6, anchor=f"x{number}")
        place = {"xref": f"x{number} domain", "yref": f"y{number} domain", "x": 0, "y": 1.02}
        notes.append(note(LF_WF[key], font={"size": 12}, **place))
    legend = {"orientation": "h", "x": 0, "xanchor": "left", "y": 1.14, "yanchor": "bottom", "font": {"size": 11}}
    margin = {"l": 62, "r": 14, "t": 40 + 18 * len(curves), "b": 46}
    made = figure(data, height + 18 * len(curves), annotations=notes, margin=margin, **layout)
    made["layout"]["legend"] = legend
    return made


def _drawn(drawn: Curve, band: Band, unit: str, number: str, shown: bool) -> dict[str, Any]:
    made = curve(band.omega, band.values, drawn.name, **drawn.style, unit=unit)
    return made | {"xaxis": f"x{number}", "yaxis": f"y{number}", "legendgroup": drawn.name, "showlegend": shown}


def _together(spans: list[list[float]]) -> list[float]:
    return [min(low for low, _ in spans), max(high for _, high in spans)]


def along(title: str, curves: Sequence[Curve], height: int = 320) -> Figure:
    """A quantity along one line, of all curves."""
    data, unit = [], ""
    for drawn in curves:
        values, unit = scaled(drawn.channel)
        data.append(curve(axis_values(drawn.channel), values, drawn.name, **drawn.style, unit=unit))
    return figure(
        data, height, xaxis=axis("arc length from end a [m]", rangemode="tozero"),
        yaxis=axis(titled(title, unit), rangemode="tozero"),
    )  # fmt: skip


def study_curves(
    curves: Sequence[tuple[str, Sequence[float], Sequence[float | None]]], x_name: str, y_name: str, height: int = 400
) -> Figure:
    """Results of a study over what it varies, (name, x, y) each; a gap where a run left no number."""
    data = []
    for index, (name, x, y) in enumerate(curves):
        known = np.array([np.nan if value is None else value for value in y], dtype=float)
        made = curve(x, known, name, CYCLE[index % len(CYCLE)], "", STUDY_DASHES[index // len(CYCLE) % 3])
        data.append(made | {"mode": "lines+markers", "marker": {"size": 7}})
    return figure(data, height, legend=len(curves) > 1, xaxis=axis(x_name), yaxis=axis(y_name))
