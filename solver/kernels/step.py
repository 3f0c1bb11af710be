"""One implicit step of a block of seeds: predict, Newton, finish (docs/theory.md, T1-T3, T7)."""

from __future__ import annotations

import numpy as np
from numba import njit

from .elimination import backward, factor, forward
from .ends import arm_now, write_fairleads, write_prescribed
from .lanes import FAST, elements, inner_forces, outer_forces, wet_shares
from .tangent import tangent
from .vessel import line_loads, lu_solve, vessel_matrix, vessel_residual
from .waves import ramp, water_at, water_where

# Newton's matrix in a step: as it was, new at the start, new every RENEWAL iterations, the same with all elements taut
KEPT, RENEWED, OFTEN, TAUT = 0, 1, 2, 3
FEW = 8  # iterations with a matrix that is not renewed during the step
RENEWAL = 4


@njit(cache=True)
def advance(setup, state, work, time, h, since, done, matrix):  # type: ignore[no-untyped-def]
    """One step of length h of every seed with done = 0; sets done to 1 where it converged, 2 where it did not (T1-T3).

    since : time since the last sample of the memory; matrix : KEPT, RENEWED, OFTEN or TAUT. The state of a seed moves only when
    its step converged. Returns iterations used.
    """
    table, tau = setup.table, setup.table[0] * h
    L, Q = setup.lines.lines, work.b.shape[1]
    going, ends = np.zeros(Q), np.empty((3, 2, 3, Q))
    for q in range(Q):
        going[q] = 1.0 if done[q // L] == 0 else 0.0
    moves = going.copy()
    _predict(state, work, table[0], tau)
    load = ramp(time + tau, setup.build_up)[0]
    water_at(setup.sea, time + tau, load, work.terms)
    most, used = int(setup.limits[2]), 0
    for iteration in range(most if matrix >= OFTEN else min(FEW, most)):
        used = iteration + 1
        _kinematics(state, work, table, tau)
        write_prescribed(setup.lines, setup.base, time + tau, setup.build_up, work.xt, work.vt, work.at, ends)
        if setup.body.exists:
            write_fairleads(setup.lines, setup.body, work.st, work.svt, work.sat, work.xt, work.vt, work.at)
        water_where(setup.sea, work, work.xt, time + tau, load)
        residual(setup.lines, work, work.xt, work.vt, work.at, work.res)
        if (iteration == 0 and matrix != KEPT) or (matrix >= OFTEN and iteration % RENEWAL == 0):
            _renew(setup.lines, setup.body, work, table, tau, 1.0 if matrix == TAUT else 0.0)
        _solve(setup, state, work, time + tau, since + tau, load, going)
        if _judge(setup, work, done, going) == 0:
            break
    for q in range(Q):
        seed = q // L
        if done[seed] == 0:
            done[seed] = 2
        if done[seed] == 2:
            moves[q] = 0.0
    _kinematics(state, work, table, tau)
    _finish(setup, state, work, time + h, h, moves, ends)
    return used


@njit(cache=True)
def residual(lines, work, x, v, a, out):  # type: ignore[no-untyped-def]
    """Forces less inertia on every node into out (P, 3, Q) (T7)."""
    elements(x, lines.C, work.t, work.length)
    wet_shares(x, lines.C, work.wet)
    inner_forces(x, lines.C, work.t, work.length, out)
    outer_forces(
        x, v, a, lines.C, lines.D, work.t, lines.friction, work.wet, work.water, lines.first_wave, lines.current, out
    )


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
def _renew(lines, body, work, table, tau, least):  # type: ignore[no-untyped-def]
    """Newton's matrix at the present guess: lines factored down to end b, then the vessel's 6×6 factored (T2)."""
    m, d = table[4] / (tau * tau), table[1] / tau
    tangent(
        work.xt, work.vt, lines.C, lines.D, work.t, work.length, lines.friction, work.wet, work.water, lines.first_wave,
        lines.current, m, d, least, work.A,
    )  # fmt: skip
    P, Q = work.xt.shape[0], work.xt.shape[2]
    for i in range(P - 1):
        for q in range(Q):
            if lines.free[i, q] == 0.0:
                for p in range(3):
                    work.A[3 * i + p, 0, q] += 1e25
    factor(work.A, 0, 3 * (P - 1))
    if body.exists:
        vessel_matrix(lines, body, work, m, d)


@njit(cache=True)
def _solve(setup, state, work, time, since, load, going):  # type: ignore[no-untyped-def]
    """Newton's correction of lines and vessel from the residual, added in the lanes that are going (T2)."""
    _right_hand_side(setup.lines, work)
    forward(work.A, work.b, 0, work.b.shape[0] - 3)
    if setup.body.exists:
        for seed in range(work.ds.shape[0]):
            vessel_residual(setup.body, setup.sea, setup.memory, state, work, seed, time, since, load, work.rs[seed])
            line_loads(setup.lines, setup.body, work, seed, work.rs[seed])
            lu_solve(work.V[seed], work.rs[seed])
    _correct(setup.lines, setup.body, work, going)


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
            r0, r1, r2 = arm_now(lines, body, work, q)
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


@njit(cache=True)
def _judge(setup, work, done, going):  # type: ignore[no-untyped-def]
    """Freeze the seeds that converged (done = 1) or ran away (2); returns how many go on."""
    L, Q = setup.lines.lines, work.b.shape[1]
    steps, forces = np.zeros(Q), np.zeros(Q)
    _sizes(setup.lines, work, steps, forces)
    left = 0
    for seed in range(work.ds.shape[0]):
        if done[seed] == 0:
            done[seed] = _verdict(setup.body, work, seed, L, steps, forces, setup.limits)
            left += 1 if done[seed] == 0 else 0
            for q in range(seed * L, (seed + 1) * L):
                going[q] = 1.0 if done[seed] == 0 else 0.0
    return left


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _sizes(lines, work, step, force):  # type: ignore[no-untyped-def]
    """Largest correction [m] and largest residual [N] of every lane into step and force (Q,); not a number spreads."""
    P, Q = work.res.shape[0], work.res.shape[2]
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


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _finish(setup, state, work, time, h, moves, ends):  # type: ignore[no-untyped-def]
    """Move the lanes that converged to the end of the step, `time` (T1). moves : (Q,) 1 for those lanes."""
    _integrate(state, work, h, 1.0 / setup.table[0], moves, setup.lines.lines)
    # ends are written, never integrated
    write_prescribed(setup.lines, setup.base, time, setup.build_up, work.xt, work.vt, work.at, ends)
    if setup.body.exists:
        write_fairleads(setup.lines, setup.body, state.s, state.sv, state.sa, work.xt, work.vt, work.at)
    for q in range(work.xt.shape[2]):
        if moves[q] > 0.0:
            for i in (int(setup.lines.bottom[q]), work.xt.shape[0] - 1):
                for p in range(3):
                    state.x[i, p, q], state.v[i, p, q] = work.xt[i, p, q], work.vt[i, p, q]
                    state.a[i, p, q], state.da[i, p, q] = work.at[i, p, q], 0.0


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _integrate(state, work, h, inverse, moves, lines):  # type: ignore[no-untyped-def]
    if moves.min() > 0.0:
        _integrate_all(state.x.ravel(), state.v.ravel(), state.a.ravel(), state.da.ravel(), work.at.ravel(), h, inverse)
    else:
        _integrate_some(state, work, h, inverse, moves)
    for seed in range(work.ds.shape[0]):
        if moves[seed * lines] > 0.0:
            for p in range(6):
                da = (work.sat[seed, p] - state.sa[seed, p]) * inverse
                state.s[seed, p] += h * (state.sv[seed, p] + h * (0.5 * state.sa[seed, p] + da / 6.0))
                state.sv[seed, p] += h * (state.sa[seed, p] + 0.5 * da)
                state.sa[seed, p] += da
                state.sda[seed, p] = da


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _integrate_all(x, v, a, da, at, h, inverse):  # type: ignore[no-untyped-def]
    half, sixth = 0.5 * h * h, h * h / 6.0
    for k in range(x.size):
        change = (at[k] - a[k]) * inverse
        x[k] += h * v[k] + half * a[k] + sixth * change
        v[k] += h * a[k] + 0.5 * h * change
        a[k] += change
        da[k] = change


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _integrate_some(state, work, h, inverse, moves):  # type: ignore[no-untyped-def]
    half, sixth = 0.5 * h * h, h * h / 6.0
    for i in range(work.xt.shape[0]):
        for p in range(3):
            for q in range(work.xt.shape[2]):
                if moves[q] > 0.0:
                    a = state.a[i, p, q]
                    change = (work.at[i, p, q] - a) * inverse
                    state.x[i, p, q] += h * state.v[i, p, q] + half * a + sixth * change
                    state.v[i, p, q] += h * a + 0.5 * h * change
                    state.a[i, p, q] = a + change
                    state.da[i, p, q] = change
