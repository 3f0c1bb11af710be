"""The shape Newton's iteration starts from: an elastic catenary laid through the nodes, or a sagging chord."""

from __future__ import annotations

import numpy as np

from ..model.line import LineModel
from .catenary import solve_catenary

Array = np.ndarray


def first_shape(line: LineModel, a: Array, b: Array) -> Array:
    """Node positions (N+1, 3) [m] from end a at `a` to end b at `b`, with segments averaged into one uniform line."""
    arrays = line.arrays
    weight = float((arrays.w_dry - arrays.b_wet).sum() + (arrays.point_weight - arrays.point_lift).sum()) / line.length
    flip = weight < 0.0  # a buoyant line hangs upwards
    sign = -1.0 if flip else 1.0
    low, high = (a, b) if sign * (b[2] - a[2]) >= 0 else (b, a)
    span = float(np.hypot(*(high - low)[:2]))
    drop = float(sign * (high[2] - low[2]))
    arc = line.node_arc if low is a else line.length - line.node_arc
    stiffness = line.length / float((arrays.L / arrays.EA).sum())
    bed = bool(arrays.depth > low[2] - 1.0) and not flip
    if bed and line.length > 0.9995 * (span + drop) and drop > 0.0:
        return _straight_down(line, a, b, low is a)
    found = None
    if abs(weight) * line.length > 1e-6 * stiffness and span > 1e-3 * line.length:
        found = solve_catenary(span, drop, line.length, abs(weight), stiffness, bed)
    if found is None:
        return _sagging_chord(line, a, b, sign)
    x, z = found.shape(arc)
    if not np.all(np.isfinite(x)) or not np.all(np.isfinite(z)):
        return _sagging_chord(line, a, b, sign)
    along = (high - low) * [1.0, 1.0, 0.0] / span
    shape = low + x[:, None] * along
    shape[:, 2] = low[2] + sign * z
    shape[0], shape[-1] = a, b
    return np.ascontiguousarray(shape)


def _straight_down(line: LineModel, a: Array, b: Array, from_a: bool) -> Array:
    """A line longer than the way straight down and along the bed: it hangs from its upper end and lies evenly on the bed.

    from_a : end a is the lower end.
    """
    low, high = (a, b) if from_a else (b, a)
    arc = line.length - line.node_arc if from_a else line.node_arc  # from the upper end
    drop = float(high[2] - low[2])
    share = np.clip((arc - drop) / (line.length - drop), 0.0, 1.0)[:, None]
    shape = high + share * (low - high)
    shape[:, 2] = high[2] - np.minimum(arc, drop)
    shape[0], shape[-1] = a, b
    return np.ascontiguousarray(shape)


def _sagging_chord(line: LineModel, a: Array, b: Array, sign: float) -> Array:
    """The straight chord with a parabolic sag that takes up the slack."""
    chord = float(np.linalg.norm(b - a))
    share = (line.node_arc / line.length)[:, None]
    slack = max(line.length / max(chord, 1e-9) - 1.0, 1e-6)
    sag = chord * np.sqrt(3.0 * min(slack, 3.0) / 8.0) * 4.0 * share * (1.0 - share)
    if np.hypot(*(b - a)[:2]) < 1e-3 * line.length:  # a vertical line: bow it sideways a little
        direction = np.array([1.0, 0.0, 0.0])
    else:
        direction = np.array([0.0, 0.0, -sign])
    shape = a + share * (b - a) + sag * direction
    shape[:, 2] = np.maximum(shape[:, 2], min(arrays_bed(line), a[2], b[2]))
    return np.ascontiguousarray(shape)


def arrays_bed(line: LineModel) -> float:
    return float(line.arrays.depth)
