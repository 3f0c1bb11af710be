"""Finds the anchor radius, or a segment's length, that gives a wanted pretension (docs/theory.md, S9).

The catenary of the averaged line gives the start by bracketing; a secant on the discretised line, still water, finishes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..case import Case
from ..model.line import LineModel, anchor_point, discretise, has_current
from ..outcome import CaseError, FieldError, NotConverged
from .catenary import solve_catenary
from .newton import State, equilibrium
from .root import find_root
from .start import first_shape

Array = np.ndarray
NEUTRAL = 1e-3  # weight in water over dry weight, below which a slack line is neutral


def least_tension(line: LineModel, drop: float) -> float | None:
    """A tension [N] that the upper end exceeds whatever the radius: the weight of what hangs above the bed (S17).

    drop : height of the upper end above the bed [m]. None where a part of the line or an attachment floats.
    """
    arrays, wanted = line.arrays, float(line.wanted or 0.0)
    weight, hung = arrays.w_dry - arrays.b_wet, arrays.point_weight - arrays.point_lift
    if weight.min() < 0.0 or hung.min() < 0.0:
        return None
    lengths, order = arrays.L, slice(None) if line.anchor_at_b else slice(None, None, -1)
    reach = drop / (1.0 + wanted / float(arrays.EA.min()))
    arc = np.concatenate([[0.0], np.cumsum(lengths[order])])
    share = np.clip((reach - arc[:-1]) / np.diff(arc), 0.0, 1.0)
    return float(share @ weight[order] + hung[order][arc < reach].sum())


def still_water(line: LineModel) -> LineModel:
    """The same line without current."""
    return replace(line, arrays=line.arrays._replace(current_v=np.zeros_like(line.arrays.current_v)))


def place(case: Case, line: LineModel, frame: float, tolerance: float, most: int) -> tuple[LineModel, State]:
    """The line with its anchor or its length found, so that its other end has the wanted tension, and its equilibrium.

    The equilibrium is that in still water with both ends held. Raises CaseError, with the range of tensions that can be
    had, when none fits; NotConverged when the search or the equilibrium fails.
    """
    if line.wanted is None:
        return line, held(line, None, tolerance, most)
    loc: tuple[str | int, ...] = ("lines", line.name, "end_b" if line.anchor_at_b else "end_a", "anchor", "pretension")
    if any(segment.length == "find" for segment in line.spec.segments):

        def with_length(length: float) -> LineModel:
            return replace(line, arrays=discretise(case, line.name, frame, length))

        fixed = line.length - 1000.0  # what the model holds for a length still to be found
        chord = float(np.linalg.norm(_point(line.end_b.point) - _point(line.end_a.point)))
        strain = line.wanted / float(line.arrays.EA.min())  # at most, where the line is straight
        low = max(0.9 * chord / (1.0 + strain) - fixed, 1e-3 * chord)
        across = _point(line.end_b.point) - _point(line.end_a.point)
        way = float(np.hypot(*across[:2]) + abs(across[2]))  # straight down and along the bed: no more is pulled in
        return _search(Search(line, with_length, low, max(1.001 * way - fixed, 1.1 * low), -1.0, most), loc)
    drop = float(_point(line.end_a.point if line.anchor_at_b else line.end_b.point)[2] + case.environment.depth)
    stretch = 1.0 + line.wanted * float((line.arrays.L / line.arrays.EA).sum()) / line.length
    if drop >= line.length * stretch:
        raise CaseError(
            [FieldError(loc[:2], f"{line.length:g} m of line cannot reach the seabed {drop:g} m below its end")]
        )

    least = least_tension(line, drop)
    if least is not None and line.wanted < least:
        raise CaseError([FieldError(
            loc, f"{line.wanted:g} N is less than the weight of the line that hangs between its upper end and the bed, "
            f"{drop:g} m below; allowed: more than {least:.5g} N", f"{line.wanted:g}",
        )])  # fmt: skip

    def with_radius(radius: float) -> LineModel:
        return line.with_end(anchor_point(case, line, radius))

    high = float(np.sqrt(max((line.length * stretch) ** 2 - drop**2, 0.0))) * (1 - 1e-9)
    low = min(max(0.02 * line.length, line.length - drop), 0.5 * high)
    return _search(Search(line, with_radius, low, high, 1.0, most), loc)


def held(line: LineModel, start: State | None, tolerance: float, most: int) -> State:
    """Equilibrium in still water with both ends held, from a state of the same nodes or from the first shape.

    A slack line that is neutral in water has no shape in still water: in a current it keeps the current, else it is refused.
    """
    a, b = _point(line.end_a.point), _point(line.end_b.point)
    if not _shapeless(line, a, b):
        line = still_water(line)
    if start is None:
        state = State([first_shape(line, a, b)], np.zeros(6))
    else:  # the old shape, its ends brought to where they are
        share = (line.node_arc / line.length)[:, None]
        shape = start.shapes[0] + (1.0 - share) * (a - start.shapes[0][0]) + share * (b - start.shapes[0][-1])
        shape[0], shape[-1] = a, b
        state = State([shape], np.zeros(6), tensions=start.tensions)
    return equilibrium([line], state, [np.zeros((line.nodes, 3))], None, tolerance, most)


def _shapeless(line: LineModel, a: Array, b: Array) -> bool:
    """Whether neither weight nor tension gives the line a shape in still water. Raises NotConverged without a current."""
    arrays = line.arrays
    dry = float(arrays.w_dry.sum() + arrays.point_weight.sum())
    net = float(np.abs(arrays.w_dry - arrays.b_wet).sum() + np.abs(arrays.point_weight - arrays.point_lift).sum())
    spare = line.length - float(np.linalg.norm(b - a))
    if net > NEUTRAL * dry or spare <= 0.0:
        return False
    if has_current(arrays):
        return True
    raise NotConverged(
        "statics",
        f"line {line.name!r} weighs {net / line.length:.3g} N/m in water, {net / dry:.1e} of its dry weight (threshold "
        f"{NEUTRAL:g}), and is {spare:.4g} m longer than the distance of its ends: nothing gives it a shape.",
        f"Give it a weight or a buoyancy above {NEUTRAL * dry / line.length:.3g} N/m, or make it shorter than that distance.",
    )


def top_tension(line: LineModel, state: State) -> float:
    """Tension of the end that is not the anchor [N], from the equilibrium of this one line."""
    force = state.end_forces[0][3:] if line.anchor_at_b else state.end_forces[0][:3]
    return float(np.linalg.norm(force))


def _point(point: Array | None) -> Array:
    if point is None:
        raise NotConverged("statics", "an end of the line has no position.", "Give a point or an azimuth.")
    return point


@dataclass
class Search:
    """The search for the radius or length between `low` and `high` [m] that gives the wanted tension.

    make : the line of a value; sign : whether tension rises (1) or falls (-1) with it; most : iterations of statics.
    """

    line: LineModel
    make: Callable[[float], LineModel]
    low: float
    high: float
    sign: float
    most: int
    last: tuple[float, State] | None = None

    @property
    def wanted(self) -> float:
        return float(self.line.wanted or 0.0)

    def tension(self, value: float) -> float:
        """Tension of the discretised line at its upper end [N]; starts from the last shape where that is near."""
        line = self.make(value)
        near = self.last is not None and abs(value - self.last[0]) < 0.02 * self.last[0]
        state = held(line, self.last[1] if near and self.last is not None else None, 1e-10, self.most)
        self.last = value, state
        return top_tension(line, state)

    def error(self, value: float) -> float:
        """Logarithm of tension over wanted, in the sense that it rises with the value."""
        return self.sign * math.log(self.tension(value) / self.wanted)

    def guess(self) -> float:
        """The value that the averaged line's catenary gives [m], or the middle where it gives none."""

        def rough(value: float) -> float:
            return _catenary_tension(self.make(value)) - self.wanted

        at_low, at_high = rough(self.low), rough(self.high)
        if at_low * at_high > 0:
            return 0.5 * (self.low + self.high)
        return find_root(rough, self.low, self.high, 1e-6, at_low, at_high).value


