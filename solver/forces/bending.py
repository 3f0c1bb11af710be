"""Rotational spring at a node between two elements, with its exact tangent (docs/theory.md, L3-L5)."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..kernels.line import HALF


@njit(cache=True)
def _angle_factors(c, sine):  # type: ignore[no-untyped-def]
    """θ, p = θ/sin θ and q = (1 - θ cot θ)/sin²θ; p → 1 and q → 1/3 as θ → 0 (L3)."""
    theta = np.arctan2(sine, c)
    if theta < 1e-2:
        t2 = theta * theta
        return theta, 1.0 + t2 / 6.0 + 7.0 * t2 * t2 / 360.0, 1.0 / 3.0 + 2.0 * t2 / 15.0 + 2.0 * t2 * t2 / 63.0
    s = max(np.sin(theta), 1e-9)
    return theta, theta / s, (1.0 - theta * np.cos(theta) / s) / (s * s)


@njit(cache=True)
def _geometry(x, i, tj, tk):  # type: ignore[no-untyped-def]
    """Unit tangents of the elements at node i; returns their lengths, cos θ and sin θ."""
    for p in range(3):
        tj[p] = x[i, p] - x[i - 1, p]
        tk[p] = x[i + 1, p] - x[i, p]
    lj = np.sqrt(tj[0] * tj[0] + tj[1] * tj[1] + tj[2] * tj[2])
    lk = np.sqrt(tk[0] * tk[0] + tk[1] * tk[1] + tk[2] * tk[2])
    for p in range(3):
        tj[p] /= lj
        tk[p] /= lk
    c = tj[0] * tk[0] + tj[1] * tk[1] + tj[2] * tk[2]
    s0 = tj[1] * tk[2] - tj[2] * tk[1]
    s1 = tj[2] * tk[0] - tj[0] * tk[2]
    s2 = tj[0] * tk[1] - tj[1] * tk[0]
    return lj, lk, c, np.sqrt(s0 * s0 + s1 * s1 + s2 * s2)


@njit(cache=True)
def force(line, x, v, u, a, out):  # type: ignore[no-untyped-def]
    """Add kb p ∂c/∂y to the three nodes of each joint (L4)."""
    tj, tk = np.empty(3), np.empty(3)
    for i in range(1, line.L.size):
        kb = line.kb[i]
        if kb == 0.0:
            continue
        lj, lk, c, sine = _geometry(x, i, tj, tk)
        _, p, _ = _angle_factors(c, sine)
        for r in range(3):
            g1 = -(tk[r] - c * tj[r]) / lj
            g3 = (tj[r] - c * tk[r]) / lk
            out[i - 1, r] += kb * p * g1
            out[i + 1, r] += kb * p * g3
            out[i, r] -= kb * p * (g1 + g3)


@njit(cache=True)
def tangent(line, x, v, u, K, B):  # type: ignore[no-untyped-def]
    """Add kb (q g gᵀ - p ∂²c/∂y²) to K, exact (L5)."""
    tj, tk, g = np.empty(3), np.empty(3), np.empty(9)
    h11, h13, h33, block = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((9, 9))
    for i in range(1, line.L.size):
        kb = line.kb[i]
        if kb == 0.0:
            continue
        lj, lk, c, sine = _geometry(x, i, tj, tk)
        _, p, q = _angle_factors(c, sine)
        for r in range(3):
            g[r] = -(tk[r] - c * tj[r]) / lj
            g[6 + r] = (tj[r] - c * tk[r]) / lk
            g[3 + r] = -g[r] - g[6 + r]
        _second_derivatives(tj, tk, c, lj, lk, h11, h13, h33)
        for r in range(3):
            for s in range(3):
                block[r, s] = h11[r, s]
                block[r, 6 + s] = h13[r, s]
                block[6 + r, s] = h13[s, r]
                block[6 + r, 6 + s] = h33[r, s]
                block[r, 3 + s] = -h11[r, s] - h13[r, s]
                block[3 + r, s] = -h11[r, s] - h13[s, r]
                block[6 + r, 3 + s] = -h13[s, r] - h33[r, s]
                block[3 + r, 6 + s] = -h13[r, s] - h33[r, s]
                block[3 + r, 3 + s] = h11[r, s] + h13[r, s] + h13[s, r] + h33[r, s]
        first = 3 * (i - 1)
        for r in range(9):
            for s in range(9):
                K[first + r, HALF + s - r] += kb * (q * g[r] * g[s] - p * block[r, s])


@njit(cache=True)
def _second_derivatives(tj, tk, c, lj, lk, h11, h13, h33):  # type: ignore[no-untyped-def]
    """∂²c/∂y1², ∂²c/∂y1∂y3, ∂²c/∂y3² of c = tj·tk; the rows and columns of node 2 follow by translation."""
    for r in range(3):
        for s in range(3):
            unit = 1.0 if r == s else 0.0
            pj = unit - tj[r] * tj[s]
            nr, ns = tk[r] - c * tj[r], tk[s] - c * tj[s]
            h11[r, s] = -(c * pj + nr * tj[s] + tj[r] * ns) / (lj * lj)
            mr, ms = tj[r] - c * tk[r], tj[s] - c * tk[s]
            h33[r, s] = -(c * (unit - tk[r] * tk[s]) + mr * tk[s] + tk[r] * ms) / (lk * lk)
            # -(1/lj lk) Pj Pk, with P = I - t tᵀ
            h13[r, s] = -(unit - tj[r] * tj[s] - tk[r] * tk[s] + c * tj[r] * tk[s]) / (lj * lk)


@njit(cache=True)
def moment(line, x):  # type: ignore[no-untyped-def]
    """Bending moment kb θ at every node, shape (N+1,) [N m]; zero at the ends (pinned) (L3)."""
    tj, tk, out = np.empty(3), np.empty(3), np.zeros(line.L.size + 1)
    for i in range(1, line.L.size):
        _, _, c, sine = _geometry(x, i, tj, tk)
        theta, _, _ = _angle_factors(c, sine)
        out[i] = line.kb[i] * theta
    return out
