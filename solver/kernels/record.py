"""What is written of a step: outputs, and the forces at the ends of the lines (docs/theory.md, T7, L21)."""

from __future__ import annotations

import math

from numba import njit

from .arrays import GROUNDED, TENSION_A, TENSION_B, TOUCHDOWN, VERTICAL_A, VERTICAL_B
from .lanes import A1, A2, B_WET, BED, DIAMETER, EL, FAST, W_DRY, axial_force, bed_force
from .step import residual
from .waves import ramp, water_at, water_where


@njit(cache=True)
def forces_now(setup, state, work, time):  # type: ignore[no-untyped-def]
    """Forces less inertia on every node of the present state into work.res; at a held end, what its support carries."""
    load = ramp(time, setup.build_up)[0]
    water_at(setup.sea, time, load, work.terms)
    water_where(setup.sea, work, state.x, time, load)
    residual(setup.lines, work, state.x, state.v, state.a, work.res)


@njit(cache=True)
def end_node(lines, N, e, q):  # type: ignore[no-untyped-def]
    """Node of end b (e = 0) or end a (e = 1) of a lane."""
    return N if e == 0 else int(lines.bottom[q])


@njit(cache=True)
def watch_ends(setup, work, watch):  # type: ignore[no-untyped-def]
    """Take the forces at the ends, as `forces_now` left them, into their extremes."""
    N, Q = work.length.shape
    for q in range(Q):
        for e in range(2):
            i = end_node(setup.lines, N, e, q)
            size = math.sqrt(work.res[i, 0, q] ** 2 + work.res[i, 1, q] ** 2 + work.res[i, 2, q] ** 2)
            for row, value in ((TENSION_B + e, size), (VERTICAL_B + e, work.res[i, 2, q])):
                watch.ends[0, row, q] = min(watch.ends[0, row, q], value)
                watch.ends[1, row, q] = max(watch.ends[1, row, q], value)


@njit(cache=True)
def write(setup, state, work, out, row):  # type: ignore[no-untyped-def]
    """Vessel, element tensions and the values of the ends into a row of the outputs, after `forces_now`."""
    N, Q = work.length.shape
    lines, (vessel, tension, ends) = setup.lines, out
    if row >= tension.shape[0]:
        return
    vessel[row] = state.s
    for j in range(N):
        for q in range(Q):
            tension[row, j, q] = axial_force(lines.C, work.length, j, q)
    for q in range(Q):
        for e in range(2):
            i = end_node(lines, N, e, q)
            total = 0.0
            for p in range(3):
                total += work.res[i, p, q] ** 2
            ends[row, TENSION_B if e == 0 else TENSION_A, q] = math.sqrt(total)
            ends[row, VERTICAL_B if e == 0 else VERTICAL_A, q] = work.res[i, 2, q]
        ends[row, GROUNDED, q], ends[row, TOUCHDOWN, q] = on_the_bed(lines, state.x, q)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def contact_share(lines, x, i, q):  # type: ignore[no-untyped-def]
    """Share of the weight in water of an inner node that the bed carries, 0…1 (L21)."""
    C, D = lines.C, lines.D
    weight = 0.5 * (C[i - 1, W_DRY, q] - C[i - 1, B_WET, q] + C[i, W_DRY, q] - C[i, B_WET, q])
    if weight <= 0.0:
        return 0.0
    force, _ = bed_force(D[i, A1, q], D[i, A2, q], x[i, 2, q] - D[i, BED, q])
    return min(force / weight, 1.0)


@njit(cache=True)
def on_the_bed(lines, x, q):  # type: ignore[no-untyped-def]
    """Length of a lane's line on the bed, and the arc length from end a to its last point there; zeros without any."""
    N, first = x.shape[0] - 1, int(lines.bottom[q])
    if first + 1 >= N:
        return 0.0, 0.0
    arc, total, touchdown = 0.0, 0.0, 0.0
    before = contact_share(lines, x, first + 1, q)
    if x[first, 2, q] - lines.depth > lines.C[first, DIAMETER, q]:
        before = 0.0
    for i in range(first, N):
        L = lines.C[i, EL, q]
        if i + 1 < N:
            after = contact_share(lines, x, i + 1, q)
        else:
            after = before if x[N, 2, q] - lines.depth <= lines.C[i, DIAMETER, q] else 0.0
        lying = min(max((max(before, after) - 0.5) / max(abs(before - after), 1e-12), 0.0), 1.0)
        total += L * lying
        if after >= 0.5:
            touchdown = arc + L
        elif before >= 0.5:
            touchdown = arc + L * lying
        arc += L
        before = after
    return total, touchdown