def _search(search: Search, loc: tuple[str | int, ...]) -> tuple[LineModel, State]:
    """A secant inside a bracket of the discretised line, which is halved where the secant leaves it (S9)."""
    low, high = search.low, search.high
    value, before = search.guess(), math.nan
    error, error_before = search.error(value), math.nan
    for _ in range(100):
        if abs(error) < 1e-9 or high - low < 1e-13 * high:
            break
        low, high = (value, high) if error < 0.0 else (low, value)
        if math.isnan(before):
            step = -math.copysign(1e-5 * value, error)
        else:
            slope = (error - error_before) / (value - before)
            step = -error / slope if slope > 0.0 else math.inf
        before, error_before = value, error
        value = value + step if low < value + step < high else 0.5 * (low + high)
        error = search.error(value)
    if abs(error) < 1e-7 and search.last is not None:
        return search.make(value), search.last[1]
    ends = sorted((search.tension(search.low), search.tension(search.high)))
    if ends[0] < search.wanted < ends[1]:
        raise NotConverged(
            "statics",
            f"the search for the pretension of line {search.line.name!r} stopped at {100 * math.expm1(abs(error)):.3g} % "
            f"from {search.wanted:.4g} N.",
            "Use shorter elements or another pretension.",
        )
    raise CaseError([FieldError(
        loc, f"{search.wanted:g} N cannot be reached with this line; allowed: about {ends[0]:.4g} to {ends[1]:.4g} N",
        f"{search.wanted:g}",
    )])  # fmt: skip


def _catenary_tension(line: LineModel) -> float:
    """Upper-end tension of the averaged line [N]; large where the catenary is too taut to solve."""
    a, b = _point(line.end_a.point), _point(line.end_b.point)
    low, high = (a, b) if b[2] >= a[2] else (b, a)
    arrays = line.arrays
    weight = max(
        float((arrays.w_dry - arrays.b_wet).sum() + (arrays.point_weight - arrays.point_lift).sum()) / line.length, 1e-9
    )
    EA = line.length / float((arrays.L / arrays.EA).sum())
    span, drop = float(np.hypot(*(high - low)[:2])), float(high[2] - low[2])
    found = solve_catenary(span, drop, line.length, weight, EA, bool(arrays.depth > low[2] - 1.0))
    if found is not None:
        return found.tension
    chord = float(np.hypot(span, drop))
    return EA * max(chord / line.length - 1.0, 0.0) + weight * drop
