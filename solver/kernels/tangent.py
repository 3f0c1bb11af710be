"""Newton's matrix of many lines at once, lanes last (docs/theory.md, T8)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .compression import released
from .lanes import (
    A1,
    A2,
    BED,
    BED_C,
    CAN,
    CAT,
    CDN,
    CDT,
    EA,
    EL,
    FAST,
    KB,
    KNEE,
    LIMIT,
    MASS,
    MW,
    POINT_CA,
    POINT_D,
    POINT_M,
    POINT_R,
    bed_force,
    clear_of_bed,
    wet_point,
)  # fmt: skip


@njit(cache=True, fastmath=FAST, error_model="numpy")
def tangent(x, v, C, D, t, length, friction, wet, water, first_wave, current, mass_factor, damping_factor, least, A):  # type: ignore[no-untyped-def]
    """Lower band of K + mass_factor M + damping_factor B into A (3P, BAND, Q), overwritten: A[i, i - j] (L2, L5, L9, L11, L18).

    Symmetric and positive: the negative stiffness of slack elements and what drag owes to turning are left out.
    least : least share of EA/L along an element: 0, or 1 for a matrix that is stiffer than any tangent of (L17).
    """
    P, _, Q = x.shape
    A[:] = 0.0
    block, r = np.empty((6, Q)), np.empty((3, Q))
    for j in range(P - 1):
        for q in range(Q):
            strain = length[j, q] / C[j, EL, q] - 1.0
            free, share = released(strain, C[j, LIMIT, q], C[j, KNEE, q])
            along = max(share, least) * C[j, EA, q] / C[j, EL, q]
            across = max(C[j, EA, q] * (strain + free) / length[j, q], 0.0)
            rest = along - across
            t0, t1, t2 = t[j, 0, q], t[j, 1, q], t[j, 2, q]
            block[0, q], block[1, q], block[2, q] = (
                across + rest * t0 * t0,
                across + rest * t1 * t1,
                across + rest * t2 * t2,
            )
            block[3, q], block[4, q], block[5, q] = rest * t0 * t1, rest * t0 * t2, rest * t1 * t2
        _add_diagonal(A, 3 * j, block)
        _add_diagonal(A, 3 * j + 3, block)
        _subtract_coupling(A, 3 * j + 3, block)
    _bending_tangent(C, t, length, A)
    for i in range(P):
        w = i - first_wave
        for p in range(3):
            for q in range(Q):
                r[p, q] = current[i, p, q] - v[i, p, q]
        if w >= 0:
            for p in range(3):
                for q in range(Q):
                    r[p, q] += water[w, p, q]
        for q in range(Q):
            share = wet_point(x[i, 2, q], D[i, POINT_R, q])
            m = mass_factor * (D[i, MASS, q] + share * D[i, POINT_M, q] * D[i, POINT_CA, q])
            size = share * D[i, POINT_D, q] * math.sqrt(r[0, q] ** 2 + r[1, q] ** 2 + r[2, q] ** 2)
            m += damping_factor * 2.0 * size
            block[0, q], block[1, q], block[2, q] = m, m, m
            block[3, q], block[4, q], block[5, q] = 0.0, 0.0, 0.0
        for side in range(2):
            j = i - 1 + side
            if 0 <= j <= P - 2:
                _half_tangent(C, t, wet, r, i, j, side, mass_factor, damping_factor, block)
        _bed_tangent(D, x, v, friction, i, damping_factor, block)
        _add_diagonal(A, 3 * i, block)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _bed_tangent(D, x, v, friction, i, damping_factor, block):  # type: ignore[no-untyped-def]
    """Spring, damping and friction of the bed; friction's change with depth is left out (L14, L16)."""
    if clear_of_bed(D, x, i):
        return
    mu, slow = friction[0], friction[1]
    for q in range(x.shape[2]):
        force, share = bed_force(D[i, A1, q], D[i, A2, q], x[i, 2, q] - D[i, BED, q])
        block[2, q] += share * (D[i, A1, q] + damping_factor * D[i, BED_C, q])
        if mu > 0.0:
            v0, v1 = v[i, 0, q], v[i, 1, q]
            speed2 = v0 * v0 + v1 * v1 + slow * slow
            rub = damping_factor * mu * force / math.sqrt(speed2)
            block[0, q] += rub * (1.0 - v0 * v0 / speed2)
            block[1, q] += rub * (1.0 - v1 * v1 / speed2)
            block[3, q] -= rub * v0 * v1 / speed2


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _half_tangent(C, t, wet, r, i, j, side, mass_factor, damping_factor, block):  # type: ignore[no-untyped-def]
    for q in range(r.shape[1]):
        t0, t1, t2 = t[j, 0, q], t[j, 1, q], t[j, 2, q]
        share = wet[i, side, q]
        along = r[0, q] * t0 + r[1, q] * t1 + r[2, q] * t2
        n0, n1, n2 = r[0, q] - along * t0, r[1, q] - along * t1, r[2, q] - along * t2
        size = math.sqrt(n0 * n0 + n1 * n1 + n2 * n2) + 1e-12
        d = damping_factor * share * C[j, CDN, q]
        m = mass_factor * share * C[j, MW, q]
        even = d * size + m * C[j, CAN, q]
        s = d / size
        k = 2.0 * damping_factor * share * C[j, CDT, q] * abs(along) - d * size + m * (C[j, CAT, q] - C[j, CAN, q])
        block[0, q] += even + s * n0 * n0 + k * t0 * t0
        block[1, q] += even + s * n1 * n1 + k * t1 * t1
        block[2, q] += even + s * n2 * n2 + k * t2 * t2
        block[3, q] += s * n0 * n1 + k * t0 * t1
        block[4, q] += s * n0 * n2 + k * t0 * t2
        block[5, q] += s * n1 * n2 + k * t1 * t2


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _add_diagonal(A, row, b):  # type: ignore[no-untyped-def]
    for q in range(b.shape[1]):
        A[row, 0, q] += b[0, q]
        A[row + 1, 0, q] += b[1, q]
        A[row + 2, 0, q] += b[2, q]
        A[row + 1, 1, q] += b[3, q]
        A[row + 2, 2, q] += b[4, q]
        A[row + 2, 1, q] += b[5, q]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _subtract_coupling(A, row, b):  # type: ignore[no-untyped-def]
    """Subtract the block from rows row … row + 2, columns three before."""
    for q in range(b.shape[1]):
        A[row, 3, q] -= b[0, q]
        A[row, 2, q] -= b[3, q]
        A[row, 1, q] -= b[4, q]
        A[row + 1, 4, q] -= b[3, q]
        A[row + 1, 3, q] -= b[1, q]
        A[row + 1, 2, q] -= b[5, q]
        A[row + 2, 5, q] -= b[4, q]
        A[row + 2, 4, q] -= b[5, q]
        A[row + 2, 3, q] -= b[2, q]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _bending_tangent(C, t, length, A):  # type: ignore[no-untyped-def]
    """kb (g gᵀ/3 + PᵀP-like part) of nearly straight joints: kb Σ over directions across the line (symmetric, positive).

    For small angles the exact tangent tends to kb aᵀ(I - t tᵀ)a with a = (1/lj, -1/lj - 1/lk, 1/lk).
    """
    N, _, Q = t.shape
    w, s = np.empty((3, Q)), np.empty((6, Q))
    for i in range(1, N):
        for q in range(Q):
            w[0, q] = 1.0 / length[i - 1, q]
            w[2, q] = 1.0 / length[i, q]
            w[1, q] = -w[0, q] - w[2, q]
            t0 = 0.5 * (t[i - 1, 0, q] + t[i, 0, q])
            t1 = 0.5 * (t[i - 1, 1, q] + t[i, 1, q])
            t2 = 0.5 * (t[i - 1, 2, q] + t[i, 2, q])
            size = 1.0 / max(t0 * t0 + t1 * t1 + t2 * t2, 1e-6)
            k = C[i, KB, q]
            s[0, q], s[1, q], s[2, q] = (
                k * (1.0 - size * t0 * t0),
                k * (1.0 - size * t1 * t1),
                k * (1.0 - size * t2 * t2),
            )
            s[3, q], s[4, q], s[5, q] = -k * size * t0 * t1, -k * size * t0 * t2, -k * size * t1 * t2
        for n in range(3):
            for m in range(n + 1):
                row, shift = 3 * (i - 1 + n), 3 * (n - m)
                for p in range(3):
                    for c in range(3):
                        d = shift + p - c
                        if d < 0:
                            continue
                        k = p if p == c else p + c + 2
                        for q in range(Q):
                            A[row + p, d, q] += w[n, q] * w[m, q] * s[k, q]
