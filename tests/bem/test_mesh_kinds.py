"""Meshes as people have them: high order, counts that do not fit, dipole panels, HAMS, and kinds that are not read."""

from __future__ import annotations

import pytest

from solver.bem.read import read_mesh
from solver.outcome import DataError

from .shapes import as_gdf, as_msh2, as_pnl, box, hemisphere, hemisphere_quarter

GDF = as_gdf(box(size=1.0)).decode()
ROWS = GDF.splitlines()
COUNT = int(ROWS[3].split()[0])
PNL = as_pnl(box(size=1.0)).decode()
PLATE = "0 0 -1 1 0 -1 1 1 -1 0 1 -1\n"  # one panel


def refusal(text: str | bytes, name: str = "hull.dat") -> str:
    with pytest.raises(DataError) as caught:
        read_mesh(text.encode() if isinstance(text, str) else text, name)
    return str(caught.value)


@pytest.mark.parametrize("line", ["2 1 NPATCH IGDEF", "64  1", "87 2 NPATCH, IGDEF", "4 -1"])
@pytest.mark.parametrize("name", ["hull.gdf", "hull.dat"])
def test_a_high_order_file_is_refused_by_its_name(line: str, name: str) -> None:
    """Two bilinear B-spline patches: knots, then four control points each, which fit into the form of panels."""
    patch = "1 1\n2 2\n-1 -1 1 1\n-1 -1 1 1\n-9 {y} -5\n9 {y} -5\n-9 {y} 0\n9 {y} 0\n"
    text = f"box side\n1.0 9.80665 ULEN GRAV\n0 0 ISX ISY\n{line}\n{patch.format(y=5)}{patch.format(y=-5)}"
    said = refusal(text, name)
    assert f"{name}, line 4: a high-order GDF (IGDEF = {line.split()[1]} beside NPATCH)" in said
    assert "ILOWGDF = 1" in said


def test_flat_patches_have_the_form_of_panels() -> None:
    flat = GDF.replace(ROWS[3], f"{COUNT} 0 NPATCH IGDEF")
    assert read_mesh(flat.encode(), "a.gdf")[0].volume == pytest.approx(8.0)


@pytest.mark.parametrize("count", [1, COUNT // 2, COUNT - 1])
def test_a_file_that_goes_on_after_its_panels_is_refused(count: int) -> None:
    text = GDF.replace(ROWS[3], str(count))
    line = 4 + (len(ROWS) - 4) // COUNT * count + 1
    assert f"hull.dat, line {line}: the file goes on after panel {count}, the last of NPAN" in refusal(text)


def test_a_file_that_ends_before_its_panels_is_refused() -> None:
    assert f"panel {COUNT + 1} of {COUNT + 1}" in refusal(GDF.replace(ROWS[3], str(COUNT + 1)))


@pytest.mark.parametrize("end", ["0 NPAND\n", "  0\n", "\n\n", "end of the hull\n", "NPAND 3\nmade by hand\n"])
def test_no_dipole_panels_and_text_may_follow(end: str) -> None:
    assert read_mesh((GDF + end).encode(), "a.gdf")[0].volume == pytest.approx(8.0)


@pytest.mark.parametrize(
    ("end", "words"),
    [
        ("2 NPAND\n" + 2 * PLATE, "NPAND is 2: dipole panels"),
        ("7\n", "NPAND is 7: dipole panels"),
        ("0\n" + PLATE, "goes on after panel"),
        (PLATE, "goes on after panel"),
    ],
)
def test_dipole_panels_and_more_panels_are_refused(end: str, words: str) -> None:
    assert words in refusal(GDF + end)


# --- HAMS


def test_a_mesh_of_hams_with_triangles() -> None:
    """A square pyramid upside down under the water: side 2 m, 3 m deep, 4 m3."""
    text = """  ---Hull Mesh File---

    # Number of Panels, Nodes, X-Symmetry and Y-Symmetry
         4         5         0         0

    # Start Definition of Node Coordinates     ! node_number   x   y   z
    1   1.0  1.0  0.0
    2  -1.0  1.0  0.0
    3  -1.0 -1.0  0.0
    4   1.0 -1.0  0.0
    5   0.0  0.0 -3.0
    # End Definition of Node Coordinates

    # Start Definition of Node Relations
    1  3  1  2  5
    2  3  2  3  5
    3  3  3  4  5
    4  3  4  1  5
    # End Definition of Node Relations

    ----End Hull Mesh File----
"""
    mesh, kind = read_mesh(text.encode(), "HullMesh.pnl")
    assert kind == "HAMS"
    assert abs(mesh.volume) == pytest.approx(4.0)
    assert bool(mesh.triangles.all())


def test_the_symmetries_of_hams_are_those_of_the_planes_x_0_and_y_0() -> None:
    quarter, whole = hemisphere_quarter(4), hemisphere(4)
    assert read_mesh(as_pnl(quarter, 1, 1), "a.pnl")[0].volumes == pytest.approx(whole.volumes)
    lopsided = box(size=1.0)
    lopsided.vertices[:, 0] += 5.0  # from x = 3 to 7: with X-symmetry there are two boxes, 8 m3 each
    found = read_mesh(as_pnl(lopsided, 1, 0), "a.pnl")[0]
    assert found.volume == pytest.approx(16.0)
    assert found.vertices[:, 0].min() == pytest.approx(-7.0)
    assert found.vertices[:, 1].min() == pytest.approx(-1.0)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("\n1 ", "\n2 ", "node 2 where node 1 of"),
        (f"  {COUNT} ", f"  {COUNT - 1} ", f"the file goes on after panel {COUNT - 1}"),
        (f"  {COUNT} ", f"  {COUNT + 1} ", f"panel {COUNT + 1} of {COUNT + 1}"),
        (" 0 0\n\n", " 0 3\n\n", "a symmetry is given as 3"),
        ("Relations\n1 4 1 ", "Relations\n1 4 999 ", "allowed: 1 to"),
        ("Relations\n1 4 1 ", "Relations\n1 5 1 1 ", "3 or 4 of them"),
        ("Relations\n1 4 1 ", "Relations\n1 4 1.5 ", "whole numbers"),
        ("Coordinates\n\n", "Coordinates\n9 0 0 0\n", "expected number, number of corners"),
    ],
)  # fmt: skip
def test_a_damaged_mesh_of_hams_is_refused(old: str, new: str, words: str) -> None:
    assert old in PNL
    assert words in refusal(PNL.replace(old, new, 1), "a.pnl")


