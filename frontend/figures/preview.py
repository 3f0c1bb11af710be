"""The pictures beside the form: the case's shape at rest with azimuths, touchdown points and the way the sea goes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from frontend.editor.text import EditError
from frontend.figures import shape as shapes
from frontend.figures.base import Figure, note
from frontend.figures.sea import towards
from frontend.theme import BLUE, CYCLE, INK

STILL = "preview"  # uirevision: an edit redraws the picture without turning it back


def scene(preview: dict[str, Any], tree: dict[str, Any]) -> shapes.Scene:
    """From the answer of POST /preview and the editor's tree."""
    vessel = ((preview.get("statics") or {}).get("vessel") or {}).get("position")
    channels = {name: {"values": line["position"]} for name, line in (preview.get("lines") or {}).items()}
    return shapes.scene(channels, tree, vessel)


def upside_down(nodes: np.ndarray) -> bool:
    """Whether end b is the one that lies deeper."""
    return bool(nodes[-1, 2] < nodes[0, 2])


def touchdown(nodes: np.ndarray, arc: np.ndarray, grounded: float) -> np.ndarray | None:
    """Where a line leaves the seabed [m]; None for one that nowhere lies on it, or that lies wholly."""
    if not 0 < grounded < arc[-1]:
        return None
    if upside_down(nodes):
        grounded = arc[-1] - grounded
    return np.array([np.interp(grounded, arc, nodes[:, i]) for i in range(3)])


def touchdowns(preview: dict[str, Any]) -> dict[str, np.ndarray]:
    found = {}
    for name, line in (preview.get("lines") or {}).items():
        held = ((preview.get("statics") or {}).get("lines") or {}).get(name) or {}
        nodes, arc = np.asarray(line["position"], float), np.asarray(line["arc_length"], float)
        point = touchdown(nodes, arc, float(held.get("grounded_length") or 0.0))
        if point is not None:
            found[name] = point
    return found


def in_space(preview: dict[str, Any], tree: dict[str, Any], height: int = 460) -> tuple[Figure, float]:
    made, stretch = shapes.in_space(scene(preview, tree), height)
    made["layout"]["uirevision"] = STILL
    return made, stretch


def plan(preview: dict[str, Any], tree: dict[str, Any], height: int = 460) -> Figure:
    """From above, with the azimuth of every line at its far end, and arrows where waves and current go."""
    seen = scene(preview, tree)
    made = shapes.plan(seen, height)
    notes = []
    for index, nodes in enumerate(seen.lines.values()):
        start, end = (nodes[0], nodes[-1]) if upside_down(nodes) else (nodes[-1], nodes[0])
        angle = math.degrees(math.atan2(end[1] - start[1], end[0] - start[0])) % 360
        side = {
            "xanchor": "left" if end[0] >= start[0] else "right",
            "yanchor": "bottom" if end[1] >= start[1] else "top",
        }
        font = {"size": 11, "color": CYCLE[index % len(CYCLE)]}
        notes.append(note(f"{angle:.1f}°", x=float(end[0]), y=float(end[1]), font=font) | side)
    size = float((seen.box[1] - seen.box[0])[:2].max()) or 1.0
    middle = seen.box.mean(axis=0)
    for words, angle in directions(tree):
        dx, dy = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        tip = (middle[0] - 0.18 * size * dx, middle[1] - 0.18 * size * dy)
        tail = (middle[0] - 0.42 * size * dx, middle[1] - 0.42 * size * dy)
        arrow = {"x": tip[0], "y": tip[1], "ax": tail[0], "ay": tail[1], "xref": "x", "yref": "y", "axref": "x", "ayref": "y",
                 "showarrow": True, "arrowhead": 2, "arrowwidth": 2, "arrowcolor": BLUE, "text": words,
                 "font": {"size": 11, "color": INK}}  # fmt: skip
        notes.append(arrow)
    layout = made["layout"] | {
        "annotations": notes,
        "uirevision": STILL,
        "margin": {"l": 62, "r": 24, "t": 34, "b": 46},
    }
    return made | {"layout": layout}


def directions(tree: dict[str, Any]) -> list[tuple[str, float]]:
    """Words and the direction [deg] that every wave system and the current goes to."""
    environment = tree.get("environment") or {}
    found = []
    for named, part in [("waves", sea) for sea in environment.get("seastates") or []] + [
        ("current", environment.get("current"))
    ]:
        try:
            if part:
                found.append((named, towards(part)))
        except (EditError, AttributeError):
            continue
    return found


def profile(preview: dict[str, Any], tree: dict[str, Any], height: int = 460) -> Figure:
    """Every line from the side, with the point where it leaves the seabed."""
    seen = scene(preview, tree)
    made = shapes.profile(seen, height)
    points = touchdowns(preview)
    data = list(made["data"])
    for index, (name, nodes) in enumerate(seen.lines.items()):
        if name in points:
            point, end = points[name], nodes[-1]
            x = float(np.hypot(point[0] - end[0], point[1] - end[1]))
            marker = {
                "size": 9,
                "symbol": "triangle-up",
                "color": CYCLE[index % len(CYCLE)],
                "line": {"width": 1, "color": INK},
            }
            data.append({"type": "scatter", "mode": "markers", "x": [x], "y": [float(point[2])], "name": f"{name}, touchdown",
                         "marker": marker, "showlegend": False,
                         "hovertemplate": f"{name} leaves the seabed %{{x:.1f}} m out<extra></extra>"})  # fmt: skip
    return made | {"data": data, "layout": made["layout"] | {"uirevision": STILL}}
