"""The vessel in a step: its loads, its six equations with the lines condensed onto them, its memory (T2, T5, T6)."""

from __future__ import annotations

import numpy as np
from numba import njit

from .ends import arm_now
from .lanes import FAST
from .waves import force_at


@njit(cache=True)
def vessel_matrix(lines, body, work, m, d):  # type: ignore[no-untyped-def]
    """Factor the vessel's 6×6 of every seed, its factored lines condensed onto it (T2)."""
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
def _add_line(lines, body, work, q, V):  # type: ignore[no-untyped-def]
    """Add n GᵀSG of one lane, S the Schur complement left at its end b."""
    row = work.A.shape[0] - 3
    S, G = np.empty((3, 3)), np.zeros((3, 6))
    for p in range(3):
        for r in range(p + 1):
            S[p, r] = work.A[row + p, p - r, q]
            S[r, p] = S[p, r]
    r0, r1, r2 = arm_now(lines, body, work, q)
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
def lu_solve(V, b):  # type: ignore[no-untyped-def]
    for i in range(6):
        for j in range(i):
            b[i] -= V[i, j] * b[j]
    for i in range(5, -1, -1):
        for j in range(i + 1, 6):
            b[i] -= V[i, j] * b[j]
        b[i] /= V[i, i]


@njit(cache=True)
def vessel_residual(body, sea, memory, state, work, seed, time, since, factor_, out):  # type: ignore[no-untyped-def]
    """Loads less inertia on the vessel of a seed, without its lines (T5, T6). `since`: time since the last sample."""
    force_at(sea, time, seed, factor_, out)
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
                value -= 0.5 * since * memory.newest[p, r] * (work.svt[seed, r] + state.past[seed, r])
        out[p] += value


@njit(cache=True)
def line_loads(lines, body, work, seed, out):  # type: ignore[no-untyped-def]
    """Add n Gᵀ times what reaches end b of every lane of a seed (in the last rows of b)."""
    row = work.b.shape[0] - 3
    for q in range(seed * lines.lines, (seed + 1) * lines.lines):
        if lines.kind[q] == 1:
            f0, f1, f2 = (
                lines.number[q] * work.b[row, q],
                lines.number[q] * work.b[row + 1, q],
                lines.number[q] * work.b[row + 2, q],
            )
            r0, r1, r2 = arm_now(lines, body, work, q)
            out[0] += f0
            out[1] += f1
            out[2] += f2
            out[3] += r1 * f2 - r2 * f1
            out[4] += r2 * f0 - r0 * f2
            out[5] += r0 * f1 - r1 * f0


@njit(cache=True, fastmath=FAST, error_model="numpy")
def remember(memory, state, h):  # type: ignore[no-untyped-def]
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
