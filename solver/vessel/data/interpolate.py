"""Interpolation over frequency and heading that refuses to extrapolate (V3, V4)."""

from __future__ import annotations

import math

import numpy as np

from ...outcome import DataError

Array = np.ndarray
TURN = 2.0 * math.pi
NEAR = math.radians(5.0)  # a heading outside the data is taken as the nearest one within this, with a warning
PRINTED = 2e-5  # of a frequency: what files of five printed digits may differ by; nearer than this is inside


def spans_circle(headings: Array) -> bool:
    """Whether interpolation may close the circle: no gap, the closing one included, wider than 90 deg, and the
    closing gap no wider than the widest gap inside."""
    if headings.size < 3:
        return False
    inner = float(np.diff(headings).max())
    closing = TURN - float(headings[-1] - headings[0])
    return closing <= inner * (1 + 1e-6) and inner <= math.pi / 2 * (1 + 1e-6)


def heading_weights(headings: Array, heading: float, name: str, reach: float = NEAR) -> tuple[int, int, float]:
    """Indices i, j and weight w with value = (1 - w) value[i] + w value[j] at a heading [rad] (V4).

    Outside the data the nearest heading stands in, if it is within `reach` [rad], and `outside` says so (V29); none is
    extrapolated. Raises DataError for a heading farther outside.
    """
    found = _between(headings, heading)
    if found is not None:
        return found
    nearest, distance = _nearest(headings, heading)
    if distance <= reach:
        return nearest, nearest, 0.0
    have = ", ".join(f"{math.degrees(value):.4g}" for value in headings[:40])
    raise DataError(
        f"{name}: waves meet the vessel at {math.degrees(heading % TURN):.4g} deg (from its own x axis, direction of travel), "
        f"but the data hold {have} deg; compute that heading, or headings round the circle at most 90 deg apart"
    )


def outside(headings: Array, heading: float) -> tuple[float, float] | None:
    """The heading that stands in for one outside the data, and its distance [rad]; None for a heading inside."""
    if _between(headings, heading) is not None:
        return None
    nearest, distance = _nearest(headings, heading)
    return float(headings[nearest]), distance


def _nearest(headings: Array, heading: float) -> tuple[int, float]:
    distance = np.abs((headings - heading + math.pi) % TURN - math.pi)
    nearest = int(distance.argmin())
    return nearest, float(distance[nearest])


def _between(headings: Array, heading: float) -> tuple[int, int, float] | None:
    """Indices and weight of a heading that the data hold or enclose, None for another."""
    angle = heading % TURN
    nearest, distance = _nearest(headings, angle)
    if distance < 1e-6:
        return nearest, nearest, 0.0
    upper = int(np.searchsorted(headings, angle))
    if 0 < upper < headings.size:
        width = float(headings[upper] - headings[upper - 1])
        if width <= math.pi / 2 * (1 + 1e-6):
            return upper - 1, upper, float(angle - headings[upper - 1]) / width
    elif spans_circle(headings):
        width = TURN - float(headings[-1] - headings[0])
        return headings.size - 1, 0, float((angle - headings[-1]) % TURN) / width
    return None


def check_range(omega: Array, low: float, high: float, name: str, what: str) -> None:
    """Raises DataError when a frequency lies outside low to high [rad/s], naming both and the remedy."""
    if omega.size == 0:
        return
    least, most = float(omega.min()), float(omega.max())
    if least < low * (1 - PRINTED) - 1e-9:
        raise DataError(
            f"{name}: {what} is asked for at {least:.4g} rad/s, below the lowest frequency of the data, "
            f"{low:.4g} rad/s; compute the data at omega = 0 or at lower frequencies"
        )
    if most > high * (1 + PRINTED):
        raise DataError(
            f"{name}: {what} is asked for at {most:.4g} rad/s, above the highest frequency of the data, "
            f"{high:.4g} rad/s; compute higher frequencies or lower analyses.frequency_domain.wave.to"
        )


def linear(omega: Array, nodes: Array, values: Array) -> Array:
    """Piecewise-linear values, shape (N, ...), at omega, shape (W,) -> (W, ...); ends held (check the range first)."""
    if nodes.size == 1:
        return np.broadcast_to(values[0], (omega.size, *values.shape[1:])).copy()
    upper = np.clip(np.searchsorted(nodes, omega), 1, nodes.size - 1)
    weight = np.clip((omega - nodes[upper - 1]) / (nodes[upper] - nodes[upper - 1]), 0.0, 1.0)
    weight = weight.reshape(-1, *([1] * (values.ndim - 1)))
    result: Array = (1.0 - weight) * values[upper - 1] + weight * values[upper]
    return result
