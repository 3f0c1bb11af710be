"""The first column and the headings of WAMIT's files: periods or frequencies, 0 and -1, degrees."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....outcome import DataError
from ..interpolate import TURN
from .text import Array, Table

CLEAR = 3.0  # the heave force at one end over that at the other, to tell periods from frequencies
MAX_OMEGA, MAX_HEADINGS = 2000, 721
SAME = 2e-5  # of a frequency or (in rad) of a heading: what files of six printed digits differ by


@dataclass(frozen=True)
class Frequencies:
    """omega : rising, 0 and infinity included; column : rows -> index into omega."""

    omega: Array
    column: Array

    @property
    def finite(self) -> Array:
        return np.flatnonzero((self.omega > 0) & np.isfinite(self.omega))


def frequencies(table: Table, column: int, periods: bool) -> Frequencies:
    """Angular frequencies of a column of periods (-1: infinite, 0: zero) or frequencies (0; -1: infinite).

    Raises DataError for other negative values, and for two that print alike but differ.
    """
    values = table.values[:, column]
    with np.errstate(divide="ignore", over="ignore"):
        omega = TURN / values if periods else values.copy()
    omega[values < 0] = 0.0 if periods else math.inf
    bad = np.flatnonzero((values < 0) & (values != -1.0) | np.isinf(omega) & (values > 0))
    if bad.size:
        raise table.fault(
            int(bad[0]), f"the first column is {values[bad[0]]:g}; allowed: positive, 0 or -1 (its limits)"
        )
    unique, index = np.unique(omega, return_inverse=True)
    if unique.size > MAX_OMEGA:
        raise DataError(f"{table.name}: {unique.size} different periods; allowed: at most {MAX_OMEGA}")
    inner = unique[np.isfinite(unique)]
    close = np.flatnonzero(np.diff(inner) < SAME * inner[1:])
    if close.size:
        raise table.fault(
            int(np.flatnonzero(omega == inner[close[0] + 1])[0]),
            f"{inner[close[0] + 1]:.7g} rad/s is all but the same as {inner[close[0]]:.7g}; give one of them",
        )
    return Frequencies(unique, index)


def headings(table: Table, column: int) -> Array:
    """Headings of a column of degrees, in [0, 2π) [rad]; -180 and 180 become one. Raises DataError beyond ±720."""
    degrees = table.values[:, column]
    bad = np.flatnonzero(np.abs(degrees) > 720)
    if bad.size:
        raise table.fault(int(bad[0]), f"the heading is {degrees[bad[0]]:g}; allowed: -720 to 720 degrees")
    angle = np.round(np.radians(degrees % 360.0), 12)
    angle = np.where(TURN - angle < 1e-9, 0.0, angle)
    if np.unique(angle).size > MAX_HEADINGS:
        raise DataError(f"{table.name}: {np.unique(angle).size} headings; allowed: at most {MAX_HEADINGS}")
    return angle


def first_listed(column: Array, printed: Array) -> Array:
    """Of one direction (column) that is printed in two ways, as -180 and 180, the rows of the first: a mask."""
    values, first, back = np.unique(printed, return_index=True, return_inverse=True)
    if values.size == np.unique(column).size:
        return np.ones(column.shape, dtype=bool)
    chosen: dict[int, int] = {}
    for k in np.argsort(first):
        chosen.setdefault(int(column[first[k]]), int(k))
    return np.isin(back, list(chosen.values()))


def match(wanted: Array, have: Array) -> Array:
    """Index into `have` of each of `wanted`, -1 where none is within printing accuracy."""
    distance = np.abs(np.asarray(have)[None, :] - wanted[:, None])
    near = distance.argmin(axis=1)
    ok = distance[np.arange(wanted.size), near] <= SAME * np.maximum(np.abs(wanted), 1.0)
    return np.where(ok, near, -1)


def tell(force: Table | None, value_column: int, mode_column: int) -> tuple[bool | None, float]:
    """Whether the first column holds periods, by the heave force that long waves make largest; None when unclear.

    Also the ratio it was told by: the largest heave force over headings at the greatest value to that at the least.
    """
    if force is None:
        return None, 1.0
    values = force.values[(force.values[:, mode_column] == 3) & (force.values[:, 0] > 0)]
    if values.size == 0:
        return None, 1.0
    low, high = values[:, 0].min(), values[:, 0].max()
    least, most = (np.abs(values[values[:, 0] == end, value_column]).max() for end in (low, high))
    if low == high or max(least, most) == 0:
        return None, 1.0
    ratio = float(most / max(least, 1e-300))
    return (None if 1 / CLEAR < ratio < CLEAR else ratio > 1), ratio


def span(omega: Array) -> str:
    """Such as "40 frequencies of 0.05 to 2 rad/s", for messages."""
    inner = omega[(omega > 0) & np.isfinite(omega)]
    if inner.size == 0:
        return "no finite frequency"
    return f"{inner.size} frequencies of {inner[0]:.4g} to {inner[-1]:.4g} rad/s"


def shown(values: Sequence[float] | Array, unit: str) -> str:
    """The first few of some values, for messages."""
    text = ", ".join(f"{value:.5g}" for value in list(values)[:5])
    return f"{text}{', …' if len(values) > 5 else ''} {unit}"
