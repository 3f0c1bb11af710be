"""Mean drift (.8, .9) and the difference-frequency QTF (.12d), made dimensional."""

from __future__ import annotations

import numpy as np

from ....case.quantities import DOF
from ....outcome import DataError
from ..qtf import HERMITIAN, QTF
from .axis import Frequencies, first_of_the_turn, frequencies, headings, match, shown, span
from .first import positions
from .text import Array, Table, magnitude_agrees, place, whole

DRIFT = ("PER", "BETA1", "BETA2", "I", "MOD", "PHS", "RE", "IM")
PAIRS = ("PER1", "PER2", "BETA1", "BETA2", "I", "MOD", "PHS", "RE", "IM")
MAX_PAIR_NODES = 500
MAX_CELLS = 12_000_000  # complex numbers of a QTF: 192 MB


def read_mean_drift(table: Table, periods: bool, factor: Array, omega: Array) -> tuple[Array, Array, tuple[str, ...]]:
    """A .8 or .9 file at the frequencies `omega` of the .1: headings (H,), force per amplitude squared (W, H, 6), and
    what was left out.

    Rows of two different headings are left out, modes that are absent are zero. Raises DataError for gaps.
    """
    one = table.values[:, 1] == table.values[:, 2]
    warnings: tuple[str, ...] = ()
    if not one.all():
        warnings = (f"{table.name}: {int((~one).sum())} rows of two different headings are not read",)
        table = Table(table.name, table.values[one], table.lines[one])
    if not one.any():
        raise DataError(f"{table.name}: no row has twice the same heading; compute the unidirectional mean drift")
    axis, beta, mode = frequencies(table, 0, periods), headings(table, 1), whole(table, 3, "I")
    magnitude_agrees(table, 4, 6, 7)
    if axis.finite.size != axis.omega.size:
        raise table.fault(0, "the first column holds 0 or -1; the mean drift exists at finite frequencies only")
    where = positions(table, axis, omega)
    angles, column = np.unique(beta, return_inverse=True)
    first = first_of_the_turn(table, column, (1,), (0, 3), (6, 7))
    kept = Table(table.name, table.values[first], table.lines[first])
    cell = (where[axis.column] * angles.size + column) * 6 + mode
    rows = place(kept, cell[first], (omega.size, angles.size, 6))
    present = (rows >= 0).any(axis=(0, 1))
    gaps = np.argwhere(rows[:, :, present] < 0)
    if gaps.size:
        w, h, dof = gaps[0]
        raise DataError(
            f"{table.name}: {DOF[int(np.flatnonzero(present)[dof])]} is missing at {omega[w]:.5g} rad/s, heading "
            f"{np.degrees(angles[h]):.5g} deg ({len(gaps)} entries in all, the last line is "
            f"{int(table.lines[-1])}); the file is cut off or mixes headings"
        )
    values = np.where(rows < 0, 0.0, kept.values[rows, 6]) * factor
    return angles, values, warnings


def pairs_are_periods(table: Table, omega: Array) -> bool:
    """Whether the columns hold periods, by which reading falls into the range of the other files. Raises DataError."""
    values = np.unique(table.values[:, :2])
    values = values[values > 0]
    inside = []
    for nodes in (2 * np.pi / values, values):
        inside.append(bool(np.all((nodes >= 0.9 * omega[0]) & (nodes <= 1.1 * omega[-1]))))
    if inside[0] != inside[1]:
        return inside[0]
    fit = [float(np.mean(match(nodes, omega) >= 0)) for nodes in (2 * np.pi / values, values)]
    if max(fit) > 0.5 and min(fit) < 0.1:
        return fit[0] > fit[1]
    raise DataError(
        f"{table.name}: {shown(values, '')} may be periods or frequencies beside {span(omega)} of the .1 file; "
        f"give pair_columns: periods or frequencies"
    )


