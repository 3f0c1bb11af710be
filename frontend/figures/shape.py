"""The system in static equilibrium: in space, from above, and each line from the side."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from frontend.editor.pattern import degrees
from frontend.editor.text import EditError
from frontend.figures.base import Figure, axis, figure, note, titled
from frontend.theme import BLUE, CYCLE, GRID, INK, PAPER, YELLOW

SEABED, SEA, HULL = "#c8b68f", "#8fc1de", "#495057"


@dataclass(frozen=True)
class Scene:
    """Node positions per line [m, earth axes, z up], the depth, and by line which of its nodes sits on a vessel."""

    lines: Mapping[str, np.ndarray]
    depth: float | None
    on_vessel: tuple[tuple[str, int], ...] = ()
    vessel: tuple[float, float, float] | None = None

    @property
    def hull(self) -> np.ndarray | None:
        """The fairleads in order of bearing, closed: all that the result tells of the hull's outline."""
        if not self.on_vessel:
            return None
        ends = np.array([self.lines[name][node] for name, node in self.on_vessel])
        offset = ends[:, :2] - ends[:, :2].mean(axis=0)
        ordered = ends[np.argsort(np.arctan2(offset[:, 1], offset[:, 0]))]
        return np.vstack([ordered, ordered[:1]])

    @property
    def box(self) -> np.ndarray:
        """Lowest and highest x, y, z over all nodes."""
        nodes = np.vstack(list(self.lines.values()))
        return np.array([nodes.min(axis=0), nodes.max(axis=0)])


def scene(channels: Mapping[str, dict[str, Any]], case: dict[str, Any] | None, position: list[float] | None) -> Scene:
    """From the channels `static/line/{NAME}/position` (by line name), the case and the vessel's static displacement."""
    lines = {name: np.asarray(channel["values"], dtype=float) for name, channel in channels.items()}
    described = (case or {}).get("lines") or {}
    ends = (("end_b", -1), ("end_a", 0))
    held = tuple((name, node) for name in lines for end, node in ends if _on_vessel(described.get(name) or {}, end))
    depth = metres(((case or {}).get("environment") or {}).get("depth"))
    return Scene(lines, depth, held, _vessel(position, case))


def metres(value: Any) -> float | None:
    """A length in a case: a number, or text such as ``2000 m`` or ``2 km``."""
    if isinstance(value, int | float):
        return float(value)
    found = re.fullmatch(r"\s*([-+\d.eE]+)\s*(m|km|ft)?\s*", value) if isinstance(value, str) else None
    try:
        return float(found[1]) * {"km": 1e3, "ft": 0.3048}.get(found[2], 1.0) if found else None
    except ValueError:
        return None


def _on_vessel(line: dict[str, Any], which: str) -> bool:
    end = line.get(which)
    return isinstance(end, dict) and (end.get("fairlead") is not None or end.get("kind") == "fairlead")


def _vessel(position: list[float] | None, case: dict[str, Any] | None) -> tuple[float, float, float] | None:
    vessel = (case or {}).get("vessel")
    if not vessel:
        return None
    centre = [metres(part) or 0.0 for part in vessel.get("centre_of_gravity") or (0, 0, 0)]
    x, y, z = (at + by for at, by in zip(centre, (position or [0.0] * 6)[:3], strict=True))
    turn = _heading(vessel.get("heading"))  # both go along the vessel's axes in the design position
    return (math.cos(turn) * x - math.sin(turn) * y, math.sin(turn) * x + math.cos(turn) * y, z)


def _heading(value: Any) -> float:
    """[rad]; zero where there is none, or nothing that can be read yet."""
    try:
        return math.radians(degrees(value, "heading")) if value else 0.0
    except EditError:
        return 0.0


def in_space(made: Scene, height: int = 520) -> tuple[Figure, float]:
    """The 3D picture, and by how much its vertical is stretched (1 = true to scale)."""
    low, high = _frame(made)
    data = [_sheet(low, high, 0.0, SEA, 0.18, "still water")]
    if made.depth:
        data.append(_sheet(low, high, -made.depth, SEABED, 0.45, "seabed"))
    for index, (name, nodes) in enumerate(made.lines.items()):
        data.append(_path(nodes, name, CYCLE[index % len(CYCLE)], 5))
    data += _hull(made)
    stretch, ratio = _aspect(high - low)
    side = {"backgroundcolor": PAPER, "gridcolor": GRID, "color": INK, "showspikes": False}
    ticks = {c: 3 if ratio[c] < 0.5 else 6 for c in "xyz"}
    scene = {f"{c}axis": side | {"title": {"text": f"{c} [m]"}, "nticks": ticks[c]} for c in "xyz"} | {
        "aspectmode": "manual",
        "aspectratio": ratio,
        "camera": {"eye": {"x": 1.25, "y": -1.6, "z": 0.8}, "center": {"x": 0, "y": 0, "z": -0.1}},
    }
    margin = {"l": 0, "r": 0, "t": 8, "b": 0}
    return figure(data, height, margin=margin, scene=scene, hovermode="closest"), stretch


