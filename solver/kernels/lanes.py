"""Forces and tangents of many lines at once: lanes (line × seed) stand last in every array (docs/theory.md, T7-T9).

The same equations as `solver.forces`, laid out so that every operation runs over lanes; a test holds the two together.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

# rows of the packed element constants, shape (N, 12, Q)
EL, EA, CDN, CDT, MW, CAN, CAT, W_DRY, B_WET, KB, KBQ, ELEMENT_ROWS = range(12)
# rows of the packed node constants, shape (P, 9, Q)
MASS, A1, POINT_W, POINT_D, POINT_M, POINT_CA, BED_C, POINT_L, POINT_R, NODE_ROWS = range(10)
BAND = 9  # diagonal and eight below it
FAST = {"contract", "reassoc", "arcp", "nsz"}


@njit(cache=True, fastmath=FAST, error_model="numpy")
def elements(x, C, t, length):  # type: ignore[no-untyped-def]
    """Unit tangents (N, 3, Q) and lengths (N, Q) of all elements."""
    for j in range(length.shape[0]):
        for q in range(length.shape[1]):
            d0, d1, d2 = x[j + 1, 0, q] - x[j, 0, q], x[j + 1, 1, q] - x[j, 1, q], x[j + 1, 2, q] - x[j, 2, q]
            size = math.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
            inverse = 1.0 / size
            length[j, q] = size
            t[j, 0, q] = d0 * inverse
            t[j, 1, q] = d1 * inverse
            t[j, 2, q] = d2 * inverse


@njit(cache=True, fastmath=FAST, error_model="numpy")
def inner_forces(x, C, t, length, out):  # type: ignore[no-untyped-def]
    """Axial and bending forces, weight of the dry line and full buoyancy into out (P, 3, Q), which is overwritten (L1, L4)."""
    N, Q = length.shape
    out[:] = 0.0
    for j in range(N):
        for q in range(Q):
            T = C[j, EA, q] * (length[j, q] / C[j, EL, q] - 1.0)
            f0, f1, f2 = T * t[j, 0, q], T * t[j, 1, q], T * t[j, 2, q]
            half = 0.5 * (C[j, B_WET, q] - C[j, W_DRY, q])
            out[j, 0, q] += f0
            out[j, 1, q] += f1
            out[j, 2, q] += f2 + half
            out[j + 1, 0, q] -= f0
            out[j + 1, 1, q] -= f1
            out[j + 1, 2, q] -= f2 - half
    for i in range(1, N):
        for q in range(Q):
            j0, j1, j2 = t[i - 1, 0, q], t[i - 1, 1, q], t[i - 1, 2, q]
            k0, k1, k2 = t[i, 0, q], t[i, 1, q], t[i, 2, q]
            c = j0 * k0 + j1 * k1 + j2 * k2
            s0, s1, s2 = j1 * k2 - j2 * k1, j2 * k0 - j0 * k2, j0 * k1 - j1 * k0
            # 1 - c from the sine where the angle is small: no cancellation
            z = (s0 * s0 + s1 * s1 + s2 * s2) / (1.0 + c) if c > 0.0 else 1.0 - c
            p = C[i, KB, q] * over_sine(z)
            a, b = p / length[i - 1, q], p / length[i, q]
            m0, m1, m2 = a * (k0 - c * j0), a * (k1 - c * j1), a * (k2 - c * j2)
            n0, n1, n2 = b * (j0 - c * k0), b * (j1 - c * k1), b * (j2 - c * k2)
            out[i - 1, 0, q] -= m0
            out[i - 1, 1, q] -= m1
            out[i - 1, 2, q] -= m2
            out[i + 1, 0, q] += n0
            out[i + 1, 1, q] += n1
            out[i + 1, 2, q] += n2
            out[i, 0, q] += m0 - n0
            out[i, 1, q] += m1 - n1
            out[i, 2, q] += m2 - n2


@njit(cache=True, fastmath=FAST, error_model="numpy")
def over_sine(z):  # type: ignore[no-untyped-def]
    """θ/sin θ from z = 1 - cos θ: the hypergeometric series of arccos, good to 2e-8 below 75 degrees."""
    y = 0.5 * z
    value = 1.0
    for n in range(16, 0, -1):
        value = 1.0 + value * y * n / (n + 0.5)
    return value


@njit(cache=True)
def sharp(x, C, t):  # type: ignore[no-untyped-def]
    """Whether a joint with bending stiffness is bent by more than 75 degrees in some lane, where `over_sine` ends."""
    for i in range(1, t.shape[0]):
        for q in range(t.shape[2]):
            if C[i, KB, q] > 0.0:
                c = t[i, 0, q] * t[i - 1, 0, q] + t[i, 1, q] * t[i - 1, 1, q] + t[i, 2, q] * t[i - 1, 2, q]
                if not c > 0.25:
                    return True
    return False


@njit(cache=True, fastmath=FAST, error_model="numpy")
def outer_forces(x, v, acc, C, D, t, seabed, wet, water, first_wave, current, out):  # type: ignore[no-untyped-def]
    """Drag, inertia of water and line, seabed and attachments, added to out (P, 3, Q) (L6-L14).

    wet : (P, 2, Q) wet shares of the half elements before and after each node.
    water : (P - first_wave, 6, Q) velocity and acceleration of the water at the upper nodes; current : (P, 3, Q).
    acc : accelerations of the nodes; the inertia of the line itself is subtracted, so that out is the whole residual.
    """
    P, _, Q = x.shape
    a2, bed = seabed[0], seabed[1]
    r = np.empty((6, Q))
    for i in range(P):
        w = i - first_wave
        for q in range(Q):
            r[0, q], r[1, q], r[2, q] = (
                current[i, 0, q] - v[i, 0, q],
                current[i, 1, q] - v[i, 1, q],
                current[i, 2, q] - v[i, 2, q],
            )
            r[3, q], r[4, q], r[5, q] = 0.0, 0.0, 0.0
        if w >= 0:
            for k in range(6):
                for q in range(Q):
                    r[k, q] += water[w, k, q]
        for q in range(Q):
            m = D[i, MASS, q]
            out[i, 0, q] -= m * acc[i, 0, q]
            out[i, 1, q] -= m * acc[i, 1, q]
            out[i, 2, q] -= m * acc[i, 2, q] + D[i, POINT_W, q]
        for side in range(2):
            j = i - 1 + side
            if j < 0 or j > P - 2:
                continue
            _half_element(v, acc, C, t, wet, r, i, j, side, out)
        _attachment(D, x, acc, r, i, out)
        lowest = 1e300
        for q in range(Q):
            lowest = min(lowest, x[i, 2, q])
        if 2.0 * a2 * (lowest - bed) < 40.0:
            for q in range(Q):
                e = -2.0 * a2 * (x[i, 2, q] - bed)
                grown = math.exp(min(e, 40.0))
                depth = math.log1p(grown) if e < 40.0 else e
                out[i, 2, q] += D[i, A1, q] * depth / (2.0 * a2) - D[i, BED_C, q] * grown / (1.0 + grown) * v[i, 2, q]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _half_element(v, acc, C, t, wet, r, i, j, side, out):  # type: ignore[no-untyped-def]
    for q in range(r.shape[1]):
        t0, t1, t2 = t[j, 0, q], t[j, 1, q], t[j, 2, q]
        share = wet[i, side, q]
        along = r[0, q] * t0 + r[1, q] * t1 + r[2, q] * t2
        n0, n1, n2 = r[0, q] - along * t0, r[1, q] - along * t1, r[2, q] - along * t2
        cn = share * C[j, CDN, q] * math.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
        ct = share * C[j, CDT, q] * abs(along) * along
        # Froude-Krylov on the displaced mass, added mass on the relative acceleration
        mass = share * C[j, MW, q]
        b0, b1, b2 = r[3, q] - acc[i, 0, q], r[4, q] - acc[i, 1, q], r[5, q] - acc[i, 2, q]
        push = b0 * t0 + b1 * t1 + b2 * t2
        ka = mass * C[j, CAN, q]
        kt = ct + mass * (C[j, CAT, q] - C[j, CAN, q]) * push
        dry = 0.5 * (1.0 - share) * C[j, B_WET, q]
        out[i, 0, q] += cn * n0 + kt * t0 + ka * b0 + mass * r[3, q]
        out[i, 1, q] += cn * n1 + kt * t1 + ka * b1 + mass * r[4, q]
        out[i, 2, q] += cn * n2 + kt * t2 + ka * b2 + mass * r[5, q] - dry


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _attachment(D, x, acc, r, i, out):  # type: ignore[no-untyped-def]
    some = 0.0
    for q in range(r.shape[1]):
        some += D[i, POINT_D, q] + D[i, POINT_M, q]
    if some == 0.0:
        return
    for q in range(r.shape[1]):
        out[i, 2, q] += D[i, POINT_L, q] * min(max(0.5 * (1.0 - x[i, 2, q] / D[i, POINT_R, q]), 0.0), 1.0)
        if x[i, 2, q] < 0.0:
            size = D[i, POINT_D, q] * math.sqrt(r[0, q] ** 2 + r[1, q] ** 2 + r[2, q] ** 2)
            for p in range(3):
                out[i, p, q] += size * r[p, q] + D[i, POINT_M, q] * (
                    r[3 + p, q] + D[i, POINT_CA, q] * (r[3 + p, q] - acc[i, p, q])
                )


@njit(cache=True, fastmath=FAST, error_model="numpy")
def tangent(x, v, C, D, t, length, seabed, wet, water, first_wave, current, mass_factor, damping_factor, A):  # type: ignore[no-untyped-def]
    """Lower band of K + mass_factor M + damping_factor B into A (3P, BAND, Q), overwritten: A[i, i - j] (L2, L5, L9, L11).

    Symmetric and positive: the negative stiffness of slack elements and what drag owes to turning are left out.
    """
    P, _, Q = x.shape
    A[:] = 0.0
    a2, bed = seabed[0], seabed[1]
    block, r = np.empty((6, Q)), np.empty((3, Q))
    for j in range(P - 1):
        for q in range(Q):
            along = C[j, EA, q] / C[j, EL, q]
            across = max(along - C[j, EA, q] / length[j, q], 0.0)
            rest = along - across
            t0, t1, t2 = t[j, 0, q], t[j, 1, q], t[j, 2, q]
            block[0, q], block[1, q], block[2, q] = (
                across + rest * t0 * t0,
                across + rest * t1 * t1,
                across + rest * t2 * t2,
            )
            block[3, q], block[4, q], block[5, q] = rest * t0 * t1, rest * t0 * t2, rest * t1 * t2
        _add_diagonal(A, 3 * j, block, 1.0)
        _add_diagonal(A, 3 * j + 3, block, 1.0)
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
            m = mass_factor * (D[i, MASS, q] + D[i, POINT_M, q] * D[i, POINT_CA, q])
            m += damping_factor * 2.0 * D[i, POINT_D, q] * math.sqrt(r[0, q] ** 2 + r[1, q] ** 2 + r[2, q] ** 2)
            block[0, q], block[1, q], block[2, q] = m, m, m
            block[3, q], block[4, q], block[5, q] = 0.0, 0.0, 0.0
        for side in range(2):
            j = i - 1 + side
            if 0 <= j <= P - 2:
                _half_tangent(C, t, wet, r, i, j, side, mass_factor, damping_factor, block)
        lowest = 1e300
        for q in range(Q):
            lowest = min(lowest, x[i, 2, q])
        if 2.0 * a2 * (lowest - bed) < 40.0:
            for q in range(Q):
                share = 1.0 / (1.0 + math.exp(2.0 * a2 * (x[i, 2, q] - bed)))
                block[2, q] += share * (D[i, A1, q] + damping_factor * D[i, BED_C, q])
        _add_diagonal(A, 3 * i, block, 1.0)


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
def _add_diagonal(A, row, b, factor):  # type: ignore[no-untyped-def]
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


@njit(cache=True, fastmath=FAST, error_model="numpy")
def factor(A, first, last):  # type: ignore[no-untyped-def]
    """LDLᵀ in place of rows first … last - 1 of the lower band (rows, BAND, Q); the rows from `last` on keep the Schur
    complement. On return A[i, 0] holds 1/d of eliminated rows and A[i, k] the factor L of the column k before.
    """
    rows, _, Q = A.shape
    run = BAND * Q
    flat = A.reshape(rows, run)
    scaled = np.empty((BAND, Q))
    for k in range(first, last):
        for q in range(Q):
            flat[k, q] = 1.0 / flat[k, q]
        most = min(rows - 1 - k, BAND - 1)
        for d in range(1, most + 1):
            for q in range(Q):
                scaled[d, q] = A[k + d, d, q] * A[k, 0, q]
        for d in range(1, most + 1):
            for e in range(1, d + 1):
                for q in range(Q):
                    A[k + d, d - e, q] -= scaled[d, q] * A[k + e, e, q]
        for d in range(1, most + 1):
            for q in range(Q):
                A[k + d, d, q] = scaled[d, q]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def forward(A, b, first, last):  # type: ignore[no-untyped-def]
    """L⁻¹ of rows first … last - 1 on b (rows, Q), in place; later rows receive what reaches them."""
    rows, Q = b.shape
    for k in range(first, last):
        for d in range(1, min(rows - 1 - k, BAND - 1) + 1):
            for q in range(Q):
                b[k + d, q] -= A[k + d, d, q] * b[k, q]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def backward(A, b, first, last):  # type: ignore[no-untyped-def]
    """Finish the solution of rows last - 1 … first from those after them, which hold the answer already."""
    rows, Q = b.shape
    for k in range(last - 1, first - 1, -1):
        for q in range(Q):
            b[k, q] *= A[k, 0, q]
        for d in range(1, min(rows - 1 - k, BAND - 1) + 1):
            for q in range(Q):
                b[k, q] -= A[k + d, d, q] * b[k + d, q]
