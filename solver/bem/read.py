"""Meshes from files: GDF (WAMIT), Nemoh's .dat, HAMS' .pnl, MSH (gmsh, text), STL (text and binary), by their content.

Every reader is bounded by the size of what it is given: nothing is set aside for numbers that a header only claims.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import takewhile
from pathlib import PurePosixPath, PureWindowsPath

import numpy as np

from ..outcome import DataError
from .msh import read_msh
from .panels import Panels, unfolded, welded
from .pnl import is_pnl, read_pnl
from .spec import MAX_PANELS
from .textlines import Lines, fortran_number

Array = np.ndarray
MAX_BYTES = 32 * 1024 * 1024
COORDINATE = 1e6  # m
KINDS = "STL, GDF (low order), MSH (text), Nemoh .dat or HAMS .pnl"
_FOREIGN = (  # how files of other kinds begin, lower case
    (rb"ply\b", "PLY"),
    (rb"c?off\b", "OFF"),
    (rb"# vtk", "VTK"),
    (rb"<\?xml", "XML"),
    (rb"iso-10303", "STEP"),
    (rb"meshversionformatted", "Medit"),
    (rb"\*(heading|node|keyword)", "Abaqus or LS-DYNA"),
    (rb"(#[^\n]*\n|\s|(mtllib|o|g|s)\s[^\n]*\n)*vn?\s+[-+.\d]", "OBJ"),
    (rb"[a-z_]+[,;]", "comma-separated text"),
)
FEET = (32.0, 32.4)  # a GRAV of 32.174 ft/s2
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_mesh(payload: bytes, filename: str) -> tuple[Panels, str]:
    """The panels of a file as they stand in it, and its format. Symmetries that a file declares are unfolded.

    Raises DataError: one sentence with the file, the line (of text), the value and the remedy.
    """
    name = PureWindowsPath(PurePosixPath(filename).name).name[:120] or "mesh"
    if len(payload) > MAX_BYTES:
        raise DataError(f"{name}: the file has {len(payload) / 2**20:.1f} MB; allowed: at most {MAX_BYTES // 2**20} MB")
    if not payload.strip():
        raise DataError(f"{name}: the file is empty; upload it again")
    kind, reader = _kind(payload, name)
    mesh = reader(payload, name)
    if mesh.count == 0:
        raise DataError(f"{name}: the file holds no panels")
    if mesh.count > 2 * MAX_PANELS:
        raise DataError(f"{name}: {mesh.count} panels; allowed: at most {2 * MAX_PANELS}, {MAX_PANELS} below the water")
    used = mesh.vertices[np.unique(mesh.faces)]
    if not np.all(np.isfinite(used)) or np.abs(used).max() > COORDINATE:
        raise DataError(f"{name}: a corner lies at {np.abs(used).max():g}; allowed: finite, within {COORDINATE:g} m")
    made = welded(mesh)
    if made.count == 0:
        raise DataError(f"{name}: all {mesh.count} panels collapse: their corners lie on points or lines")
    return made, kind


def _kind(payload: bytes, name: str) -> tuple[str, Callable[[bytes, str], Panels]]:
    if _facets(payload) is not None:
        return "STL", _read_stl
    head = payload[:4096]
    if head.lstrip().startswith(b"$MeshFormat"):
        return "MSH", read_msh
    if head.lstrip()[:5].lower() == b"solid":
        return "STL", _read_ascii_stl
    if b"\0" in head:
        if payload[80:84].strip() and len(payload) > 84 and name.lower().endswith(".stl"):
            said = int.from_bytes(payload[80:84], "little")
            raise DataError(
                f"{name}: a binary STL of {said} facets has {84 + 50 * said} bytes, this file has {len(payload)}; "
                "it is truncated or damaged, write it again"
            )
        raise DataError(f"{name}: this is neither text nor a whole binary STL; give a mesh as {KINDS}")
    if is_pnl(head):
        return "HAMS", read_pnl
    first = head.decode("latin-1").splitlines()[0].split()
    if len(first) == 2 and all(re.fullmatch(r"\d+", word) for word in first) and first[0] == "2":
        return "Nemoh", _read_nemoh
    if name.lower().endswith(".gdf") or _looks_like_gdf(head):
        return "GDF", _read_gdf
    foreign = next((what for begin, what in _FOREIGN if re.match(begin, head.lower())), None)
    looks = f", and looks like {foreign}" if foreign else ""
    raise DataError(f"{name}: this is not a mesh of a known kind{looks}; give a mesh as {KINDS}")


def _looks_like_gdf(head: bytes) -> bool:
    """Whether lines 2 to 4 hold two, two and one or two numbers and then text, as after the title of a GDF.

    A file that ends before its fourth line is taken for a GDF, whose reader says where it is cut off.
    """
    lines = [line.split() for line in head.decode("latin-1").splitlines() if line.strip()][1:4]
    numbers = [sum(1 for _ in takewhile(lambda word: fortran_number(word) is not None, line)) for line in lines]
    return bool(lines) and all(few <= count <= 2 for few, count in zip((1, 1, 1), numbers, strict=False))


# --- WAMIT


def _read_gdf(payload: bytes, name: str) -> Panels:
    """Title; ULEN GRAV; ISX ISY; NPAN; then twelve coordinates a panel, what follows them on their line ignored."""
    lines = Lines(payload, name)
    lines.take("the title")
    if FEET[0] < float(lines.floats(2, "ULEN and GRAV")[1]) < FEET[1]:
        raise lines.fault(
            "GRAV is that of feet, and so are the coordinates; write 9.80665 in its place and give geometry.scale: 0.3048"
        )
    isx, isy = (lines.symmetry(value) for value in lines.integers(2, "ISX and ISY"))
    count = _low_order(lines)
    corners = np.empty((min(count, len(payload) // 12 + 1), 4, 3))
    for panel in range(count):
        values = lines.numbers(12, f"panel {panel + 1} of {count}")
        corners[panel] = values.reshape(4, 3)
    _nothing_follows(lines, count)
    mesh = Panels(corners.reshape(-1, 3), np.arange(4 * count).reshape(-1, 4))
    for axis, flag in ((0, isx), (1, isy)):
        if flag:
            mesh = unfolded(mesh, axis, name)
    return mesh


def _low_order(lines: Lines) -> int:
    """NPAN of a low-order file; NPATCH of one of flat patches (IGDEF = 0), which has the same form."""
    words = lines.take("the number of panels, NPAN").split()
    count = lines.whole(words[:1], "the number of panels, NPAN", 1)[0]
    order = fortran_number(words[1]) if len(words) > 1 else None
    if order:
        raise lines.fault(
            f"a high-order GDF (IGDEF = {order:g} beside NPATCH) holds patches, not panels; export it in low order, "
            "such as with ILOWGDF = 1 in WAMIT"
        )
    if not 0 < count <= 2 * MAX_PANELS:
        raise lines.fault(f"NPAN is {count}; allowed: 1 to {2 * MAX_PANELS}")
    return count


def _nothing_follows(lines: Lines, count: int) -> None:
    """After the last panel: nothing, text, or NPAND = 0, the number of dipole panels. Raises DataError."""
    if lines.done():
        return
    words = lines.take("the end of the file").split()
    numbers = [fortran_number(word) for word in words]
    known = next((k for k, value in enumerate(numbers) if value is None), len(numbers))
    if known == 1 and numbers[0]:
        raise lines.fault(f"NPAND is {words[0][:20]}: dipole panels, thin as plates, are not read; leave them out")
    if known > 1 or (known == 1 and not lines.done()):
        raise lines.fault(
            f"the file goes on after panel {count}, the last of NPAN = {count} panels (line 4); correct NPAN, or take "
            "out what follows"
        )


# --- Nemoh


def _read_nemoh(payload: bytes, name: str) -> Panels:
    """`2 symmetry`; lines `number x y z` up to a line of zeros; lines of four corners up to a line of zeros."""
    lines = Lines(payload, name)
    symmetric = lines.symmetry(lines.integers(2, "`2 symmetry`")[1])
    points: list[Array] = []
    while True:
        values = lines.row(4, "number, x, y, z of a corner, or the line of zeros after the last")
        if values[0] == 0:
            break
        if values[0] != len(points) + 1:
            raise lines.fault(f"corner {values[0]:g} follows corner {len(points)}; number them 1, 2, 3 …")
        points.append(values[1:])
    faces: list[list[int]] = []
    while not lines.done():
        what = "the four corners of a panel, or the line of zeros after the last"
        panel = lines.whole(lines.take(what).split(), what, 4)
        if not any(panel):
            break
        if not all(1 <= corner <= len(points) for corner in panel):
            raise lines.fault(f"a panel has the corners {panel}; allowed: 1 to {len(points)}")
        faces.append(panel)
    mesh = Panels(np.array(points).reshape(-1, 3), np.array(faces, int).reshape(-1, 4) - 1)
    return unfolded(mesh, 1, name) if symmetric else mesh


# --- STL


def _facets(payload: bytes) -> int | None:
    """Number of facets of a whole binary STL; None when it is not one."""
    count = int.from_bytes(payload[80:84], "little")
    return count if len(payload) > 84 and len(payload) == 84 + 50 * count else None


def _triangles(corners: Array) -> Panels:
    count = corners.shape[0]
    index = np.arange(3 * count).reshape(-1, 3)
    with np.errstate(invalid="ignore"):  # bytes of anybody may be a number that signals; it is refused as not finite
        corners = corners.reshape(-1, 3).astype(float)
    return Panels(corners, np.column_stack([index, index[:, 2]]))


def _read_stl(payload: bytes, name: str) -> Panels:
    return _triangles(np.frombuffer(payload, _FACET, offset=84)["corners"])


def _read_ascii_stl(payload: bytes, name: str) -> Panels:
    """Only `vertex x y z` and `endfacet` matter: three vertices a facet."""
    lines = Lines(payload, name)
    corners: list[Array] = []
    ended = False
    while not lines.done():
        words = lines.take("a facet, or endsolid").split()
        key = words[0].lower()
        if key == "vertex":
            corners.append(lines.parse(words[1:], 3, "x, y, z of a vertex"))
        elif key == "endfacet" and len(corners) % 3:
            raise lines.fault(f"a facet ends with {len(corners) % 3} vertices; expected 3")
        elif key not in ("solid", "facet", "outer", "endloop", "endfacet", "endsolid"):
            raise lines.fault(f"{words[0][:40]!r} is no word of an STL; expected facet, vertex, endfacet or endsolid")
        ended = key == "endsolid"
    if not ended:
        raise lines.fault("the file ends without endsolid; it is truncated, write it again")
    if len(corners) % 3:
        raise lines.fault(f"{len(corners)} vertices are no whole number of triangles; an endfacet is missing")
    return _triangles(np.array(corners).reshape(-1, 3, 3))
