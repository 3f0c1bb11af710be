"""Reader of HAMS' meshes (.pnl): counts and symmetries, nodes, and panels by the numbers of their nodes."""

from __future__ import annotations

import numpy as np

from .panels import Panels, unfolded
from .textlines import Lines

Array = np.ndarray
COUNTS = "panels, nodes, X-symmetry and Y-symmetry"


def is_pnl(head: bytes) -> bool:
    """Whether a text begins as HAMS writes it: a title with `Mesh File`, then a comment on the numbers of panels."""
    lines = [line.strip().lower() for line in head.splitlines() if line.strip()][:3]
    return len(lines) > 1 and b"mesh file" in lines[0] and lines[1].startswith(b"#") and b"panels" in lines[1]


def read_pnl(payload: bytes, name: str) -> Panels:
    """Raises DataError with the line. X-symmetry 1: the plane x = 0, Y-symmetry 1: y = 0; both are unfolded."""
    lines = Lines(payload, name)
    lines.take("the title")
    count, nodes, isx, isy = lines.past("#").integers(4, COUNTS)
    symmetries = [lines.symmetry(value) for value in (isx, isy)]
    if count < 1 or nodes < 1:
        raise lines.fault(f"{count} panels and {nodes} nodes; allowed: at least one of each")
    points = [_node(lines.past("#"), number, nodes) for number in range(1, nodes + 1)]
    faces = [_panel(lines.past("#"), number, count, nodes) for number in range(1, count + 1)]
    lines.past("#", "-")
    if not lines.done():
        lines.take("the end")
        raise lines.fault(f"the file goes on after panel {count}, the number of panels that its head states")
    mesh = Panels(np.array(points), np.array(faces) - 1)
    for axis, flag in enumerate(symmetries):
        if flag:
            mesh = unfolded(mesh, axis, name)
    return mesh


def _node(lines: Lines, number: int, count: int) -> Array:
    values = lines.row(4, f"number, x, y, z of node {number} of {count}")
    if values[0] != number:
        raise lines.fault(f"node {values[0]:g} where node {number} of {count} is expected; number them 1, 2, 3 …")
    return values[1:]


def _panel(lines: Lines, number: int, count: int, nodes: int) -> list[int]:
    what = f"number, number of corners and corners of panel {number} of {count}"
    words = lines.take(what).split()
    values = [int(value) for value in lines.whole(words, what)]
    if len(values) < 5 or values[0] != number or values[1] not in (3, 4) or len(values) != 2 + values[1]:
        raise lines.fault(f"expected {what}, 3 or 4 of them")
    corners = values[2 : 2 + values[1]]
    if not all(1 <= corner <= nodes for corner in corners):
        raise lines.fault(f"panel {number} has the corners {corners}; allowed: 1 to {nodes}")
    return [*corners, corners[-1]] if len(corners) == 3 else corners
