"""Weight and buoyancy, in halves onto the end nodes; elements that pierce the surface are wet in part (L6-L7)."""

from __future__ import annotations

from numba import njit

from ..kernels.line import HALF


@njit(cache=True)
def wet_half(z_node, z_other, D):  # type: ignore[no-untyped-def]
    """Wet share of the half element at a node, and its derivatives with the node's and the other node's height (L7).

    D : its diameter [m], over which a piece that lies nearly flat goes under.
    """
    z_mid = 0.5 * (z_node + z_other)
    low, high = min(z_node, z_mid), max(z_node, z_mid)
    e, slope = 0.0, 0.0  # what the section reaches beyond the ends of the axis, and its change with high - low
    if high - low < D:
        e, slope = 0.5 * (D - (high - low)), -0.5
    if high <= -e:
        return 1.0, 0.0, 0.0
    if low >= e:
        return 0.0, 0.0, 0.0
    whole = high - low + 2.0 * e
    share = (e - low) / whole
    d_high = (slope - share * (1.0 + 2.0 * slope)) / whole
    d_low = -1.0 / whole - d_high
    if z_node <= z_mid:
        return share, d_low + 0.5 * d_high, 0.5 * d_high
    return share, d_high + 0.5 * d_low, 0.5 * d_low


@njit(cache=True)
def wet_point(z, radius):  # type: ignore[no-untyped-def]
    """Wet share of an attachment at height z: it falls evenly from 1 to 0 as its sphere rises through the surface (L7)."""
    return min(max(0.5 * (1.0 - z / radius), 0.0), 1.0)


@njit(cache=True)
def force(line, x, v, u, a, out):  # type: ignore[no-untyped-def]
    """Add the vertical load of the half elements and of attachments (L6)."""
    for j in range(line.L.size):
        wet1, _, _ = wet_half(x[j, 2], x[j + 1, 2], line.D[j])
        wet2, _, _ = wet_half(x[j + 1, 2], x[j, 2], line.D[j])
        out[j, 2] += 0.5 * (wet1 * line.b_wet[j] - line.w_dry[j])
        out[j + 1, 2] += 0.5 * (wet2 * line.b_wet[j] - line.w_dry[j])
    for i in range(line.L.size + 1):
        out[i, 2] += line.point_lift[i] * wet_point(x[i, 2], line.point_radius[i]) - line.point_weight[i]


@njit(cache=True)
def tangent(line, x, v, u, K, B):  # type: ignore[no-untyped-def]
    """Add the change of buoyancy of elements that pierce the surface (L7)."""
    for j in range(line.L.size):
        if max(x[j, 2], x[j + 1, 2]) <= -0.5 * line.D[j]:
            continue
        _, own1, other1 = wet_half(x[j, 2], x[j + 1, 2], line.D[j])
        _, own2, other2 = wet_half(x[j + 1, 2], x[j, 2], line.D[j])
        half = 0.5 * line.b_wet[j]
        i, k = 3 * j + 2, 3 * j + 5
        K[i, HALF] -= half * own1
        K[i, HALF + 3] -= half * other1
        K[k, HALF] -= half * own2
        K[k, HALF - 3] -= half * other2
    for i in range(line.L.size + 1):
        if abs(x[i, 2]) < line.point_radius[i]:
            K[3 * i + 2, HALF] += 0.5 * line.point_lift[i] / line.point_radius[i]
