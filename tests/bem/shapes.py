"""Meshes with closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solver.bem.hulls import Barge
from solver.bem.panels import Panels, welded
from solver.bem.shapes import hull_panels, patch
from solver.bem.symmetry import Fundamental


def need_capytaine() -> None:
    pytest.importorskip("capytaine", reason="Capytaine is not installed (the extra `bem`): no boundary elements here")


def box(length: float = 4.0, breadth: float = 2.0, draft: float = 1.0, size: float = 0.5) -> Panels:
    return hull_panels(Barge(kind="barge", length=length, breadth=breadth, draft=draft), size)[0]


def hemisphere_quarter(n: int) -> Panels:
    """A quarter of the unit hemisphere in n x n panels, its corners moved out so that it encloses the true volume."""

    def place(azimuth: np.ndarray, polar: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), -np.cos(polar)

    points = np.linspace(0.0, math.pi / 2, n + 1)
    made = welded(patch(points, points, place))
    made = made if made.volume > 0 else made.flipped()
    return Panels(made.vertices * (math.pi / 6 / made.volume) ** (1 / 3), made.faces)


def hemisphere(n: int) -> Panels:
    return welded(Fundamental(hemisphere_quarter(n), ("x", "y")).whole())


def as_gdf(mesh: Panels, isx: int = 0, isy: int = 0) -> bytes:
    rows = "\n".join(" ".join(f"{value:.17g}" for value in corner) for panel in mesh.corners for corner in panel)
    return f"made for a test\n1.0 9.80665 ULEN GRAV\n{isx} {isy} ISX ISY\n{mesh.count}\n{rows}\n".encode()


def as_nemoh(mesh: Panels, symmetric: int = 0) -> bytes:
    lines = [f"2 {symmetric}"]
    lines += [f"{i + 1} " + " ".join(f"{value:.17g}" for value in point) for i, point in enumerate(mesh.vertices)]
    lines += ["0 0. 0. 0."]
    lines += [" ".join(str(corner + 1) for corner in face) for face in mesh.faces.tolist()]
    return ("\n".join([*lines, "0 0 0 0"]) + "\n").encode()


def as_triangles(mesh: Panels) -> np.ndarray:
    """(T, 3, 3): quadrangles cut in two."""
    a, b, c, d = np.moveaxis(mesh.corners, 1, 0)
    quads = ~mesh.triangles
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)[quads]])


def as_stl(mesh: Panels) -> bytes:
    facets = np.zeros(len(as_triangles(mesh)), [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    facets["v"] = as_triangles(mesh)
    return b"binary".ljust(80) + len(facets).to_bytes(4, "little") + facets.tobytes()


def as_ascii_stl(mesh: Panels) -> bytes:
    lines = ["solid hull"]
    for triangle in as_triangles(mesh):
        lines += ["facet normal 0 0 0", " outer loop"]
        lines += [f"  vertex {x:.17g} {y:.17g} {z:.17g}" for x, y, z in triangle]
        lines += [" endloop", "endfacet"]
    return ("\n".join([*lines, "endsolid hull"]) + "\n").encode()


def _faces(mesh: Panels) -> list[tuple[int, list[int]]]:
    return [
        (2, [c + 1 for c in face[:3]]) if face[2] == face[3] else (3, [c + 1 for c in face])
        for face in mesh.faces.tolist()
    ]


def as_msh2(mesh: Panels) -> bytes:
    nodes = [f"{i + 1} {x:.17g} {y:.17g} {z:.17g}" for i, (x, y, z) in enumerate(mesh.vertices)]
    elements = ["1 15 2 0 1 1", "2 1 2 0 1 1 2"]
    for number, (kind, corners) in enumerate(_faces(mesh)):
        elements.append(f"{number + 3} {kind} 2 0 1 {' '.join(map(str, corners))}")
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "1", '2 1 "hull"', "$EndPhysicalNames"]
    text += ["$Nodes", str(len(nodes)), *nodes, "$EndNodes"]
    text += ["$Elements", str(len(elements)), *elements, "$EndElements"]
    return ("\n".join(text) + "\n").encode()


def as_msh4(mesh: Panels) -> bytes:
    count = len(mesh.vertices)
    nodes = [f"1 {count} 1 {count}", f"2 1 0 {count}", *(str(i + 1) for i in range(count))]
    nodes += [f"{x:.17g} {y:.17g} {z:.17g}" for x, y, z in mesh.vertices]
    faces, elements = _faces(mesh), []
    for kind in (2, 3):
        chosen = [corners for found, corners in faces if found == kind]
        elements.append((kind, chosen))
    body = [f"2 {len(faces)} 1 {len(faces)}"]
    number = 0
    for kind, chosen in elements:
        body.append(f"2 1 {kind} {len(chosen)}")
        for corners in chosen:
            number += 1
            body.append(f"{number} {' '.join(map(str, corners))}")
    text = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Nodes", *nodes, "$EndNodes"]
    return ("\n".join([*text, "$Elements", *body, "$EndElements"]) + "\n").encode()


def as_pnl(mesh: Panels, isx: int = 0, isy: int = 0) -> bytes:
    """As HAMS' mesh converter writes it."""
    nodes = [f"{i + 1} {x:.17g} {y:.17g} {z:.17g}" for i, (x, y, z) in enumerate(mesh.vertices)]
    panels = [f"{i + 1} {kind + 1} {' '.join(map(str, corners))}" for i, (kind, corners) in enumerate(_faces(mesh))]
    text = [
        "    --------------Hull Mesh File---------------",
        "",
        "    # Number of Panels, Nodes, X-Symmetry and Y-Symmetry",
    ]
    text += [
        f"  {len(panels)} {len(nodes)} {isx} {isy}",
        "",
        "    # Start Definition of Node Coordinates     ! node x y z",
    ]
    text += [*nodes, "   # End Definition of Node Coordinates", "", "   # Start Definition of Node Relations", *panels]
    return (
        "\n".join([*text, "   # End Definition of Node Relations", "", "  --------End Hull Mesh File-------"]) + "\n"
    ).encode()
