"""Each way to fail, as a sentence with a remedy.

Every exception a caller may meet derives from `SlowdriftError`. `CaseError` and `DataError` mean the question is wrong
(exit status 2, HTTP 422); `NotConverged` means the analysis could not answer it (exit status 3); `Cancelled` is raised
by a caller's own progress callback and passes through untouched.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any


class SlowdriftError(Exception):
    """Base of every error this program raises on purpose."""


@dataclass(frozen=True)
class FieldError:
    """One fault of a case, at one field.

    loc : path of keys and indices from the top of the case, () for the case as a whole.
    message : a sentence with the value and the allowed range in it.
    value : the offending value, shortened, as text.
    line : line number in the YAML text, from 1, when known.
    """

    loc: tuple[str | int, ...]
    message: str
    value: str = ""
    line: int | None = None

    @property
    def field(self) -> str:
        """Dotted path, e.g. ``lines.bow-port.segments.0.length``."""
        return ".".join(str(part) for part in self.loc) or "(case)"

    def as_dict(self) -> dict[str, Any]:
        return {
            "loc": list(self.loc),
            "field": self.field,
            "message": self.message,
            "value": self.value,
            "line": self.line,
        }

    def __str__(self) -> str:
        where = f" (line {self.line})" if self.line else ""
        return f"{self.field}{where}: {self.message}"

    @property
    def place(self) -> tuple[int, str]:
        """Faults are listed by this: by line, those without one first, then by field."""
        return self.line or 0, self.field


class CaseError(SlowdriftError):
    """The case is wrong; `errors` names each field."""

    def __init__(self, errors: list[FieldError]):
        self.errors = errors
        super().__init__("; ".join(str(error) for error in errors))


class Unread(SlowdriftError):
    """A field of a case that could not be read is asked for; a check that needs it cannot be made."""


class DataError(SlowdriftError):
    """A data file cannot be read or does not hold what it must."""


class NotConverged(SlowdriftError):
    """An iteration ended without an answer."""

    def __init__(self, analysis: str, message: str, remedy: str):
        self.analysis, self.message, self.remedy = analysis, message, remedy
        super().__init__(f"{message} {remedy}".strip())


#: what the words of a ValueError hold when numbers, not the program, are at fault
NUMBERS = ("infs or NaNs", "NaN to integer", "math domain error", "singular", "did not converge")


@contextmanager
def numerical(analysis: str, line: str | None = None) -> Iterator[None]:
    """Turn what arithmetic and linear algebra raise inside an analysis into NotConverged; faults of the program pass.

    numpy's LinAlgError is a ValueError, as are SciPy's words on matrices that are not finite.
    """
    try:
        yield
    except (ArithmeticError, ValueError) as error:
        named = type(error).__name__
        text = str(error).strip().rstrip(".")
        known = isinstance(error, ArithmeticError) or named == "LinAlgError"
        if not known and not any(words.lower() in text.lower() for words in NUMBERS):
            raise
        where = f" for line {line!r}" if line is not None else ""
        raise NotConverged(
            analysis, f"the arithmetic of the analysis ({analysis}) broke down{where}: {text or named}.",
            "Look for lines that are slack, folded or neutral in water, nodes that coincide, and stiffnesses or masses that "
            "are nearly zero.",
        ) from error  # fmt: skip


class Cancelled(SlowdriftError):
    """The caller asked the run to stop."""


class Interrupted(Cancelled):
    """The caller asked the run to stop and wants the analyses that are done."""
