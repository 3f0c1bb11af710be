"""Panels of the hulls given by dimensions. Patches share the points of their common edges, so that the hull is closed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..outcome import CaseError, FieldError
from .hulls import AnyHull, Barge, Column, Pontoon, SemiSubmersible, Ship, Spar, diameter_between
from .panels import Panels, joined, welded

Array = np.ndarray
ABOUT = 1000  # panels of a hull whose panel size is not given
ROUND = math.pi / 6  # at least so many angles round a column [rad]


def hull_panels(hull: AnyHull, size: float | None) -> tuple[Panels, float]:
    """Panels with edges of at most `size` [m], and that size; None: such that there are about 1000."""
    if size is None:
        size = _usual_size(hull)
    if isinstance(hull, Barge):
        made = _barge(hull, size)
    elif isinstance(hull, Ship):
        made = _ship(hull, size)
    elif isinstance(hull, Spar):
        column = Column(position=(0.0, 0.0), profile=hull.profile)
        made = _column(column, size, [], (), *_round(column, size, []))
    else:
        made = _semi(hull, size)
    return welded(made), size


def count_about(hull: AnyHull, size: float) -> float:
    """Rough number of panels, before they are made: wetted area over that of a panel."""
    return _area(hull) / size**2


def _usual_size(hull: AnyHull) -> float:
    size = math.sqrt(_area(hull) / ABOUT)
    for _ in range(4):  # the last panel of every edge is shorter than `size`, so the first guess gives too many
        found = hull_panels(hull, size)[0].count
        size *= math.sqrt(found / ABOUT)
    return float(f"{size:.3g}")


def _area(hull: AnyHull) -> float:
    if isinstance(hull, Barge | Ship):
        return hull.length * hull.breadth + 2 * hull.draft * (hull.length + hull.breadth)
    if isinstance(hull, Spar):
        return _round_area(hull.profile)
    total = sum(_round_area(column.profile) for column in hull.columns)
    for pontoon in hull.pontoons:
        a, b = (hull.columns[i].position for i in pontoon.between)
        total += 2 * math.dist(a, b) * (pontoon.width + pontoon.bottom - pontoon.top)
    return total


def _round_area(profile: tuple) -> float:  # type: ignore[type-arg]
    total = math.pi * profile[-1].diameter ** 2 / 4
    for a, b in pairwise(profile):
        slant = math.hypot(b.depth - a.depth, (b.diameter - a.diameter) / 2)
        total += math.pi * (a.diameter + b.diameter) / 2 * slant
    return float(total)


def even(start: float, end: float, size: float) -> Array:
    """Points from one to the other, at most `size` apart."""
    return np.linspace(start, end, max(1, math.ceil(abs(end - start) / size - 1e-9)) + 1)


def patch(p: Array, q: Array, place: Callable[[Array, Array], tuple[Array, Array, Array]]) -> Panels:
    """The grid `p` x `q`; `place` gives x, y, z. The normal points along dp x dq."""
    pp, qq = (a.ravel() for a in np.meshgrid(p, q, indexing="ij"))
    first = (np.arange(len(p) - 1)[:, None] * len(q) + np.arange(len(q) - 1)).ravel()
    faces = np.stack([first, first + len(q), first + len(q) + 1, first + 1], axis=1)
    return Panels(np.stack(np.broadcast_arrays(*place(pp, qq)), axis=1).astype(float), faces)


# --- barge and ship


def _barge(hull: Barge, size: float) -> Panels:
    x, y = even(0.0, hull.length / 2, size), even(0.0, hull.breadth / 2, size)
    z = even(0.0, -hull.draft, size)
    bottom = patch(y, x, lambda p, q: (q, p, np.full_like(p, -hull.draft)))
    side = patch(x, z, lambda p, q: (p, np.full_like(p, hull.breadth / 2), q))
    end = patch(z, y, lambda p, q: (np.full_like(p, hull.length / 2), q, p))
    quarter = joined([bottom, side, end])
    half = joined([quarter, quarter.mirrored(0)])
    return joined([half, half.mirrored(1)])


def _ship(hull: Ship, size: float) -> Panels:
    """The port half as a grid of stations along x and points along the girth, from the keel to the water line."""
    half = hull.breadth / 2
    ends = (-hull.length / 2, -hull.length / 2 + hull.stern, hull.length / 2 - hull.bow, hull.length / 2)
    x = np.concatenate([even(a, b, size)[:-1] for a, b in pairwise(ends) if b - a > 1e-9 * hull.length] + [ends[-1:]])
    aft = np.clip((ends[1] - x) / hull.stern, 0.0, 1.0)
    fore = np.clip((x - ends[2]) / hull.bow, 0.0, 1.0)
    width = half * (1.0 - np.maximum(aft, fore) ** hull.fullness)
    radius = hull.bilge_radius
    pieces = (half - radius, radius * math.pi / 2, hull.draft - radius)
    counts = [max(1, math.ceil(piece / size - 1e-9)) if piece > 1e-9 * half else 0 for piece in pieces]
    if counts[1]:
        counts[1] = max(3, counts[1])
    flat, bilge, side = (np.linspace(0.0, 1.0, n + 1) for n in counts)
    # girth as (part, fraction): y = flat share of the breadth, bilge, side
    station = np.array([0, *([0] * counts[0]), *([1] * counts[1]), *([2] * counts[2])])
    share = np.concatenate(
        [[0.0], flat[1:] if counts[0] else [], bilge[1:] if counts[1] else [], side[1:] if counts[2] else []]
    )

    def place(p: Array, q: Array) -> tuple[Array, Array, Array]:
        i, j = p.astype(int), q.astype(int)
        b = width[i]
        r = radius * b / half
        t = share[j] * math.pi / 2
        y = np.choose(station[j], [(b - r) * share[j], b - r + r * np.sin(t), b])
        up = np.choose(station[j], [np.zeros_like(b), r * (1 - np.cos(t)), r + (hull.draft - r) * share[j]])
        return x[i], y, up - hull.draft

    port = patch(np.arange(share.size), np.arange(x.size), lambda q, p: place(p, q))
    if port.volumes[2] < 0:
        port = port.flipped()
    return joined([port, port.mirrored(1)])


# --- columns and pontoons


@dataclass(frozen=True)
class _Opening:
    """Where a pontoon meets a column: azimuth of its axis [rad], lateral points [m], the column's radius there [m]."""

    azimuth: float
    lateral: Array
    radius: float
    pontoon: Pontoon

    def offsets(self, factor: float) -> Array:
        """Angles of the lateral points from the axis, on the column as it is drawn."""
        return np.arcsin(self.lateral / (self.radius * factor))


