"""Natural periods with the damping that vessel and lines give to each."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc

from frontend.components.tables import table
from frontend.format import number, percent
from frontend.results import Results

HEAD = ("Mode", "Period [s]", "Damping, vessel", "Damping, lines", "Damping, total", "Mass in lines")
NOTE = (
    "A mode is named by the direction that holds most of its kinetic energy; “line” when the lines hold more than "
    "half. Damping is the share of critical damping, linearised for this sea state."
)


def applies(results: Results) -> bool:
    return bool(results.summary.get("modes"))


def rows(modes: list[dict[str, Any]]) -> list[list[str]]:
    made = []
    for index, mode in enumerate(modes, start=1):
        vessel, lines = mode.get("damping_vessel"), mode.get("damping_lines")
        total = None if vessel is None and lines is None else (vessel or 0.0) + (lines or 0.0)
        shares = [percent(value) for value in (vessel, lines, total, mode.get("mass_lines"))]
        made.append([f"{index}  {mode.get('label', '')}", number(mode.get("period"), 4), *shares])
    return made


def render(results: Results) -> list[Any]:
    return [
        table("Natural modes", HEAD, rows(results.summary["modes"]), min_width=620),
        dmc.Text(NOTE, size="sm", c="dimmed", maw=720, mt="sm"),
    ]
