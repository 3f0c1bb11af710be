"""The tabs of a run page. A new tab: one module with `applies(results)` and `render(results)`, and its line here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from frontend.panels import along, case, history, modes, motion, overview, raos, shape, spectra
from frontend.results import Results


@dataclass(frozen=True)
class Panel:
    key: str
    label: str
    applies: Callable[[Results], bool]
    render: Callable[[Results], Any]


PANELS = (
    Panel("overview", "Overview", overview.applies, overview.render),
    Panel("spectra", "Spectra", spectra.applies, spectra.render),
    Panel("time", "Time domain", history.applies, history.render),
    Panel("raos", "RAOs", raos.applies, raos.render),
    Panel("lines", "Along lines", along.applies, along.render),
    Panel("shape", "Static shape", shape.applies, shape.render),
    Panel("motion", "Motion", motion.applies, motion.render),
    Panel("modes", "Modes", modes.applies, modes.render),
    Panel("case", "Case and provenance", case.applies, case.render),
)


def available(results: Results) -> list[Panel]:
    return [panel for panel in PANELS if panel.applies(results)]


def find(key: str | None) -> Panel:
    return next((panel for panel in PANELS if panel.key == key), PANELS[0])
