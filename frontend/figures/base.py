"""What every picture has in common: fonts, grid, margins, axis titles with units, legend above.

Figures are plain plotly.js JSON (`data`, `layout`): building the same through plotly's Python classes took 0.13 s each.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from frontend.format import shown
from frontend.theme import FAINT, FONT, GRID, INK, PAPER

Figure = dict[str, Any]
FREQUENCY = "ω [rad/s]"
ARC_LENGTH = "arc length from end a [m]"


def titled(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def axis(title: str = "", **more: Any) -> dict[str, Any]:
    """One axis in the house style; `more` goes to plotly as it is."""
    return {
        "title": {"text": title, "standoff": 8},
        "gridcolor": GRID,
        "zerolinecolor": "#c4cad0",
        "linecolor": FAINT,
        "showline": True,
        "ticks": "outside",
        "tickcolor": FAINT,
        "ticklen": 4,
        "tickangle": 0,
        "automargin": True,
        "exponentformat": "power",
        "minexponent": 5,
    } | more


def figure(data: list[dict[str, Any]], height: int = 320, legend: bool = True, **layout: Any) -> Figure:
    """Traces and axes to a whole picture."""
    common = {
        "height": height,
        "margin": {"l": 62, "r": 14, "t": 34, "b": 46},
        "paper_bgcolor": PAPER,
        "plot_bgcolor": PAPER,
        "font": {"family": FONT, "size": 12, "color": INK},
        "showlegend": legend,
        "legend": {"orientation": "h", "x": 0, "xanchor": "left", "y": 1.02, "yanchor": "bottom", "font": {"size": 11}},
        "hovermode": "x unified",
        "hoverlabel": {"namelength": -1},
    }
    return {"data": data, "layout": common | layout}


def curve(x: Any, y: Any, name: str, colour: str, unit: str, dash: str = "solid", **more: Any) -> dict[str, Any]:
    """A line with a readable hover: the value, its unit and its name."""
    return {
        "type": "scatter",
        "mode": "lines",
        "x": np.asarray(x),
        "y": np.asarray(y),
        "name": name,
        "line": {"color": colour, "width": 1.8, "dash": dash},
        "hovertemplate": f"%{{y:.4~g}} {unit}",
    } | more


def note(text: str, **more: Any) -> dict[str, Any]:
    """Words inside a picture."""
    return {"text": text, "showarrow": False, "xanchor": "left", "yanchor": "bottom"} | more


def scaled(channel: dict[str, Any]) -> tuple[np.ndarray, str]:
    """The values in the unit that people read, and that unit."""
    unit, factor = shown(channel["unit"])
    return np.asarray(channel["values"], dtype=float) * factor, unit


def axis_values(channel: dict[str, Any], index: int = 0) -> np.ndarray:
    return np.asarray(channel["axes"][index]["values"], dtype=float)
