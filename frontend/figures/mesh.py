"""The panels of a hull in space."""

from __future__ import annotations

from typing import Any

import numpy as np

from frontend.figures.base import Figure, figure
from frontend.theme import BLUE, GRID, INK, PAPER

SEA = "#8fc1de"


def mesh(preview: dict[str, Any], height: int = 460) -> Figure:
    """`preview` has vertices (n, 3) [m] and faces (m, 4); a triangle repeats its last corner."""
    vertices, faces = np.asarray(preview["vertices"], dtype=float), np.asarray(preview["faces"], dtype=int)
    x, y, z = vertices.T
    i, j, k = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]).T
    skin = {
        "type": "mesh3d", "x": x, "y": y, "z": z, "i": i, "j": j, "k": k, "color": BLUE, "opacity": 0.85, "flatshading": True,
        "hoverinfo": "skip", "name": "hull", "showlegend": False,
    }  # fmt: skip
    loops = np.concatenate([faces, faces[:, :1]], axis=1)
    edges = np.full((len(loops), 6, 3), np.nan)
    edges[:, :5] = vertices[loops]
    ex, ey, ez = edges.reshape(-1, 3).T
    wire = {
        "type": "scatter3d", "mode": "lines", "x": ex, "y": ey, "z": ez, "line": {"color": INK, "width": 1},
        "hoverinfo": "skip", "name": "panel edges", "showlegend": False,
    }  # fmt: skip
    side = {"backgroundcolor": PAPER, "gridcolor": GRID, "color": INK, "showspikes": False}
    scene = {f"{c}axis": side | {"title": {"text": f"{c} [m]"}} for c in "xyz"} | {
        "aspectmode": "data", "camera": {"eye": {"x": 1.2, "y": -1.5, "z": 0.7}},
    }  # fmt: skip
    return figure(
        [skin, wire, _water(vertices)], height, legend=False, margin={"l": 0, "r": 0, "t": 8, "b": 0}, scene=scene,
        hovermode="closest",
    )  # fmt: skip


def _water(vertices: np.ndarray) -> dict[str, Any]:
    (x0, y0, _), (x1, y1, _) = vertices.min(axis=0), vertices.max(axis=0)
    mx, my = 0.1 * (x1 - x0) + 1e-6, 0.1 * (y1 - y0) + 1e-6
    return {
        "type": "mesh3d", "x": [x0 - mx, x1 + mx, x1 + mx, x0 - mx], "y": [y0 - my, y0 - my, y1 + my, y1 + my], "z": [0.0] * 4,
        "i": [0, 0], "j": [1, 2], "k": [2, 3], "color": SEA, "opacity": 0.25, "hoverinfo": "skip", "name": "still water",
    }  # fmt: skip
