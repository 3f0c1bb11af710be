"""Contact with the seabed (docs/theory.md, L13-L16): a smooth bilinear spring, damping in contact, friction along it.

A node without a spring (a1 = 0: a held end) does not touch the bed: its support carries it.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..kernels.line import HALF


@njit(cache=True)
def contact(height, a2):  # type: ignore[no-untyped-def]
    """Softplus law (force / a1 [m], share in contact 0…1) at a height over the level of a node's spring (L13)."""
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
    damping, mu, slow = line.contact[0], line.contact[1], line.contact[2]
    for i in range(line.L.size + 1):
        if line.a1[i] == 0.0:
            continue
        depth, share = contact(x[i, 2] - line.bed[i], line.a2[i])
        normal = line.a1[i] * depth
        out[i, 2] += normal - damping * share * v[i, 2]
        size = np.sqrt(v[i, 0] ** 2 + v[i, 1] ** 2 + slow * slow)
        for p in range(2):
            out[i, p] -= mu * normal * v[i, p] / size


@njit(cache=True)
def tangent(line, x, v, u, K, B):  # type: ignore[no-untyped-def]
    """Add -∂F/∂x to K and -∂F/∂ẋ to B, exact (L14, L16)."""
    damping, mu, slow = line.contact[0], line.contact[1], line.contact[2]
    for i in range(line.L.size + 1):
        if line.a1[i] == 0.0:
            continue
        depth, share = contact(x[i, 2] - line.bed[i], line.a2[i])
        turn = -2.0 * line.a2[i] * share * (1.0 - share)
        K[3 * i + 2, HALF] += line.a1[i] * share + damping * turn * v[i, 2]
        B[3 * i + 2, HALF] += damping * share
        size = np.sqrt(v[i, 0] ** 2 + v[i, 1] ** 2 + slow * slow)
        rub = mu * line.a1[i] / size
        for p in range(2):
            K[3 * i + p, HALF + 2 - p] -= rub * share * v[i, p]
            B[3 * i + p, HALF] += rub * depth
            for q in range(2):
                B[3 * i + p, HALF + q - p] -= rub * depth * v[i, p] * v[i, q] / size**2


@njit(cache=True)
def damping_blocks(line, x):  # type: ignore[no-untyped-def]
    """Vertical damping of the bed on every node at rest at x, shape (N+1,) [N s/m] (L14)."""
    out = np.zeros(line.L.size + 1)
    for i in range(out.size):
        if line.a1[i] > 0.0:
            out[i] = line.contact[0] * contact(x[i, 2] - line.bed[i], line.a2[i])[1]
    return out


@njit(cache=True)
def spring_forces(line, x):  # type: ignore[no-untyped-def]
    """Force of the bed's springs on every node at x, shape (N+1,) [N] (L13)."""
    out = np.zeros(line.L.size + 1)
    for i in range(out.size):
        if line.a1[i] > 0.0:
            out[i] = line.a1[i] * contact(x[i, 2] - line.bed[i], line.a2[i])[0]
    return out
