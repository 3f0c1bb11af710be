"""Axial spring of an element (docs/theory.md, L1-L2, L17-L18)."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..kernels.compression import released
from ..kernels.line import HALF


@njit(cache=True)
def force(line, x, v, u, a, out):  # type: ignore[no-untyped-def]
    """Add the axial force along each element to its two nodes (L1, L17)."""
    for j in range(line.L.size):
        d0, d1, d2 = x[j + 1, 0] - x[j, 0], x[j + 1, 1] - x[j, 1], x[j + 1, 2] - x[j, 2]
        length = np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        free, _ = released(length / line.L[j] - 1.0, line.limit[j], line.knee[j])
        scale = line.EA[j] * (1.0 / line.L[j] - 1.0 / length + free / length)
        out[j, 0] += scale * d0
        out[j, 1] += scale * d1
        out[j, 2] += scale * d2
        out[j + 1, 0] -= scale * d0
        out[j + 1, 1] -= scale * d1
        out[j + 1, 2] -= scale * d2


@njit(cache=True)
def _add(line, x, keep_slack, K):  # type: ignore[no-untyped-def]
    for j in range(line.L.size):
        d = x[j + 1] - x[j]
        length = np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        free, share = released(length / line.L[j] - 1.0, line.limit[j], line.knee[j])
        across = line.EA[j] * (1.0 / line.L[j] - 1.0 / length + free / length)
        if across < 0.0 and not keep_slack:
            across = 0.0
        along = line.EA[j] / line.L[j] * share
        for p in range(3):
            for q in range(3):
                value = (along - across) * d[p] * d[q] / (length * length)
                if p == q:
                    value += across
                i = 3 * j + p
                K[i, HALF + q - p] += value
                K[i + 3, HALF + q - p] += value
                K[i, HALF + 3 + q - p] -= value
                K[i + 3, HALF - 3 + q - p] -= value


@njit(cache=True)
def tangent(line, x, v, u, K, B):  # type: ignore[no-untyped-def]
    """Add -∂F/∂x to K, exact (L2, L18)."""
    _add(line, x, True, K)


@njit(cache=True)
def tangent_without_slack(line, x, K):  # type: ignore[no-untyped-def]
    """As `tangent`, with the negative transverse stiffness of slack elements left out: for Newton's matrix only (L2)."""
    _add(line, x, False, K)


@njit(cache=True)
def tension(line, x):  # type: ignore[no-untyped-def]
    """Axial force of every element, shape (N,) [N] (L1, L17)."""
    out = np.empty(line.L.size)
    for j in range(out.size):
        d = x[j + 1] - x[j]
        length = np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        free, _ = released(length / line.L[j] - 1.0, line.limit[j], line.knee[j])
        out[j] = line.EA[j] * (length - line.L[j]) / line.L[j] + line.EA[j] * free
    return out
