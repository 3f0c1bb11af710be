"""Contact with the seabed (docs/theory.md, L13-L16): a smooth bilinear spring, damping in contact, friction along it."""

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
    """Add the vertical force of the bed and its damping (L13), and its friction (L15)."""
    a2, bed, damping = line.seabed[0], line.seabed[1], line.seabed[2]
    mu, slow = line.seabed[3], line.seabed[4]
    for i in range(line.L.size + 1):
        depth, share = contact(x[i, 2] - bed, a2)
        normal = line.a1[i] * depth
        out[i, 2] += normal - damping * share * v[i, 2]
        size = np.sqrt(v[i, 0] ** 2 + v[i, 1] ** 2 + slow * slow)
        for p in range(2):
            out[i, p] -= mu * normal * v[i, p] / size


@njit(cache=True)
def tangent(line, x, v, u, K, B):  # type: ignore[no-untyped-def]
    """Add -∂F/∂x to K and -∂F/∂ẋ to B, exact (L14, L16)."""
    a2, bed, damping = line.seabed[0], line.seabed[1], line.seabed[2]
    mu, slow = line.seabed[3], line.seabed[4]
    for i in range(line.L.size + 1):
        depth, share = contact(x[i, 2] - bed, a2)
        turn = -2.0 * a2 * share * (1.0 - share)
        K[3 * i + 2, HALF] += line.a1[i] * share + damping * turn * v[i, 2]
        B[3 * i + 2, HALF] += damping * share
        size = np.sqrt(v[i, 0] ** 2 + v[i, 1] ** 2 + slow * slow)
        rub = mu * line.a1[i] / size
        for p in range(2):
            K[3 * i + p, HALF + 2 - p] -= rub * share * v[i, p]
            B[3 * i + p, HALF] += rub * depth
            for q in range(2):
                B[3 * i + p, HALF + q - p] -= rub * depth * v[i, p] * v[i, q] / size**2
