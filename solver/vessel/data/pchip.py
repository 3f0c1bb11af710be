"""Shape-preserving piecewise cubic interpolation: Fritsch and Butland (1984), with the ends as SciPy has them."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def pchip(nodes: Array, values: Array, at: Array) -> Array:
    """Values at `at`, shape (W,), from nodes (N,), N >= 2, rising, and values (N, ...) on them: (W, ...).

    No overshoot between the nodes; outside of them the end cubics go on (check the range first).
    """
    h = np.diff(nodes).reshape(-1, *([1] * (values.ndim - 1)))
    secant = np.diff(values, axis=0) / h
    slope = _slopes(h, secant)
    i = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, nodes.size - 2)
    h, secant = h[i], secant[i]
    s = (at - nodes[i]).reshape(h.shape)
    first, last = slope[i], slope[i + 1]
    bend = (first + last - 2.0 * secant) / h
    result: Array = values[i] + s * (first + s * ((secant - first) / h - bend + s * bend / h))
    return result


def _slopes(h: Array, secant: Array) -> Array:
    """Derivatives at the nodes, (N, ...): the weighted harmonic mean of both secants, zero where they turn."""
    if len(h) == 1:
        return np.concatenate([secant, secant])
    left, right = secant[:-1], secant[1:]
    rising = np.sign(left) * np.sign(right) > 0
    a, b = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
    safe_left, safe_right = np.where(rising, left, 1.0), np.where(rising, right, 1.0)
    with np.errstate(over="ignore"):
        mean = (a + b) / (a / safe_left + b / safe_right)
    inner = np.where(rising, mean, 0.0)
    start = _end(h[0], h[1], secant[0], secant[1])
    finish = _end(h[-1], h[-2], secant[-1], secant[-2])
    return np.concatenate([start[None], inner, finish[None]])


def _end(h0: Array, h1: Array, m0: Array, m1: Array) -> Array:
    """Slope of the parabola through the last three points, held to the sign and three times the last secant."""
    slope = ((2.0 * h0 + h1) * m0 - h0 * m1) / (h0 + h1)
    slope = np.where(np.sign(slope) != np.sign(m0), 0.0, slope)
    steep = (np.sign(m0) != np.sign(m1)) & (np.abs(slope) > 3.0 * np.abs(m0))
    return np.where(steep, 3.0 * m0, slope)
