"""Dynamic response of one line, condensed to its ends, many frequencies at a time (docs/theory.md, F7-F11).

Frequencies come in multiples of LANES and stand last in every array, so that all arithmetic runs over them.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..kernels.band import LANES, eliminate_lanes
from ..kernels.compression import released
from ..kernels.line import HALF, WIDTH


@njit(cache=True)
def solve_line(K, M, B, C, omega, ur, ui, ends, half):  # type: ignore[no-untyped-def]
    """Response of a line's interior and its condensed dynamic stiffness (F7-F9).

    K : (3(N+1), WIDTH) banded stiffness; M, B, C : (N+1, 3, 3) mass, damping, factor of the water's acceleration.
    omega : (W,) [rad/s], W a multiple of LANES; ur, ui : (R, N+1, 3, W) water velocity per unit of each load.
    ends : columns of end motion kept: 3 (end b), 6 (end b and end a) or 0; half : half-bandwidth in use.

    Returns Xr, Xi (3(N-1), ends + R, W): interior displacement against unit end motion (to be subtracted) and under
    each load with ends held; Zr, Zi (ends, ends, W) condensed stiffness; Lr, Li (6, R, W): loads that reach end b and
    end a when both are held.
    """
    R, nodes, W = ur.shape[0], ur.shape[1], omega.size
    rows, m = 3 * (nodes - 2), ends + R
    Xr, Xi = np.empty((rows, m, W)), np.empty((rows, m, W))
    Zr, Zi = np.zeros((ends, ends, W)), np.zeros((ends, ends, W))
    Lr, Li = np.zeros((6, R, W)), np.zeros((6, R, W))
    ar, ai = np.empty((rows, WIDTH, LANES)), np.empty((rows, WIDTH, LANES))
    rr, ri = np.empty((rows, m, LANES)), np.empty((rows, m, LANES))
    for w0 in range(0, W, LANES):
        w = omega[w0 : w0 + LANES]
        _matrix(K, M, B, w, ar, ai)
        _end_motion(K, ends, rr, ri)
        for r in range(R):
            for i in range(1, nodes - 1):
                for p in range(3):
                    row = 3 * (i - 1) + p
                    _load(B[i, p], C[i, p], w, ur[r, i], ui[r, i], w0, rr[row, ends + r], ri[row, ends + r])
            for e in range(6):
                i, p = (nodes - 1, e) if e < 3 else (0, e - 3)
                sr, si = np.empty(LANES), np.empty(LANES)
                _load(B[i, p], C[i, p], w, ur[r, i], ui[r, i], w0, sr, si)
                Lr[e, r, w0 : w0 + LANES] = sr
                Li[e, r, w0 : w0 + LANES] = si
        eliminate_lanes(ar, ai, rr, ri, half, min(ends, 3))
        Xr[:, :, w0 : w0 + LANES] = rr
        Xi[:, :, w0 : w0 + LANES] = ri
        _condense(K, M, B, w, rr, ri, ends, w0, Zr, Zi, Lr, Li)
    return Xr, Xi, Zr, Zi, Lr, Li


@njit(cache=True)
def _matrix(K, M, B, w, ar, ai):  # type: ignore[no-untyped-def]
    """Interior band of K - ω²M + iωB for every lane (F7)."""
    rows = ar.shape[0]
    for i in range(rows):
        for q in range(WIDTH):
            j = i + q - HALF
            value = K[i + 3, q] if 0 <= j < rows else 0.0
            for lane in range(LANES):
                ar[i, q, lane] = value
                ai[i, q, lane] = 0.0
        node, p = 1 + i // 3, i % 3
        for s in range(3):
            q = HALF + s - p
            for lane in range(LANES):
                ar[i, q, lane] -= w[lane] * w[lane] * M[node, p, s]
                ai[i, q, lane] += w[lane] * B[node, p, s]


@njit(cache=True)
def _end_motion(K, ends, rr, ri):  # type: ignore[no-untyped-def]
    """Right-hand sides of unit motion of end b (3 columns) and end a (3 more)."""
    rows = rr.shape[0]
    total = rows + 6
    for row in range(rows):
        for c in range(ends):
            j = total - 3 + c if c < 3 else c - 3
            q = HALF + j - (row + 3)
            value = K[row + 3, q] if 0 <= q < WIDTH else 0.0
            for lane in range(LANES):
                rr[row, c, lane] = value
                ri[row, c, lane] = 0.0


@njit(cache=True)
def _load(b, c, w, ur, ui, w0, outr, outi):  # type: ignore[no-untyped-def]
    """(B + iωC) u of one coordinate of one node (F8)."""
    for lane in range(LANES):
        re, im = 0.0, 0.0
        for s in range(3):
            vr, vi = ur[s, w0 + lane], ui[s, w0 + lane]
            re += b[s] * vr - w[lane] * c[s] * vi
            im += b[s] * vi + w[lane] * c[s] * vr
        outr[lane] = re
        outi[lane] = im


@njit(cache=True)
def _condense(K, M, B, w, rr, ri, ends, w0, Zr, Zi, Lr, Li):  # type: ignore[no-untyped-def]
    rows, m = rr.shape[0], rr.shape[1]
    total = rows + 6
    nodes = total // 3
    for e in range(6):
        i = total - 3 + e if e < 3 else e - 3
        node, p = (nodes - 1, e) if e < 3 else (0, e - 3)
        if e < ends:
            for c in range(ends):
                j = total - 3 + c if c < 3 else c - 3
                q = HALF + j - i
                same = (e < 3) == (c < 3)
                for lane in range(LANES):
                    if 0 <= q < WIDTH:
                        Zr[e, c, w0 + lane] += K[i, q]
                    if same:
                        Zr[e, c, w0 + lane] -= w[lane] * w[lane] * M[node, p, c % 3]
                        Zi[e, c, w0 + lane] += w[lane] * B[node, p, c % 3]
        for j in range(max(3, i - HALF), min(total - 3, i + HALF + 1)):
            k = K[i, HALF + j - i]
            for c in range(m):
                for lane in range(LANES):
                    if c >= ends:
                        Lr[e, c - ends, w0 + lane] -= k * rr[j - 3, c, lane]
                        Li[e, c - ends, w0 + lane] -= k * ri[j - 3, c, lane]
                    elif e < ends:
                        Zr[e, c, w0 + lane] -= k * rr[j - 3, c, lane]
                        Zi[e, c, w0 + lane] -= k * ri[j - 3, c, lane]


@njit(cache=True, fastmath={"contract", "reassoc"})
def displacements(Xr, Xi, sr, si, ends, loads):  # type: ignore[no-untyped-def]
    """Node displacements from end motions (F10).

    sr, si : (R, 6, W) motion of end b and end a in each response; loads : whether the columns of loads are added.
    Returns Yr, Yi (R, N+1, 3, W).
    """
    rows, W, R = Xr.shape[0], Xr.shape[2], sr.shape[0]
    nodes = rows // 3 + 2
    Yr, Yi = np.empty((R, nodes, 3, W)), np.empty((R, nodes, 3, W))
    for r in range(R):
        for p in range(3):
            for k in range(W):
                Yr[r, nodes - 1, p, k] = sr[r, p, k]
                Yi[r, nodes - 1, p, k] = si[r, p, k]
                Yr[r, 0, p, k] = sr[r, 3 + p, k]
                Yi[r, 0, p, k] = si[r, 3 + p, k]
        for row in range(rows):
            node, p = 1 + row // 3, row % 3
            yr, yi = Yr[r, node, p], Yi[r, node, p]
            if loads:
                yr[:] = Xr[row, ends + r]
                yi[:] = Xi[row, ends + r]
            else:
                yr[:] = 0.0
                yi[:] = 0.0
            for c in range(ends):
                xr, xi, er, ei = Xr[row, c], Xi[row, c], sr[r, c], si[r, c]
                for k in range(W):
                    yr[k] -= xr[k] * er[k] - xi[k] * ei[k]
                    yi[k] -= xr[k] * ei[k] + xi[k] * er[k]
    return Yr, Yi


@njit(cache=True, fastmath={"contract", "reassoc"})
def velocity_covariance(Yr, Yi, ur, ui, omega, weight, out):  # type: ignore[no-untyped-def]
    """Add Σ weight Re(v vᴴ) of the relative velocity v = u - iωy to out (N+1, 6) (F11).

    weight : (R, W), variance per unit response squared; ur may be empty (0 responses) for still water.
    """
    R, nodes, _, W = Yr.shape
    vr, vi = np.empty((3, W)), np.empty((3, W))
    for r in range(R):
        for i in range(nodes):
            for p in range(3):
                for k in range(W):
                    vr[p, k] = omega[k] * Yi[r, i, p, k]
                    vi[p, k] = -omega[k] * Yr[r, i, p, k]
                if ur.shape[0] > 0:
                    for k in range(W):
                        vr[p, k] += ur[r, i, p, k]
                        vi[p, k] += ui[r, i, p, k]
            for q in range(6):
                a, b = (q, q) if q < 3 else ((0, 1) if q == 3 else ((0, 2) if q == 4 else (1, 2)))
                total = 0.0
                for k in range(W):
                    total += weight[r, k] * (vr[a, k] * vr[b, k] + vi[a, k] * vi[b, k])
                out[i, q] += total


@njit(cache=True)
def tension_response(line, x, Yr, Yi):  # type: ignore[no-untyped-def]
    """Tension of every element, EA/L t·(y2 - y1): (R, N, W) real and imaginary part [N per unit response] (F13, L18)."""
    R, nodes, _, W = Yr.shape
    Tr, Ti = np.zeros((R, nodes - 1, W)), np.zeros((R, nodes - 1, W))
    for j in range(nodes - 1):
        t = x[j + 1] - x[j]
        length = np.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
        _, share = released(length / line.L[j] - 1.0, line.limit[j], line.knee[j])
        t = t * (share * line.EA[j] / line.L[j] / length)
        for r in range(R):
            for p in range(3):
                Tr[r, j] += t[p] * (Yr[r, j + 1, p] - Yr[r, j, p])
                Ti[r, j] += t[p] * (Yi[r, j + 1, p] - Yi[r, j, p])
    return Tr, Ti
