"""One compiled march of a block of seeds through a block of time steps (docs/theory.md, T1-T9)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from .lanes import FAST, backward, elements, factor, forward, inner_forces, outer_forces, sharp, tangent

Array = np.ndarray
OK, FAILED, SHARP = 0, 1, 2
MOST_HALVINGS = 4


class Lines(NamedTuple):
    """Constants of Q lanes; lane q belongs to seed q // lines. P nodes of which the first may be padding."""

    C: Array  # (N, 12, Q) elements
    D: Array  # (P, 8, Q) nodes
    free: Array  # (P, Q) 1 where a node moves by itself, 0 where it is fixed, prescribed or on the vessel
    wet: Array  # (P, 2, Q) wet shares at the static position, used where a node is far from the surface
    near: Array  # (P,) whether the wet share is found anew in every step
    current: Array  # (P, 3, Q)
    seabed: Array  # (2,) 1/transition, height
    kind: Array  # (Q,) end b: 0 fixed or prescribed, 1 on the vessel
    arm: Array  # (3, Q) fairlead from the CG at the static position
    number: Array  # (Q,) real lines the lane stands for
    phasor: Array  # (2, 6, Q) cosine and sine part of prescribed motion of end b and end a
    omega: Array  # (1,) its frequency
    bottom: Array  # (Q,) node of end a; nodes below it are padding
    lines: int
    first_wave: int


class Body(NamedTuple):
    """The vessel about its static position, frame axes."""

    M: Array  # (6, 6) mass with constant added mass
    B: Array  # (6, 6) linear damping
    quadratic: Array  # (6,)
    K: Array  # (6, 6) hydrostatic stiffness
    Kg: Array  # (6, 6) geometric stiffness, for Newton's matrix only
    steady: Array  # (6,) load that balances the lines at the static position
    point: Array  # (3, Q) fairleads at the static position
    finite: bool
    exists: bool


class Sea(NamedTuple):
    """Loads on even time grids that repeat after their last entry."""

    force: Array  # (T, S, 6) on the vessel
    force_step: float
    water: Array  # (T', P - first_wave, 6, Q) float32
    water_step: float


class Memory(NamedTuple):
    """Retardation functions on the coarse grid of the memory (docs/theory.md, T6); no columns without memory."""

    rows: Array  # (12, 6J) weights of the samples, newest first: force at the newest, then one interval later
    at_zero: Array  # (6, 6) K(0)
    every: int  # steps between samples


class State(NamedTuple):
    """Everything that moves, at one time; a copy of it is a checkpoint."""

    x: Array  # (P, 3, Q)
    v: Array
    a: Array
    da: Array  # change of a over the last step, for the predictor
    s: Array  # (S, 6) vessel from its static position
    sv: Array
    sa: Array
    sda: Array
    past: Array  # (S, 6J) velocities at the samples of the memory, newest first
    lag: Array  # (2, S, 6) memory force at the last sample, and its slope


class Work(NamedTuple):
    """Scratch of one block."""

    A: Array  # (3P, 9, Q)
    b: Array  # (3P, Q)
    res: Array  # (P, 3, Q)
    dx: Array  # (P, 3, Q)
    xt: Array
    vt: Array
    at: Array
    t: Array  # (N, 3, Q)
    length: Array  # (N, Q)
    wet: Array  # (P, 2, Q)
    water: Array  # (P - first_wave, 6, Q)
    V: Array  # (S, 6, 6)
    ds: Array  # (S, 6)
    rs: Array  # (S, 6)
    st: Array  # (S, 6)
    svt: Array
    sat: Array


@njit(cache=True)
def ramp(time, build_up):  # type: ignore[no-untyped-def]
    """Load factor and its two time derivatives: a smooth rise from -build_up over half of it; 1 without build-up."""
    span = 0.5 * build_up
    u = (time + build_up) / span if span > 0.0 else 1.0
    if u >= 1.0:
        return 1.0, 0.0, 0.0
    if u <= 0.0:
        return 0.0, 0.0, 0.0
    value = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
    slope = 30.0 * u * u * (1.0 - u) ** 2 / span
    bend = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (span * span)
    return value, slope, bend


