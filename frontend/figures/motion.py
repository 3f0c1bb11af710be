"""The system in motion: frames of one oscillation about the static shape, with play, pause and a slider."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from frontend.figures.base import Figure
from frontend.figures.shape import Scene, in_space
from frontend.theme import GRID, INK

FRAMES = 24
SHARE = 0.07  # of the picture's size, the largest displacement that is drawn


def exaggeration(made: Scene, moved: Mapping[str, np.ndarray]) -> float:
    """By how much displacements are multiplied so that they can be seen."""
    low, high = made.box
    largest = max((float(np.abs(values).max(initial=0.0)) for values in moved.values()), default=0.0)
    return SHARE * float((high - low).max()) / largest if largest > 0 else 1.0


def oscillation(made: Scene, moved: Mapping[str, np.ndarray], scale: float, height: int = 540) -> tuple[Figure, float]:
    """Re(moved·e^{iφ}) × scale about the static shape, φ through one turn; and the stretch of the vertical.

    moved : per line, displacement of its nodes, complex or real, shape (nodes, 3), earth axes [m]
    """
    steps = np.linspace(0.0, 2.0 * np.pi, FRAMES, endpoint=False)
    poses = [_posed(made, moved, scale * np.exp(1j * angle)) for angle in steps]
    figure, stretch = in_space(poses[0], height)
    _hold_frame(figure, poses)
    moving = [index for index, trace in enumerate(figure["data"]) if trace["type"] == "scatter3d"]
    frames = []
    for number, pose in enumerate(poses):
        drawn = in_space(pose, height)[0]["data"]
        data = [{axis: drawn[index][axis] for axis in "xyz"} | {"type": "scatter3d"} for index in moving]
        frames.append({"name": str(number), "data": data, "traces": moving})
    layout = figure["layout"] | {"updatemenus": [_buttons()], "sliders": [_slider(steps)]}
    layout["margin"] = layout["margin"] | {"b": 84}
    return {"data": figure["data"], "layout": layout, "frames": frames}, stretch


def _posed(made: Scene, moved: Mapping[str, np.ndarray], turn: complex) -> Scene:
    lines = {
        name: nodes + np.real(moved[name] * turn) if name in moved else nodes for name, nodes in made.lines.items()
    }
    return replace(made, lines=lines, vessel=None)


def _hold_frame(figure: Figure, poses: list[Scene]) -> None:
    """Axes that hold every frame, so that the picture does not breathe."""
    boxes = np.array([pose.box for pose in poses])
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    low[2] = min(low[2], -(poses[0].depth or 0.0))
    margin = 0.04 * (high - low).max()
    for index, name in enumerate("xyz"):
        ends = [float(low[index] - margin), float(high[index] + margin)]
        figure["layout"]["scene"][f"{name}axis"] |= {"range": ends, "autorange": False}


def _buttons() -> dict[str, Any]:
    play = {"frame": {"duration": 80, "redraw": True}, "fromcurrent": True, "transition": {"duration": 0}}
    halt = {"frame": {"duration": 0, "redraw": False}, "mode": "immediate"}
    return {
        "type": "buttons", "direction": "left", "x": 0, "y": 0, "xanchor": "left", "yanchor": "top",
        "pad": {"t": 6, "r": 10}, "showactive": False, "bgcolor": GRID,
        "buttons": [
            {"label": "Play", "method": "animate", "args": [None, play]},
            {"label": "Pause", "method": "animate", "args": [[None], halt]},
        ],
    }  # fmt: skip


def _slider(steps: np.ndarray) -> dict[str, Any]:
    still = {"frame": {"duration": 0, "redraw": True}, "mode": "immediate", "transition": {"duration": 0}}
    return {
        "x": 0, "y": 0, "len": 1, "xanchor": "left", "yanchor": "top", "pad": {"t": 14, "l": 12, "r": 12},
        "currentvalue": {
            "visible": True, "prefix": "phase ", "suffix": " deg", "xanchor": "right", "font": {"size": 12, "color": INK},
        },
        "font": {"color": "rgba(0,0,0,0)"}, "ticklen": 0, "minorticklen": 0,  # the phase itself is above
        "steps": [
            {"label": f"{np.degrees(angle):.0f}", "method": "animate", "args": [[str(number)], still]}
            for number, angle in enumerate(steps)
        ],
    }  # fmt: skip
