"""Banded elimination, without pivoting: one real system, or many complex ones in lanes.

The matrices come from lines hung between supports: stiffness plus a shrinking multiple of I (statics) or dynamic
stiffness with positive damping (frequency domain), for which elimination in natural order is stable. Callers check
the residual all the same.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .line import HALF

LANES = 8


@njit(cache=True)
def solve_real(band, rhs):  # type: ignore[no-untyped-def]
    """Solve in place. band (n, 2·HALF+1) is overwritten, rhs (n, m) becomes the solution."""
    n, m = rhs.shape
    for k in range(n):
        inverse = 1.0 / band[k, HALF]
        last = min(n, k + HALF + 1)
        for i in range(k + 1, last):
            factor = band[i, HALF + k - i]
            if factor != 0.0:
                factor *= inverse
                for j in range(k + 1, last):
                    band[i, HALF + j - i] -= factor * band[k, HALF + j - k]
                for c in range(m):
                    rhs[i, c] -= factor * rhs[k, c]
    for k in range(n - 1, -1, -1):
        last = min(n, k + HALF + 1)
        for c in range(m):
            value = rhs[k, c]
            for j in range(k + 1, last):
                value -= band[k, HALF + j - k] * rhs[j, c]
            rhs[k, c] = value / band[k, HALF]


@njit(cache=True)
def multiply(band, x):  # type: ignore[no-untyped-def]
    """Banded matrix times columns. band (n, 2·HALF+1), x (n, m) -> (n, m)."""
    n, m = x.shape
    out = np.zeros((n, m))
    for i in range(n):
        for j in range(max(0, i - HALF), min(n, i + HALF + 1)):
            for c in range(m):
                out[i, c] += band[i, HALF + j - i] * x[j, c]
    return out


@njit(cache=True, fastmath={"contract", "reassoc", "arcp"}, error_model="numpy")
def eliminate_lanes(ar, ai, rr, ri, half, late):  # type: ignore[no-untyped-def]
    """Solve LANES complex banded systems at once, in place.

    ar, ai : (n, 2·HALF+1, LANES) real and imaginary part of the matrices, overwritten.
    rr, ri : (n, m, LANES) right-hand sides, become the solutions.
    half : half-bandwidth in use, at most HALF.
    late : the first `late` columns are zero in every row but the last 6, so that elimination skips them before.

    Rows are worked on as one run of half·LANES numbers: long enough to fill vector registers. What spills over the last
    column of a row's band lies inside its storage and is never read.
    """
    n, m = rr.shape[0], rr.shape[1]
    br, bi = ar.reshape(n, -1), ai.reshape(n, -1)
    sr, si = rr.reshape(n, -1), ri.reshape(n, -1)
    tiles = max(half, m)
    fr, fi = np.empty(tiles * LANES), np.empty(tiles * LANES)
    ir, ii = np.empty(LANES), np.empty(LANES)
    middle, run, wide = HALF * LANES, half * LANES, m * LANES
    for k in range(n):
        pr, pi = br[k], bi[k]
        for q in range(LANES):
            size = pr[middle + q] * pr[middle + q] + pi[middle + q] * pi[middle + q]
            ir[q] = pr[middle + q] / size
            ii[q] = -pi[middle + q] / size
        ur, ui = pr[middle + LANES : middle + LANES + run], pi[middle + LANES : middle + LANES + run]
        first = late * LANES if k < n - 6 else 0
        for i in range(k + 1, min(n, k + half + 1)):
            p = (HALF + k - i) * LANES
            for q in range(LANES):
                fr[q] = br[i, p + q] * ir[q] - bi[i, p + q] * ii[q]
                fi[q] = br[i, p + q] * ii[q] + bi[i, p + q] * ir[q]
            for x in range(LANES, tiles * LANES):
                fr[x] = fr[x - LANES]
                fi[x] = fi[x - LANES]
            xr, xi = br[i, p + LANES : p + LANES + run], bi[i, p + LANES : p + LANES + run]
            for x in range(run):
                xr[x] -= fr[x] * ur[x] - fi[x] * ui[x]
                xi[x] -= fr[x] * ui[x] + fi[x] * ur[x]
            for x in range(first, wide):
                sr[i, x] -= fr[x] * sr[k, x] - fi[x] * si[k, x]
                si[i, x] -= fr[x] * si[k, x] + fi[x] * sr[k, x]
        for q in range(LANES):  # keep the inverse pivot for the way back
            pr[middle + q] = ir[q]
            pi[middle + q] = ii[q]
    for k in range(n - 1, -1, -1):
        zr, zi = sr[k], si[k]
        for j in range(k + 1, min(n, k + half + 1)):
            p = (HALF + j - k) * LANES
            for x in range(wide):
                fr[x] = br[k, p + x % LANES]
                fi[x] = bi[k, p + x % LANES]
            for x in range(wide):
                zr[x] -= fr[x] * sr[j, x] - fi[x] * si[j, x]
                zi[x] -= fr[x] * si[j, x] + fi[x] * sr[j, x]
        for x in range(wide):
            vr, vi = br[k, middle + x % LANES], bi[k, middle + x % LANES]
            zr[x], zi[x] = zr[x] * vr - zi[x] * vi, zr[x] * vi + zi[x] * vr
