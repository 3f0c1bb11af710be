"""Spectra of the sea surface, one-sided in rad/s, and what follows from their moments (W6)-(W9).

A newcomer adds one function (omega, sea) -> S [m2 s/rad] and its name in SPECTRA; the tests then hold it to S >= 0 and
to the area Hs²/16. `sea` is one wave system of case.environment.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from ..case.environment import Jonswap, PiersonMoskowitz, Tabulated

Array = np.ndarray
Sea = Jonswap | PiersonMoskowitz | Tabulated

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_PANELS = np.array(
    [0.0, 0.3, 0.45, 0.6, 0.7, 0.8, 0.88, 0.94, 1.0, 1.06, 1.12, 1.2, 1.3, 1.45, 1.7, 2.0, 3.0, 5.0, 10.0]
)


def _shape(x: Array, gamma: float) -> Array:
    """x^-5 exp(-5/4 x^-4) gamma^b with x = omega/omega_p (W6); 0 at x = 0."""
    x = np.maximum(x, 0.1)  # e^{-12500}: zero in floating point
    inverse = 1.0 / (x * x)
    base = inverse * inverse / x * np.exp(-1.25 * inverse * inverse)
    if gamma == 1.0:
        return base
    sigma = np.where(x <= 1.0, 0.07, 0.09)
    return base * np.exp(math.log(gamma) * np.exp(-0.5 * ((x - 1.0) / sigma) ** 2))


@lru_cache(maxsize=256)
def _jonswap_area(gamma: float) -> float:
    """Area of `_shape` over x from 0 to infinity (W7), by Gauss-Legendre panels; 1/5 for gamma = 1."""
    if gamma == 1.0:
        return 0.2
    x, w = _panels(_PANELS[_PANELS <= 3.0])  # beyond 3 the peak factor is 1 to round-off
    return 0.2 + float(w @ (_shape(x, gamma) - _shape(x, 1.0)))


def _panels(edges: Array) -> tuple[Array, Array]:
    half, middle = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    return (middle[:, None] + half[:, None] * _POINTS).ravel(), (half[:, None] * _WEIGHTS).ravel()


def jonswap(omega: Array, sea: Any) -> Array:
    """JONSWAP by Hs, Tp and gamma (W6), its area made Hs²/16 by quadrature (W7), not by a fitted formula."""
    gamma = float(getattr(sea, "gamma", 1.0))
    peak = 2.0 * math.pi / sea.peak_period
    scale = sea.hs**2 / 16.0 / (peak * _jonswap_area(gamma))
    return scale * _shape(np.asarray(omega, dtype=float) / peak, gamma)


def pierson_moskowitz(omega: Array, sea: Any) -> Array:
    """Pierson-Moskowitz in its Bretschneider form by Hs and Tp: JONSWAP with gamma = 1 (W6)."""
    return jonswap(omega, sea)


def tabulated(omega: Array, sea: Any) -> Array:
    """Linear between the points of the table, zero outside."""
    return np.interp(np.asarray(omega, dtype=float), sea.frequencies, sea.densities, left=0.0, right=0.0)


SPECTRA: dict[str, Callable[[Array, Any], Array]] = {
    "jonswap": jonswap,
    "pierson-moskowitz": pierson_moskowitz,
    "tabulated": tabulated,
}


def spectrum(omega: Array | float, sea: Sea) -> Array:
    """One-sided spectral density of the elevation of one wave system at omega [rad/s], any shape -> [m2 s/rad]."""
    return SPECTRA[sea.spectrum](np.asarray(omega, dtype=float), sea)


def moments(sea: Sea, orders: tuple[int, ...] = (0, 1, 2), low: float = 0.0, high: float = math.inf) -> Array:
    """Spectral moments ∫ omega^n S d omega between low and high [rad/s], one per order [m2 (rad/s)^n] (W8).

    Orders from 0 to 3: the omega^-5 tail of the parametric spectra makes the fourth infinite when high is infinite.
    """
    if high == math.inf and max(orders) > 3 and not isinstance(sea, Tabulated):
        raise ValueError("moments of order 4 and above are infinite for an omega^-5 tail; give an upper frequency")
    omega, weights = _quadrature(sea, low, high)
    density = spectrum(omega, sea) * weights
    return np.array([float(density @ omega**n) for n in orders])


def _quadrature(sea: Sea, low: float, high: float) -> tuple[Array, Array]:
    """Nodes [rad/s] and weights over low to high, with panels that end where the spectrum has kinks."""
    if isinstance(sea, Tabulated):
        edges, tail = np.asarray(sea.frequencies), False
    else:
        edges, tail = _PANELS * 2.0 * math.pi / sea.peak_period, True
    last = edges[-1]
    inner = np.unique(np.clip(np.concatenate([edges, [low, min(high, last)]]), low, max(low, min(high, last))))
    omega, weights = _panels(inner) if inner.size > 1 else (np.empty(0), np.empty(0))
    start = max(low, last)
    if tail and high > start:  # substitute u = 1/omega: smooth, and finite for high = inf
        u, w = _panels(np.array([0.0 if math.isinf(high) else 1.0 / high, 1.0 / start]))
        omega, weights = np.concatenate([omega, 1.0 / u]), np.concatenate([weights, w / u**2])
    return omega, weights


def significant_height(sea: Sea) -> float:
    """Hs [m] of the whole spectrum, 4 √m0."""
    return hs_in_band(sea, 0.0, math.inf)


def hs_in_band(sea: Sea, low: float, high: float) -> float:
    """4 √m0 [m] of the part of the spectrum between low and high [rad/s] (W9)."""
    return 4.0 * math.sqrt(max(float(moments(sea, (0,), low, high)[0]), 0.0))


def zero_crossing_period(sea: Sea) -> float:
    """Tz = 2π √(m0/m2) [s] from the spectrum's own moments (W9)."""
    m0, m2 = moments(sea, (0, 2))
    return 2.0 * math.pi * math.sqrt(m0 / m2)
