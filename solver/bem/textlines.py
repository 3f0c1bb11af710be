"""Lines of a text file of numbers, with faults that say where."""

from __future__ import annotations

import math
import re

import numpy as np

from ..outcome import DataError

Array = np.ndarray
_NUMBER = re.compile(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eEdDqQ]?([+-]?[0-9]{1,6})|)", re.ASCII)


class Lines:
    """The lines of a text that are not blank, one after the other."""

    def __init__(self, payload: bytes, name: str):
        try:
            text = payload.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = payload.decode("latin-1")
        self._lines = text.splitlines()
        self._next = 0
        self.name = name

    def done(self) -> bool:
        """Whether nothing but blank lines is left."""
        while self._next < len(self._lines) and not self._lines[self._next].strip():
            self._next += 1
        return self._next >= len(self._lines)

    def past(self, *marks: str) -> Lines:
        """Past blank lines and those that begin with one of the marks."""
        while not self.done() and self._lines[self._next].lstrip().startswith(marks):
            self._next += 1
        return self

    def fault(self, message: str) -> DataError:
        """An error about the line that was read last."""
        return DataError(f"{self.name}, line {max(self._next, 1)}: {message}")

    def take(self, what: str) -> str:
        """The next line; `what` is expected in it."""
        if self.done():
            raise DataError(
                f"{self.name}, line {len(self._lines)}: the file ends where {what} is expected; it is truncated"
            )
        self._next += 1
        return self._lines[self._next - 1]

    def numbers(self, count: int, what: str) -> Array:
        """`count` numbers from as many lines as it takes; what follows them on their last line is ignored."""
        words = self.take(what).split()
        while len(words) < count:
            words += self.take(what).split()
        return self.parse(words[:count], count, what)

    def floats(self, count: int, what: str) -> Array:
        """`count` numbers at the start of the next line."""
        return self.parse(self.take(what).split()[:count], count, what)

    def row(self, count: int, what: str) -> Array:
        """The next line, which holds `count` numbers and nothing else."""
        return self.parse(self.take(what).split(), count, what)

    def integers(self, count: int, what: str) -> list[int]:
        """`count` whole numbers at the start of the next line."""
        return self.whole(self.take(what).split()[:count], what, count)

    def whole(self, words: list[str], what: str, count: int | None = None) -> list[int]:
        """Words as whole numbers, `count` of them if that is given."""
        values = self.parse(words, len(words) if count is None else count, what)
        if np.any(values != np.round(values)) or np.any(np.abs(values) > 1e15):
            raise self.fault(f"expected {what}: whole numbers; got {' '.join(f'{v:g}' for v in values)}")
        return [int(value) for value in values]

    def parse(self, words: list[str], count: int, what: str) -> Array:
        """Numbers, Fortran's 1.0D+00 and 1.0-100 among them; finite."""
        if len(words) != count:
            raise self.fault(f"expected {what}: {count} numbers; got {len(words)}")
        return np.array([self._number(word, what) for word in words])

    def symmetry(self, value: int) -> bool:
        """A flag that is 0 or 1."""
        if value not in (0, 1):
            raise self.fault(f"a symmetry is given as {value}; allowed: 0 or 1")
        return value == 1

    def _number(self, word: str, what: str) -> float:
        number = fortran_number(word)
        if number is None or not math.isfinite(number):
            raise self.fault(f"{word[:40]!r} is not a finite number; expected {what}")
        return number


def fortran_number(word: str) -> float | None:
    """A number as Fortran or C writes it: 1.0D+00, and 1.0-100, where three digits pushed the E out; None when it is none."""
    match = _NUMBER.fullmatch(word.rstrip(","))
    return None if match is None else float(f"{match[1]}e{match[2] or 0}")
