"""The text of a MoorDyn deck as tables of words, each with its line number.

MoorDyn reads columns by their place, not by their names. A header that names the columns in another order than MoorDyn
reads them is therefore refused, and one that names nothing known is taken by place (MoorDyn documentation, "Inputs").
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from ...outcome import CaseError, FieldError

MAX_BYTES = 1_000_000
MAX_ROWS = 20_000
MAX_ERRORS = 50

_SECTIONS = {  # MoorDyn's words for a section, upper case, v1 and v2
    "types": ("LINE TYPES", "LINE TYPE", "LINE DICTIONARY"),
    "rod types": ("ROD TYPES", "ROD TYPE", "ROD DICTIONARY"),
    "bodies": ("BODIES", "BODY LIST", "BODY PROPERTIES"),
    "rods": ("RODS", "ROD LIST", "ROD PROPERTIES"),
    "points": ("POINTS", "POINT LIST", "POINT PROPERTIES", "CONNECTION PROPERTIES", "CONNECTIONS", "NODE PROPERTIES"),
    "lines": ("LINES", "LINE LIST", "LINE PROPERTIES"),
    "failure": ("FAILURE",),
    "control": ("CONTROL",),
    "external loads": ("EXTERNAL LOADS",),
    "options": ("OPTIONS", "SOLVER OPTIONS"),
    "outputs": ("OUTPUTS", "OUTPUT"),
}
_HEADLESS = ("options", "outputs")  # no rows of names and units

_NAMES = {
    "types": {
        "name": ("name", "linetype", "typename", "type"), "diameter": ("diam", "diameter", "d"),
        "mass": ("mass/m", "massden", "massdeninair", "mass"), "EA": ("ea",), "BA": ("ba/-zeta", "ba", "ba/zeta"),
        "EI": ("ei",),
        "Cdn": ("cd", "cdn"), "Can": ("ca", "can"), "Cdt": ("cdax", "cdt"), "Cat": ("caax", "cat"), "Cl": ("cl",),
        "dF": ("df",), "cF": ("cf",),
    },
    "points": {
        "id": ("id", "node", "num", "point", "connection"), "kind": ("type", "attachment", "attach"), "x": ("x",), "y": ("y",),
        "z": ("z",), "mass": ("m", "mass"), "volume": ("v", "volume", "vol"), "FX": ("fx",), "FY": ("fy",), "FZ": ("fz",),
        "CdA": ("cda", "cda*"), "Ca": ("ca", "ca*"),
    },
    "lines": {
        "id": ("id", "line", "num"), "type": ("linetype", "type"), "a": ("attacha", "nodeanch", "nodea", "anchor"),
        "b": ("attachb", "nodefair", "nodeb", "fairlead"), "length": ("unstrlen", "length"),
        "segments": ("numsegs", "numseg", "segs"), "outputs": ("outputs", "lineoutputs", "flags/outputs", "flags"),
    },
    "bodies": {
        "id": ("id",), "kind": ("attachment", "type"), "x": ("x0",), "y": ("y0",), "z": ("z0",), "roll": ("r0",),
        "pitch": ("p0",), "yaw": ("y0",), "mass": ("mass",), "cg": ("cg*", "cg"), "inertia": ("i*", "i"), "volume": ("volume",),
        "CdA": ("cda*", "cda"), "Ca": ("ca*", "ca"),
    },
}  # fmt: skip
_ORDERS = {  # (version, columns in the order MoorDyn reads them, how many may be missing at the end)
    "types": (
        ("v2", "name diameter mass EA BA EI Cdn Can Cdt Cat Cl dF cF", 3),
        ("v1", "name diameter mass EA BA Can Cat Cdn Cdt", 0),
    ),
    "points": (
        ("v2", "id kind x y z mass volume CdA Ca", 0),
        ("v1", "id kind x y z mass volume FX FY FZ CdA Ca", 0),
    ),
    "lines": (
        ("v2", "id type a b length segments outputs", 1),
        ("v1", "id type length segments a b outputs", 1),
    ),
    "bodies": (("v2", "id kind x y z roll pitch yaw mass cg inertia volume CdA Ca", 0),),
}


@dataclass(frozen=True)
class Row:
    """One row of a table: cells by the name of their column, and where it stands in the text."""

    line: int
    cells: dict[str, str]

    def __getitem__(self, column: str) -> str:
        return self.cells[column]


@dataclass
class Deck:
    """A deck as read: rows by section (`types`, `points`, `lines`, `bodies`, …), versions of the column order, options."""

    title: str = ""
    rows: dict[str, list[Row]] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    raw: dict[str, list[tuple[int, list[str]]]] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


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
    section, skip = "", 0
    for number, line in enumerate(_lines(text), 1):
        heading = _heading(line)
        if heading == "end":
            break
        if heading is not None:
            known = _section(heading)
            if known is None and section:
                faults.add(number, (heading[:40],), "this section is not known here; take it out if it does not matter")
                known = "unknown"
            section = known or ""
            if section in found.lines and section != "unknown":
                faults.add(number, (section,), f"the section is given twice, first in line {found.lines[section]}")
            found.lines.setdefault(section, number)
            skip = 0 if section in _HEADLESS else 2
        elif not section:
            if line.strip() and not found.title and "echo" not in line.lower():
                found.title = line.strip()[:200]
        elif section != "unknown":
            if section == "outputs" and line.split()[:1] == ["END"]:
                break
            skip = _take(found, faults, section, number, line, skip)
    found.lines.pop("", None)
    faults.stop()
    _name_columns(found, faults)
    faults.stop()
    return found


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


def _heading(line: str) -> str | None:
    """Words of a heading, `end` at MoorDyn's last line, None for any other line."""
    if not re.match(r"\s*---", line):
        return None
    words = " ".join(re.sub(r"-{2,}", " ", line).split()).strip("- ").upper()
    return "end" if words.startswith("NEED THIS LINE") else words


