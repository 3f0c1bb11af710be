"""A whole job: its estimate, its file read back, checkpoints, cancelling, refusals."""

from __future__ import annotations

import io
import json
import math
from typing import Any

import numpy as np
import pytest

from solver.bem import HydrodynamicJob, parse_job, prepare
from solver.bem.geometry import Hull
from solver.bem.job import BASE_MB, check, compute, estimate, wet
from solver.outcome import Cancelled, CaseError
from solver.results.part import Progress
from solver.vessel.data import read_bytes

from .shapes import as_gdf, box, need_capytaine

SMALL: dict[str, Any] = {
    "name": "small barge",
    "geometry": {"hull": {"kind": "barge", "length": 80, "breadth": 24, "draft": 8}, "panel_size": 8},
    "water": {"density": 1000, "gravity": 9.81},
    "body": {"centre_of_gravity": [0, 0, 2], "radii_of_gyration": [8, 22, 23], "damping": {"roll": 1e8}},
    "frequencies": [0.5, 0.8],
    "headings": ["0 deg", "30 deg", "150 deg", "210 deg", "330 deg"],
}


def ready(change: dict[str, Any] | None = None) -> tuple[HydrodynamicJob, Hull]:
    job = parse_job(SMALL | (change or {}))
    return job, prepare(job, lambda _: (as_gdf(box(80, 24, 8, 8)), "hull.gdf"))


def test_estimate_counts_what_will_be_done() -> None:
    job, hull = ready()
    found = estimate(job, wet(job, hull))
    assert (found.panels, found.symmetry_planes) == (hull.panels.count, 2)
    assert found.solutions == 2 * (6 + 2) + 12  # five headings are two and their mirror images
    one_plane = ready({"geometry": {"mesh": "hull.gdf", "move": [1, 0, 0]}})
    more = estimate(one_plane[0], wet(*one_plane))
    assert more.symmetry_planes == 1
    assert more.memory_mb - BASE_MB > 2 * (found.memory_mb - BASE_MB)
    assert more.seconds > found.seconds > 0


@pytest.mark.parametrize(
    ("change", "memory", "field", "words"),
    [
        ({"geometry": {**SMALL["geometry"], "panel_size": 2}}, 410, "geometry", "allowed: 410 MB, about"),
        ({"water": {"depth": 20}, "frequencies": [0.01, 0.5]}, 3000, "frequencies", "at least 0.105 rad/s"),
        ({"geometry": {"mesh": "hull.gdf"}, "water": {"depth": 7}}, 3000, "water.depth", "draught of 8 m"),
    ],
)
def test_what_cannot_be_done_is_refused_with_the_remedy(change: Any, memory: float, field: str, words: str) -> None:
    job, hull = ready(change)
    with pytest.raises(CaseError) as caught:
        check(job, hull, wet(job, hull), memory)
    assert [error.field for error in caught.value.errors] == [field]
    assert words in str(caught.value)


def test_normals_that_disagree_are_refused() -> None:
    mesh = box(80, 24, 8, 8)
    mesh.faces[3] = mesh.faces[3][::-1]
    job = parse_job(SMALL | {"geometry": {"mesh": "a"}})
    hull = prepare(job, lambda _: (as_gdf(mesh), "a.gdf"))
    with pytest.raises(CaseError, match="disagree on which side is out"):
        check(job, hull, wet(job, hull), 3000)


@pytest.fixture(scope="module")
def made() -> Any:
    need_capytaine()
    return compute(*ready())