# --- gmsh


@pytest.mark.parametrize(("kind", "nodes"), [(1, 2), (15, 1)])
def test_a_panel_that_calls_itself_a_line_or_a_point_is_refused(kind: int, nodes: int) -> None:
    """Lines and points are skipped, and so would be the panel."""
    text = as_msh2(box(size=1.0)).decode()
    changed = text.replace(" 3 2 0 1 ", f" {kind} 2 0 1 ", 1)
    assert changed != text
    assert f"an element of type {kind} has 4 nodes; expected {nodes}" in refusal(changed, "a.msh")
    assert read_mesh(text.encode(), "a.msh")[0].volume == pytest.approx(8.0)


# --- other kinds


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("v 0 0 -1\nv 1 0 -1\nv 1 1 -1\nf 1 2 3\n", "OBJ"),
        ("# made by hand\no hull\nv 0 0 -1\nv 1 0 -1\nf 1 2 3\n", "OBJ"),
        ("ply\nformat ascii 1.0\nelement vertex 3\n", "PLY"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "OFF"),
        ("# vtk DataFile Version 3.0\nhull\nASCII\n", "VTK"),
        ("ISO-10303-21;\nHEADER;\n", "STEP"),
        ("MeshVersionFormatted 2\nDimension 3\nVertices\n3\n", "Medit"),
        ("*HEADING\n*NODE\n1, 0, 0, 0\n", "Abaqus or LS-DYNA"),
        ("x,y,z\n1,2,3\n4,5,6\n7,8,9\n", "comma-separated text"),
        ("1 1 0.0\n1 2 0.0\n1 3 2.5\n1 4 0.0\n", None),
        ("a word\nand another\nand more\n", None),
    ],
)  # fmt: skip
def test_other_kinds_of_mesh_are_named_and_refused(text: str, kind: str | None) -> None:
    said = refusal(text, "hull.txt")
    assert said.startswith("hull.txt: this is not a mesh of a known kind")
    assert said.endswith("give a mesh as STL, GDF (low order), MSH (text), Nemoh .dat or HAMS .pnl")
    assert (f"looks like {kind}" in said) if kind else ("looks like" not in said)


def test_a_file_that_is_called_gdf_is_told_what_a_gdf_lacks() -> None:
    assert "line 2: 'v' is not a finite number; expected ULEN and GRAV" in refusal("v 0 0 0\nv 1 1\n", "hull.gdf")


def test_a_symmetry_of_a_whole_hull_is_refused() -> None:
    for payload in (as_gdf(box(size=1.0), 0, 1), as_pnl(box(size=1.0), 0, 1), as_gdf(box(size=1.0), 1, 0)):
        with pytest.raises(
            DataError, match=r"a\.dat: a symmetry across [xy] = 0 is stated, but panels lie on both sides"
        ):
            read_mesh(payload, "a.dat")
