"""Inertia: the load of accelerating water and the mass of the nodes (docs/theory.md, L10-L12)."""

from __future__ import annotations

import numpy as np
from numba import njit

from .weight import wet_half, wet_point


@njit(cache=True)
def force(line, x, v, u, a, out):  # type: ignore[no-untyped-def]
    """Add mw [(1+Can)(a - (a·t)t) + (1+Cat)(a·t)t] of every wet half element, and of attachments (L10)."""
    n = line.L.size
    t = np.empty(3)
    for i in range(n + 1):
        for j in range(max(i - 1, 0), min(i + 1, n)):
            other = j if j < i else j + 1
            wet, _, _ = wet_half(x[i, 2], x[other, 2], line.D[j])
            for p in range(3):
                t[p] = x[j + 1, p] - x[j, p]
            length = np.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
            along = (a[i, 0] * t[0] + a[i, 1] * t[1] + a[i, 2] * t[2]) / (length * length)
            mass = wet * line.mw[j]
            for p in range(3):
                out[i, p] += mass * ((1.0 + line.can[j]) * a[i, p] + (line.cat[j] - line.can[j]) * along * t[p])
        share = wet_point(x[i, 2], line.point_radius[i])
        for p in range(3):
            out[i, p] += share * line.point_mw[i] * (1.0 + line.point_ca[i]) * a[i, p]


@njit(cache=True)
def tangent(line, x, v, u, K, B):  # type: ignore[no-untyped-def]
    """Nothing: still water and no acceleration in the state about which both domains are linearised."""


@njit(cache=True)
def blocks(line, x):  # type: ignore[no-untyped-def]
    """Per node, 3×3: mass with added mass (L11) and the factor of the water's acceleration (L12).

    Returns (M, C), each shape (N+1, 3, 3) [kg]; inertia load = C @ a. Nodes are not coupled.
    """
    n = line.L.size
    M, C, t = np.zeros((n + 1, 3, 3)), np.zeros((n + 1, 3, 3)), np.empty(3)
    for i in range(n + 1):
        point = wet_point(x[i, 2], line.point_radius[i]) * line.point_mw[i]
        for p in range(3):
            M[i, p, p] += line.node_mass[i] + point * line.point_ca[i]
            C[i, p, p] += point * (1.0 + line.point_ca[i])
        for j in range(max(i - 1, 0), min(i + 1, n)):
            other = j if j < i else j + 1
            wet, _, _ = wet_half(x[i, 2], x[other, 2], line.D[j])
            for p in range(3):
                t[p] = x[j + 1, p] - x[j, p]
            t /= np.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
            mass = wet * line.mw[j]
            for p in range(3):
                for q in range(3):
                    across = (1.0 if p == q else 0.0) - t[p] * t[q]
                    added = mass * (line.can[j] * across + line.cat[j] * t[p] * t[q])
                    M[i, p, q] += added
                    C[i, p, q] += added
                C[i, p, p] += mass
    return M, C