def read_qtf(table: Table, periods: bool, conjugate: bool, factor: Array) -> QTF:
    """A .12d file (or .10d, .11d), one or both triangles, unidirectional and bidirectional pairs of headings.

    conjugate : the file's phase goes with e^{i(ω2 - ω1)t}. Pairs that are absent are NaN if all of those nearer to
    the diagonal are there (a computation of small differences only), else the file is refused as cut off.
    """
    magnitude_agrees(table, 5, 7, 8)
    beta = np.column_stack([headings(table, 2), headings(table, 3)])
    _, column = np.unique(beta, return_inverse=True)
    listed = first_of_the_turn(table, column.reshape(beta.shape), (2, 3), (0, 1, 4), (7, 8))
    table = Table(table.name, table.values[listed], table.lines[listed])
    n = len(table.lines)
    both = Table(table.name, np.concatenate([table.values[:, [0]], table.values[:, [1]]]), np.tile(table.lines, 2))
    axis = frequencies(both, 0, periods)
    count = axis.omega.size
    if axis.finite.size != count or not 2 <= count <= MAX_PAIR_NODES:
        raise DataError(
            f"{table.name}: the pairs hold {count} values of the first columns, {count - axis.finite.size} of them 0 "
            f"or -1; allowed: 2 to {MAX_PAIR_NODES} finite frequencies"
        )
    angles, column = np.unique(np.concatenate([headings(table, 2), headings(table, 3)]), return_inverse=True)
    mode = whole(table, 4, "I")
    blocks = column[:n] * angles.size + column[n:]
    values, found = table.values[:, 7] + 1j * table.values[:, 8], {}
    if np.unique(blocks).size * count**2 * 6 > MAX_CELLS:
        raise DataError(f"{table.name}: more than {MAX_CELLS} values; leave out headings or frequencies")
    for block in np.unique(blocks):
        of = np.flatnonzero(blocks == block)
        part = Table(table.name, table.values[of], table.lines[of])
        cell = (axis.column[:n][of] * count + axis.column[n:][of]) * 6 + mode[of]
        rows = place(part, cell, (count, count, 6))
        filled = np.where(rows < 0, np.nan, values[of][rows])
        _modes_complete(filled, part)
        found[divmod(int(block), angles.size)] = np.conj(filled) if conjugate else filled
    return _assemble(table, axis, angles, found, factor)


def _modes_complete(values: Array, table: Table) -> None:
    """Absent modes become zero where a pair has others; a mode that only some pairs have is a gap. Raises DataError."""
    here = ~np.isnan(values)
    pairs, modes = here.any(axis=2), here.any(axis=(0, 1))
    if np.any(pairs[:, :, None] & modes & ~here):
        raise DataError(
            f"{table.name}: some pairs lack modes that others have (the last line is {int(table.lines[-1])}); "
            f"the file is cut off or was edited"
        )
    values[pairs] = np.where(here[pairs], values[pairs], 0.0)


def _assemble(
    table: Table, axis: Frequencies, angles: Array, found: dict[tuple[int, int], Array], factor: Array
) -> QTF:
    omega = axis.omega
    single = [a for a in range(angles.size) if (a, a) in found]
    if not single:
        raise DataError(f"{table.name}: no pair has twice the same heading; compute the unidirectional QTF too")
    place_of = {a: index for index, a in enumerate(single)}
    full = []
    for a in single:
        mirror = np.conj(found[a, a].transpose(1, 0, 2))
        values = np.where(np.isnan(found[a, a]), mirror, found[a, a])
        _band(~np.isnan(values[:, :, 0]), omega, table)
        full.append(values * factor)
    cross = {}
    for (a, b), values in found.items():
        if a != b and a in place_of and b in place_of and (place_of[a], place_of[b]) not in cross:
            other = found.get((b, a))
            if other is not None:
                twin = np.conj(other.transpose(1, 0, 2))
                _twins_agree(values, twin, table, angles[[a, b]])
                values = np.where(np.isnan(values), twin, values)
            low, high = sorted((a, b))
            part = values if a < b else np.conj(values.transpose(1, 0, 2))
            _band(~np.isnan(part[:, :, 0]), omega, table)
            cross[place_of[low], place_of[high]] = part * factor
    return QTF(omega, angles[single], np.array(full), table.name, cross)


def _twins_agree(values: Array, twin: Array, table: Table, angles: Array) -> None:
    """Raises DataError where a pair of headings is there both ways round and the two are not each other's conjugate."""
    both = ~np.isnan(values) & ~np.isnan(twin)
    size, gap = np.where(both, np.abs(values), 0.0).max(axis=(0, 1)), np.where(both, np.abs(values - twin), 0.0)
    size = np.repeat(size.reshape(2, 3).max(axis=1), 3)  # what vanishes by symmetry is round-off of the others
    if np.any(gap > HERMITIAN * size):
        first, second = np.degrees(angles)
        raise DataError(
            f"{table.name}: the headings {first:g}, {second:g} deg are there both ways round and contradict each other "
            f"by more than {100 * HERMITIAN:g} % of the largest, T2(m, n) = T2(n, m)*; leave one of the two out"
        )


def _band(known: Array, omega: Array, table: Table) -> None:
    """Raises DataError unless the known pairs are all those up to some difference of frequencies."""
    gap = np.abs(omega[:, None] - omega[None, :])
    if known.all():
        return
    reach = float(gap[~known].min())
    beyond = known & (gap > reach * (1 + 1e-6))
    if beyond.any() or reach == 0.0:
        m, k = np.argwhere(~known)[0]
        raise DataError(
            f"{table.name}: the pair {omega[m]:.5g}, {omega[k]:.5g} rad/s is missing ({int((~known).sum())} of "
            f"{known.size} pairs, both triangles counted; the last line is {int(table.lines[-1])}); the file is cut "
            f"off, or compute all pairs up to one difference"
        )
