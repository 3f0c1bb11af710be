"""A study's table as the page draws it: columns in words and units, and the modes by their names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from frontend.client import Client
from frontend.format import DEG, ROTATIONS
from frontend.pointers import said

MOST = 5000  # rows drawn and listed
MODES = 8
PARTS = ("period", "damping_lines")


@dataclass(frozen=True)
class Table:
    columns: list[str]
    rows: list[list[Any]]

    @property
    def pointers(self) -> list[str]:
        """What the study varies."""
        return [name for name in self.columns if name.startswith("/")]

    @property
    def results(self) -> list[str]:
        return [name for name in self.columns if "." in name and not name.startswith("/")]

    def column(self, name: str) -> list[Any]:
        at = self.columns.index(name)
        return [row[at] for row in self.rows]


def fetch(client: Client, study_id: str) -> Table:
    """The table as the service offers it, with period and damping of each mode by name. Raises ApiError."""
    offered = client.get(f"/studies/{study_id}/table", limit=1)["columns"]
    asked = [f"modes.{k}.{part}" for k in range(MODES) for part in ("label", *PARTS)]
    found = client.get(f"/studies/{study_id}/table", limit=MOST, columns=",".join([*offered, *asked]))
    return by_name(Table(found["columns"], found["rows"]), len(offered))


def by_name(table: Table, plain: int) -> Table:
    """Modes stand in the order of their periods, which differs from run to run: here each has columns of its own.

    table : after `plain` columns, label, period and damping of mode 0, of mode 1 and so on
    """
    width = 1 + len(PARTS)
    found: list[dict[str, Any]] = []
    for row in table.rows:
        modes = [row[start : start + width] for start in range(plain, plain + MODES * width, width)]
        named: dict[str, Any] = {}
        for label, *values in modes:
            if label and label != "line":
                for part, value in zip(PARTS, values, strict=True):
                    named.setdefault(f"modes.{label}.{part}", value)
        found.append(named)
    extra = sorted({name for named in found for name in named}, key=lambda name: name.split(".")[::-1])
    rows = [[*row[:plain], *(named.get(name) for name in extra)] for row, named in zip(table.rows, found, strict=True)]
    return Table([*table.columns[:plain], *extra], rows)


WORDS = {
    "frequency_domain": "frequency domain", "time_domain": "time domain", "vessel_std": "σ of", "lines": "line",
    "wf": "WF", "lf": "LF", "tension_std": "σ of tension",
}  # fmt: skip


def quantity(name: str) -> str:
    """A column's name in words."""
    if name.startswith("/"):
        return said(name)
    if name.startswith("modes."):
        _, label, part = name.split(".")
        return f"natural period, {label}" if part == "period" else f"damping by the lines, {label}"
    inner = name.removeprefix("max(").removesuffix(")")
    text = " ".join(WORDS.get(part, part.replace("_", " ")) for part in inner.split("."))
    return f"{text}, largest" if name.startswith("max(") else text


def unit(name: str) -> tuple[str, float]:
    """What a result is shown in, and the factor from SI."""
    if name.startswith("modes."):
        return ("s", 1.0) if name.endswith("period") else ("%", 100.0)
    if "tension" in name:
        return "kN", 1e-3
    return ("deg", DEG) if name.rsplit(".", 1)[-1] in ROTATIONS else ("m", 1.0)


def header(name: str) -> str:
    return f"{quantity(name)} [{unit(name)[0]}]" if "." in name and not name.startswith("/") else quantity(name)