def test_the_file_is_read_like_any_of_capytaines(made: Any) -> None:
    data = read_bytes(made.payload, "small barge.nc")
    assert data.warnings == ()
    assert data.omega == pytest.approx([0.5, 0.8])
    assert np.degrees(data.headings) == pytest.approx([0, 30, 150, 210, 330])
    assert data.added_mass_zero is not None
    assert data.added_mass_infinite is not None
    assert (data.displaced_volume, data.density, data.gravity) == pytest.approx((80 * 24 * 8, 1000, 9.81))
    assert data.reference_point == pytest.approx([0, 0, 2])
    assert math.isinf(data.depth)
    stiffness = data.hydrostatic_stiffness
    assert stiffness is not None
    weight, volume = 1000 * 9.81, 80 * 24 * 8
    assert np.diag(stiffness) / weight == pytest.approx(
        [0, 0, 80 * 24, 80 * 24**3 / 12 + volume * (-4 - 2), 24 * 80**3 / 12 + volume * (-4 - 2), 0]
    )
    assert data.excitation_zero is not None
    assert data.excitation_zero[0] == pytest.approx(stiffness[:, 2])
    assert made.summary["energy"]["imbalance"] == pytest.approx([0.0, 0.0], abs=0.1)


def test_headings_that_mirror_one_another_do(made: Any) -> None:
    data = read_bytes(made.payload, "a.nc")
    port, aft = data.excitation[:, 4], data.excitation[:, 2]
    assert port == pytest.approx(data.excitation[:, 1] * [1, -1, 1, -1, 1, -1])
    assert aft == pytest.approx(data.excitation[:, 1] * [-1, 1, 1, 1, -1, -1])
    drift = data.mean_drift
    assert drift is not None
    assert drift[:, 3] == pytest.approx(drift[:, 1] * [-1, -1, 1, -1, -1, 1])
    assert np.all(drift[1, 0, [1, 5]] == pytest.approx([0, 0], abs=1e-6 * drift[1, 0, 0]))
    assert drift[1, 0, 0] > 0  # pushed along with the wave


def test_xarray_opens_it_with_capytaines_names(made: Any) -> None:
    xarray = pytest.importorskip("xarray")
    dataset = xarray.open_dataset(io.BytesIO(made.payload), engine="scipy")
    assert set(dataset.added_mass.dims) == {"omega", "influenced_dof", "radiating_dof"}
    assert parse_job(json.loads(dataset.attrs["job"])) == parse_job(SMALL)


def test_equal_jobs_make_equal_files_and_a_checkpoint_goes_on(made: Any) -> None:
    kept: list[bytes] = []
    seen: list[Progress] = []

    def stop_in_the_third(progress: Progress) -> None:
        seen.append(progress)
        if progress.message.startswith("3 of 4"):
            assert progress.checkpoint is not None
            kept.append(progress.checkpoint())
            raise Cancelled

    job, hull = ready()
    with pytest.raises(Cancelled):
        compute(job, hull, None, stop_in_the_third)
    fractions = [progress.fraction for progress in seen]
    assert fractions == sorted(fractions)
    assert "1 of 4, 0 rad/s" in seen[0].message
    rest: list[str] = []
    again = compute(job, hull, kept[0], lambda progress: rest.append(progress.message))
    assert again.payload == made.payload
    assert all(message.startswith(("3 of 4", "4 of 4")) for message in rest)


def test_finite_depth_says_what_zero_frequency_is(made: Any) -> None:
    finite = compute(
        *ready({"water": {"density": 1000, "gravity": 9.81, "depth": 60}, "frequencies": [0.5], "mean_drift": "none"})
    )
    assert any("zero frequency in finite depth" in warning for warning in finite.warnings)
    data, deep = read_bytes(finite.payload, "a.nc"), read_bytes(made.payload, "b.nc")
    assert (data.depth, data.mean_drift) == (60, None)
    assert data.added_mass_zero is not None
    assert deep.added_mass_zero is not None
    assert data.added_mass_zero[2, 2] > deep.added_mass_zero[2, 2]  # the bottom is near


def test_a_fixed_body_drifts_more_than_a_free_one_in_long_waves(made: Any) -> None:
    fixed = read_bytes(compute(*ready({"mean_drift": "fixed", "limits": False, "frequencies": [0.5]})).payload, "a.nc")
    free = read_bytes(made.payload, "b.nc")
    assert fixed.mean_drift is not None
    assert free.mean_drift is not None
    assert fixed.mean_drift[0, 0, 0] > 2 * abs(free.mean_drift[0, 0, 0])
    assert fixed.added_mass_infinite is None
    assert fixed.excitation == pytest.approx(free.excitation[:1])
