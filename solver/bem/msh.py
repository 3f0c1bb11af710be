"""Reader of gmsh's text meshes, versions 2.2 and 4.1: triangles and quadrangles; points and lines are skipped."""

from __future__ import annotations

import numpy as np

from .panels import Panels
from .textlines import Lines

Array = np.ndarray
SKIPPED = {1: 2, 15: 1}  # lines, points: number of nodes
TAKEN = {2: 3, 3: 4}  # triangles, quadrangles: number of nodes
REMEDY = "; save the surface as first-order triangles or quadrangles (Mesh.SaveAll off, one physical surface)"


def read_msh(payload: bytes, name: str) -> Panels:
    """Raises DataError with the line."""
    lines = Lines(payload, name)
    nodes: dict[int, int] = {}
    points: list[Array] = []
    faces: list[list[int]] = []
    version = 0.0
    while not lines.done():
        section = lines.take("a section").strip()
        if section == "$MeshFormat":
            version = _version(lines)
        elif section == "$Nodes":
            (_nodes4 if version >= 4 else _nodes2)(lines, nodes, points)
        elif section == "$Elements":
            (_elements4 if version >= 4 else _elements2)(lines, nodes, faces)
        elif section.startswith("$") and not section.startswith("$End"):
            _skip(lines, section)
        else:
            raise lines.fault(f"{section[:40]!r} where a section such as $Nodes is expected")
        _end(lines, section)
    vertices = np.array(points).reshape(-1, 3)
    return Panels(vertices, np.array(faces, int).reshape(-1, 4))


def _version(lines: Lines) -> float:
    words = lines.take("version, file type, data size").split()
    if len(words) < 2 or words[0] not in ("2", "2.1", "2.2", "4.1"):
        raise lines.fault(f"MSH version {words[0][:20]!r}; read are 2.2 and 4.1; save as one of these")
    if words[1] != "0":
        raise lines.fault("a binary MSH is not read; save it as text (Mesh.Binary = 0)")
    return float(words[0])


def _end(lines: Lines, section: str) -> None:
    wanted = section.replace("$", "$End")
    if section in ("$MeshFormat", "$Nodes", "$Elements") and lines.take(wanted).strip() != wanted:
        raise lines.fault(f"expected {wanted}; there are more lines in {section} than it says")


def _skip(lines: Lines, section: str) -> None:
    wanted = section.replace("$", "$End")
    while lines.take(wanted).strip() != wanted:
        pass


def _add_node(lines: Lines, tag: int, xyz: Array, nodes: dict[int, int], points: list[Array]) -> None:
    if tag in nodes:
        raise lines.fault(f"node {tag} is given twice")
    nodes[tag] = len(points)
    points.append(xyz)


def _nodes2(lines: Lines, nodes: dict[int, int], points: list[Array]) -> None:
    for _ in range(lines.integers(1, "the number of nodes")[0]):
        values = lines.row(4, "number, x, y, z of a node")
        _add_node(lines, int(values[0]), values[1:], nodes, points)


def _nodes4(lines: Lines, nodes: dict[int, int], points: list[Array]) -> None:
    for _ in range(lines.integers(4, "blocks, nodes, least and greatest tag")[0]):
        count = lines.integers(4, "dimension, tag, parametric, number of nodes of a block")[3]
        tags = [lines.integers(1, "the tag of a node")[0] for _ in range(count)]
        for tag in tags:
            _add_node(lines, tag, lines.floats(3, "x, y, z of a node"), nodes, points)


def _add_element(lines: Lines, kind: int, corners: list[int], nodes: dict[int, int], faces: list[list[int]]) -> None:
    wanted = TAKEN.get(kind) or SKIPPED.get(kind)
    if wanted is None:
        raise lines.fault(f"an element of gmsh's type {kind}" + REMEDY)
    if len(corners) != wanted:
        raise lines.fault(f"an element of type {kind} has {len(corners)} nodes; expected {wanted}")
    if kind in SKIPPED:
        return
    unknown = [corner for corner in corners if corner not in nodes]
    if unknown:
        raise lines.fault(f"an element has node {unknown[0]}, which is not among the {len(nodes)} nodes")
    found = [nodes[corner] for corner in corners]
    faces.append([*found, found[-1]] if kind == 2 else found)


def _elements2(lines: Lines, nodes: dict[int, int], faces: list[list[int]]) -> None:
    for _ in range(lines.integers(1, "the number of elements")[0]):
        words = lines.take("number, type, tags and nodes of an element").split()
        values = [int(v) for v in lines.parse(words, len(words), "number, type, tags and nodes of an element")]
        if len(values) < 3 or values[2] < 0:
            raise lines.fault("expected number, type, number of tags, tags and nodes of an element")
        _add_element(lines, values[1], values[3 + values[2] :], nodes, faces)


def _elements4(lines: Lines, nodes: dict[int, int], faces: list[list[int]]) -> None:
    for _ in range(lines.integers(4, "blocks, elements, least and greatest tag")[0]):
        kind, count = lines.integers(4, "dimension, tag, type, number of elements of a block")[2:]
        for _ in range(count):
            words = lines.take("tag and nodes of an element").split()
            values = [int(v) for v in lines.parse(words, len(words), "tag and nodes of an element")]
            _add_element(lines, kind, values[1:], nodes, faces)
