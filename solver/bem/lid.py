"""A lid on the water plane inside the hull: with it the equations keep their only solution at irregular frequencies."""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay, QhullError

from .panels import Panels
from .symmetry import AXES

Array = np.ndarray


def lid_panels(water_line: Array, size: float, planes: tuple[str, ...]) -> Panels | None:
    """Triangles that fill the water plane on the positive side of the planes, normals down; None where there is no line.

    water_line : edges (E, 2, 3) of the whole hull in z = 0 [m]; size : of an edge [m].
    """
    axes = [AXES[plane] for plane in planes]
    segments = water_line[..., :2]
    if segments.shape[0] < 3:
        return None
    tiny = 1e-6 * float(np.ptp(segments.reshape(-1, 2), axis=0).max())
    border = _border(segments, size, axes, tiny)
    inner = _inner(segments, size, axes)
    points = np.concatenate([border, inner]) if inner.size else border
    points = points[np.all(points[:, axes] >= -tiny, axis=1)] if axes else points
    points = np.unique(np.round(points / tiny).astype(np.int64), axis=0) * tiny
    points[:, axes] = np.where(np.abs(points[:, axes]) <= 2 * tiny, 0.0, points[:, axes])
    if points.shape[0] < 3:
        return None
    try:
        triangles = Delaunay(points).simplices
    except QhullError:  # all on one line: there is no plane to fill
        return None
    a, b, c = (points[triangles[:, i]] for i in range(3))
    area = 0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))
    inside = contains(segments, (a + b + c) / 3)
    keep = inside & (np.abs(area) > 1e-4 * size**2)
    if not keep.any():
        return None
    faces = np.where((area < 0)[:, None], triangles, triangles[:, ::-1])[keep]
    vertices = np.column_stack([points, np.zeros(points.shape[0])])
    return Panels(vertices, np.column_stack([faces, faces[:, 2]]))


def contains(segments: Array, points: Array) -> Array:
    """Whether points (P, 2) lie inside the loops that segments (E, 2, 2) make, by the number of crossings to the right."""
    (x1, y1), (x2, y2) = segments[:, 0].T, segments[:, 1].T
    inside = np.zeros(points.shape[0], bool)
    for start in range(0, points.shape[0], 2000):
        x, y = points[start : start + 2000, :1], points[start : start + 2000, 1:]
        crosses = (y1 > y) != (y2 > y)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # of edges that are not crossed
            at = x1 + (y - y1) * (x2 - x1) / (y2 - y1)
        inside[start : start + 2000] = np.count_nonzero(crosses & (x < at), axis=1) % 2 == 1
    return inside


def _border(segments: Array, size: float, axes: list[int], tiny: float) -> Array:
    """Points of the water line, and of the planes of symmetry where they cross the inside."""
    points = [segments.reshape(-1, 2)]
    low, high = segments.min(axis=(0, 1)), segments.max(axis=(0, 1))
    for axis in axes:
        other = 1 - axis
        run = np.arange(np.floor(low[other] / size), np.ceil(high[other] / size) + 1) * size
        line = np.zeros((run.size, 2))
        line[:, other] = run
        beside = line.copy()
        beside[:, axis] += 10 * tiny  # on the plane itself a crossing may be counted twice
        points.append(line[contains(segments, beside) & (_distance(segments, line) > 0.4 * size)])
    return np.concatenate(points)


def _inner(segments: Array, size: float, axes: list[int]) -> Array:
    """Points of an even grid well inside, the planes of symmetry left out."""
    low, high = segments.min(axis=(0, 1)), segments.max(axis=(0, 1))
    x, y = (np.arange(np.floor(low[i] / size), np.ceil(high[i] / size) + 1) * size for i in (0, 1))
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    for axis in axes:
        points = points[points[:, axis] > 0.5 * size]
    points = points[contains(segments, points)]
    return points[_distance(segments, points) > 0.4 * size]


def _distance(segments: Array, points: Array) -> Array:
    """Of points to the nearest segment [m]."""
    best = np.full(points.shape[0], np.inf)
    for start, end in segments:
        along = end - start
        length = max(float(along @ along), 1e-300)
        share = np.clip((points - start) @ along / length, 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - start - share[:, None] * along, axis=1))
    return best
