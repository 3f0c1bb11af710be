"""Hulls of given dimensions: closed, outward, of the right volume; faults name the field."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from solver.bem import parse_job, prepare
from solver.bem.geometry import Hull
from solver.bem.quality import edges_of
from solver.outcome import CaseError


def made(hull: dict[str, Any], size: float | None = None) -> Hull:
    geometry = {"hull": hull} | ({} if size is None else {"panel_size": size})

    def no_file(reference: str) -> tuple[bytes, str]:
        raise AssertionError(reference)

    return prepare(parse_job({"geometry": geometry}, compute=False), no_file)


def column(x: float, y: float) -> dict[str, Any]:
    steps = ((0, 12), (14, 12), (14, 16), (20, 16))
    return {"position": [x, y], "profile": [{"depth": depth, "diameter": d} for depth, d in steps]}


def plain(x: float, y: float, diameter: float) -> dict[str, Any]:
    return {"position": [x, y], "profile": [{"depth": 0, "diameter": diameter}, {"depth": 20, "diameter": diameter}]}


def spar(*stations: tuple[float, float]) -> dict[str, Any]:
    return {"kind": "spar", "profile": [{"depth": depth, "diameter": diameter} for depth, diameter in stations]}


BARGE = {"kind": "barge", "length": 240, "breadth": 46, "draft": 10}
SHIP = {"kind": "ship", "length": 300, "breadth": 50, "draft": 20, "bow": 60, "stern": 40, "bilge_radius": 3}
SPAR = {
    "kind": "spar",
    "profile": [{"depth": d, "diameter": w} for d, w in ((0, 6.5), (4, 6.5), (12, 9.4), (120, 9.4))],
}
SEMI = {
    "kind": "semisubmersible",
    "columns": [column(x, y) for x in (-30, 30) for y in (-30, 30)],
    "pontoons": [{"between": b, "width": 10, "top": 15, "bottom": 19} for b in ([0, 1], [2, 3], [0, 2], [1, 3])],
}
TRIANGLE: dict[str, Any] = {
    "kind": "semisubmersible",
    "columns": [plain(50 * math.cos(t), 50 * math.sin(t), 12) for t in (math.pi, math.pi / 3, -math.pi / 3)]
    + [plain(0, 0, 11)],
    "pontoons": [{"between": [3, i], "width": 7, "top": 13, "bottom": 20} for i in range(3)],
}  # fmt: skip


def with_pontoon(**change: Any) -> dict[str, Any]:
    return {**SEMI, "pontoons": [{"between": [0, 1], "width": 8, "top": 15, "bottom": 19} | change]}


@pytest.mark.parametrize("hull", [BARGE, SHIP, SPAR, SEMI, TRIANGLE], ids=["barge", "ship", "spar", "semi", "triangle"])
@pytest.mark.parametrize("scale", [1.0, 0.6])
def test_every_hull_is_closed_and_looks_outward(hull: dict[str, Any], scale: float) -> None:
    usual = made(hull)
    found = usual if scale == 1.0 else made(hull, scale * (usual.panel_size or 0))
    edges = edges_of(found.panels)
    assert (edges.open, edges.turned) == (0, 0)
    assert found.panels.volumes == pytest.approx([found.panels.volume] * 3, rel=1e-9)
    assert found.panels.volume > 0
    assert found.panels.edge_lengths.max() <= 1.6 * (found.panel_size or 0)
    if scale == 1.0:
        assert 700 < found.panels.count < 1300  # "about 1000"


@pytest.mark.parametrize(
    ("hull", "planes"),
    [(BARGE, ("x", "y")), (SHIP, ("y",)), (SPAR, ("x", "y")), (SEMI, ("x", "y")), (TRIANGLE, ("y",))],
)
def test_symmetry_of_a_hull_is_kept_by_its_panels(hull: dict[str, Any], planes: tuple[str, ...]) -> None:
    assert made(hull).symmetry == planes


def test_volume_of_a_barge_is_exact() -> None:
    assert made(BARGE).panels.volume == pytest.approx(240 * 46 * 10, rel=1e-12)


def test_volume_of_a_ship_follows_its_waterlines() -> None:
    plain = {**SHIP, "bilge_radius": 0}
    waterplane = 50 * (300 - 60 / 3 - 40 / 3)  # the area outside a parabola is a third of its box
    found = made(plain, 3.0).panels
    assert found.water_plane()[0] == pytest.approx(waterplane, rel=3e-3)
    assert found.volume == pytest.approx(20 * waterplane, rel=3e-3)
    # a bilge of three chords takes (1 - 3/2 sin 30°) r² on each side; the mean of (1 - s²)² at the ends is 8/15
    lost = 2 * (1 - 1.5 * math.sin(math.pi / 6)) * 3**2 * (200 + (60 + 40) * 8 / 15)
    assert found.volume - made(SHIP, 3.0).panels.volume == pytest.approx(lost, rel=5e-3)


def test_volume_of_a_spar_is_the_published_one() -> None:
    """OC3 Hywind: 8029.21 m3 (Jonkman, NREL/TP-500-47535, 2010)."""
    assert made(SPAR, 1.5).panels.volume == pytest.approx(8029.21, rel=1e-4)


def test_volume_of_a_semisubmersible_is_that_of_its_parts() -> None:
    columns = 4 * math.pi / 4 * (12**2 * 14 + 16**2 * 6)
    half = 5.0
    inside = 2 * (half * math.sqrt(8**2 - half**2) + 8**2 * math.asin(half / 8)) / 2  # of a pontoon in half a column
    pontoons = 4 * 4 * (10 * 60 - 2 * inside)
    assert made(SEMI, 2.0).panels.volume == pytest.approx(columns + pontoons, rel=3e-3)


def test_panels_of_round_columns_keep_area_and_volume_at_any_size() -> None:
    for size in (6.0, 3.0):
        round_one = made(spar((0, 12), (20, 12)), size).panels
        assert round_one.volume == pytest.approx(math.pi * 36 * 20, rel=1e-9)
        assert round_one.water_plane()[0] == pytest.approx(math.pi * 36, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"kind": "barge", "length": -1, "breadth": 2, "draft": 1}, "geometry.hull.length", "-1"),
        ({"kind": "barge", "length": 4, "breadth": 2}, "geometry.hull.draft", "required"),
        ({**SHIP, "bow": 280}, "geometry.hull", "longer than the ship"),
        ({**SHIP, "bilge_radius": 30}, "geometry.hull", "at most 20 m"),
        (spar((1, 4), (9, 4)), "geometry.hull", "0 m"),
        (spar((0, 4), (-2, 4)), "geometry.hull.profile.1.depth", "-2"),
        (with_pontoon(between=[0, 9]), "geometry.hull", "0 to 3"),
        (with_pontoon(width=15.9), "geometry.hull", "15.2"),
        (with_pontoon(top=12), "geometry.hull", "constant diameter"),
        ({**SEMI, "columns": [column(0, 0), column(5, 0)], "pontoons": []}, "geometry.hull", "5 m apart"),
        ({"kind": "canoe"}, "geometry.hull", "barge"),
    ],
)  # fmt: skip
def test_a_fault_names_its_field_and_the_allowed_range(change: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(CaseError) as caught:
        made(change)
    assert field in [error.field for error in caught.value.errors]
    assert words in str(caught.value)


def test_pontoons_that_meet_at_a_column_are_refused() -> None:
    wide = {**TRIANGLE, "pontoons": [{**p, "width": 10} for p in TRIANGLE["pontoons"]]}
    with pytest.raises(CaseError, match="two pontoons meet") as caught:
        made(wide)
    assert caught.value.errors[0].field == "geometry.hull.pontoons"


def test_too_small_panels_are_refused_before_they_are_made() -> None:
    with pytest.raises(CaseError, match="larger panel_size"):
        made(BARGE, 0.01)


def test_a_step_in_the_profile_has_a_ring() -> None:
    stepped = {
        "kind": "spar",
        "profile": [{"depth": d, "diameter": w} for d, w in ((0, 10), (5, 10), (5, 20), (6, 20))],
    }
    found = made(stepped, 1.0).panels
    assert found.volume == pytest.approx(math.pi * (25 * 5 + 100 * 1), rel=1e-9)
    ring = (np.abs(found.centres[:, 2] + 5) < 1e-9) & (found.normals[:, 2] > 0.99)
    assert found.areas[ring].sum() == pytest.approx(math.pi * (100 - 25), rel=1e-2)
