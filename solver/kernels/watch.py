"""What is recorded of a step: outputs, extremes, and signs that it was too long (docs/theory.md, T16, T17)."""

from __future__ import annotations

import math

from numba import njit

from .arrays import MEAN
from .compression import released
from .lanes import A1, EA, EL, FAST, KNEE, LIMIT
from .step import residual
from .waves import ramp, water_at, water_where

LOG2 = math.log(2.0)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def watch_step(setup, state, work, watch):  # type: ignore[no-untyped-def]
    """Take the end of a kept step into the extremes of tension, its kinks, slack, and the blows of the bed (T16, T17)."""
    C, Q = setup.lines.C, work.length.shape[1]
    for j in range(work.length.shape[0]):
        for q in range(Q):
            strain = work.length[j, q] / C[j, EL, q] - 1.0
            T = C[j, EA, q] * (strain + released(strain, C[j, LIMIT, q], C[j, KNEE, q])[0])
            watch.slack[j, q] += 1.0 if T <= 0.0 else 0.0
            one, two = watch.last[0, j, q], watch.last[1, j, q]
            kink = abs(T - 2.0 * one + two)
            watch.range[0, j, q] = min(watch.range[0, j, q], T)
            watch.range[1, j, q] = max(watch.range[1, j, q], T)
            watch.kink[j, q] = kink if kink > watch.kink[j, q] else watch.kink[j, q]  # at first not a number
            watch.last[0, j, q], watch.last[1, j, q] = T, one
    wide = LOG2 / setup.lines.seabed[0]
    for i in range(state.x.shape[0]):
        for q in range(Q):
            # a hyperbola instead of (L13): the same at and below the bed within a few per cent, without its logarithm
            height = state.x[i, 2, q] - setup.lines.seabed[1]
            F = 0.5 * setup.lines.D[i, A1, q] * (math.sqrt(height * height + wide * wide) - height)
            change = abs(F - watch.bed[2, i, q])
            watch.bed[0, i, q] = min(watch.bed[0, i, q], F)
            watch.bed[1, i, q] = max(watch.bed[1, i, q], F)
            watch.bed[2, i, q] = F
            watch.bed[3, i, q] = change if change > watch.bed[3, i, q] else watch.bed[3, i, q]
    if setup.sea.kind != MEAN:
        _reach(setup.sea, state, watch)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _reach(sea, state, watch):  # type: ignore[no-untyped-def]
    first = state.x.shape[0] - sea.origin.shape[0]
    for i in range(sea.origin.shape[0]):
        for q in range(state.x.shape[2]):
            gap = 0.0
            for p in range(3):
                gap += (state.x[first + i, p, q] - sea.origin[i, p, q]) ** 2
            watch.reach[q] = max(watch.reach[q], math.sqrt(gap))


@njit(cache=True)
def write(setup, state, work, time, out, row):  # type: ignore[no-untyped-def]
    """Vessel, element tensions and end reactions at a time into a row of the outputs."""
    N, Q = work.length.shape
    lines, (vessel, tension, ends) = setup.lines, out
    if row >= tension.shape[0]:
        return
    vessel[row] = state.s
    for j in range(N):
        for q in range(Q):
            strain = work.length[j, q] / lines.C[j, EL, q] - 1.0
            free, _ = released(strain, lines.C[j, LIMIT, q], lines.C[j, KNEE, q])
            tension[row, j, q] = lines.C[j, EA, q] * (strain + free)
    load = ramp(time, setup.build_up)[0]
    water_at(setup.sea, time, load, work.terms)
    water_where(setup.sea, work, state.x, time, load)
    residual(lines, work, state.x, state.v, state.a, work.res)
    for q in range(Q):
        for e in range(2):
            i = N if e == 0 else int(lines.bottom[q])
            total = 0.0
            for p in range(3):
                total += work.res[i, p, q] ** 2
            ends[row, e, q] = math.sqrt(total)
