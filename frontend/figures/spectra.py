"""Response spectra: the low-frequency peak and the wave band, each readable though one is far narrower and taller."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frontend.figures.base import FREQUENCY, Figure, axis, axis_values, curve, figure, note, scaled, titled
from frontend.format import number
from frontend.theme import BAND_COLOUR, BAND_NAME, INK

PANELS, LOG = "panels", "log"


@dataclass(frozen=True)
class Band:
    """One band of a spectrum in shown units, with the standard deviation of the response in it."""

    key: str
    omega: np.ndarray
    values: np.ndarray
    sigma: float | None = None


def border(case: dict[str, Any] | None, omega: np.ndarray) -> float:
    """Border of the bands: as the case says, else where the strips get wider, else 0.2 rad/s."""
    analysis = ((case or {}).get("analyses") or {}).get("frequency_domain") or {}
    for band, key in (("low", "to"), ("wave", "from"), ("wave", "from_"), ("wave", "start")):
        value = (analysis.get(band) or {}).get(key) if isinstance(analysis.get(band), dict) else None
        if isinstance(value, int | float) and value > 0:
            return float(value)
    steps = np.diff(omega)
    if len(steps) > 2 and steps.max() > 1.5 * steps.min():
        return float(omega[int(np.argmax(steps > 1.5 * steps[0]))])
    return 0.2


def split(omega: np.ndarray, values: np.ndarray, at: float) -> list[Band]:
    """The bands that hold any strip, low frequency first. A frequency at the border belongs to the waves, unless it is
    there twice."""
    again = np.flatnonzero(np.diff(omega) <= 0)
    first = int(again[0]) + 1 if len(again) else int(np.searchsorted(omega, at * (1 - 1e-9)))
    bands = [Band("lf", omega[:first], values[:first]), Band("wf", omega[first:], values[first:])]
    return [band for band in bands if len(band.omega)]


def energetic(band: Band, share: float = 2e-3) -> list[float]:
    """The part of the frequency axis in which there is something to see."""
    peak = float(band.values.max(initial=0.0))
    if peak <= 0:
        return [float(band.omega[0]), float(band.omega[-1])]
    seen = band.omega[band.values > share * peak]
    margin = 0.06 * float(seen[-1] - seen[0]) + 1e-3
    start = 0.0 if band.key == "lf" else max(float(band.omega[0]), float(seen[0]) - margin)
    return [start, min(float(band.omega[-1]), float(seen[-1]) + margin)]


def spectrum(
    channel: dict[str, Any],
    at: float,
    response: tuple[str, str],
    sigmas: Mapping[str, float | None],
    scale: str = PANELS,
    height: int = 290,
    beside: tuple[str, dict[str, Any]] | None = None,
) -> Figure:
    """One response. `response` is its name and the unit of its standard deviations, `sigmas` those by band, as the
    summary has them: the solver weighs its strips itself. `beside` is the same response from the time domain, with the
    words of its legend."""
    values, unit = scaled(channel)
    bands = [replace(b, sigma=sigmas.get(b.key)) for b in split(axis_values(channel), values, at)]
    draw = _one_axis if scale == LOG else _panels
    made = draw(bands, response[0], unit, response[1], height)
    return _overlaid(made, bands, beside, scale) if beside else made


def _overlaid(made: Figure, bands: list[Band], beside: tuple[str, dict[str, Any]], scale: str) -> Figure:
    """The time domain's curve in every band's panel, and a legend that tells the domains apart."""
    name, channel = beside
    values, unit = scaled(channel)
    omega = axis_values(channel)
    drawn = [trace | {"showlegend": scale == LOG or not index} for index, trace in enumerate(made["data"])]
    if scale != LOG:
        drawn = [trace | {"name": "frequency domain", "legendgroup": "frequency"} for trace in drawn]
    for index, (band, trace) in enumerate(zip(bands, made["data"], strict=True)):
        inside = (omega >= band.omega[0]) & (omega <= band.omega[-1])
        seen = values[inside]
        places = {key: trace[key] for key in ("xaxis", "yaxis") if key in trace}
        other = curve(omega[inside], np.where(seen > 0, seen, np.nan) if scale == LOG else seen, name, INK, unit)
        thin = {"line": {"color": INK, "width": 1.1}, "legendgroup": "time", "showlegend": index == 0}
        drawn.append(other | thin | places)
    legend = {"y": 1.13 if scale != LOG else 1.02}
    layout = made["layout"]
    margin = layout["margin"] | {"t": 62 if scale != LOG else 48}
    changed = {"showlegend": True, "legend": layout["legend"] | legend, "margin": margin}
    return {"data": drawn, "layout": layout | changed | {"height": layout["height"] + 28}}


def _said(band: Band, unit: str) -> str:
    return band.key.upper() if band.sigma is None else f"{band.key.upper()}  σ = {number(band.sigma)} {unit}"


def _panels(bands: list[Band], name: str, unit: str, response_unit: str, height: int) -> Figure:
    """Side by side, each band on axes of its own."""
    data, layout, notes = [], {}, []
    width = 1.0 if len(bands) == 1 else 0.42
    for column, band in enumerate(bands):
        key, colour = "" if column == 0 else str(column + 1), BAND_COLOUR[band.key]
        left = column * (1.0 - width)
        drawn = curve(band.omega, band.values, f"{name}, {BAND_NAME[band.key]}", colour, unit)
        data.append(drawn | {"xaxis": f"x{key}", "yaxis": f"y{key}", "fill": "tozeroy", "fillcolor": _faint(colour)})
        layout[f"xaxis{key}"] = axis(
            FREQUENCY, range=energetic(band), nticks=5, domain=[left, left + width], anchor=f"y{key}"
        )
        title = titled("S", unit) if column == 0 else ""
        layout[f"yaxis{key}"] = axis(title, rangemode="tozero", nticks=6, anchor=f"x{key}")
        place = {"xref": f"x{key} domain", "yref": f"y{key} domain", "x": 0, "y": 1.02}
        notes.append(note(_said(band, response_unit), font={"size": 12, "color": colour}, **place))
    return figure(data, height, legend=False, annotations=notes, **layout)


def _one_axis(bands: list[Band], name: str, unit: str, response_unit: str, height: int) -> Figure:
    """Both bands on one logarithmic axis, six decades below the highest value."""
    top = max((float(band.values.max(initial=0.0)) for band in bands), default=0.0) or 1.0
    data = []
    for band in bands:
        seen = [float(v) if v > 1e-12 * top else None for v in band.values]
        data.append(curve(band.omega, seen, _said(band, response_unit), BAND_COLOUR[band.key], unit) | {"y": seen})
    decades = [float(np.log10(top)) - 6, float(np.log10(top)) + 0.3]
    vertical = axis(titled("S", unit), type="log", dtick=1, range=decades)
    return figure(data, height, xaxis=axis(FREQUENCY, rangemode="tozero"), yaxis=vertical, meta={"name": name})


def _faint(colour: str) -> str:
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},0.14)"
