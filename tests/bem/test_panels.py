"""Measures of meshes against closed forms; cutting, welding, mirroring, symmetry, lids."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solver.bem.lid import contains, lid_panels
from solver.bem.panels import Panels, below_water, component_areas, joined, sharp_edged, welded
from solver.bem.quality import edges_of
from solver.bem.symmetry import MIRROR, Fundamental, fundamental, symmetry_planes

from .shapes import box, hemisphere


def shifted(mesh: Panels, by: tuple[float, float, float]) -> Panels:
    return Panels(mesh.vertices + np.array(by), mesh.faces)


def test_a_box_measures_what_it_is() -> None:
    mesh = box(4.0, 2.0, 1.0)
    assert mesh.volumes == pytest.approx([8.0, 8.0, 8.0], rel=1e-12)
    assert mesh.areas.sum() == pytest.approx(8.0 + 2 * (4.0 + 2.0))
    assert mesh.centre_of_buoyancy == pytest.approx([0.0, 0.0, -0.5], abs=1e-12)
    area, first, second = mesh.water_plane()
    assert area == pytest.approx(8.0)
    assert first == pytest.approx([0.0, 0.0], abs=1e-12)
    assert second == pytest.approx([2 * 4.0**3 / 12, 4 * 2.0**3 / 12, 0.0], abs=1e-12)


def test_moments_of_a_box_beside_the_axis() -> None:
    mesh = shifted(box(4.0, 2.0, 1.0), (3.0, -2.0, 0.0))
    assert mesh.centre_of_buoyancy == pytest.approx([3.0, -2.0, -0.5], abs=1e-12)
    area, first, second = mesh.water_plane()
    assert first / area == pytest.approx([3.0, -2.0])
    assert second / area == pytest.approx([9.0 + 16 / 12, 4.0 + 4 / 12, -6.0])


def test_a_hemisphere_tends_to_the_true_one() -> None:
    errors = []
    for n in (4, 8, 16):
        mesh = hemisphere(n)
        errors.append(abs(mesh.areas.sum() - 2 * math.pi))
        assert mesh.volume == pytest.approx(2 * math.pi / 3, rel=1e-9)
    order = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert order == pytest.approx(2.0, abs=0.3)
    assert hemisphere(16).centre_of_buoyancy == pytest.approx([0.0, 0.0, -3 / 8], abs=2e-3)


def test_what_lies_above_the_water_is_cut_off() -> None:
    tall = box(4.0, 2.0, 3.0, size=0.7)
    below, flat = below_water(shifted(tall, (0.0, 0.0, 1.3)))
    assert flat == 0
    assert below.volumes == pytest.approx([4 * 2 * 1.7] * 3, rel=1e-9)
    assert edges_of(below).open == 0
    tilted = tall.vertices @ np.array([[1, 0, 0.3], [0, 1, 0.2], [0, 0, 1.0]])
    below, _ = below_water(Panels(tilted + np.array([0, 0, 1.3]), tall.faces))  # a shear keeps areas of horizontal cuts
    assert np.ptp(below.volumes) < 1e-9 * below.volume
    assert edges_of(below).open == 0


def test_panels_in_the_still_water_are_left_out() -> None:
    hull = box()
    lid = lid_panels(edges_of(hull).water_line, 0.5, ())
    assert lid is not None
    below, flat = below_water(joined([hull, lid]))
    assert (flat, below.count) == (lid.count, hull.count)


def test_welding_makes_triangles_of_collapsed_quadrangles() -> None:
    points = np.array([[0, 0, -1], [1, 0, -1], [1, 1, -1], [0, 1, -1], [0, 1, -1.0]]) + 0.0
    mesh = welded(Panels(points, np.array([[0, 1, 2, 3], [0, 2, 3, 4], [3, 4, 4, 3]])))
    assert mesh.vertices.shape == (4, 3)
    assert mesh.triangles.tolist() == [False, True]


def test_mirroring_twice_changes_nothing_and_once_keeps_normals_outward() -> None:
    mesh = hemisphere(4)
    assert mesh.mirrored(0).volume == pytest.approx(mesh.volume)
    again = mesh.mirrored(1).mirrored(1)
    assert again.normals == pytest.approx(mesh.normals)
    assert mesh.flipped().volume == pytest.approx(-mesh.volume)


@pytest.mark.parametrize(
    ("move", "planes"),
    [((0, 0, 0), ("x", "y")), ((0.3, 0, 0), ("y",)), ((0, 0.3, 0), ("x",)), ((0.2, 0.3, 0), ())],
)
def test_symmetry_is_found_where_it_is(move: tuple[float, float, float], planes: tuple[str, ...]) -> None:
    mesh = shifted(box(), move)
    assert symmetry_planes(mesh) == planes
    part = fundamental(mesh, planes)
    assert part.part.count * 2 ** len(planes) == mesh.count
    whole = part.whole()
    assert whole.volume == pytest.approx(mesh.volume)
    assert sorted(map(tuple, np.round(whole.centres, 9))) == sorted(map(tuple, np.round(mesh.centres, 9)))


def test_a_plane_that_panels_straddle_is_not_used() -> None:
    mesh = box(3.0, 2.0, 1.0, size=1.0)
    odd = Panels(mesh.vertices, mesh.faces)  # panels from -1.5 … 1.5 in four steps: none straddles
    assert fundamental(odd, ("x",)).planes == ("x",)
    three = [Panels(np.array([[x, -1, 0], [x, 1, 0], [x + 1, 1, 0], [x + 1, -1, 0.0]]) - [0, 0, 1], np.arange(4)[None])
             for x in (-1.5, -0.5, 0.5)]  # fmt: skip
    strip = joined(three)
    assert symmetry_planes(strip) == ("x", "y")
    assert fundamental(strip, ("x", "y")).planes == ()


def test_mirrors_of_forces_are_their_own_inverse_and_keep_work() -> None:
    for sign in MIRROR.values():
        assert sign * sign == pytest.approx(np.ones(6))
    assert MIRROR["x"] * MIRROR["y"] == pytest.approx([-1, -1, 1, -1, -1, 1])  # half a turn


@pytest.mark.parametrize("planes", [(), ("y",), ("x", "y")])
def test_a_lid_fills_the_water_plane(planes: tuple[str, ...]) -> None:
    for mesh in (box(4.0, 2.0, 1.0, size=0.3), hemisphere(8)):
        part = lid_panels(edges_of(mesh).water_line, 0.37, planes)
        assert part is not None
        lid = Fundamental(part, planes).whole()
        assert lid.areas.sum() == pytest.approx(mesh.water_plane()[0], rel=1e-6)
        assert lid.normals[:, 2] == pytest.approx(-np.ones(lid.count))
        assert np.abs(lid.vertices[:, 2]).max() == 0.0


def test_a_lid_on_two_columns_has_two_pieces() -> None:
    pair = joined([shifted(hemisphere(6), (0, y, 0)) for y in (-3.0, 3.0)])
    part = lid_panels(edges_of(welded(pair)).water_line, 0.4, ("x", "y"))
    assert part is not None
    areas = component_areas(welded(Fundamental(part, ("x", "y")).whole()))
    assert sorted(areas) == pytest.approx([pair.water_plane()[0] / 2] * 2, rel=1e-6)


def test_points_inside_a_ring_are_told_from_those_in_its_hole() -> None:
    turn = np.linspace(0, 2 * math.pi, 40)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    loops = [np.stack([r * circle[:-1], r * circle[1:]], axis=1) for r in (1.0, 2.0)]
    points = np.array([[0.0, 0.1], [1.5, 0.0], [0.0, -1.5], [2.5, 0.1], [0.9, 0.9]])
    assert contains(np.concatenate(loops), points).tolist() == [False, True, True, False, True]


def test_sharp_edges_are_told_from_curvature() -> None:
    assert not sharp_edged(hemisphere(6), math.radians(40)).any()
    mesh = box(4.0, 2.0, 1.0, size=0.25)
    found = sharp_edged(mesh, math.radians(40))
    beside = (np.abs(np.abs(mesh.centres) - [2.0, 1.0, 1.0]) < 0.13) & (np.abs(mesh.centres) < [2.0, 1.0, 1.0])
    assert found.tolist() == beside.any(axis=1).tolist()
