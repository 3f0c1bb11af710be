"""The text of a MoorDyn deck as tables of words, each with its line number (MoorDyn documentation, "Inputs")."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from ...outcome import CaseError, FieldError
from .columns import ORDERS, order_of
from .headings import HEADLESS, OTHER, has_dashes, heading, section_of, without_comment

MAX_BYTES = 1_000_000
MAX_ROWS = 20_000
MAX_ERRORS = 50


@dataclass(frozen=True)
class Row:
    """One row of a table: cells by the name of their column, and where it stands in the text."""

    line: int
    cells: dict[str, str]

    def __getitem__(self, column: str) -> str:
        return self.cells[column]


@dataclass
class Deck:
    """A deck as read: rows by section (`types`, `points`, `lines`, `bodies`, …), versions of the column order, options.

    other : line and words of the last heading that opens no section.
    """

    title: str = ""
    rows: dict[str, list[Row]] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    raw: dict[str, list[tuple[int, list[str]]]] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    other: tuple[int, str] = (0, "")


class Faults:
    """Collects what is wrong, so that one reading tells all of it."""

    def __init__(self) -> None:
        self.errors: list[FieldError] = []

    def add(self, line: int | None, where: tuple[str | int, ...], message: str, value: str = "") -> None:
        if len(self.errors) < MAX_ERRORS:
            self.errors.append(FieldError(("deck", *where), message, value[:80], line))

    def stop(self) -> None:
        """Raises CaseError when anything was found."""
        if self.errors:
            raise CaseError(self.errors)


def parse_deck(text: str | bytes) -> Deck:
    """The sections of a deck. Raises CaseError with line numbers."""
    found, faults = Deck(), Faults()
    section, skip = "", 0  # "" before the first section and after the last
    for number, line in enumerate(_lines(text), 1):
        words = heading(line)
        if words is not None:
            section = _open(found, faults, number, words, section)
            skip = 0 if section in HEADLESS else 2
        elif not section:
            if line.strip() and not found.title and "echo" not in line.lower():
                found.title = line.strip()[:200]
        elif section == OTHER:
            if without_comment(line).strip():
                _skipped(found, faults)
                section = ""
        elif section == "outputs" and line.split()[:1] == ["END"]:
            section = ""
        elif has_dashes(line):
            message = (
                "the line holds '---', which MoorDyn takes for a heading and the end of the section; write one dash"
            )
            faults.add(number, (section,), message, line.strip())
        else:
            skip = _take(found, faults, section, number, line, skip)
    faults.stop()
    _name_columns(found, faults)
    faults.stop()
    return found


def _open(found: Deck, faults: Faults, number: int, words: str, before: str) -> str:
    """The section that begins at a heading; "" for text that MoorDyn skips before the first and after the last one."""
    section = section_of(words)
    if section is None:
        found.other = (number, words)
        return OTHER if before and not words.startswith("NEED THIS LINE") else ""
    if section in found.lines:
        message = f"the section is given twice, first in line {found.lines[section]}"
        faults.add(number, (section,), f"{message}; MoorDyn finds its key word in this heading", words)
    found.lines.setdefault(section, number)
    return section


def _skipped(found: Deck, faults: Faults) -> None:
    number, words = found.other
    message = (
        "MoorDyn finds none of its key words in this heading and skips the rows below it; correct the heading, or take "
        "it out with its rows if they do not matter"
    )
    faults.add(number, (words[:40] or "heading",), message, words)


def _lines(text: str | bytes) -> Iterator[str]:
    if len(text) > MAX_BYTES:
        raise CaseError([FieldError(("deck",), f"the deck has {len(text)} bytes; allowed: at most {MAX_BYTES}")])
    text = _decoded(text) if isinstance(text, bytes) else text
    if any("\ud800" <= letter <= "\udfff" for letter in text):
        raise CaseError([FieldError(("deck",), "the deck is not text: it holds half of a letter (a lone surrogate)")])
    if "\x00" in text:
        raise CaseError([FieldError(("deck",), "the deck is not a text file: it holds zero bytes")])
    lines = re.split(r"\r\n|\r|\n", text)
    if len(lines) > MAX_ROWS:
        raise CaseError([FieldError(("deck",), f"the deck has {len(lines)} lines; allowed: at most {MAX_ROWS}")])
    return iter(lines)


def _decoded(payload: bytes) -> str:
    try:
        return payload.decode("utf-8-sig")
    except UnicodeDecodeError:
        return payload.decode("latin-1")  # of Windows editors: only titles and comments hold such letters


def _take(found: Deck, faults: Faults, section: str, number: int, line: str, skip: int) -> int:
    """One line inside a section; returns how many rows of names and units are still to come."""
    if skip:
        words = (without_comment(line) if skip == 2 else line).split()
        if not words:
            return skip
        if skip == 2 and len(words) > 1 and re.fullmatch(r"\d+", words[0]) and re.match(r"N[A-Z]", words[1]):
            return skip  # `3 NTypes - number of line types`, as the oldest decks have it
        if skip == 2:
            found.raw.setdefault(f"{section} columns", []).append((number, words))
        elif not words[0].startswith("("):
            message = "the line of units is missing: MoorDyn skips two lines after a heading, names and (units)"
            faults.add(number, (section,), message, line.strip())
        return skip - 1
    words = without_comment(line).split()
    if words:
        found.raw.setdefault(section, []).append((number, words))
    return 0


def _name_columns(found: Deck, faults: Faults) -> None:
    for section in ORDERS:
        rows = found.raw.get(section, [])
        if not rows:
            continue
        line, header = found.raw[f"{section} columns"][0]
        order = order_of(section, header, len(rows[0][1]))
        if isinstance(order, str):
            faults.add(line, (section,), order, " ".join(header))
            continue
        if order.by_place:
            found.notes.append(
                f"{section}: the names of the columns are not known; taken by place, as MoorDyn {order.version}"
            )
        found.versions[section] = order.version
        for number, words in rows:
            if not order.takes(len(words)):
                few = len(order.columns) - order.optional
                allowed = f"{few} to {len(order.columns)}" if order.optional else f"{few}"
                message = f"the row has {len(words)} columns; allowed: {allowed} ({' '.join(order.columns)})"
                faults.add(number, (section, words[0]), message, " ".join(words))
                continue
            found.rows.setdefault(section, []).append(Row(number, dict(zip(order.columns, words, strict=False))))


def number(
    row: Row, column: str, faults: Faults, section: str, low: float = -math.inf, high: float = math.inf
) -> float:
    """A cell as a number in [low, high]; adds a fault and gives NaN otherwise. Fortran's 1.0D3 and 1.0-100 are read."""
    text = row[column]
    return parse_number(
        text, row.line, (section, row.cells.get("id", row.cells.get("name", "")), column), faults, low, high
    )


def parse_number(
    text: str, line: int, where: tuple[str | int, ...], faults: Faults, low: float = -math.inf, high: float = math.inf
) -> float:
    plain = re.sub(r"(?<=[\d.])[dD](?=[-+]?\d)", "e", text)
    plain = re.sub(r"^([-+]?\d*\.\d*)([-+]\d+)$", r"\1e\2", plain)
    if not re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", plain):
        faults.add(line, where, f"{text[:40]!r} is not a number", text)
        return math.nan
    value = float(plain)
    if not math.isfinite(value) or not low <= value <= high:
        allowed = f"≥ {low:g}" if high == math.inf else f"{low:g} to {high:g}"
        faults.add(
            line, where, f"{text[:40]} is out of range; allowed: {allowed if low > -math.inf else 'finite'}", text
        )
        return math.nan
    return value