def _section(heading: str) -> str | None:
    return next((name for name, words in _SECTIONS.items() if heading in words), None)


def _take(found: Deck, faults: Faults, section: str, number: int, line: str, skip: int) -> int:
    """One line inside a section; returns how many rows of names and units are still to come."""
    if skip:
        words = line.split()
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
    words = re.split(r"[!#%]", line, maxsplit=1)[0].split()
    if words:
        found.raw.setdefault(section, []).append((number, words))
    return 0


def _name_columns(found: Deck, faults: Faults) -> None:
    for section in _ORDERS:
        rows = found.raw.get(section, [])
        if not rows:
            continue
        line, header = found.raw[f"{section} columns"][0]
        order = _order(found, faults, section, line, header, len(rows[0][1]))
        if order is None:
            continue
        version, columns, optional = order
        found.versions[section] = version
        for number, words in rows:
            if not len(columns) - optional <= len(words) <= len(columns):
                few = len(columns) - optional
                allowed = f"{few} to {len(columns)}" if optional else f"{few}"
                message = f"the row has {len(words)} columns; allowed: {allowed} ({' '.join(columns)})"
                faults.add(number, (section, words[0]), message, " ".join(words))
                continue
            found.rows.setdefault(section, []).append(Row(number, dict(zip(columns, words, strict=False))))


def _order(
    found: Deck, faults: Faults, section: str, line: int, header: list[str], width: int
) -> tuple[str, list[str], int] | None:
    """Which of MoorDyn's column orders a table has: by its header if that names columns, else by its width."""
    known = _NAMES[section]
    named = [[name for name, words in known.items() if word.lower() in words] for word in header]
    orders = [(version, columns.split(), optional) for version, columns, optional in _ORDERS[section]]
    if sum(map(bool, named)) >= 0.6 * len(header):
        for version, columns, optional in orders:
            fits = len(columns) - optional <= len(header) <= len(columns)
            if fits and all(not names or column in names for column, names in zip(columns, named, strict=False)):
                return version, columns, optional
        expected = " or ".join(f"{version}: {' '.join(columns)}" for version, columns, _ in orders)
        message = f"the columns are not in an order MoorDyn reads; it reads by place, not by name ({expected})"
        faults.add(line, (section,), message, " ".join(header))
        return None
    for version, columns, optional in orders:
        if len(columns) - optional <= width <= len(columns):
            found.notes.append(
                f"{section}: the names of the columns are not known; taken by place, as MoorDyn {version}"
            )
            return version, columns, optional
    faults.add(line, (section,), f"{width} columns fit no table of MoorDyn's", " ".join(header))
    return None


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
