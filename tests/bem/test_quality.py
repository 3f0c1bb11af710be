"""The quality report: each doubt is raised where there is reason to, with threshold, value and remedy, and only there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.bem import Hull, HydrodynamicJob, parse_job, prepare
from solver.bem.panels import Panels, joined, welded
from solver.bem.quality import doubts, edges_of, measures, preview
from solver.outcome import DataError

from .shapes import as_gdf, box, hemisphere


def job(**more: Any) -> HydrodynamicJob:
    return parse_job({"geometry": {"mesh": "hull.gdf"}} | more, compute=False)


def looked(mesh: Panels, **more: Any) -> tuple[Hull, dict[str, Any], dict[str, Any]]:
    asked = job(**more)
    hull = prepare(asked, lambda _: (as_gdf(mesh), "hull.gdf"))
    found = measures(hull, asked)
    return hull, found, {doubt.check: doubt for doubt in doubts(hull, asked, found)}


def test_a_good_mesh_raises_no_doubt() -> None:
    hull, found, raised = looked(box(4, 2, 1, 0.25), coarsest=1.5)
    assert not raised
    assert found["closed"]
    assert found["normals_outward"]
    assert found["symmetry"] == ["x", "y"]
    assert (found["volume"], found["waterplane_area"]) == pytest.approx((8.0, 8.0))
    assert found["block_coefficient"] == pytest.approx(1.0)
    assert found["displacement"] == pytest.approx(8.0 * 1025)
    assert found["draught"] == pytest.approx(1.0)
    assert found["bounds"] == [[-2, -1, -1], [2, 1, 0]]
    assert hull.format == "GDF"


def test_panels_are_held_against_the_shortest_wave() -> None:
    wave = 2 * np.pi * 9.80665 / 3.0**2
    _, found, raised = looked(box(4, 2, 1, 1.0), coarsest=3.0)
    assert found["shortest_wave"] == pytest.approx(wave)
    assert found["panels_per_wavelength"] == pytest.approx(wave / 1.0)
    doubt = raised["panels per wavelength"]
    assert (doubt.threshold, doubt.value) == (8.0, pytest.approx(wave))
    assert f"at most {wave / 8:.3g} m" in doubt.message
    shallow = measures(prepare(job(), lambda _: (as_gdf(box()), "a")), job(coarsest=0.5, water={"depth": 2}))
    assert shallow["shortest_wave"] < 2 * np.pi * 9.80665 / 0.5**2


def test_a_hole_is_found_and_counted() -> None:
    whole = box(4, 2, 1, 0.5)
    away = np.ones(whole.count, bool)
    away[np.argmin(np.linalg.norm(whole.centres - [0.25, 0.25, -1.0], axis=1))] = False
    _, found, raised = looked(whole.chosen(away))
    assert (found["open_edges"], found["closed"]) == (4, False)
    assert raised["watertight"].value == 4
    assert "volume" in raised
    assert raised["volume"].value == pytest.approx(0.25 / 8, rel=0.1)


def test_a_panel_beside_two_smaller_ones_is_no_hole() -> None:
    def tile(x0: float, x1: float, y0: float, y1: float) -> Panels:
        corners = np.array([[x0, y0, -1], [x0, y1, -1], [x1, y1, -1], [x1, y0, -1]], float)
        return Panels(corners, np.array([[0, 1, 2, 3]]))

    tiles = welded(joined([tile(0, 2, 0, 1), tile(0, 1, 1, 2), tile(1, 2, 1, 2)]))
    assert edges_of(tiles).open == 3 + 4  # the rim alone: the long edge meets the two short ones


def test_inward_normals_are_turned_and_said() -> None:
    hull, found, raised = looked(box().flipped())
    assert hull.turned
    assert hull.panels.volume == pytest.approx(8.0)
    assert not found["normals_outward"]
    assert "were turned" in raised["normals"].message


def test_neighbours_that_disagree_are_found() -> None:
    mesh = box()
    faces = mesh.faces.copy()
    faces[3] = faces[3][::-1]
    _, found, raised = looked(Panels(mesh.vertices, faces))
    assert found["turned_edges"] == 4
    assert raised["normals"].value == 4


def test_doubles_slivers_and_panels_without_area() -> None:
    mesh = box()
    double = Panels(mesh.vertices, np.concatenate([mesh.faces, mesh.faces[:2]]))
    _, found, raised = looked(double)
    assert found["duplicate_panels"] == 2
    assert found["panels"] == mesh.count
    assert raised["duplicates"].value == 2
    thin = box(4, 2, 1, 0.5)
    squeezed = thin.vertices.copy()
    squeezed[:, 0] = np.where(np.isclose(squeezed[:, 0], 0.5), 1e-4, squeezed[:, 0])
    _, found, raised = looked(Panels(squeezed, thin.faces))
    assert raised["aspect ratio"].value == pytest.approx(0.5 / 1e-4, rel=1e-3)
    assert raised["area"].value < 1e-3


def test_mass_is_held_against_displacement() -> None:
    body = {"centre_of_gravity": [0, 0, 0], "mass": 9000, "radii_of_gyration": [1, 1, 1]}
    doubt = looked(box(), body=body)[2]["displacement"]
    assert doubt.value == pytest.approx(9000 / 8200 - 1)
    assert "9.8 %" in doubt.message


def test_a_mesh_is_scaled_moved_and_cut() -> None:
    tall = Panels(box(4, 2, 3).vertices * 1000, box(4, 2, 3).faces)  # millimetres, keel at -3000
    asked = job(geometry={"mesh": "a", "scale": 0.001, "move": [0, 0, 1.0]})
    hull = prepare(asked, lambda _: (as_gdf(tall), "a.gdf"))
    assert hull.panels.volume == pytest.approx(4 * 2 * 2)
    assert hull.draught == pytest.approx(2.0)


def test_a_preview_is_bounded_and_whole_when_it_can_be() -> None:
    hull = prepare(job(), lambda _: (as_gdf(hemisphere(8)), "a"))
    shown = preview(hull)
    assert (shown["panels"], shown["shown"], len(shown["faces"])) == (256, 256, 256)
    assert max(map(max, shown["faces"])) == len(shown["vertices"]) - 1
    few = preview(hull, most=100)
    assert (few["panels"], few["shown"]) == (256, 100)


def test_a_mesh_that_encloses_nothing_is_refused() -> None:
    bottom = box().chosen(np.isclose(box().normals[:, 2], -1))
    with pytest.raises(DataError, match="encloses"):
        looked(bottom)
