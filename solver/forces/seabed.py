"""Vertical contact with the seabed (docs/theory.md, L13-L14): a smooth bilinear spring, and damping in contact."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..kernels.line import HALF


@njit(cache=True)
def contact(height, a2):  # type: ignore[no-untyped-def]
    """Softplus law with a3 = 0: (force / a1 [m], share in contact 0…1) at a height above the bed (L13)."""
    e = -2.0 * a2 * height
    if e > 40.0:
        return e / (2.0 * a2), 1.0
    if e < -40.0:
        return np.exp(e) / (2.0 * a2), np.exp(e)
    grown = np.exp(e)
    return np.log1p(grown) / (2.0 * a2), grown / (1.0 + grown)


@njit(cache=True)
def force(line, x, v, u, a, out):  # type: ignore[no-untyped-def]
    """Add the vertical force of the bed and its damping (L13)."""
    a2, bed, damping = line.seabed[0], line.seabed[1], line.seabed[2]
    for i in range(line.L.size + 1):
        depth, share = contact(x[i, 2] - bed, a2)
        out[i, 2] += line.a1[i] * depth - damping * share * v[i, 2]


@njit(cache=True)
def tangent(line, x, v, u, K, B):  # type: ignore[no-untyped-def]
    """Add -∂F/∂z to K and -∂F/∂ż to B, exact (L14)."""
    a2, bed, damping = line.seabed[0], line.seabed[1], line.seabed[2]
    for i in range(line.L.size + 1):
        _, share = contact(x[i, 2] - bed, a2)
        slope = -2.0 * a2 * share * (1.0 - share)
        K[3 * i + 2, HALF] += line.a1[i] * share + damping * slope * v[i, 2]
        B[3 * i + 2, HALF] += damping * share
