"""Columns of numbers as Fortran prints them, from files of anybody: bounded, every fault with its line."""

from __future__ import annotations

import io
import math
import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ....outcome import DataError

Array = np.ndarray
MAX_ROWS = 3_000_000
MAX_LINE = 2000  # characters
_FORTRAN = re.compile(rb"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdDqQ]?([+-]?\d+))")


@dataclass(frozen=True)
class Table:
    """Rows of one file. values : (R, C), NaN where a row is shorter than the widest allowed; lines : (R,) from 1."""

    name: str
    values: Array
    lines: Array

    def fault(self, row: int, message: str) -> DataError:
        return DataError(f"{self.name}, line {int(self.lines[row])}: {message}")


def read_table(payload: bytes, name: str, columns: Sequence[str], optional: int = 0) -> Table:
    """The numbers of a text file; the last `optional` columns may be absent from a row.

    Exponents without a letter (1.0-100) and with D are read; one heading line is skipped. Raises DataError with the
    line for a wrong number of columns, what is not a number, NaN, infinity and ****.
    """
    quick = _all_alike(payload, name, len(columns))
    if quick is not None:
        return quick
    wide, flat, lines = len(columns), array("d"), array("q")
    for number, line in _lines(payload, name):
        words = line.split()
        if not words:
            continue
        where = f"{name}, line {number}"
        if number == 1 and not lines and _heading(words):
            continue
        if not wide - optional <= len(words) <= wide:
            allowed = f"{wide - optional} or {wide}" if optional else f"{wide}"
            raise DataError(
                f"{where}: {len(words)} columns; expected {allowed} ({' '.join(columns)}), separated by blanks; "
                f"is the file cut off, or of another kind?"
            )
        flat.extend(_number(word, where) for word in words)
        flat.extend([math.nan] * (wide - len(words)))
        lines.append(number)
        if len(lines) > MAX_ROWS:
            raise DataError(f"{where}: more than {MAX_ROWS} rows; leave out frequencies or headings")
    _last_row(payload, name)
    if not lines:
        raise DataError(f"{name}: there are no numbers in the file; expected rows of {' '.join(columns)}")
    return Table(name, np.array(flat).reshape(-1, wide), np.array(lines))


def _all_alike(payload: bytes, name: str, wide: int) -> Table | None:
    """A file whose every line is a row of so many plain numbers, read ten times as fast; None for any other."""
    first = payload[: payload.find(b"\n") + 1 or MAX_LINE]
    skip = int(_heading(first.split()))
    count = payload.count(b"\n") + (not payload.endswith(b"\n")) - skip
    ends = np.flatnonzero(np.frombuffer(payload, np.uint8) == 10)
    widest = int(np.diff(ends, prepend=-1, append=len(payload)).max())
    if b"_" in payload or widest > MAX_LINE or count > MAX_ROWS:
        return None
    try:
        values = np.loadtxt(io.BytesIO(payload), ndmin=2, comments=None, skiprows=skip, encoding="ascii")
    except (ValueError, UnicodeError):
        return None
    if values.shape != (count, wide) or not np.isfinite(values).all():
        return None  # the slow way finds the line
    _last_row(payload, name)
    return Table(name, values, np.arange(count) + 1 + skip)


def _lines(payload: bytes, name: str) -> Iterator[tuple[int, bytes]]:
    """Lines and their numbers, without a copy of the whole."""
    start, number, end = 0, 0, len(payload)
    while start < end:
        stop = payload.find(b"\n", start)
        stop = end if stop < 0 else stop
        number += 1
        if stop - start > MAX_LINE:
            raise DataError(f"{name}, line {number}: {stop - start} characters; allowed: at most {MAX_LINE} in a line")
        yield number, payload[start:stop]
        start = stop + 1


def _last_row(payload: bytes, name: str) -> None:
    """Raises DataError when the last row has no end and is shorter than the rows of one width before it."""
    if payload.endswith((b"\n", b"\r")):
        return
    *before, last = payload[-20 * MAX_LINE :].split(b"\n")
    rows = [row.rstrip() for row in before[1:] if len(row.split()) == len(last.split())][-20:]
    widths = {len(row) for row in rows}
    if len(rows) > 1 and len(widths) == 1 and len(last.rstrip()) < widths.pop():
        number = payload.count(b"\n") + 1
        raise DataError(
            f"{name}, line {number}: the last row is shorter than those before and has no end; it is cut off"
        )


def _heading(words: list[bytes]) -> bool:
    """Whether a first line is the heading that NUMHDR = 1 writes: with words that are no kind of number."""
    return any(word[:1].isalpha() and not word.lower().startswith((b"nan", b"inf")) for word in words)


def _number(word: bytes, where: str) -> float:
    try:
        value = float(word) if b"_" not in word else math.nan
    except ValueError:
        found = _FORTRAN.fullmatch(word)
        value = float(b"%be%b" % found.groups()) if found else math.nan
    if math.isfinite(value):
        return value
    shown = word[:30].decode("ascii", "backslashreplace")
    if b"*" in word:
        raise DataError(f"{where}: {shown} is a number too wide for its column; print the file with a wider format")
    raise DataError(f"{where}: {shown!r} is not a finite number; compute or write the file again")


def whole(table: Table, column: int, what: str, high: int = 6) -> Array:
    """A column of indices from 1 to `high`, counted from 0. Raises DataError with the line."""
    values = table.values[:, column]
    bad = np.flatnonzero((values != np.round(values)) | (values < 1) | (values > high))
    if bad.size:
        more = "; several bodies and generalised modes are not read" if values[bad[0]] > high else ""
        raise table.fault(int(bad[0]), f"{what} is {values[bad[0]]:g}; allowed: 1 to {high}{more}")
    return np.asarray(values.astype(int) - 1)


def place(table: Table, cell: Array, shape: tuple[int, ...]) -> Array:
    """Row of each cell of an array of this shape, -1 where there is none: int `shape`. Raises DataError for two rows."""
    found = np.full(math.prod(shape), -1, dtype=np.int64)
    found[cell[::-1]] = np.arange(cell.size)[::-1]
    twice = np.flatnonzero(found[cell] != np.arange(cell.size))
    if twice.size:
        first = int(table.lines[found[cell[twice[0]]]])
        raise table.fault(int(twice[0]), f"the same entry as in line {first}; give each once")
    return found.reshape(shape)


def magnitude_agrees(table: Table, mod: int, re_: int, im: int) -> None:
    """The printed modulus against real and imaginary part: a row that was cut or edited is told. Raises DataError."""
    values = table.values
    gap = np.abs(np.hypot(values[:, re_], values[:, im]) - np.abs(values[:, mod]))
    bad = np.flatnonzero(gap > 2e-3 * np.abs(values[:, mod]) + 1e-9 * np.abs(values[:, mod]).max())
    if bad.size:
        row = int(bad[0])
        raise table.fault(
            row,
            f"the modulus {values[row, mod]:g} is not that of {values[row, re_]:g} and {values[row, im]:g} "
            f"(threshold 0.2 %); the row is cut off or damaged",
        )
