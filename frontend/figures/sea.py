"""The sea as the case says it, before any run: elevation spectra of its wave systems, by the formulas of docs/theory.md."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from frontend.editor.pattern import degrees, metres, quantity
from frontend.editor.text import EditError
from frontend.figures.base import FREQUENCY, Figure, axis, curve, figure, titled
from frontend.theme import BLACK, CYCLE

_TIMES = {"": 1.0, "s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0, "hr": 3600.0}
_FREQUENCIES = {"": 1.0, "rad/s": 1.0, "Hz": 2 * math.pi, "deg/s": math.pi / 180}


def _scaled(value: Any, units: dict[str, float], what: str) -> float:
    number, unit = quantity(value, what)
    if unit not in units:
        raise EditError(f"{what} {value!r} has a unit that is not known here")
    return number * units[unit]


def jonswap(omega: np.ndarray, hs: float, tp: float, gamma: float) -> np.ndarray:
    """S(ω) [m² s/rad] scaled so that its integral over all ω is Hs²/16 (numerically, on a fine grid of its own)."""

    def shape(w: np.ndarray) -> np.ndarray:
        peak = 2 * math.pi / tp
        width = np.where(w <= peak, 0.07, 0.09)
        safe = np.maximum(w, 1e-9)
        raised = np.exp(-((safe / peak - 1) ** 2) / (2 * width**2))
        return np.asarray(np.where(w > 0, safe**-5.0 * np.exp(-1.25 * (peak / safe) ** 4) * gamma**raised, 0.0))

    fine = np.linspace(0.05, 20.0, 20_000) * 2 * math.pi / tp
    tail = shape(fine[-1:])[0] * fine[-1] / 4  # ∫ ω^-5 beyond the grid
    area = float(np.trapezoid(shape(fine), fine)) + tail
    return shape(omega) * hs**2 / 16 / area


def described(sea: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, str]:
    """ω [rad/s], S [m² s/rad] and words of one random system, a tree of the editor. Raises EditError."""
    kind = str(sea.get("spectrum"))
    if kind == "tabulated":
        omega = np.array([_scaled(v, _FREQUENCIES, "frequency") for v in sea.get("frequencies") or []])
        return omega, np.array([float(quantity(v, "density")[0]) for v in sea.get("densities") or []]), "table"
    gamma = float(sea.get("gamma") or 3.3) if kind == "jonswap" else 1.0
    hs = metres(sea.get("hs"), "hs")
    if sea.get("tp") is not None:
        tp = _scaled(sea["tp"], _TIMES, "tp")
    else:
        tp = _scaled(sea.get("tz"), _TIMES, "tz") * math.sqrt((11 + gamma) / (5 + gamma))
    if hs <= 0 or tp <= 0 or gamma < 1:
        raise EditError("Hs and period must be more than zero")
    omega = np.linspace(0.2, 4.0, 381) * 2 * math.pi / tp
    words = f"{kind}, Hs {hs:g} m, Tp {tp:.3g} s" + (f", γ {gamma:g}" if kind == "jonswap" else "")
    return omega, jonswap(omega, hs, tp, gamma), words


def towards(sea: dict[str, Any]) -> float:
    """Direction it goes to [deg]."""
    return degrees(sea.get("direction"), "direction")


def sea_figure(seas: list[dict[str, Any]], height: int = 420) -> Figure:
    """Every wave system, and their sum when there are several random ones; a regular wave is a line at its frequency."""
    data, random = [], []
    for index, sea in enumerate(seas):
        colour = CYCLE[index % len(CYCLE)]
        if sea.get("wave") is not None:
            omega = 2 * math.pi / _scaled(sea.get("period"), _TIMES, "period")
            words = f"regular, H {metres(sea.get('height'), 'height'):g} m, to {towards(sea):g}°"
            made = curve([omega, omega], [0, 1], words, colour, "")
            data.append(made | {"yaxis": "y2", "hovertemplate": f"{words}<extra></extra>"})
            continue
        omega_values, density, words = described(sea)
        random.append((omega_values, density))
        data.append(curve(omega_values, density, f"{words}, to {towards(sea):g}°", colour, "m² s/rad"))
    if len(random) > 1:
        grid = np.unique(np.concatenate([omega for omega, _ in random]))
        whole = sum(np.interp(grid, omega, density, left=0, right=0) for omega, density in random)
        data.append(curve(grid, whole, "together", BLACK, "m² s/rad", "dot"))
    hidden = {"overlaying": "y", "visible": False, "range": [0, 1.05], "fixedrange": True}
    vertical = axis(titled("S", "m² s/rad"), rangemode="tozero")
    return figure(
        data, height, xaxis=axis(FREQUENCY, rangemode="tozero"), yaxis=vertical, yaxis2=hidden, hovermode="closest"
    )