def _semi(hull: SemiSubmersible, size: float) -> Panels:
    depths = tuple(sorted({level for pontoon in hull.pontoons for level in (pontoon.top, pontoon.bottom)}))
    openings: list[list[_Opening]] = [[] for _ in hull.columns]
    for pontoon in hull.pontoons:
        lateral = even(-pontoon.width / 2, pontoon.width / 2, size)
        here, there = (np.array(hull.columns[i].position) for i in pontoon.between)
        azimuth = math.atan2(*(there - here)[::-1])
        for index, turn in zip(pontoon.between, (0.0, math.pi), strict=True):
            radius = (diameter_between(hull.columns[index], pontoon.top, pontoon.bottom) or 0.0) / 2
            openings[index].append(_Opening(azimuth + turn, lateral, radius, pontoon))
    rounds = [_round(column, size, holes) for column, holes in zip(hull.columns, openings, strict=True)]
    parts = [_pontoon(hull, pontoon, size, depths, [factor for _, factor in rounds]) for pontoon in hull.pontoons]
    for column, holes, (theta, factor) in zip(hull.columns, openings, rounds, strict=True):
        parts.append(_column(column, size, holes, depths, theta, factor))
    return joined(parts)


def _levels(top: float, bottom: float, size: float, breaks: tuple[float, ...]) -> Array:
    """Depths from top to bottom, at most `size` apart, with the breaks among them."""
    marks = [top, *(level for level in breaks if top + 1e-9 < level < bottom - 1e-9), bottom]
    return np.concatenate([even(a, b, size)[:-1] for a, b in pairwise(marks)] + [[bottom]])


