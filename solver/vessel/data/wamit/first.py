"""Added mass and damping (.1), excitation (.3, .2), motions (.4), hydrostatics (.hst), made dimensional."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....case.quantities import DOF
from ....outcome import DataError
from .axis import Frequencies, first_of_the_turn, frequencies, headings, match, shown, span
from .text import Array, Table, magnitude_agrees, place, whole

ROTATION = np.array([0, 0, 0, 1, 1, 1])
RADIATION = ("PER", "I", "J", "A", "B")
FORCE = ("PER", "BETA", "I", "MOD", "PHS", "RE", "IM")
STIFFNESS = ("I", "J", "C")


@dataclass(frozen=True)
class Scale:
    """What turns printed values into SI: 1 for dimensional files, else WAMIT's powers (docs/hydrodynamics.md)."""

    length: float
    density: float
    gravity: float
    dimensional: bool = False

    def radiation(self) -> Array:
        """ρ L^k, k = 3 + rotations among i and j: (6, 6); damping has ω beside."""
        if self.dimensional:
            return np.ones((6, 6))
        return self.density * self.length ** (3.0 + ROTATION[:, None] + ROTATION[None, :])

    def force(self) -> Array:
        """ρ g L^m, m = 2 or 3, per amplitude: (6,)."""
        return np.ones(6) if self.dimensional else self.density * self.gravity * self.length ** (2.0 + ROTATION)

    def stiffness(self) -> Array:
        """ρ g L^k, k = 2 + rotations among i and j: (6, 6)."""
        if self.dimensional:
            return np.ones((6, 6))
        return self.density * self.gravity * self.length ** (2.0 + ROTATION[:, None] + ROTATION[None, :])

    def drift(self) -> Array:
        """ρ g L^k, k = 1 or 2, per amplitude squared: (6,)."""
        return np.ones(6) if self.dimensional else self.density * self.gravity * self.length ** (1.0 + ROTATION)

    def motion(self) -> Array:
        """L^-n, n = 0 or 1, per amplitude: (6,)."""
        return np.ones(6) if self.dimensional else self.length ** (-1.0 * ROTATION)


@dataclass(frozen=True)
class Radiation:
    """omega (W,) finite and rising; matrices as printed, not made symmetric; the limits where they are."""

    omega: Array
    added_mass: Array
    damping: Array
    zero: Array | None
    infinite: Array | None


def read_radiation(table: Table, periods: bool, scale: Scale) -> Radiation:
    """The .1 file. Entries that no frequency has vanish by symmetry. Raises DataError for gaps, with the line."""
    axis = frequencies(table, 0, periods)
    i, j = whole(table, 1, "I"), whole(table, 2, "J")
    pair = 6 * i + j
    if axis.finite.size == 0:
        raise DataError(f"{table.name}: there is no period other than the limits 0 and -1; compute the band of waves")
    rows = place(table, axis.column * 36 + pair, (axis.omega.size, 36))
    pattern = np.flatnonzero((rows >= 0).any(axis=0))
    gaps = np.argwhere(rows[:, pattern] < 0)
    if gaps.size:
        at, p = axis.omega[gaps[0, 0]], pattern[gaps[0, 1]]
        raise DataError(
            f"{table.name}: I {p // 6 + 1}, J {p % 6 + 1} is missing at {at:.5g} rad/s ({len(gaps)} entries in all, "
            f"the last line is {int(table.lines[-1])}); the file is cut off or was edited"
        )
    values = np.zeros((axis.omega.size, 36, 2))
    values[:, pattern] = table.values[rows[:, pattern], 3:5]
    finite = axis.finite
    absent = np.argwhere(np.isnan(values[finite][..., 1]))
    if absent.size:
        row = int(rows[finite[absent[0, 0]], absent[0, 1]])
        raise table.fault(row, "there is no damping; expected 5 columns (PER I J A B) at a finite frequency")
    factor = scale.radiation()
    added = values[..., 0].reshape(-1, 6, 6) * factor
    omega = axis.omega[finite]
    damping = values[finite, :, 1].reshape(-1, 6, 6) * factor
    if not scale.dimensional:
        damping = damping * omega[:, None, None]
    limits = [
        added[np.flatnonzero(edge)[0]] if edge.any() else None for edge in (axis.omega == 0, axis.omega == np.inf)
    ]
    return Radiation(omega, added[finite], damping, *limits)


