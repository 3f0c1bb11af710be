"""The seven spectra: six responses of the vessel and the tension at end b of one line, WF and LF apart, both domains."""

from __future__ import annotations

from typing import Any

from frontend.components.cards import grid, picture
from frontend.components.options import bar, pick, pick_line
from frontend.figures import spectra as figures
from frontend.figures.base import axis_values
from frontend.format import DOFS, dof_unit
from frontend.results import Results

SCALES = ((figures.PANELS, "LF and WF apart"), (figures.LOG, "One axis, log"))


def _top(line: str) -> str:
    return f"frequency/line/{line}/top_tension"


def _timed(name: str) -> str:
    """The time domain's channel of the same response."""
    return f"{name.replace('frequency/', 'time/', 1)}_spectrum"


def applies(results: Results) -> bool:
    names = {f"frequency/vessel/{dof}" for dof in DOFS} | {_top(line) for line in results.lines}
    return bool((names | {_timed(name) for name in names}) & results.names)


def render(results: Results) -> list[Any]:
    line = results.option("line", results.lines)
    scale = results.option("scale", (key for key, _ in SCALES)) or figures.PANELS
    wanted = {f"frequency/vessel/{dof}": (dof.capitalize(), dof_unit(dof)[0]) for dof in DOFS}
    if line:
        wanted[_top(line)] = (f"Tension at end b, {line}", "kN")
    found = results.channels(wanted)
    last = max((float(axis_values(channel)[-1]) for channel in found.values()), default=None)
    timed = results.channels((_timed(name) for name in wanted), to=last)
    drawn = []
    for name in wanted:
        beside = timed.get(_timed(name))
        channel = found.get(name) or beside
        if channel is None:
            continue
        other = (results.time_domain, beside) if beside and name in found else None
        at = figures.border(results.case, axis_values(channel))
        figure = figures.spectrum(
            channel, at, wanted[name], sigmas(results.summary, name, name in found), scale, beside=other
        )
        drawn.append(picture(wanted[name][0], figure, "top-tension" if "/line/" in name else name))
    controls = bar(pick("scale", "Frequency axis", SCALES, scale), *([pick_line(results.lines, line)] if line else []))
    return [controls, grid(drawn, wide=3)]


def sigmas(summary: dict[str, Any], name: str, frequency: bool = True) -> dict[str, float | None]:
    """Standard deviations by band of the response in a channel, in metres, degrees, kilonewtons."""
    analysis = summary.get("frequency_domain" if frequency else "time_domain") or {}
    _, owner, which, *_ = name.split("/")
    if owner == "line":
        bands = ((analysis.get("lines") or {}).get(which) or {}).get("tension_std") or {}
        return {band: values[-1] / 1e3 for band, values in bands.items() if values}
    factor = dof_unit(which)[1]
    spread = analysis.get("vessel_std") or {}
    return {band: values[which] * factor for band, values in spread.items() if which in values}
