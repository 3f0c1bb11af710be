"""Forces and tangents of many lines at once: lanes (line × seed) stand last in every array (docs/theory.md, T7-T9).

The same equations as `solver.forces`, laid out so that every operation runs over lanes; a test holds the two together.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .compression import released

# rows of the packed element constants, shape (N, ELEMENT_ROWS, Q)
EL, EA, CDN, CDT, MW, CAN, CAT, W_DRY, B_WET, KB, DIAMETER, LIMIT, KNEE, ELEMENT_ROWS = range(14)
# rows of the packed node constants, shape (P, NODE_ROWS, Q)
MASS, A1, POINT_W, POINT_D, POINT_M, POINT_CA, BED_C, POINT_L, POINT_R, A2, BED, NODE_ROWS = range(12)
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
def axial_force(C, length, j, q):  # type: ignore[no-untyped-def]
    """Axial force of element j in lane q (L1, L17)."""
    strain = length[j, q] / C[j, EL, q] - 1.0
    return C[j, EA, q] * (strain + released(strain, C[j, LIMIT, q], C[j, KNEE, q])[0])


@njit(cache=True, fastmath=FAST, error_model="numpy")
def axial_forces(C, length, j, T):  # type: ignore[no-untyped-def]
    """Axial force of element j in every lane into T (Q,) (L1, L17)."""
    margin = 0.0
    for q in range(T.shape[0]):
        strain = length[j, q] / C[j, EL, q] - 1.0
        T[q] = C[j, EA, q] * strain
        margin = min(margin, strain + C[j, LIMIT, q])
    if margin < 0.0:  # compressed beyond its limit in some lane
        for q in range(T.shape[0]):
            T[q] = axial_force(C, length, j, q)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def inner_forces(x, C, t, length, out):  # type: ignore[no-untyped-def]
    """Axial and bending forces, dry weight and full buoyancy into out (P, 3, Q), which is overwritten (L1, L4, L17)."""
    N, Q = length.shape
    out[:] = 0.0
    work = np.empty((2, Q))
    for j in range(N):
        axial_forces(C, length, j, work[0])
        for q in range(Q):
            T = work[0, q]
            f0, f1, f2 = T * t[j, 0, q], T * t[j, 1, q], T * t[j, 2, q]
            half = 0.5 * (C[j, B_WET, q] - C[j, W_DRY, q])
            out[j, 0, q] += f0
            out[j, 1, q] += f1
            out[j, 2, q] += f2 + half
            out[j + 1, 0, q] -= f0
            out[j + 1, 1, q] -= f1
            out[j + 1, 2, q] -= f2 - half
    for i in range(1, N):
        _bending(C, t, length, i, work[0], work[1], out)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _bending(C, t, length, i, cosine, moment, out):  # type: ignore[no-untyped-def]
    """Forces of the bent joint at node i (L4); cosine and moment are scratch (Q,)."""
    Q = length.shape[1]
    _joint_moments(C, t, i, cosine, moment)
    for q in range(Q):
        j0, j1, j2 = t[i - 1, 0, q], t[i - 1, 1, q], t[i - 1, 2, q]
        k0, k1, k2 = t[i, 0, q], t[i, 1, q], t[i, 2, q]
        c, p = cosine[q], moment[q]
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
def _joint_moments(C, t, i, cosine, moment):  # type: ignore[no-untyped-def]
    """Cosine of the angle at node i, and EI/l times the angle over its sine, of every lane (L4)."""
    Q, largest = cosine.shape[0], 0.0
    for q in range(Q):
        j0, j1, j2 = t[i - 1, 0, q], t[i - 1, 1, q], t[i - 1, 2, q]
        k0, k1, k2 = t[i, 0, q], t[i, 1, q], t[i, 2, q]
        c = j0 * k0 + j1 * k1 + j2 * k2
        s0, s1, s2 = j1 * k2 - j2 * k1, j2 * k0 - j0 * k2, j0 * k1 - j1 * k0
        # 1 - c from the sine where the angle is small: no cancellation
        z = (s0 * s0 + s1 * s1 + s2 * s2) / (1.0 + c) if c > 0.0 else 1.0 - c
        cosine[q], moment[q] = c, z
        largest = max(largest, z)
    if largest < 0.02:
        for q in range(Q):
            moment[q] = C[i, KB, q] * _series(moment[q], 7)
    else:
        for q in range(Q):
            moment[q] = C[i, KB, q] * over_sine(moment[q])


@njit(cache=True, fastmath=FAST, error_model="numpy")
def over_sine(z):  # type: ignore[no-untyped-def]
    """θ/sin θ from z = 1 - cos θ: the hypergeometric series of arccos, good to 2e-8 below 75 degrees.

    The first seven terms give it to rounding where z < 0.02 (11 degrees).
    """
    return _series(z, 16)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _series(z, terms):  # type: ignore[no-untyped-def]
    y = 0.5 * z
    value = 1.0
    for n in range(terms, 0, -1):
        value = 1.0 + value * y * (n / (n + 0.5))
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
def outer_forces(x, v, acc, C, D, t, friction, wet, water, first_wave, current, out):  # type: ignore[no-untyped-def]
    """Drag, inertia of water and line, seabed and attachments, added to out (P, 3, Q) (L6-L14).

    wet : (P, 2, Q) wet shares of the half elements before and after each node.
    water : (P - first_wave, 6, Q) velocity and acceleration of the water at the upper nodes; current : (P, 3, Q).
    acc : accelerations of the nodes; the inertia of the line itself is subtracted, so that out is the whole residual.
    """
    P, _, Q = x.shape
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
        _bed(D, x, v, friction, i, out)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def bed_force(a1, a2, height):  # type: ignore[no-untyped-def]
    """Spring force of the bed on a node, and its share in contact (L13)."""
    e = -2.0 * a2 * height
    grown = math.exp(min(e, 40.0))
    depth = math.log1p(grown) if e < 40.0 else e
    return a1 * depth / (2.0 * a2), grown / (1.0 + grown)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def clear_of_bed(D, x, i):  # type: ignore[no-untyped-def]
    """Whether node i is so far above the bed in every lane that its force is less than rounding (L13)."""
    nearest = 1e300
    for q in range(x.shape[2]):
        nearest = min(nearest, D[i, A2, q] * (x[i, 2, q] - D[i, BED, q]))
    return nearest >= 20.0


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _bed(D, x, v, friction, i, out):  # type: ignore[no-untyped-def]
    """Spring, damping and friction of the bed on a node (L13, L15)."""
    if clear_of_bed(D, x, i):
        return
    mu, slow = friction[0], friction[1]
    for q in range(x.shape[2]):
        force, share = bed_force(D[i, A1, q], D[i, A2, q], x[i, 2, q] - D[i, BED, q])
        out[i, 2, q] += force - D[i, BED_C, q] * share * v[i, 2, q]
        if mu > 0.0:
            rub = mu * force / math.sqrt(v[i, 0, q] ** 2 + v[i, 1, q] ** 2 + slow * slow)
            out[i, 0, q] -= rub * v[i, 0, q]
            out[i, 1, q] -= rub * v[i, 1, q]


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
        share = wet_point(x[i, 2, q], D[i, POINT_R, q])
        out[i, 2, q] += D[i, POINT_L, q] * share
        size = share * D[i, POINT_D, q] * math.sqrt(r[0, q] ** 2 + r[1, q] ** 2 + r[2, q] ** 2)
        for p in range(3):
            push = r[3 + p, q] + D[i, POINT_CA, q] * (r[3 + p, q] - acc[i, p, q])
            out[i, p, q] += size * r[p, q] + share * D[i, POINT_M, q] * push


@njit(cache=True, fastmath=FAST, error_model="numpy")
def wet_point(z, radius):  # type: ignore[no-untyped-def]
    """Wet share of an attachment at height z (L7)."""
    return min(max(0.5 * (1.0 - z / radius), 0.0), 1.0)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def wet_shares(x, C, wet):  # type: ignore[no-untyped-def]
    """Wet shares (P, 2, Q) of the half elements before and after each node (L7)."""
    P, _, Q = x.shape
    for j in range(P - 1):
        top, thick = -1e300, 0.0
        for q in range(Q):
            top = max(top, max(x[j, 2, q], x[j + 1, 2, q]))
            thick = max(thick, C[j, DIAMETER, q])
        if top <= -0.5 * thick:
            for q in range(Q):
                wet[j, 1, q] = 1.0
                wet[j + 1, 0, q] = 1.0
        else:
            for q in range(Q):
                one, other, D = x[j, 2, q], x[j + 1, 2, q], C[j, DIAMETER, q]
                wet[j, 1, q] = wet_half(one, other, D)
                wet[j + 1, 0, q] = wet_half(other, one, D)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def wet_half(node, other, D):  # type: ignore[no-untyped-def]
    """Wet share of the half element at a node, between its height and that of the middle (L7)."""
    rise = 0.5 * abs(other - node)
    e = 0.5 * max(D - rise, 0.0)
    return min(max((e - min(node, 0.5 * (node + other))) / max(rise + 2.0 * e, 1e-12), 0.0), 1.0)
