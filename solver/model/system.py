"""Residual and tangent of one line: the fixed list of forces, assembled and condensed to its ends."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..forces import axial, bending, drag, inertia, seabed, weight
from ..kernels.band import solve_real
from ..kernels.line import HALF, WIDTH


@njit(cache=True)
def forces(line, x, v, u, a):  # type: ignore[no-untyped-def]
    """Sum of all line forces on every node, shape (N+1, 3) [N]. Arguments as in `solver.forces`."""
    out = np.zeros_like(x)
    axial.force(line, x, v, u, a, out)
    bending.force(line, x, v, u, a, out)
    weight.force(line, x, v, u, a, out)
    drag.force(line, x, v, u, a, out)
    inertia.force(line, x, v, u, a, out)
    seabed.force(line, x, v, u, a, out)
    return out


@njit(cache=True)
def stiffness(line, x, with_slack):  # type: ignore[no-untyped-def]
    """Banded -∂F/∂x about rest in still water with current, shape (3(N+1), WIDTH).

    with_slack : the exact tangent; False drops the negative stiffness of slack elements, for Newton's matrix.
    """
    still = np.zeros_like(x)
    K, B = np.zeros((x.size, WIDTH)), np.zeros((x.size, WIDTH))
    if with_slack:
        axial.tangent(line, x, still, still, K, B)
    else:
        axial.tangent_without_slack(line, x, K)
    bending.tangent(line, x, still, still, K, B)
    weight.tangent(line, x, still, still, K, B)
    drag.tangent(line, x, still, still, K, B)
    seabed.tangent(line, x, still, still, K, B)
    return K


@njit(cache=True)
def end_columns(K, rhs, first):  # type: ignore[no-untyped-def]
    """Put the coupling of the interior rows to end b (3 columns) and end a (3 columns) into rhs[:, first:first+6]."""
    rows = rhs.shape[0]
    total = rows + 6
    for row in range(rows):
        i = row + 3
        for c in range(3):
            jb, ja = total - 3 + c, c
            rhs[row, first + c] = K[i, HALF + jb - i] if abs(jb - i) <= HALF else 0.0
            rhs[row, first + 3 + c] = K[i, HALF + ja - i] if abs(ja - i) <= HALF else 0.0


@njit(cache=True)
def end_rows(K, y, out):  # type: ignore[no-untyped-def]
    """Rows of end b and end a of K times interior columns y (3(N-1), m) -> out (6, m)."""
    total = K.shape[0]
    out[:] = 0.0
    for r in range(6):
        i = total - 3 + r if r < 3 else r - 3
        for j in range(max(3, i - HALF), min(total - 3, i + HALF + 1)):
            for c in range(out.shape[1]):
                out[r, c] += K[i, HALF + j - i] * y[j - 3, c]


@njit(cache=True)
def end_block(K):  # type: ignore[no-untyped-def]
    """The (6, 6) block of K between end b and end a themselves."""
    total = K.shape[0]
    out = np.zeros((6, 6))
    for r in range(6):
        i = total - 3 + r if r < 3 else r - 3
        for c in range(6):
            j = total - 3 + c if c < 3 else c - 3
            if abs(j - i) <= HALF:
                out[r, c] = K[i, HALF + j - i]
    return out


@njit(cache=True)
def stiffen_across(line, x, mixed, K):  # type: ignore[no-untyped-def]
    """Replace the tension in the transverse stiffness of every element by `mixed` (N,) [N] (S13)."""
    own = axial.tension(line, x)
    for j in range(line.L.size):
        d = x[j + 1] - x[j]
        length = np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        extra = (mixed[j] - max(own[j], 0.0)) / length
        for p in range(3):
            for q in range(3):
                value = -extra * d[p] * d[q] / (length * length)
                if p == q:
                    value += extra
                i = 3 * j + p
                K[i, HALF + q - p] += value
                K[i + 3, HALF + q - p] += value
                K[i, HALF + 3 + q - p] -= value
                K[i + 3, HALF - 3 + q - p] -= value


@njit(cache=True)
def newton_step(line, x, load, lam, mixed):  # type: ignore[no-untyped-def]
    """One linearisation of a line in static equilibrium under its forces and a constant nodal `load` (N+1, 3) (S6).

    lam : λ added to the diagonal [N/m]; mixed : tension that stiffens the elements across (N,) [N] (S13).
    Returns (F, y, X, Kc, fc): nodal forces; interior step with ends held, (3(N-1),); interior displacement per unit end
    displacement, (3(N-1), 6), to be subtracted; condensed end stiffness (6, 6); end forces after the step y, (6,).
    """
    still = np.zeros_like(x)
    F = forces(line, x, still, still, still) + load
    K = stiffness(line, x, False)
    stiffen_across(line, x, mixed, K)
    rows = x.size - 6
    band = K[3 : 3 + rows].copy()
    rhs = np.empty((rows, 7))
    for i in range(rows):
        band[i, HALF] += lam
        rhs[i, 0] = F[1 + i // 3, i % 3]
        for q in range(WIDTH):  # couplings to the ends leave the band of the interior
            j = i + q - HALF
            if j < 0 or j >= rows:
                band[i, q] = 0.0
    end_columns(K, rhs, 1)
    solve_real(band, rhs)
    y = np.ascontiguousarray(rhs[:, 0])
    X = np.ascontiguousarray(rhs[:, 1:])
    coupled = np.empty((6, 7))
    end_rows(K, rhs, coupled)
    Kc = end_block(K) - coupled[:, 1:]
    fc = np.empty(6)
    for c in range(3):
        fc[c] = F[F.shape[0] - 1, c] - coupled[c, 0]
        fc[3 + c] = F[0, c] - coupled[3 + c, 0]
    return F, y, X, Kc, fc
