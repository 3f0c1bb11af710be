"""Where the ends of the lines are: prescribed, fixed, or on the vessel (docs/theory.md, T4, T5)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .waves import ramp


@njit(cache=True)
def fairlead(body, lines, s, sv, sa, q, x, v, a):  # type: ignore[no-untyped-def]
    """Position, velocity, acceleration of the fairlead of lane q into the three (3,) arrays, and its arm (T5)."""
    r0, r1, r2 = lines.arm[0, q], lines.arm[1, q], lines.arm[2, q]
    if body.finite:
        r0, r1, r2 = turn(s[3], s[4], s[5], r0, r1, r2)
        x[0], x[1], x[2] = r0 - lines.arm[0, q], r1 - lines.arm[1, q], r2 - lines.arm[2, q]
    else:
        x[0], x[1], x[2] = s[4] * r2 - s[5] * r1, s[5] * r0 - s[3] * r2, s[3] * r1 - s[4] * r0
    w0, w1, w2 = sv[3], sv[4], sv[5]
    u0, u1, u2 = w1 * r2 - w2 * r1, w2 * r0 - w0 * r2, w0 * r1 - w1 * r0
    for p in range(3):
        x[p] += body.point[p, q] + s[p]
    v[0], v[1], v[2] = sv[0] + u0, sv[1] + u1, sv[2] + u2
    a[0] = sa[0] + sa[4] * r2 - sa[5] * r1
    a[1] = sa[1] + sa[5] * r0 - sa[3] * r2
    a[2] = sa[2] + sa[3] * r1 - sa[4] * r0
    if body.finite:
        a[0] += w1 * u2 - w2 * u1
        a[1] += w2 * u0 - w0 * u2
        a[2] += w0 * u1 - w1 * u0
    return r0, r1, r2


@njit(cache=True)
def turn(a0, a1, a2, r0, r1, r2):  # type: ignore[no-untyped-def]
    """A vector turned by a rotation vector (Rodrigues)."""
    angle2 = a0 * a0 + a1 * a1 + a2 * a2
    if angle2 < 1e-12:
        s, c = 1.0 - angle2 / 6.0, 0.5
    else:
        angle = math.sqrt(angle2)
        s, c = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle2
    c0, c1, c2 = a1 * r2 - a2 * r1, a2 * r0 - a0 * r2, a0 * r1 - a1 * r0
    return (
        r0 + s * c0 + c * (a1 * c2 - a2 * c1), r1 + s * c1 + c * (a2 * c0 - a0 * c2), r2 + s * c2 + c * (a0 * c1 - a1 * c0)
    )  # fmt: skip


@njit(cache=True)
def prescribe(lines, base, time, build_up, x, v, a):  # type: ignore[no-untyped-def]
    """Write prescribed motion about `base` (2, 3, Q), end b and end a, at a time (T4); the ends' nodes are given."""
    f, df, ddf = ramp(time, build_up)
    w = lines.omega[0]
    c, s = math.cos(w * time), math.sin(w * time)
    for e in range(2):
        for q in range(x.shape[2]):
            if e == 0 and lines.kind[q] == 1:
                continue
            for p in range(3):
                u = lines.phasor[0, 3 * e + p, q] * c - lines.phasor[1, 3 * e + p, q] * s
                du = -w * (lines.phasor[0, 3 * e + p, q] * s + lines.phasor[1, 3 * e + p, q] * c)
                x[e, p, q] = base[e, p, q] + f * u
                v[e, p, q] = df * u + f * du
                a[e, p, q] = ddf * u + 2.0 * df * du - f * w * w * u


@njit(cache=True)
def write_fairleads(lines, body, s, sv, sa, x, v, a):  # type: ignore[no-untyped-def]
    """Write the end b of every lane that hangs on the vessel."""
    last = x.shape[0] - 1
    px, pv, pa = np.empty(3), np.empty(3), np.empty(3)
    for q in range(x.shape[2]):
        if lines.kind[q] == 1:
            seed = q // lines.lines
            fairlead(body, lines, s[seed], sv[seed], sa[seed], q, px, pv, pa)
            for p in range(3):
                x[last, p, q], v[last, p, q], a[last, p, q] = px[p], pv[p], pa[p]


@njit(cache=True)
def write_prescribed(lines, base, time, build_up, x, v, a, ends):  # type: ignore[no-untyped-def]
    """Write the prescribed and fixed ends. ends (3, 2, 3, Q) is scratch."""
    prescribe(lines, base, time, build_up, ends[0], ends[1], ends[2])
    last = x.shape[0] - 1
    for q in range(x.shape[2]):
        for p in range(3):
            if lines.kind[q] == 0:
                x[last, p, q], v[last, p, q], a[last, p, q] = ends[0, 0, p, q], ends[1, 0, p, q], ends[2, 0, p, q]
            i = int(lines.bottom[q])
            x[i, p, q], v[i, p, q], a[i, p, q] = ends[0, 1, p, q], ends[1, 1, p, q], ends[2, 1, p, q]


@njit(cache=True)
def arm_now(lines, body, work, q):  # type: ignore[no-untyped-def]
    seed = q // lines.lines
    r0, r1, r2 = lines.arm[0, q], lines.arm[1, q], lines.arm[2, q]
    if body.finite:
        return turn(work.st[seed, 3], work.st[seed, 4], work.st[seed, 5], r0, r1, r2)
    return r0, r1, r2