def read_force(table: Table, periods: bool, factor: Array, omega: Array, modes: bool = True) -> tuple[Array, Array]:
    """A .3, .2 or .4 file at the frequencies `omega` of the .1: headings (H,) and complex (W, H, 6).

    WAMIT's e^{+iωt} and direction of travel are ours. Raises DataError for frequencies that differ and for gaps.
    """
    axis, beta, mode = frequencies(table, 0, periods), headings(table, 1), whole(table, 2, "I")
    magnitude_agrees(table, 3, 5, 6)
    _limits(table, axis)
    where = positions(table, axis, omega)
    angles, column = np.unique(beta, return_inverse=True)
    keep = first_of_the_turn(table, column, (1,), (0, 2), (5, 6))
    cell = (where[axis.column] * angles.size + column) * 6 + mode
    kept = Table(table.name, table.values[keep], table.lines[keep])
    rows = place(kept, cell[keep], (omega.size, angles.size, 6))
    gaps = np.argwhere(rows < 0)
    if gaps.size:
        w, h, dof = gaps[0]
        raise DataError(
            f"{table.name}: {DOF[dof]} is missing at {omega[w]:.5g} rad/s, heading {np.degrees(angles[h]):.5g} deg "
            f"({len(gaps)} entries in all, the last line is {int(table.lines[-1])}); every heading needs every "
            f"frequency and all six modes; the file is cut off or mixes headings"
        )
    values = kept.values[rows]
    return angles, (values[..., 5] + 1j * values[..., 6]) * factor


def _limits(table: Table, axis: Frequencies) -> None:
    if axis.finite.size != axis.omega.size:
        row = int(np.flatnonzero(~np.isin(axis.column, axis.finite))[0])
        raise table.fault(row, "the first column is 0 or -1; forces exist at finite frequencies only")


def positions(table: Table, axis: Frequencies, omega: Array) -> Array:
    """Index into `omega`, the frequencies of the .1, of each frequency of another file. Raises DataError."""
    where = match(axis.omega, omega)
    if np.any(where < 0):
        raise DataError(
            f"{table.name}: {shown(axis.omega[where < 0], 'rad/s')} not in the .1 file, which has {span(omega)}; "
            f"the files are of different runs, or one lists periods and the other frequencies"
        )
    lacking = np.setdiff1d(np.arange(omega.size), where)
    if lacking.size:
        raise DataError(
            f"{table.name}: {shown(omega[lacking], 'rad/s')} of the .1 file are missing ({lacking.size} of "
            f"{omega.size}, the last line is {int(table.lines[-1])}); the file is cut off or of another run"
        )
    return where


def read_stiffness(table: Table, scale: Scale) -> tuple[Array, tuple[str, ...]]:
    """The .hst file: (6, 6) [N/m, N, N m], and a warning for entries that are not there. Raises DataError for entries
    that are given twice, and without C33, C44 and C55.
    """
    i, j = whole(table, 0, "I"), whole(table, 1, "J")
    rows = place(table, 6 * i + j, (6, 6))
    needed = [(2, 2), (3, 3), (4, 4)]
    for a, b in needed:
        if rows[a, b] < 0:
            raise DataError(f"{table.name}: C({a + 1},{b + 1}) is missing; the file is cut off")
    count = int((rows >= 0).sum())
    few = (
        f"{table.name}: {count} of 36 entries are there, the others are taken as zero; look whether the file is cut off"
    )
    return np.where(rows < 0, 0.0, table.values[rows, 2]) * scale.stiffness(), () if count == 36 else (few,)
