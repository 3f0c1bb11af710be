"""One compiled march of a block of seeds through a block of time steps (docs/theory.md, T1-T17)."""

from __future__ import annotations

import numpy as np
from numba import njit

from .arrays import FAILED, OK, SHARP
from .lanes import elements, sharp
from .record import forces_now, watch_ends, write
from .step import KEPT, OFTEN, RENEWED, TAUT, advance
from .vessel import remember
from .watch import watch_step

MOST_HALVINGS = 4


@njit(cache=True, nogil=True)
def march(setup, state, work, spare, first, count, h, every, out, watch, counts):  # type: ignore[no-untyped-def]
    """`count` steps from step number `first`; time 0 ends the build-up.

    every : steps between outputs, the first of them that long after time 0. out : vessel (n, S, 6), tension (n, N, Q)
    float32, ends (n, 6, Q) of this block (rows ENDS). counts : (3,) iterations, divided steps, outputs written.
    watch : taken from step number setup.limits[4] on, build-up or not. Returns (status, step, seed).
    """
    S = work.ds.shape[0]
    done = np.zeros(S, dtype=np.int64)
    memory, begins, renewal = setup.memory, round(setup.build_up / h), int(setup.limits[3])
    watched = int(setup.limits[4])
    for k in range(first, first + count):
        time = -setup.build_up + k * h
        if memory.rows.shape[1] > 0 and k % memory.every == 0:
            remember(memory, state, h)
        since = (k % max(memory.every, 1)) * h
        done[:] = 0
        counts[0] += advance(setup, state, work, time, h, since, done, RENEWED if k % renewal == 0 else KEPT)
        for seed in range(S):
            if done[seed] == 2:
                parts = _retry(setup, state, work, spare, time, h, since, seed)
                counts[1] += 1 if parts > 1 else 0
                if parts == 0:
                    return FAILED, k, seed
        elements(state.x, setup.lines.C, work.t, work.length)
        if sharp(state.x, setup.lines.C, work.t):
            return SHARP, k, 0
        kept = k + 1 - begins
        output = kept > 0 and kept % every == 0
        extreme = k >= watched and watch_step(setup, state, work, watch)
        if output or (extreme and kept > 0):
            forces_now(setup, state, work, time + h)
            watch_ends(setup, work, watch)
        if output:
            write(setup, state, work, out, int(counts[2]))
            counts[2] += 1
    return OK, first + count, 0


@njit(cache=True)
def _retry(setup, state, work, spare, time, h, since, seed):  # type: ignore[no-untyped-def]
    """The step of one seed with a new matrix, then in 2, 4, … 2^MOST_HALVINGS parts; in how many, 0 where it cannot be done.

    Each with the tangent first, then with the matrix of a line that is taut everywhere: where elements turn slack and taut,
    the tangent of the one overshoots the other, and a matrix stiffer than both settles.
    """
    done = np.ones(spare.ds.shape[0], dtype=np.int64)
    x, v, a, da = state.x.copy(), state.v.copy(), state.a.copy(), state.da.copy()
    s, sv, sa, sda = state.s.copy(), state.sv.copy(), state.sa.copy(), state.sda.copy()
    for attempt in range(2 * (MOST_HALVINGS + 1)):
        parts = 2 ** (attempt // 2)
        small = h / parts
        for part in range(parts):
            done[:] = 1
            done[seed] = 0
            matrix = OFTEN if attempt % 2 == 0 else TAUT
            advance(setup, state, spare, time + part * small, small, since + part * small, done, matrix)
            if done[seed] != 1:
                break
        if done[seed] == 1:
            if parts == 1:
                _adopt(work, spare, seed, setup.lines.lines)
            return parts
        state.x[:], state.v[:], state.a[:], state.da[:] = x, v, a, da
        state.s[:], state.sv[:], state.sa[:], state.sda[:] = s, sv, sa, sda
    return 0


@njit(cache=True)
def _adopt(work, spare, seed, lines):  # type: ignore[no-untyped-def]
    """Go on with the matrix that a seed's step was done with."""
    for q in range(seed * lines, (seed + 1) * lines):
        work.A[:, :, q] = spare.A[:, :, q]
    work.V[seed] = spare.V[seed]
