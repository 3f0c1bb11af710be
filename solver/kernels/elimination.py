"""Banded LDLᵀ of many lines at once, lanes last (docs/theory.md, T9)."""

from __future__ import annotations

import numpy as np
from numba import njit

from .lanes import BAND, FAST


@njit(cache=True, fastmath=FAST, error_model="numpy")
def factor(A, first, last):  # type: ignore[no-untyped-def]
    """LDLᵀ in place of rows first … last - 1 of the lower band (rows, BAND, Q); the rows from `last` on keep the Schur
    complement. On return A[i, 0] holds 1/d of eliminated rows and A[i, k] the factor L of the column k before.
    """
    rows, _, Q = A.shape
    run = BAND * Q
    flat = A.reshape(rows, run)
    scaled = np.empty((BAND, Q))
    for k in range(first, last):
        for q in range(Q):
            flat[k, q] = 1.0 / flat[k, q]
        most = min(rows - 1 - k, BAND - 1)
        for d in range(1, most + 1):
            for q in range(Q):
                scaled[d, q] = A[k + d, d, q] * A[k, 0, q]
        for d in range(1, most + 1):
            for e in range(1, d + 1):
                for q in range(Q):
                    A[k + d, d - e, q] -= scaled[d, q] * A[k + e, e, q]
        for d in range(1, most + 1):
            for q in range(Q):
                A[k + d, d, q] = scaled[d, q]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def forward(A, b, first, last):  # type: ignore[no-untyped-def]
    """L⁻¹ of rows first … last - 1 on b (rows, Q), in place; later rows receive what reaches them."""
    rows, Q = b.shape
    for k in range(first, last):
        for d in range(1, min(rows - 1 - k, BAND - 1) + 1):
            for q in range(Q):
                b[k + d, q] -= A[k + d, d, q] * b[k, q]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def backward(A, b, first, last):  # type: ignore[no-untyped-def]
    """Finish the solution of rows last - 1 … first from those after them, which hold the answer already."""
    rows, Q = b.shape
    for k in range(first, last):
        for q in range(Q):
            b[k, q] *= A[k, 0, q]
    for k in range(rows - 1, first, -1):
        for d in range(max(1, k - last + 1), min(k - first, BAND - 1) + 1):
            for q in range(Q):
                b[k - d, q] -= A[k, d, q] * b[k, q]
