"""Mutants of a file by flipped bytes, and what may come of one.

A mutant is numbered, so that (reader, seed, number) makes it again. It may be refused, be read as before, or be read with the
damaged entries alone changed: at most ALLOWED entries for each damaged byte, all others in their places. Anything else is
`other numbers`, a table that moved, or was read in another order or scale.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from solver.outcome import CaseError, DataError

from .subjects import Numbers, Subject

Array = np.ndarray
ALLOWED = 2  # entries for each damaged byte: a byte that joins two rows spoils both
EXTREMES = (0, 127, 128, 255)


def mutate(subject: Subject, seed: int, number: int) -> tuple[dict[str, bytes], int, str]:
    """The files with one to six bytes of one file changed; how many, and where for messages."""
    rng = np.random.default_rng([seed, number])
    name = sorted(subject.files)[int(rng.integers(len(subject.files)))]
    payload = bytearray(subject.files[name])
    count = 1 if rng.random() < 0.7 else int(rng.integers(2, 7))
    places = []
    for place in rng.integers(0, len(payload), count).tolist():
        kind = rng.random()
        old = payload[place]
        if kind < 0.6:
            payload[place] ^= 1 << int(rng.integers(8))
        elif kind < 0.8:
            payload[place] = int(rng.integers(256))
        else:
            payload[place] = EXTREMES[int(rng.integers(len(EXTREMES)))]
        places.append(f"{name}[{place}] {old} -> {payload[place]}")
    return subject.files | {name: bytes(payload)}, count, ", ".join(places)


def outcome(subject: Subject, whole: Numbers, files: dict[str, bytes], count: int) -> str:
    """`refused`, `same`, `entries`, or a sentence on what should not be."""
    try:
        found = subject.read(files)
    except (DataError, CaseError) as error:
        lines = [str(item) for item in getattr(error, "errors", [error])]
        bad = [line for line in lines if not line or len(line) > 1000]
        return f"a refusal that does not help: {bad[0]!r}" if bad else "refused"
    except Exception as error:  # any other exception is a fault of the reader
        return f"{type(error).__name__}: {error}"
    if "panels" in whole:
        return panels_differ(whole["panels"], found["panels"], ALLOWED * count, subject.own_corners)
    return difference(whole, found, ALLOWED * count)


def difference(whole: Numbers, found: Numbers, allowed: int) -> str:
    """How the numbers of a mutant differ from those of the whole file; a table that is no longer there is told by its name."""
    changed = 0
    order = {
        axis: _order(whole[axis], found[axis]) for axis in ("omega", "headings") if axis in whole and axis in found
    }
    for name, values in whole.items():
        if name not in found:
            continue
        other = found[name]
        if other.dtype == object:
            changed += len(set(values.tolist()) ^ set(other.tolist())) // 2 + abs(values.size - other.size)
            continue
        if other.shape != values.shape:
            return f"other numbers: {name} has shape {other.shape}, was {values.shape}"
        changed += _changed(values, _in_order(name, other, order))
    if changed > allowed:
        return f"other numbers: {changed} entries differ, of {allowed} allowed"
    return "entries" if changed else "same"


def panels_differ(whole: Array, found: Array, allowed: int, own_corners: bool) -> str:
    """How panels (N, 4, 3) differ: a corner that moved takes the panels that share it along, the others must be there."""
    before, after = ({tuple(corner) for corner in panels.reshape(-1, 3).tolist()} for panels in (whole, found))
    gone, new = before - after, after - before
    if np.array_equal(whole, found):
        return "same"
    if max(len(gone), len(new)) > allowed:
        return f"other numbers: {len(gone)} corners are gone, {len(new)} are new, of {allowed} allowed"
    panels = [tuple(map(tuple, panel)) for panel in whole.tolist()]
    here = Counter(tuple(map(tuple, panel)) for panel in found.tolist())
    here.subtract(panel for panel in panels if not gone & set(panel))
    missing = -sum(value for value in here.values() if value < 0)
    if missing > allowed or (len(found) != len(whole) and not gone and not own_corners):
        return f"other numbers: {missing} panels are lost, {len(found)} there, were {len(whole)}"
    return "entries"


def _changed(values: Array, other: Array) -> int:
    same = (values == other) | (np.isnan(values) & np.isnan(other)) if values.dtype.kind in "fc" else values == other
    return int(np.count_nonzero(~same))


def _order(values: Array, other: Array) -> Array | None:
    """Where each value of an axis went when a damaged one moved to another place; None when nothing moved."""
    if values.shape != other.shape:
        return None
    here = {value: k for k, value in enumerate(other.tolist())}
    places = [here.pop(value, None) for value in values.tolist()]
    left = iter(sorted(here.values()))
    return np.array([next(left) if place is None else place for place in places])


def _in_order(name: str, table: Array, order: dict[str, Array | None]) -> Array:
    """A table with its frequencies and headings in the order of the whole file's."""
    axes = {
        "omega": ("omega",), "headings": ("headings",), "added_mass": ("omega",), "damping": ("omega",),
        "excitation": ("omega", "headings"), "motions": ("omega", "headings"), "mean_drift": ("omega", "headings"),
        "excitation_zero": ("headings",),
    }.get(name, ())  # fmt: skip
    for position, axis in enumerate(axes):
        where = order.get(axis)
        if where is not None and table.shape[position] == where.size:
            table = np.take(table, where, axis=position)
    return table