@njit(cache=True)
def _cubic(position):  # type: ignore[no-untyped-def]
    """Lower index and the four Lagrange weights of points at -1, 0, 1, 2."""
    lower = math.floor(position)
    u = position - lower
    return (
        int(lower), -u * (u - 1.0) * (u - 2.0) / 6.0, (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
        -(u + 1.0) * u * (u - 2.0) / 2.0, (u + 1.0) * u * (u - 1.0) / 6.0,
    )  # fmt: skip


@njit(cache=True, fastmath=FAST)
def water_at(sea, time, factor, out):  # type: ignore[no-untyped-def]
    """Water velocity and acceleration at the upper nodes at a time into out."""
    T = sea.water.shape[0]
    if T == 0 or out.size == 0:
        out[:] = 0.0
        return
    lower, w0, w1, w2, w3 = _cubic(time / sea.water_step)
    a, b = sea.water[(lower - 1) % T].ravel(), sea.water[lower % T].ravel()
    c, d = sea.water[(lower + 1) % T].ravel(), sea.water[(lower + 2) % T].ravel()
    flat = out.ravel()
    w0, w1, w2, w3 = w0 * factor, w1 * factor, w2 * factor, w3 * factor
    for k in range(flat.size):
        flat[k] = w0 * a[k] + w1 * b[k] + w2 * c[k] + w3 * d[k]


@njit(cache=True)
def _force_at(sea, time, s, factor, out):  # type: ignore[no-untyped-def]
    T = sea.force.shape[0]
    lower, w0, w1, w2, w3 = _cubic(time / sea.force_step)
    for p in range(6):
        value = w0 * sea.force[(lower - 1) % T, s, p] + w1 * sea.force[lower % T, s, p]
        out[p] = factor * (value + w2 * sea.force[(lower + 1) % T, s, p] + w3 * sea.force[(lower + 2) % T, s, p])


@njit(cache=True)
def fairlead(body, lines, s, sv, sa, q, x, v, a):  # type: ignore[no-untyped-def]
    """Position, velocity, acceleration of the fairlead of lane q into the three (3,) arrays, and its arm (T5)."""
    r0, r1, r2 = lines.arm[0, q], lines.arm[1, q], lines.arm[2, q]
    if body.finite:
        r0, r1, r2 = _turn(s[3], s[4], s[5], r0, r1, r2)
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
def _turn(a0, a1, a2, r0, r1, r2):  # type: ignore[no-untyped-def]
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


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _kinematics(state, work, table, tau):  # type: ignore[no-untyped-def]
    """Positions, velocities and accelerations at t + τ from the displacements of the step (T1)."""
    dx, x, v, a = work.dx.ravel(), state.x.ravel(), state.v.ravel(), state.a.ravel()
    xt, vt, at = work.xt.ravel(), work.vt.ravel(), work.at.ravel()
    v0, v1, v2 = table[1] / tau, table[2], table[3] * tau
    a0, a1, a2 = table[4] / (tau * tau), table[5] / tau, table[6]
    for k in range(dx.size):
        xt[k] = x[k] + dx[k]
    for k in range(dx.size):
        vt[k] = v0 * dx[k] + v1 * v[k] + v2 * a[k]
    for k in range(dx.size):
        at[k] = a0 * dx[k] + a1 * v[k] + a2 * a[k]
    for k in range(work.ds.shape[0]):
        for p in range(6):
            d = work.ds[k, p]
            work.st[k, p] = state.s[k, p] + d
            work.svt[k, p] = v0 * d + v1 * state.sv[k, p] + v2 * state.sa[k, p]
            work.sat[k, p] = a0 * d + a1 * state.sv[k, p] + a2 * state.sa[k, p]


@njit(cache=True)
def _fairleads(lines, body, s, sv, sa, x, v, a):  # type: ignore[no-untyped-def]
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
def _prescribed(lines, base, time, build_up, x, v, a, ends):  # type: ignore[no-untyped-def]
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
def _wet(lines, x, wet):  # type: ignore[no-untyped-def]
    """Wet shares of half elements of nodes near the surface (L7)."""
    P, Q = x.shape[0], x.shape[2]
    for i in range(P):
        if not lines.near[i]:
            continue
        for side in range(2):
            other = i - 1 + 2 * side
            if other < 0 or other >= P:
                continue
            for q in range(Q):
                z, mid = x[i, 2, q], 0.5 * (x[i, 2, q] + x[other, 2, q])
                low, high = min(z, mid), max(z, mid)
                if high <= 0.0:
                    wet[i, side, q] = 1.0
                elif low >= 0.0:
                    wet[i, side, q] = 0.0
                else:
                    wet[i, side, q] = -low / (high - low)


@njit(cache=True)
def residual(lines, work, x, v, a, out):  # type: ignore[no-untyped-def]
    """Forces less inertia on every node into out (P, 3, Q)."""
    elements(x, lines.C, work.t, work.length)
    _wet(lines, x, work.wet)
    inner_forces(x, lines.C, work.t, work.length, out)
    outer_forces(
        x, v, a, lines.C, lines.D, work.t, lines.seabed, work.wet, work.water, lines.first_wave, lines.current, out
    )


@njit(cache=True)
def _refresh(lines, body, state, work, table, tau):  # type: ignore[no-untyped-def]
    """Newton's matrix at the present guess: lines factored down to end b, then the vessel's 6×6 factored (T2)."""
    m, d = table[4] / (tau * tau), table[1] / tau
    tangent(
        work.xt, work.vt, lines.C, lines.D, work.t, work.length, lines.seabed, work.wet, work.water, lines.first_wave,
        lines.current, m, d, work.A,
    )  # fmt: skip
    P, Q = work.xt.shape[0], work.xt.shape[2]
    for i in range(P - 1):
        for q in range(Q):
            if lines.free[i, q] == 0.0:
                for p in range(3):
                    work.A[3 * i + p, 0, q] += 1e25
    factor(work.A, 0, 3 * (P - 1))
    if not body.exists:
        return
    for seed in range(work.V.shape[0]):
        V = work.V[seed]
        for p in range(6):
            for r in range(6):
                V[p, r] = m * body.M[p, r] + d * body.B[p, r] + body.K[p, r] + body.Kg[p, r]
            V[p, p] += d * 2.0 * body.quadratic[p] * abs(work.svt[seed, p])
        for q in range(seed * lines.lines, (seed + 1) * lines.lines):
            if lines.kind[q] == 1:
                _add_line(lines, body, work, q, V)
        _lu(V)


@njit(cache=True)
def _arm(lines, body, work, q):  # type: ignore[no-untyped-def]
    seed = q // lines.lines
    r0, r1, r2 = lines.arm[0, q], lines.arm[1, q], lines.arm[2, q]
    if body.finite:
        return _turn(work.st[seed, 3], work.st[seed, 4], work.st[seed, 5], r0, r1, r2)
    return r0, r1, r2


@njit(cache=True)
def _add_line(lines, body, work, q, V):  # type: ignore[no-untyped-def]
    """Add n GᵀSG of one lane, S the Schur complement left at its end b."""
    row = work.A.shape[0] - 3
    S, G = np.empty((3, 3)), np.zeros((3, 6))
    for p in range(3):
        for r in range(p + 1):
            S[p, r] = work.A[row + p, p - r, q]
            S[r, p] = S[p, r]
    r0, r1, r2 = _arm(lines, body, work, q)
    G[0, 0] = G[1, 1] = G[2, 2] = 1.0
    G[0, 4], G[0, 5], G[1, 3], G[1, 5], G[2, 3], G[2, 4] = r2, -r1, -r2, r0, r1, -r0
    for i in range(6):
        for j in range(6):
            total = 0.0
            for p in range(3):
                for r in range(3):
                    total += G[p, i] * S[p, r] * G[r, j]
            V[i, j] += lines.number[q] * total


@njit(cache=True)
def _lu(V):  # type: ignore[no-untyped-def]
    """LU in place without pivoting: mass and stiffness make the matrix near symmetric and positive."""
    for k in range(6):
        for i in range(k + 1, 6):
            V[i, k] /= V[k, k]
            for j in range(k + 1, 6):
                V[i, j] -= V[i, k] * V[k, j]


@njit(cache=True)
def _lu_solve(V, b):  # type: ignore[no-untyped-def]
    for i in range(6):
        for j in range(i):
            b[i] -= V[i, j] * b[j]
    for i in range(5, -1, -1):
        for j in range(i + 1, 6):
            b[i] -= V[i, j] * b[j]
        b[i] /= V[i, i]


@njit(cache=True)
def _vessel_residual(body, sea, memory, state, work, seed, time, since, factor_, out):  # type: ignore[no-untyped-def]
    """Loads less inertia on the vessel of a seed, without its lines (T5, T6). `since`: time since the last sample."""
    _force_at(sea, time, seed, factor_, out)
    has_memory = memory.rows.shape[1] > 0
    for p in range(6):
        rate = work.svt[seed, p]
        value = body.steady[p] - body.quadratic[p] * abs(rate) * rate
        for r in range(6):
            value -= (
                body.K[p, r] * work.st[seed, r] + body.M[p, r] * work.sat[seed, r] + body.B[p, r] * work.svt[seed, r]
            )
        if has_memory:
            value -= state.lag[0, seed, p] + since * state.lag[1, seed, p]
            for r in range(6):
                value -= (
                    0.5
                    * since
                    * (memory.at_zero[p, r] * work.svt[seed, r] + memory.at_zero[p, r] * state.past[seed, r])
                )
        out[p] += value


@njit(cache=True)
def _line_loads(lines, body, work, seed, out):  # type: ignore[no-untyped-def]
    """Add n Gᵀ times what reaches end b of every lane of a seed (in the last rows of b)."""
    row = work.b.shape[0] - 3
    for q in range(seed * lines.lines, (seed + 1) * lines.lines):
        if lines.kind[q] == 1:
            f0, f1, f2 = (
                lines.number[q] * work.b[row, q],
                lines.number[q] * work.b[row + 1, q],
                lines.number[q] * work.b[row + 2, q],
            )
            r0, r1, r2 = _arm(lines, body, work, q)
            out[0] += f0
            out[1] += f1
            out[2] += f2
            out[3] += r1 * f2 - r2 * f1
            out[4] += r2 * f0 - r0 * f2
            out[5] += r0 * f1 - r1 * f0


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _right_hand_side(lines, work):  # type: ignore[no-untyped-def]
    P, Q = work.res.shape[0], work.res.shape[2]
    for i in range(P):
        for p in range(3):
            for q in range(Q):
                work.b[3 * i + p, q] = work.res[i, p, q] * lines.free[i, q]
    for p in range(3):
        for q in range(Q):
            if lines.kind[q] == 1:
                work.b[3 * P - 3 + p, q] = work.res[P - 1, p, q]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _correct(lines, body, work, going):  # type: ignore[no-untyped-def]
    """Give the vessel's correction to the fairleads, finish the lines, and add it all in the lanes that are going."""
    row = work.b.shape[0] - 3
    Q = work.b.shape[1]
    for q in range(Q):
        e0, e1, e2 = 0.0, 0.0, 0.0
        if lines.kind[q] == 1:
            e = work.rs[q // lines.lines]
            r0, r1, r2 = _arm(lines, body, work, q)
            e0, e1, e2 = e[0] + e[4] * r2 - e[5] * r1, e[1] + e[5] * r0 - e[3] * r2, e[2] + e[3] * r1 - e[4] * r0
        work.b[row, q], work.b[row + 1, q], work.b[row + 2, q] = e0, e1, e2
    backward(work.A, work.b, 0, row)
    flat = work.dx.reshape(work.b.shape)
    for i in range(row):
        for q in range(Q):
            flat[i, q] += work.b[i, q] if going[q] > 0.0 else 0.0
    for seed in range(work.ds.shape[0]):
        if going[seed * lines.lines] > 0.0:
            for p in range(6):
                work.ds[seed, p] += work.rs[seed, p]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _sizes(lines, work, step, force):  # type: ignore[no-untyped-def]
    """Largest correction [m] and largest residual [N] of every lane into step and force (Q,); not a number spreads."""
    P, Q = work.res.shape[0], work.res.shape[2]
    step[:] = 0.0
    force[:] = 0.0
    wild = np.zeros(Q)
    for i in range(P - 1):
        for p in range(3):
            for q in range(Q):
                s, f = abs(work.b[3 * i + p, q]), abs(work.res[i, p, q]) * lines.free[i, q]
                step[q] = max(step[q], s)
                force[q] = max(force[q], f)
                wild[q] += (s - s) + (f - f)  # zero unless one of them is infinite or not a number
    for q in range(Q):
        step[q] += wild[q]
        force[q] += wild[q]


@njit(cache=True)
def _verdict(body, work, seed, L, steps, forces, limits):  # type: ignore[no-untyped-def]
    """1 where a seed has converged in displacement and force, 2 where it has run away, 0 where it goes on (T3)."""
    step, force = 0.0, 0.0
    for q in range(seed * L, (seed + 1) * L):
        if not steps[q] <= step:
            step = steps[q]
        if not forces[q] <= force:
            force = forces[q]
    if body.exists:
        for p in range(6):
            e = abs(work.rs[seed, p]) * (1.0 if p < 3 else 100.0)
            if not e <= step:
                step = e
    if not (step < 1e6 and force < 1e15):
        return 2
    return 1 if step < limits[0] and force < limits[1] else 0


@njit(cache=True)
def advance(lines, body, sea, memory, state, work, base, table, time, h, since, build_up, limits, done, refresh):  # type: ignore[no-untyped-def]
    """One step of length h of every seed with done = 0; sets done to 1 where it converged, 2 where it did not (T1-T3).

    limits : tolerance in displacement [m], in force [N], most iterations. Returns iterations used. The state of a seed
    moves only when its step converged.
    """
    tau = table[0] * h
    S, Q, L = work.ds.shape[0], work.b.shape[1], lines.lines
    going, moves, steps, forces = np.zeros(Q), np.zeros(Q), np.zeros(Q), np.zeros(Q)
    for q in range(Q):
        going[q] = 1.0 if done[q // L] == 0 else 0.0
    _predict(state, work, table[0], tau)
    load = ramp(time + tau, build_up)[0]
    water_at(sea, time + tau, load, work.water)
    ends = np.empty((3, 2, 3, Q))
    used = 0
    for iteration in range(int(limits[2])):
        used = iteration + 1
        _kinematics(state, work, table, tau)
        _prescribed(lines, base, time + tau, build_up, work.xt, work.vt, work.at, ends)
        if body.exists:
            _fairleads(lines, body, work.st, work.svt, work.sat, work.xt, work.vt, work.at)
        residual(lines, work, work.xt, work.vt, work.at, work.res)
        if iteration == 0 and refresh:
            _refresh(lines, body, state, work, table, tau)
        _right_hand_side(lines, work)
        forward(work.A, work.b, 0, work.b.shape[0] - 3)
        if body.exists:
            for seed in range(S):
                _vessel_residual(body, sea, memory, state, work, seed, time + tau, since + tau, load, work.rs[seed])
                _line_loads(lines, body, work, seed, work.rs[seed])
                _lu_solve(work.V[seed], work.rs[seed])
        _correct(lines, body, work, going)
        _sizes(lines, work, steps, forces)
        left = 0
        for seed in range(S):
            if done[seed] != 0:
                continue
            done[seed] = _verdict(body, work, seed, L, steps, forces, limits)
            if done[seed] == 0:
                left += 1
            else:
                for q in range(seed * L, (seed + 1) * L):
                    going[q] = 0.0
                    moves[q] = 1.0 if done[seed] == 1 else 0.0
        if left == 0:
            break
    for seed in range(S):
        if done[seed] == 0:
            done[seed] = 2
    _kinematics(state, work, table, tau)
    _finish(lines, body, state, work, base, table[0], time, h, build_up, moves, ends)
    return used


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _predict(state, work, theta, tau):  # type: ignore[no-untyped-def]
    """First guess of the step: the acceleration keeps changing as it did (T3)."""
    dx, v, a, da = work.dx.ravel(), state.v.ravel(), state.a.ravel(), state.da.ravel()
    half, sixth = 0.5 * tau * tau, theta * tau * tau / 6.0
    for k in range(dx.size):
        dx[k] = v[k] * tau + a[k] * half + da[k] * sixth
    for k in range(work.ds.shape[0]):
        for p in range(6):
            work.ds[k, p] = state.sv[k, p] * tau + state.sa[k, p] * half + state.sda[k, p] * sixth


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _finish(lines, body, state, work, base, theta, time, h, build_up, moves, ends):  # type: ignore[no-untyped-def]
    """Move the lanes that converged to t + h (T1). moves : (Q,) 1 for those lanes."""
    P, Q = work.xt.shape[0], work.xt.shape[2]
    inverse = 1.0 / theta
    for i in range(P):
        for p in range(3):
            for q in range(Q):
                go = moves[q] > 0.0
                x, v, a = state.x[i, p, q], state.v[i, p, q], state.a[i, p, q]
                da = (work.at[i, p, q] - a) * inverse
                state.x[i, p, q] = x + h * (v + h * (0.5 * a + da / 6.0)) if go else x
                state.v[i, p, q] = v + h * (a + 0.5 * da) if go else v
                state.a[i, p, q] = a + da if go else a
                state.da[i, p, q] = da if go else state.da[i, p, q]
    for seed in range(work.ds.shape[0]):
        if moves[seed * lines.lines] > 0.0:
            for p in range(6):
                da = (work.sat[seed, p] - state.sa[seed, p]) * inverse
                state.s[seed, p] += h * (state.sv[seed, p] + h * (0.5 * state.sa[seed, p] + da / 6.0))
                state.sv[seed, p] += h * (state.sa[seed, p] + 0.5 * da)
                state.sa[seed, p] += da
                state.sda[seed, p] = da
    # ends are written, never integrated
    _prescribed(lines, base, time + h, build_up, work.xt, work.vt, work.at, ends)
    if body.exists:
        _fairleads(lines, body, state.s, state.sv, state.sa, work.xt, work.vt, work.at)
    for q in range(Q):
        if moves[q] > 0.0:
            for p in range(3):
                for i in (int(lines.bottom[q]), P - 1):
                    state.x[i, p, q], state.v[i, p, q], state.a[i, p, q] = (
                        work.xt[i, p, q],
                        work.vt[i, p, q],
                        work.at[i, p, q],
                    )
                    state.da[i, p, q] = 0.0


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _remember(memory, state, h):  # type: ignore[no-untyped-def]
    """Take a sample of the vessel's velocity and renew the memory force and its slope (T6)."""
    S, n = state.past.shape
    for seed in range(S):
        past = state.past[seed]
        for k in range(n - 1, 5, -1):
            past[k] = past[k - 6]
        for p in range(6):
            past[p] = state.sv[seed, p]
        for p in range(6):
            now, later = memory.rows[p], memory.rows[6 + p]
            first, second = 0.0, 0.0
            for k in range(n):
                first += now[k] * past[k]
            for k in range(n):
                second += later[k] * past[k]
            state.lag[0, seed, p] = first
            state.lag[1, seed, p] = (second - first) / (memory.every * h)


@njit(cache=True, nogil=True)
def march(
    lines,
    body,
    sea,
    memory,
    state,
    work,
    spare,
    base,
    table,
    first,
    count,
    h,
    build_up,
    limits,
    every,
    out,
    seen,
    counts,
):  # type: ignore[no-untyped-def]
    """`count` steps from step number `first`; time 0 ends the build-up.

    every : steps between outputs, the first of them that long after time 0. out : vessel (n, S, 6), tension (n, N, Q)
    float32, ends (n, 2, Q) of this block.
    seen : (2, N, Q) least and largest tension so far; counts : (3,) iterations, retried steps, outputs written.
    Returns (status, step, seed).
    """
    S = work.ds.shape[0]
    done = np.zeros(S, dtype=np.int64)
    begins = round(build_up / h)
    for k in range(first, first + count):
        time = -build_up + k * h
        if memory.rows.shape[1] > 0 and k % memory.every == 0:
            _remember(memory, state, h)
        since = (k % max(memory.every, 1)) * h
        done[:] = 0
        counts[0] += advance(
            lines,
            body,
            sea,
            memory,
            state,
            work,
            base,
            table,
            time,
            h,
            since,
            build_up,
            limits,
            done,
            k % int(limits[3]) == 0,
        )
        for seed in range(S):
            if done[seed] == 2:
                counts[1] += 1
                if not _retry(
                    lines, body, sea, memory, state, spare, base, table, time, h, since, build_up, limits, seed
                ):
                    return FAILED, k, seed
        elements(state.x, lines.C, work.t, work.length)
        if sharp(state.x, lines.C, work.t):
            return SHARP, k, 0
        if time + h > 1e-9 * h:
            _extremes(lines, work, seen)
        kept = k + 1 - begins
        if kept > 0 and kept % every == 0:
            _write(lines, body, sea, state, work, time + h, build_up, out, int(counts[2]))
            counts[2] += 1
    return OK, first + count, 0


@njit(cache=True)
def _retry(lines, body, sea, memory, state, spare, base, table, time, h, since, build_up, limits, seed):  # type: ignore[no-untyped-def]
    """The step of one seed in 2, 4, … 2^MOST_HALVINGS parts; True when it got through."""
    S = spare.ds.shape[0]
    x, v, a, da = state.x.copy(), state.v.copy(), state.a.copy(), state.da.copy()
    s, sv, sa, sda = state.s.copy(), state.sv.copy(), state.sa.copy(), state.sda.copy()
    done = np.ones(S, dtype=np.int64)
    for halving in range(1, MOST_HALVINGS + 1):
        parts = 2**halving
        good = True
        for part in range(parts):
            done[:] = 1
            done[seed] = 0
            small = h / parts
            advance(
                lines, body, sea, memory, state, spare, base, table, time + part * small, small, since + part * small, build_up,
                limits, done, True,
            )  # fmt: skip
            if done[seed] != 1:
                good = False
                break
        if good:
            return True
        state.x[:], state.v[:], state.a[:], state.da[:] = x, v, a, da
        state.s[:], state.sv[:], state.sa[:], state.sda[:] = s, sv, sa, sda
    return False


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _extremes(lines, work, seen):  # type: ignore[no-untyped-def]
    N, Q = work.length.shape
    for j in range(N):
        for q in range(Q):
            T = lines.C[j, 1, q] * (work.length[j, q] / lines.C[j, 0, q] - 1.0)
            seen[0, j, q] = min(seen[0, j, q], T)
            seen[1, j, q] = max(seen[1, j, q], T)


@njit(cache=True)
def _write(lines, body, sea, state, work, time, build_up, out, row):  # type: ignore[no-untyped-def]
    """Vessel, element tensions and end reactions at a time."""
    N, Q = work.length.shape
    vessel, tension, ends = out
    if row >= tension.shape[0]:
        return
    vessel[row] = state.s
    for j in range(N):
        for q in range(Q):
            tension[row, j, q] = lines.C[j, 1, q] * (work.length[j, q] / lines.C[j, 0, q] - 1.0)
    water_at(sea, time, ramp(time, build_up)[0], work.water)
    residual(lines, work, state.x, state.v, state.a, work.res)
    for q in range(Q):
        for e in range(2):
            i = N if e == 0 else int(lines.bottom[q])
            total = 0.0
            for p in range(3):
                total += work.res[i, p, q] ** 2
            ends[row, e, q] = math.sqrt(total)
