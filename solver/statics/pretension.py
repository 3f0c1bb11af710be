"""Finds the anchor radius, or a segment's length, that gives a wanted pretension (docs/theory.md, S9).

The catenary of the averaged line gives the start by bracketing; a secant on the discretised line, still water, finishes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..case import Case
from ..model.line import LineModel, anchor_point, discretise
from ..outcome import CaseError, FieldError, NotConverged
from .catenary import solve_catenary
from .newton import State, equilibrium
from .root import find_root
from .start import first_shape

Array = np.ndarray


def still_water(line: LineModel) -> LineModel:
    """The same line without current."""
    return replace(line, arrays=line.arrays._replace(current_v=np.zeros_like(line.arrays.current_v)))


def place(case: Case, line: LineModel, frame: float) -> LineModel:
    """The line with its anchor or its length found, so that its other end has the wanted tension.

    Raises CaseError, with the range of tensions that can be had, when none fits; NotConverged when the search fails.
    """
    if line.wanted is None:
        return line
    loc: tuple[str | int, ...] = ("lines", line.name, "end_b" if line.anchor_at_b else "end_a", "anchor", "pretension")
    if any(segment.length == "find" for segment in line.spec.segments):
        index = next(i for i, segment in enumerate(line.spec.segments) if segment.length == "find")

        def with_length(length: float) -> LineModel:
            return replace(line, arrays=discretise(case, line.name, frame, length))

        fixed = line.length - 1000.0  # what the model holds for a length still to be found
        chord = float(np.linalg.norm(_point(line.end_b.point) - _point(line.end_a.point)))
        low, high = max(0.9 * chord - fixed, 1e-3 * chord), 2.0 * chord + 2.0 * case.environment.depth
        del index
        return _search(line, with_length, low, high, loc)
    drop = float(_point(line.end_a.point if line.anchor_at_b else line.end_b.point)[2] + case.environment.depth)
    stretch = 1.0 + line.wanted * float((line.arrays.L / line.arrays.EA).sum()) / line.length
    if drop >= line.length * stretch:
        raise CaseError(
            [FieldError(loc[:2], f"{line.length:g} m of line cannot reach the seabed {drop:g} m below its end")]
        )

    def with_radius(radius: float) -> LineModel:
        return line.with_end(anchor_point(case, line, radius))

    high = float(np.sqrt(max((line.length * stretch) ** 2 - drop**2, 0.0)))
    return _search(line, with_radius, max(0.02 * line.length, line.length - drop), high * (1 - 1e-9), loc)


def _point(point: Array | None) -> Array:
    if point is None:
        raise NotConverged("statics", "an end of the line has no position.", "Give a point or an azimuth.")
    return point


def _search(
    line: LineModel, make: Callable[[float], LineModel], low: float, high: float, loc: tuple[str | int, ...]
) -> LineModel:
    wanted = float(line.wanted or 0.0)

    def rough(value: float) -> float:
        return _catenary_tension(make(value)) - wanted

    at_low, at_high = rough(low), rough(high)
    if at_low * at_high > 0:
        lo, hi = sorted((at_low + wanted, at_high + wanted))
        raise CaseError([FieldError(
            loc, f"{wanted:g} N cannot be reached with this line; allowed: about {lo:.4g} to {hi:.4g} N", f"{wanted:g}"
        )])  # fmt: skip
    guess = find_root(rough, low, high, 1e-6, at_low, at_high).value
    values = [guess, guess * (1.0 + 1e-5)]
    errors = [top_tension(make(value)) - wanted for value in values]
    for _ in range(40):
        if abs(errors[-1]) < 1e-9 * wanted:
            return make(values[-1])
        slope = (errors[-1] - errors[-2]) / (values[-1] - values[-2])
        step = np.clip(-errors[-1] / slope, -0.02 * guess, 0.02 * guess) if slope != 0 else 0.0
        if abs(step) < 1e-13 * guess:
            return make(values[-1])
        values.append(float(values[-1] + step))
        errors.append(top_tension(make(values[-1])) - wanted)
    raise NotConverged(
        "statics",
        f"the search for the pretension of line {line.name!r} stopped {abs(errors[-1]):.3g} N from {wanted:.4g} N.",
        "Use shorter elements or another pretension.",
    )


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


def top_tension(line: LineModel) -> float:
    """Tension of the end that is not the anchor, in still water, both ends held [N]."""
    line = still_water(line)
    a, b = _point(line.end_a.point), _point(line.end_b.point)
    state = State([first_shape(line, a, b)], np.zeros(6))
    solved = equilibrium([line], state, [np.zeros((line.nodes, 3))], None, 1e-10, 2000)
    force = solved.end_forces[0][3:] if line.anchor_at_b else solved.end_forces[0][:3]
    return float(np.linalg.norm(force))
