"""Morison drag of half elements and attachments (docs/theory.md, L8-L9), and its exact tangents.

The relative velocity is V = u + Vc - ẋ with the current Vc at the node's height; each half element sees its own tangent.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..kernels.line import HALF
from .weight import wet_half, wet_point


@njit(cache=True)
def current(line, z, out):  # type: ignore[no-untyped-def]
    """Current velocity at height z into out (3,); returns nothing. Linear in height, held beyond the ends."""
    heights, velocity = line.current_z, line.current_v
    n = heights.size
    if z <= heights[0]:
        out[:] = velocity[0]
    elif z >= heights[n - 1]:
        out[:] = velocity[n - 1]
    else:
        k = np.searchsorted(heights, z) - 1
        share = (z - heights[k]) / (heights[k + 1] - heights[k])
        for p in range(3):
            out[p] = velocity[k, p] + share * (velocity[k + 1, p] - velocity[k, p])


@njit(cache=True)
def current_slope(line, z, out):  # type: ignore[no-untyped-def]
    """∂Vc/∂z at height z into out (3,)."""
    heights, velocity = line.current_z, line.current_v
    n = heights.size
    out[:] = 0.0
    if n > 1 and heights[0] < z < heights[n - 1]:
        k = np.searchsorted(heights, z) - 1
        for p in range(3):
            out[p] = (velocity[k + 1, p] - velocity[k, p]) / (heights[k + 1] - heights[k])


@njit(cache=True)
def force(line, x, v, u, a, out):  # type: ignore[no-untyped-def]
    """Add cdn |Vn| Vn + cdt |Vt| Vt of every half element, and of attachments (L8)."""
    n = line.L.size
    rel, t = np.empty(3), np.empty(3)
    for i in range(n + 1):
        current(line, x[i, 2], rel)
        for p in range(3):
            rel[p] += u[i, p] - v[i, p]
        for j in range(max(i - 1, 0), min(i + 1, n)):
            other = j if j < i else j + 1
            wet, _, _ = wet_half(x[i, 2], x[other, 2], line.D[j])
            if wet == 0.0:
                continue
            length = 0.0
            for p in range(3):
                t[p] = x[j + 1, p] - x[j, p]
                length += t[p] * t[p]
            length = np.sqrt(length)
            vt = (rel[0] * t[0] + rel[1] * t[1] + rel[2] * t[2]) / length
            vn2 = 0.0
            for p in range(3):
                t[p] /= length
                vn2 += (rel[p] - vt * t[p]) ** 2
            cn = wet * line.cdn[j] * np.sqrt(vn2)
            ct = wet * line.cdt[j] * abs(vt) * vt
            for p in range(3):
                out[i, p] += cn * (rel[p] - vt * t[p]) + ct * t[p]
        share = wet_point(x[i, 2], line.point_radius[i])
        if line.point_drag[i] * share > 0.0:
            size = share * np.sqrt(rel[0] * rel[0] + rel[1] * rel[1] + rel[2] * rel[2])
            for p in range(3):
                out[i, p] += line.point_drag[i] * size * rel[p]


@njit(cache=True)
def _half_derivatives(line, j, rel, t, length, wet, dV, dt):  # type: ignore[no-untyped-def]
    """∂F/∂V into dV (3, 3) and ∂F/∂(x2 - x1) into dt (3, 3) of one half element (L9)."""
    vt = rel[0] * t[0] + rel[1] * t[1] + rel[2] * t[2]
    n = rel - vt * t
    vn = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    cn, ct = wet * line.cdn[j], wet * line.cdt[j]
    for p in range(3):
        for q in range(3):
            unit = 1.0 if p == q else 0.0
            along = n[p] * n[q] / vn if vn > 0.0 else 0.0
            dV[p, q] = cn * (vn * (unit - t[p] * t[q]) + along) + 2.0 * ct * abs(vt) * t[p] * t[q]
    # ∂n/∂t = -(t rᵀ + vt I), ∂vt/∂t = rᵀ; then ∂t/∂d = (I - t tᵀ)/l
    for p in range(3):
        for q in range(3):
            unit = 1.0 if p == q else 0.0
            dn = -(t[p] * rel[q] + vt * unit)
            row = 0.0
            for s in range(3):
                row += n[s] * -(t[s] * rel[q] + vt * (1.0 if s == q else 0.0))
            value = cn * (vn * dn + (n[p] * row / vn if vn > 0.0 else 0.0))
            value += ct * (2.0 * abs(vt) * rel[q] * t[p] + abs(vt) * vt * unit)
            dt[p, q] = value
    for p in range(3):
        radial = dt[p, 0] * t[0] + dt[p, 1] * t[1] + dt[p, 2] * t[2]
        for q in range(3):
            dt[p, q] = (dt[p, q] - radial * t[q]) / length


@njit(cache=True)
def tangent(line, x, v, u, K, B):  # type: ignore[no-untyped-def]
    """Add -∂F/∂x to K and -∂F/∂ẋ to B, exact (L9)."""
    n = line.L.size
    rel, t, slope = np.empty(3), np.empty(3), np.empty(3)
    dV, dt = np.empty((3, 3)), np.empty((3, 3))
    for i in range(n + 1):
        current(line, x[i, 2], rel)
        current_slope(line, x[i, 2], slope)
        for p in range(3):
            rel[p] += u[i, p] - v[i, p]
        if rel[0] == 0.0 and rel[1] == 0.0 and rel[2] == 0.0:
            continue
        for j in range(max(i - 1, 0), min(i + 1, n)):
            other = j if j < i else j + 1
            wet, own, far = wet_half(x[i, 2], x[other, 2], line.D[j])
            if wet == 0.0 and own == 0.0:
                continue
            for p in range(3):
                t[p] = x[j + 1, p] - x[j, p]
            length = np.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
            t /= length
            _half_derivatives(line, j, rel, t, length, wet, dV, dt)
            sign = 1.0 if j < i else -1.0  # d = x[j+1] - x[j]; node i is its end or its start
            shift = 3 * (other - i)
            vt = rel[0] * t[0] + rel[1] * t[1] + rel[2] * t[2]
            vn = np.sqrt(max(rel[0] ** 2 + rel[1] ** 2 + rel[2] ** 2 - vt * vt, 0.0))
            for p in range(3):
                row = 3 * i + p
                dry = line.cdn[j] * vn * (rel[p] - vt * t[p]) + line.cdt[j] * abs(vt) * vt * t[p]
                K[row, HALF + 2 - p] -= own * dry + dV[p, 0] * slope[0] + dV[p, 1] * slope[1] + dV[p, 2] * slope[2]
                K[row, HALF + shift + 2 - p] -= far * dry
                for q in range(3):
                    B[row, HALF + q - p] += dV[p, q]
                    K[row, HALF + q - p] -= sign * dt[p, q]
                    K[row, HALF + shift + q - p] += sign * dt[p, q]
        share = wet_point(x[i, 2], line.point_radius[i])
        if line.point_drag[i] * share > 0.0:
            _point_tangent(line, i, rel, slope, share, K, B)


@njit(cache=True)
def _point_tangent(line, i, rel, slope, share, K, B):  # type: ignore[no-untyped-def]
    size = np.sqrt(rel[0] * rel[0] + rel[1] * rel[1] + rel[2] * rel[2])
    rise = 0.5 / line.point_radius[i] if share < 1.0 else 0.0
    for p in range(3):
        K[3 * i + p, HALF + 2 - p] += line.point_drag[i] * rise * size * rel[p]
        for q in range(3):
            value = share * line.point_drag[i] * ((size if p == q else 0.0) + rel[p] * rel[q] / size)
            B[3 * i + p, HALF + q - p] += value
            K[3 * i + p, HALF + 2 - p] -= value * slope[q]
