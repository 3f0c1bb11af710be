"""Which section of a deck a heading opens.

MoorDyn takes every line that holds three dashes for a heading and looks for key words anywhere in it, the Fortran code in
the order below (MoorDyn.f90, first pass over the file); of a heading without a key word it skips the rows.
"""

from __future__ import annotations

import re

#: Key words of each section, upper case; the first section whose word stands in a heading is the one it opens.
SECTIONS = {
    "types": ("LINE DICTIONARY", "LINE TYPES"),
    "rod types": ("ROD DICTIONARY", "ROD TYPES"),
    "bodies": ("BODIES", "BODY LIST", "BODY PROPERTIES"),
    "rods": ("RODS", "ROD LIST", "ROD PROPERTIES"),
    "points": ("POINTS", "CONNECTION PROPERTIES", "NODE PROPERTIES", "POINT PROPERTIES", "POINT LIST"),
    "lines": ("LINES", "LINE PROPERTIES", "LINE LIST"),
    "external loads": ("EXTERNAL LOADS",),
    "control": ("CONTROL",),
    "failure": ("FAILURE",),
    "options": ("OPTIONS",),
    "outputs": ("OUTPUT",),
}
HEADLESS = ("options", "outputs")  # no rows of names and units
OTHER = "other"  # a section that MoorDyn does not know, and skips
_WHOLE = {"LINE TYPE": "types", "ROD TYPE": "rod types", "CONNECTIONS": "points"}  # read here though not by MoorDyn
_COMMENT = re.compile(r"[!#%]")
_DASHES = "---"


def without_comment(line: str) -> str:
    return _COMMENT.split(line, maxsplit=1)[0]


def heading(line: str) -> str | None:
    """The words of a heading, upper case; None for a line that is none."""
    bare = without_comment(line)
    before, dashes, _ = bare.partition(_DASHES)
    if not dashes or (before.strip(" -\t") and section_of(before.upper()) is None):
        return None
    return " ".join(re.sub(r"-{2,}", " ", bare).split()).strip("- ").upper()


def has_dashes(line: str) -> bool:
    """Whether a line that is no heading holds the three dashes at which MoorDyn ends a section."""
    return _DASHES in without_comment(line)


def section_of(words: str) -> str | None:
    """The section that a heading opens; None when it has no key word."""
    for section, keys in SECTIONS.items():
        if any(key in words for key in keys):
            return section
    return _WHOLE.get(words)
