"""Largest values, one per seed, on Gumbel paper: a straight line is a Gumbel distribution (Gumbel 1958, ch. 5)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from frontend.figures.base import Figure, axis, curve, figure
from frontend.theme import BLUE, INK

EULER = 0.5772156649015329


def gumbel(values: Sequence[float] | np.ndarray) -> tuple[float, float]:
    """Location and scale by moments: scale = √6 s/π, location = mean - 0.5772 scale; s with n - 1."""
    held = np.asarray(values, dtype=float)
    scale = math.sqrt(6.0) / math.pi * float(held.std(ddof=1))
    return float(held.mean()) - EULER * scale, scale


def fractile(location: float, scale: float, probability: float) -> float:
    """The value that one record's largest stays below with this probability."""
    return location - scale * math.log(-math.log(probability))


def paper(values: Sequence[float], name: str, unit: str, height: int = 340) -> Figure:
    """Sorted maxima at p = i/(n + 1) over the reduced variate -ln(-ln p), with the fit; `values` in `unit`."""
    held = np.sort(np.asarray(values, dtype=float))
    p = np.arange(1, len(held) + 1) / (len(held) + 1)
    reduced = -np.log(-np.log(p))
    location, scale = gumbel(held)
    ends = np.array([min(-1.5, reduced[0] - 0.2), max(3.2, reduced[-1] + 0.3)])
    dots = curve(held, reduced, "seeds", BLUE, "") | {"mode": "markers", "marker": {"size": 8, "color": BLUE}}
    fit = curve(location + scale * ends, ends, "Gumbel, by moments", INK, "", "dash")
    hover = f"%{{x:.5~g}} {unit}<extra></extra>"
    shares = (0.1, 0.37, 0.5, 0.75, 0.9, 0.95)
    ticks = [-math.log(-math.log(share)) for share in shares]
    vertical = axis("stays below in a record [%]", tickvals=ticks, ticktext=[f"{100 * share:.0f}" for share in shares])
    data = [dots | {"hovertemplate": hover}, fit | {"hovertemplate": hover}]
    return figure(data, height, xaxis=axis(f"{name} [{unit}]"), yaxis=vertical, hovermode="closest")