def _path(nodes: np.ndarray, name: str, colour: str, width: int) -> dict[str, Any]:
    x, y, z = nodes.T
    return {
        "type": "scatter3d", "mode": "lines", "x": x, "y": y, "z": z, "name": name,
        "line": {"color": colour, "width": width}, "hovertemplate": "x %{x:.1f} m, y %{y:.1f} m, z %{z:.1f} m",
    }  # fmt: skip


def _frame(made: Scene) -> tuple[np.ndarray, np.ndarray]:
    low, high = made.box.copy()
    margin = 0.05 * max(float((high - low)[:2].max()), 1.0)
    low[:2] -= margin
    high[:2] += margin
    low[2], high[2] = min(low[2], -(made.depth or 0.0)), max(high[2], 0.0)
    return low, high


def _aspect(size: np.ndarray) -> tuple[float, dict[str, float]]:
    """True to scale unless the vertical or a side would be a sliver; then that one is stretched to a quarter."""
    share = size / size.max()
    shown = np.maximum(share, [0.25, 0.25, 0.3])
    stretch = float((shown[2] / share[2]) / (shown[:2] / share[:2]).min())
    return stretch, dict(zip("xyz", (1.35 * shown / shown.max()).tolist(), strict=True))


def _sheet(low: np.ndarray, high: np.ndarray, z: float, colour: str, opacity: float, name: str) -> dict[str, Any]:
    x, y = [low[0], high[0], high[0], low[0]], [low[1], low[1], high[1], high[1]]
    return {
        "type": "mesh3d", "x": x, "y": y, "z": [z] * 4, "i": [0, 0], "j": [1, 2], "k": [2, 3], "color": colour,
        "opacity": opacity, "name": name, "hoverinfo": "skip", "showlegend": True,
    }  # fmt: skip


def _hull(made: Scene) -> list[dict[str, Any]]:
    drawn = []
    if made.hull is not None and len(made.hull) > 2:
        drawn.append(_path(made.hull, "fairleads", HULL, 7) | {"hoverinfo": "skip"})
    if made.vessel:
        x, y, z = ([value] for value in made.vessel)
        marker = {"symbol": "diamond", "size": 6, "color": YELLOW, "line": {"color": INK, "width": 1}}
        centre = {"type": "scatter3d", "mode": "markers", "x": x, "y": y, "z": z, "marker": marker}
        drawn.append(centre | {"name": "vessel (centre of gravity)"})
    return drawn


def _flat(x: Any, y: Any, name: str, colour: str, width: int = 2) -> dict[str, Any]:
    line = {"color": colour, "width": width}
    return {"type": "scatter", "mode": "lines", "x": x, "y": y, "name": name, "line": line}


def plan(made: Scene, height: int = 460) -> Figure:
    """From above, x to the right, y up: equal scales."""
    data = []
    for index, (name, nodes) in enumerate(made.lines.items()):
        colour = CYCLE[index % len(CYCLE)]
        data.append(_flat(nodes[:, 0], nodes[:, 1], name, colour))
        end = _flat(nodes[:1, 0], nodes[:1, 1], f"{name}, end a", colour) | {"mode": "markers", "showlegend": False}
        data.append(end | {"marker": {"symbol": "square", "size": 8, "color": colour}})
    if made.hull is not None:
        data.append(_flat(made.hull[:, 0], made.hull[:, 1], "fairleads", HULL, 3))
    horizontal = axis("x [m]", constrain="domain")
    vertical = axis("y [m]", scaleanchor="x", scaleratio=1, constrain="domain")
    return figure(data, height, xaxis=horizontal, yaxis=vertical, hovermode="closest")


def profile(made: Scene, height: int = 460) -> Figure:
    """Each line from the side: height over the horizontal distance from its end b."""
    data = []
    for index, (name, nodes) in enumerate(made.lines.items()):
        distance = np.hypot(nodes[:, 0] - nodes[-1, 0], nodes[:, 1] - nodes[-1, 1])
        data.append(_flat(distance, nodes[:, 2], name, CYCLE[index % len(CYCLE)]))
    levels = [(0.0, "still water", {"color": BLUE, "width": 1, "dash": "dot"})]
    if made.depth:
        levels.append((-made.depth, "seabed", {"color": SEABED, "width": 4}))
    shapes = [
        {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": z, "y1": z, "line": line, "layer": "below"}
        for z, _, line in levels
    ]
    words = [note(text, xref="paper", x=1, xanchor="right", y=z) for z, text, _ in levels]
    return figure(
        data, height, xaxis=axis(titled("horizontal distance from end b", "m")), yaxis=axis("z [m]"),
        shapes=shapes, annotations=words, hovermode="closest",
    )  # fmt: skip