def _pontoon(
    hull: SemiSubmersible, pontoon: Pontoon, size: float, breaks: tuple[float, ...], factors: list[float]
) -> Panels:
    """The four sides of a pontoon, from wall to wall."""
    ends = [hull.columns[i] for i in pontoon.between]
    start, end = (np.array(column.position) for column in ends)
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    across = np.array([-along[1], along[0]])
    t = even(-pontoon.width / 2, pontoon.width / 2, size)
    radii = [
        (diameter_between(column, pontoon.top, pontoon.bottom) or 0.0) / 2 * factors[i]
        for i, column in zip(pontoon.between, ends, strict=True)
    ]
    steps = even(0.0, 1.0, size / (length - sum(radii)))
    depth = _levels(pontoon.top, pontoon.bottom, size, breaks)

    def at(s: Array, side: Array, z: Array) -> tuple[Array, Array, Array]:
        near, far = (np.sqrt(radius**2 - side**2) for radius in radii)
        run = near + s * (length - far - near)
        return start[0] + run * along[0] + side * across[0], start[1] + run * along[1] + side * across[1], -z

    left, right = np.full(1, t[-1]), np.full(1, t[0])
    return joined(
        [
            patch(steps, t, lambda p, q: at(p, q, np.full_like(p, pontoon.top))),
            patch(t, steps, lambda p, q: at(q, p, np.full_like(p, pontoon.bottom))),
            patch(steps, depth, lambda p, q: at(p, left, q)),
            patch(depth, steps, lambda p, q: at(q, right, p)),
        ]
    )


def _round(column: Column, size: float, holes: list[_Opening]) -> tuple[Array, float]:
    """Angles round a column [rad], and the factor on its radius that gives the polygon the area of the circle."""
    widest = max(station.diameter for station in column.profile) / 2
    factor = 1.0
    for _ in range(8):  # the angles of openings depend, a little, on the factor
        theta = _angles(
            [hole.azimuth % (2 * math.pi) + hole.offsets(factor) for hole in holes], min(size / widest, ROUND)
        )
        factor = math.sqrt(2 * math.pi / float(np.sin(np.diff(theta)).sum()))
    return theta, factor


def _angles(openings: list[Array], step: float) -> Array:
    """Angles over one turn, at most `step` apart, the points of openings among them."""
    if not openings:
        return np.linspace(0.0, 2 * math.pi, 4 * math.ceil(math.pi / 2 / step - 1e-9) + 1)
    spans: list[Array] = []
    for found in sorted(openings, key=lambda a: float(a[0])):
        if not spans or found.size != spans[-1].size or np.abs(found - spans[-1]).max() > 1e-9:
            spans.append(found)  # pontoons above one another share their edges
    angles: list[Array] = []
    for found, following in zip(spans, [*spans[1:], spans[0] + 2 * math.pi], strict=True):
        if found[-1] > following[0] - 1e-9:
            message = "two pontoons meet one another at a column; make them narrower or the column wider"
            raise CaseError([FieldError(("geometry", "hull", "pontoons"), message)])
        angles += [found[:-1], even(found[-1], following[0], step)[:-1]]
    turn = np.concatenate(angles)
    return np.append(turn, turn[0] + 2 * math.pi)


def _column(
    column: Column, size: float, holes: list[_Opening], breaks: tuple[float, ...], theta: Array, factor: float
) -> Panels:
    """Walls between stations, with openings where pontoons join, and a flat bottom."""
    parts = []
    for a, b in pairwise(column.profile):
        ra, rb = factor * a.diameter / 2, factor * b.diameter / 2
        if a.depth == b.depth:
            radius = even(ra, rb, size)
            depth = np.full(radius.size, a.depth)
        else:
            slant = math.hypot(b.depth - a.depth, rb - ra)
            depth = _levels(a.depth, b.depth, size * (b.depth - a.depth) / slant, breaks)
            radius = ra + (rb - ra) * (depth - a.depth) / (b.depth - a.depth)
        parts.append(_wall(column, theta, depth, radius, holes))
    keel = column.profile[-1]
    rings = even(factor * keel.diameter / 2, 0.0, size)
    parts.append(_wall(column, theta, np.full(rings.size, keel.depth), rings, []))
    return joined(parts)


def _wall(column: Column, theta: Array, depth: Array, radius: Array, holes: list[_Opening]) -> Panels:
    """A surface of revolution; downward x counter-clockwise points outward."""
    x0, y0 = column.position

    def place(p: Array, q: Array) -> tuple[Array, Array, Array]:
        i = p.astype(int)
        return x0 + radius[i] * np.cos(q), y0 + radius[i] * np.sin(q), -depth[i]

    made = patch(np.arange(depth.size), theta, place)
    middle = np.repeat(0.5 * (depth[1:] + depth[:-1]), theta.size - 1)
    angle = np.tile(0.5 * (theta[1:] + theta[:-1]), depth.size - 1)
    keep = np.ones(made.count, bool)
    for hole in holes:
        away = (angle - hole.azimuth + math.pi) % (2 * math.pi) - math.pi
        inside = np.abs(away) < math.asin(hole.lateral[-1] / hole.radius)
        keep &= ~(inside & (middle > hole.pontoon.top) & (middle < hole.pontoon.bottom))
    return made.chosen(keep)
