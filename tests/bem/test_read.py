"""Meshes from files: each format read back, every fault with its line, nothing but DataError whatever the bytes."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from solver.bem.panels import Panels
from solver.bem.read import MAX_BYTES, read_mesh
from solver.outcome import DataError

from .shapes import (
    as_ascii_stl,
    as_gdf,
    as_msh2,
    as_msh4,
    as_nemoh,
    as_pnl,
    as_stl,
    box,
    hemisphere,
    hemisphere_quarter,
)

WRITERS: dict[str, Callable[[Panels], bytes]] = {
    "GDF": as_gdf,
    "Nemoh": as_nemoh,
    "STL": as_stl,
    "STL text": as_ascii_stl,
    "MSH": as_msh2,
    "MSH 4": as_msh4,
    "HAMS": as_pnl,
}


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("mesh", [box(), hemisphere(4)], ids=["box", "hemisphere"])
def test_what_was_written_is_read(kind: str, mesh: Panels) -> None:
    found, said = read_mesh(WRITERS[kind](mesh), "hull.dat")
    assert said == kind.split()[0]
    assert found.volumes == pytest.approx(mesh.volumes, rel=1e-6)
    assert found.vertices.shape == mesh.vertices.shape  # corners welded
    assert found.count == (mesh.count if "STL" not in kind else 2 * mesh.count - mesh.triangles.sum())


def test_symmetries_that_a_file_declares_are_unfolded() -> None:
    quarter = hemisphere_quarter(4)
    found, _ = read_mesh(as_gdf(quarter, 1, 1), "hull.gdf")
    assert found.volumes == pytest.approx([4 * quarter.volume] * 3)
    half = Panels(*(lambda m: (m.vertices, m.faces))(read_mesh(as_gdf(quarter, 1, 0), "half.gdf")[0]))
    found, _ = read_mesh(as_nemoh(half, 1), "hull.dat")
    assert found.volumes == pytest.approx([4 * quarter.volume] * 3)


def test_what_follows_a_panel_on_its_line_is_ignored_as_wamit_does() -> None:
    lines = as_gdf(box(size=1.0)).decode().splitlines()
    lines[7] += "    1"
    assert read_mesh("\n".join(lines).encode(), "a.gdf")[0].volume == pytest.approx(8.0)


def test_fortran_numbers() -> None:
    text = as_gdf(box(size=1.0)).decode().replace("-0.5", "-5.0D-01").replace(" 0 ", " 0.0-100 ")
    assert read_mesh(text.encode(), "a.gdf")[0].volume == pytest.approx(8.0)


GDF, NEMOH, MSH = as_gdf(box(size=1.0)).decode(), as_nemoh(box(size=1.0)).decode(), as_msh2(box(size=1.0)).decode()
PNL = as_pnl(box(size=1.0)).decode()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"),
        (GDF[:200], "truncated"),
        (GDF.replace("1.0 9.80665 ULEN", "1.0 nan ULEN"), "line 2: 'nan' is not a finite number"),
        (GDF.replace("1.0 9.80665 ULEN", "1.0 32.174 ULEN"), "line 2: GRAV is that of feet"),
        (GDF.replace("0 0 ISX", "0 2 ISX"), "line 3: a symmetry is given as 2; allowed: 0 or 1"),
        (GDF.replace("ISY\n", "ISY\n-"), "line 4: NPAN is -"),
        ("t\n1 9.8\n0 0\n99999999999\n", "line 4: NPAN is 99999999999; allowed: 1 to"),
        (GDF.replace("\n-2 ", "\nminus ", 1), "'minus' is not a finite number"),
        (NEMOH.replace("\n2 ", "\n7 ", 1), "line 3: corner 7 follows corner 1"),
        (NEMOH.replace("0 0. 0. 0.\n", "0 0. 0. 0.\n1 2 3 9999\n"), "a panel has the corners [1, 2, 3, 9999]; allowed: 1 to"),
        ("\n".join(NEMOH.splitlines()[:5]), "line 5: the file ends where number, x, y, z"),
        ("solid a\nfacet normal 0 0 1\nvertex 0 0\n", "line 3: expected x, y, z of a vertex: 3 numbers; got 2"),
        ("solid a\nfacet\nvertex 0 0 0\nendfacet\n", "line 4: a facet ends with 1 vertices; expected 3"),
        ("solid a\nfacet\nvertex 0 0 0\nvertex 0 0 0\nvertex 1 0 0\nendfacet\n", "without endsolid"),
        ("solid a\nvertex 0 0 0\nendsolid\n", "line 3: 1 vertices are no whole number of triangles"),
        ("solid a\nfrobnicate\n", "line 2: 'frobnicate' is no word of an STL"),
        (MSH.replace("2.2 0 8", "2.2 1 8"), "line 2: a binary MSH is not read"),
        (MSH.replace("2.2 0 8", "3.0 0 8"), "line 2: MSH version '3.0'"),
        (MSH.replace(" 3 2 0 1 ", " 16 2 0 1 ", 1), "an element of gmsh's type 16"),
        (MSH.replace("\n3 3 2 0 1 1 ", "\n3 3 2 0 1 999 ", 1), "has node 999, which is not among"),
        (MSH.replace("$EndNodes", "8 0 0 0\n$EndNodes"), "expected $EndNodes"),
        (MSH.split("$Elements")[0], "holds no panels"),
        ("hull\n1 9.8\n0 0\n1\n0 0 0 1 0 0 1 1 1e300 0 1 0\n", "a corner lies at 1e+300"),
        ("hull\n1 9.8\n0 0\n1\n0 0 0 1 0 0 1 0 0 0 0 0\n", "all 1 panels collapse"),
    ],
)  # fmt: skip
def test_a_fault_says_where_and_what(text: str, words: str) -> None:
    with pytest.raises(DataError) as caught:
        read_mesh(text.encode(), "hull.dat")
    assert words in str(caught.value)
    assert str(caught.value).startswith("hull.dat")


def test_a_damaged_binary_stl_says_how_much_is_missing() -> None:
    with pytest.raises(DataError, match=r"a binary STL of \d+ facets has \d+ bytes, this file has \d+"):
        read_mesh(as_stl(box())[:-7], "hull.stl")


def test_large_files_are_refused_and_claims_of_a_header_cost_no_memory() -> None:
    with pytest.raises(DataError, match="allowed: at most 32 MB"):
        read_mesh(b"\0" * (MAX_BYTES + 1), "hull.stl")
    claims = [
        b"t\n1 9.8\n0 0\n40000\n0 0 0",
        b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 900000000000 1 900000000000\n2 1 0 900000000000\n1\n",
        b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n900000000000\n1 0 0 0\n",
    ]
    tracemalloc.start()
    for claim in claims:
        with pytest.raises(DataError, match="truncated"):
            read_mesh(claim, "hull.dat")
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    kind=st.sampled_from(sorted(WRITERS)),
    at=st.floats(0, 1),
    what=st.binary(max_size=12) | st.sampled_from([b"nan", b"-", b"1e999", b"0", b"\n", b" 99999999 ", b"$EndNodes"]),
    cut=st.integers(0, 30),
)
def test_no_damage_does_anything_but_a_sentence(kind: str, at: float, what: bytes, cut: int) -> None:
    whole = WRITERS[kind](box(size=1.0))
    place = int(at * len(whole))
    try:
        mesh, _ = read_mesh(whole[:place] + what + whole[place + cut :], "hull.dat")
    except DataError as error:
        mesh, sentence = box(), str(error)
        assert len(sentence) < 400
    assert np.all(np.isfinite(mesh.vertices))
    assert mesh.faces.max(initial=-1) < len(mesh.vertices)
