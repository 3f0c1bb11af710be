"""Loads and water at one time from their tables, and waves at the instantaneous position (docs/theory.md, T4, T11-T15)."""

from __future__ import annotations

import math

from numba import njit

from .arrays import EXACT, MEAN
from .lanes import FAST


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
    """Rows of the water table at a time, times a factor, into out."""
    T = sea.water.shape[0]
    if T == 0 or out.size == 0:
        out[:] = 0.0
        return
    lower, w0, w1, w2, w3 = _cubic(time / sea.water_step)
    lower -= sea.water_first
    a, b = sea.water[(lower - 1) % T].ravel(), sea.water[lower % T].ravel()
    c, d = sea.water[(lower + 1) % T].ravel(), sea.water[(lower + 2) % T].ravel()
    flat = out.ravel()
    w0, w1, w2, w3 = w0 * factor, w1 * factor, w2 * factor, w3 * factor
    for k in range(flat.size):
        flat[k] = w0 * a[k] + w1 * b[k] + w2 * c[k] + w3 * d[k]


@njit(cache=True)
def force_at(sea, time, s, factor, out):  # type: ignore[no-untyped-def]
    """Wave load on the vessel of seed s at a time, times a factor, into out (6,)."""
    T = sea.force.shape[0]
    lower, w0, w1, w2, w3 = _cubic(time / sea.force_step)
    for p in range(6):
        value = w0 * sea.force[(lower - 1) % T, s, p] + w1 * sea.force[lower % T, s, p]
        out[p] = factor * (value + w2 * sea.force[(lower + 1) % T, s, p] + w3 * sea.force[(lower + 2) % T, s, p])


@njit(cache=True)
def water_where(sea, work, x, time, factor):  # type: ignore[no-untyped-def]
    """Water at positions x into work.water; `work.terms` holds the table at that time already."""
    if sea.kind == MEAN or work.water.size == 0:
        return
    if sea.kind == EXACT:
        _exact(sea, x, time, factor, work.water)
    else:
        _series(sea, work.terms, x, work.water)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _exact(sea, x, time, factor, out):  # type: ignore[no-untyped-def]
    """Regular waves of one frequency at positions x (T14)."""
    nodes, Q = out.shape[0], out.shape[2]
    first, w, d = x.shape[0] - nodes, sea.omega, sea.depth
    out[:] = 0.0
    for system in range(sea.wave.shape[0]):
        k, full = sea.wave[system, 0], sea.wave[system, 1]
        re, im = factor * sea.wave[system, 2], factor * sea.wave[system, 3]
        c, s = sea.heading[system, 0], sea.heading[system, 1]
        for i in range(nodes):
            for q in range(Q):
                z = max(min(x[first + i, 2, q], 0.0), -d)
                up, down = full * math.exp(k * z), full * math.exp(-k * (z + 2.0 * d))
                phase = w * time - k * (c * x[first + i, 0, q] + s * x[first + i, 1, q])
                cosine, sine = math.cos(phase), math.sin(phase)
                real, imag = re * cosine - im * sine, re * sine + im * cosine
                u, v = (up + down) * real, -(up - down) * imag
                du, dv = -w * (up + down) * imag, -w * (up - down) * real
                out[i, 0, q] += c * u
                out[i, 1, q] += s * u
                out[i, 2, q] += v
                out[i, 3, q] += c * du
                out[i, 4, q] += s * du
                out[i, 5, q] += dv


@njit(cache=True, fastmath=FAST, error_model="numpy")
def _series(sea, terms, x, out):  # type: ignore[no-untyped-def]
    """Random waves at positions x: two power series in the displacement from the static position (T15).

    Rows of `terms`: wave system, part, order, velocity or acceleration, real or imaginary.
    """
    nodes, Q = out.shape[0], out.shape[2]
    first, systems = x.shape[0] - nodes, sea.heading.shape[0]
    orders = terms.shape[1] // (4 * sea.parts * systems)
    out[:] = 0.0
    for system in range(systems):
        c, s = sea.heading[system, 0], sea.heading[system, 1]
        for i in range(nodes):
            for q in range(Q):
                along = c * (x[first + i, 0, q] - sea.origin[i, 0, q]) + s * (x[first + i, 1, q] - sea.origin[i, 1, q])
                up = min(x[first + i, 2, q], 0.0) - sea.origin[i, 2, q]
                for kind in range(2):
                    u, w = 0.0, 0.0
                    for part in range(sea.parts):
                        sign = 1.0 - 2.0 * part
                        row = 4 * (orders * (sea.parts * system + part + 1) - 1) + 2 * kind
                        real, imag = terms[i, row, q], terms[i, row + 1, q]
                        for _ in range(orders - 1):
                            row -= 4
                            real, imag = (
                                real * sign * up + imag * along + terms[i, row, q],
                                imag * sign * up - real * along + terms[i, row + 1, q],
                            )
                        u += real
                        w -= sign * imag
                    out[i, 3 * kind, q] += c * u
                    out[i, 3 * kind + 1, q] += s * u
                    out[i, 3 * kind + 2, q] += w
