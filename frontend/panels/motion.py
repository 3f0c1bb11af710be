"""The whole system in motion: in a regular wave, or in one of its natural modes."""

from __future__ import annotations

from typing import Any

import numpy as np

from frontend.components.cards import picture
from frontend.components.options import bar, pick_one
from frontend.figures import shape
from frontend.figures.base import axis_values
from frontend.figures.motion import exaggeration, oscillation
from frontend.format import number
from frontend.panels.shape import POSITION
from frontend.results import Results

MODE, WAVE = "mode:", "wave:"
SHAPE = "modes/line/{line}/shape"
RAO = "frequency/line/{line}/motion_rao_%s"
HARMONIC = "frequency/line/{line}/motion_%s"


def applies(results: Results) -> bool:
    return bool(results.lines) and bool(_patterns(results))


def _patterns(results: Results) -> list[str]:
    """Those of the three kinds of motion that the run has."""
    line = results.lines[0]
    return [p for p in (SHAPE, RAO % "amplitude", HARMONIC % "amplitude") if p.format(line=line) in results.names]


def choices(results: Results) -> dict[str, str]:
    """What can be set in motion, and its words."""
    made: dict[str, str] = {}
    patterns = _patterns(results)
    if SHAPE in patterns:
        for index, mode in enumerate(results.summary.get("modes") or []):
            made[f"{MODE}{index}"] = f"mode {index + 1}, {mode.get('label', '')}, {number(mode.get('period'), 4)} s"
    for pattern in patterns:
        if pattern != SHAPE:
            channel = results.channels([pattern.format(line=results.lines[0])], points=1000)
            omega = axis_values(next(iter(channel.values())))
            for index in range(len(omega)):
                period = number(2 * np.pi / omega[index])
                made[f"{WAVE}{index}"] = f"waves of {number(omega[index])} rad/s, {period} s"
    return made


def render(results: Results) -> list[Any]:
    offered = choices(results)
    chosen = results.option("motion", offered) or ""
    vessel = ((results.summary.get("statics") or {}).get("vessel") or {}).get("position")
    scene = shape.scene(results.per_line(POSITION), results.case, vessel)
    moved, unit = displacements(results, chosen)
    scale = exaggeration(scene, moved)
    figure, stretch = oscillation(scene, moved, scale)
    note = f"Displacements × {number(scale)}{unit}; " + (
        "true to scale otherwise." if stretch < 1.02 else f"the vertical is stretched {number(stretch, 2)} times."
    )
    label = offered[chosen]
    card = picture(label[0].upper() + label[1:], figure, f"motion-{chosen}", note)
    return [bar(pick_one("motion", "Motion", list(offered.items()), chosen, 320)), card]


def displacements(results: Results, chosen: str) -> tuple[dict[str, np.ndarray], str]:
    """Per line the nodes' displacement, complex, (nodes, 3) [m]; and per what it is."""
    index = int(chosen.partition(":")[2])
    if chosen.startswith(MODE):
        found = results.per_line(SHAPE)
        return {
            line: np.asarray(c["values"][index], dtype=complex) for line, c in found.items()
        }, " of a mode of unit size"
    pattern = RAO if RAO % "amplitude" in _patterns(results) else HARMONIC
    size, phase = results.per_line(pattern % "amplitude"), results.per_line(pattern % "phase")
    made = {
        line: np.asarray(size[line]["values"][index]) * np.exp(1j * np.asarray(phase[line]["values"][index]))
        for line in size
    }
    return made, " of those in waves of 1 m amplitude" if pattern == RAO else ""
