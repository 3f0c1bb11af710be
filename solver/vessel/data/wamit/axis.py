"""The first column and the headings of WAMIT's files: periods or frequencies, 0 and -1, degrees."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....outcome import DataError
from ....waves.dispersion import wave_number
from ..interpolate import TURN
from .text import Array, Table

CLEAR = 3.0  # the heave force at one end over that at the other, to tell periods from frequencies
MAX_OMEGA, MAX_HEADINGS = 2000, 721
LONG, APART = 0.95, 1.3  # heave force of a long wave over that of the longest; ratio of two first columns to compare
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


def first_of_the_turn(
    table: Table, column: Array, angles: tuple[int, ...], keys: tuple[int, ...], values: tuple[int, ...]
) -> Array:
    """Rows to keep when one direction is listed in two ways, as -180 and 180: those of the first, a mask.

    column : direction of each row, or of each row and `angles` column, (R,) or (R, A). Rows are compared with those of
    the same `keys`, the mode last, and direction, in whatever order they are. Raises DataError where their `values` differ.
    """
    printed = table.values[:, angles]
    keep = np.asarray(first_listed(column.ravel(), printed.ravel()).reshape(printed.shape).all(axis=1))
    if keep.all():
        return keep
    cells = np.column_stack([table.values[:, keys], column.reshape(printed.shape)])
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    cell = cell.ravel()
    kept = np.full(cell.max() + 1, -1)
    kept[cell[keep]] = np.flatnonzero(keep)
    others = np.flatnonzero(~keep & (kept[cell] >= 0))
    if others.size < np.count_nonzero(~keep):
        row = int(np.flatnonzero(~keep & (kept[cell] < 0))[0])
        raise table.fault(row, f"heading {_angles(printed[row])} has an entry that the same direction lacks elsewhere")
    twins = kept[cell[others]]
    have, rotation = table.values[:, values], table.values[:, keys[-1]] > 3
    size = np.array([np.abs(have[rotation == kind]).max(initial=0.0) for kind in (False, True)])[rotation.astype(int)]
    gap = np.abs(have[others] - have[twins])
    bad = np.flatnonzero((gap > 1e-3 * np.abs(have[twins]) + 1e-4 * size[others, None]).any(axis=1))
    if bad.size:
        row, twin = int(others[bad[0]]), int(twins[bad[0]])
        raise table.fault(
            row,
            f"headings {_angles(printed[row])} and {_angles(printed[twin])} are one direction but their values differ "
            f"(line {int(table.lines[twin])})",
        )
    return keep


def _angles(printed: Array) -> str:
    return ", ".join(f"{value:g}" for value in printed)


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


def wave_number_slope(
    force: Table, columns: tuple[int, int], depth: float, gravity: float
) -> tuple[float, float] | None:
    """Whether a first column that rises with the frequency may hold wave numbers: two powers, or None when unclear.

    The horizontal force of long waves grows with their wave number k (docs/theory-vessel.md, Q13). Returned are the power of
    the first column with which it grows between two long waves, near 1 if the column holds k, and the power that k
    has if the column holds frequencies, 2 in deep water. Long waves: heave forces that still are 0.95 of the longest's.
    columns : those of the mode and of the modulus.
    """
    mode, modulus = columns
    values = np.unique(force.values[force.values[:, 0] > 0, 0])
    if values.size < 2:
        return None
    at = np.searchsorted(values, force.values[:, 0])
    largest = np.zeros((values.size, 3))
    for dof in range(3):
        rows = (force.values[:, mode] == dof + 1) & (force.values[:, 0] > 0)
        np.maximum.at(largest[:, dof], at[rows], np.abs(force.values[rows, modulus]))
    side = np.hypot(largest[:, 0], largest[:, 1])
    long = np.logical_and.accumulate(largest[:, 2] >= LONG * largest[0, 2])
    last = int(np.flatnonzero(long)[-1])
    ratio = values[last] / values[0]
    if ratio < APART or not side[0] > 0 or not side[last] > 0:
        return None
    k = np.asarray(wave_number(values[[0, last]], depth, gravity))
    return tuple(float(np.log(pair[1] / pair[0]) / np.log(ratio)) for pair in (side[[0, last]], k))  # type: ignore[return-value]


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
