"""A root between two ends where a function changes sign: the ITP method of Oliveira and Takahashi (2021)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from ..outcome import NotConverged

PULL = 0.2  # share of the first bracket by which a secant is moved towards its middle, falling with the bracket squared
SLACK = 1  # halvings more than bisection would need, at most


@dataclass(frozen=True)
class Root:
    """Where the sign changes, how often the function was called inside the bracket, and the bracket's width at the end."""

    value: float
    calls: int
    width: float


def find_root(
    function: Callable[[float], float], low: float, high: float, tolerance: float, at_low: float, at_high: float
) -> Root:
    """The root in low < x < high, to ± tolerance; at_low, at_high are the function's values at the ends.

    Never slower than bisection by more than one call; a jump through zero counts as a root. Raises NotConverged when
    both ends have one sign, or the function gives NaN.
    """
    for x, y in ((low, at_low), (high, at_high)):
        if y == 0.0:
            return Root(x, 0, 0.0)
    if math.isnan(at_low) or math.isnan(at_high) or (at_low > 0.0) == (at_high > 0.0):
        raise _failed(f"no change of sign between {low:.6g} and {high:.6g}")
    first = high - low
    tolerance = max(tolerance, 2.0 * math.ulp(max(abs(low), abs(high))))
    most = max(math.ceil(math.log2(first / (2.0 * tolerance))), 0) + SLACK
    for call in range(most):
        width = high - low
        if width <= 2.0 * tolerance:
            return Root(0.5 * (low + high), call, width)
        x = _next(low, high, at_low, at_high, PULL * width**2 / first, tolerance * 2.0 ** (most - call) - 0.5 * width)
        y = function(x)
        if math.isnan(y):
            raise _failed(f"no value at {x:.6g}")
        if y == 0.0:
            return Root(x, call + 1, 0.0)
        if (y > 0.0) == (at_high > 0.0):
            high, at_high = x, y
        else:
            low, at_low = x, y
    return Root(0.5 * (low + high), most, high - low)


def _next(low: float, high: float, at_low: float, at_high: float, pull: float, reach: float) -> float:
    """Interpolate, truncate, project: the secant's root, moved towards the middle, and held within `reach` of it."""
    middle = 0.5 * (low + high)
    secant = low + (high - low) * (at_low / (at_low - at_high))
    if not math.isfinite(secant):
        return middle
    towards = math.copysign(1.0, middle - secant)
    x = secant + towards * pull if pull <= abs(middle - secant) else middle
    return x if abs(x - middle) <= reach else middle - towards * max(reach, 0.0)


def _failed(why: str) -> NotConverged:
    return NotConverged("statics", f"the search for a root failed: {why}.", "Check the line's ends and its length.")
