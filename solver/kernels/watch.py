"""Extremes of every kept step, and signs that it was too long (docs/theory.md, T16, T17)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .arrays import MEAN
from .lanes import A1, A2, BED, FAST, axial_force, axial_forces

LOG2 = math.log(2.0)
CLEAR = 350.0  # heights above the bed, in 1/A2, from which its hyperbola is left out


@njit(cache=True, fastmath=FAST, error_model="numpy")
def watch_step(setup, state, work, watch):  # type: ignore[no-untyped-def]
    """Take the end of a kept step into the extremes of tension, its kinks, slack, and the blows of the bed (T16, T17).

    Returns whether the tension at an end of some line has a new extreme.
    """
    C, Q = setup.lines.C, work.length.shape[1]
    extreme = _new_extreme(setup.lines, work, watch)
    forces = np.empty(Q)
    for j in range(work.length.shape[0]):
        axial_forces(C, work.length, j, forces)
        for q in range(Q):
            T = forces[q]
            watch.slack[j, q] += 1.0 if T <= 0.0 else 0.0
            one, two = watch.last[0, j, q], watch.last[1, j, q]
            kink = abs(T - 2.0 * one + two)
            watch.range[0, j, q] = min(watch.range[0, j, q], T)
            watch.range[1, j, q] = max(watch.range[1, j, q], T)
            watch.kink[j, q] = kink if kink > watch.kink[j, q] else watch.kink[j, q]  # at first not a number
            watch.last[0, j, q], watch.last[1, j, q] = T, one
    for i in range(state.x.shape[0]):
        _watch_bed(setup.lines.D, state.x, i, watch.bed)
    if setup.sea.kind != MEAN:
        _reach(setup.sea, state, watch)
    return extreme


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _watch_bed(D, x, i, bed):  # type: ignore[no-untyped-def]
    """Take the force of the bed on node i into its extremes and its largest change in a step (T17).

    A hyperbola instead of (L13): the same at and below the bed within a few per cent, without its logarithm; nothing
    where it is less than 1e-3 of the force at bed level.
    """
    nearest = 1e300
    for q in range(x.shape[2]):
        nearest = min(nearest, D[i, A2, q] * (x[i, 2, q] - D[i, BED, q]))
        if bed[2, i, q] != 0.0:  # at first not a number
            nearest = 0.0
    if nearest > CLEAR:
        return
    for q in range(x.shape[2]):
        wide = LOG2 / D[i, A2, q]
        height = x[i, 2, q] - D[i, BED, q]
        F = 0.5 * D[i, A1, q] * (math.sqrt(height * height + wide * wide) - height)
        F = F if D[i, A2, q] * height <= CLEAR else 0.0
        change = abs(F - bed[2, i, q])
        bed[0, i, q] = min(bed[0, i, q], F)
        bed[1, i, q] = max(bed[1, i, q], F)
        bed[2, i, q] = F
        bed[3, i, q] = change if change > bed[3, i, q] else bed[3, i, q]


@njit(cache=True)
def _new_extreme(lines, work, watch):  # type: ignore[no-untyped-def]
    """Whether the element at an end of some line is stretched more, or less, than at any kept step before."""
    N, Q = work.length.shape
    for q in range(Q):
        for j in (int(lines.bottom[q]), N - 1):
            T = axial_force(lines.C, work.length, j, q)
            lowest, highest = watch.range[0, j, q], watch.range[1, j, q]
            if not lowest <= T <= highest:
                return True
    return False


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _reach(sea, state, watch):  # type: ignore[no-untyped-def]
    first = state.x.shape[0] - sea.origin.shape[0]
    for i in range(sea.origin.shape[0]):
        for q in range(state.x.shape[2]):
            gap = 0.0
            for p in range(3):
                gap += (state.x[first + i, p, q] - sea.origin[i, p, q]) ** 2
            watch.reach[q] = max(watch.reach[q], math.sqrt(gap))
