"""What a job may ask for: defaults, units, ranges, and faults that name the field."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from solver.bem import load_job, parse_job
from solver.outcome import CaseError

BARGE: dict[str, Any] = {
    "name": "barge",
    "geometry": {"hull": {"kind": "barge", "length": "240 m", "breadth": 46, "draft": 10}, "panel_size": 4},
    "body": {"centre_of_gravity": [0, 0, 5], "radii_of_gyration": [26, 60, 60]},
    "frequencies": {"from": 0.1, "to": 0.5, "step": 0.1},
}


def test_ranges_lists_and_units() -> None:
    job = parse_job(BARGE)
    assert job.omega() == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5])
    assert np.degrees(job.beta()) == pytest.approx(np.arange(0, 360, 15))
    listed = parse_job({**BARGE, "frequencies": ["0.1 Hz", 1.0], "headings": ["-90 deg", "0 deg", "360 deg"]})
    assert listed.omega() == pytest.approx([0.2 * math.pi, 1.0])
    assert np.degrees(listed.beta()) == pytest.approx([0, 270])


def test_a_job_survives_its_own_text_and_has_one_hash() -> None:
    job = parse_job(BARGE)
    assert parse_job(json.loads(job.canonical())) == job
    assert parse_job({**BARGE, "name": "barge"}).content_hash() == job.content_hash()
    assert job.content_hash("a mesh") != job.content_hash()


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"frequencies": None}, "frequencies", "required"),
        ({"body": None}, "body", "required"),
        ({"body": {"centre_of_gravity": [0, 0, 5]}}, "body.radii_of_gyration", "mean_drift: fixed"),
        ({"frequencies": [0.3, 0.2]}, "frequencies", "rise"),
        ({"frequencies": {"from": 0.1, "to": 9, "step": 0.001}}, "frequencies", "500"),
        ({"frequencies": {"from": 0.5, "to": 0.1, "step": 0.1}}, "frequencies", "below"),
        ({"frequencies": [0.0, 0.1]}, "frequencies.0", "> 0"),
        ({"headings": [30]}, "headings.0", "30 deg"),
        ({"headings": {"to": "500 deg", "step": "10 deg"}}, "headings", "360"),
        ({"geometry": {}}, "geometry", "exactly one"),
        ({"geometry": {**BARGE["geometry"], "mesh": "a"}}, "geometry", "exactly one"),
        ({"geometry": {"mesh": "a", "panel_size": 3}}, "geometry", "panel_size belongs to hull"),
        ({"water": {"depth": 10}}, "water.depth", "draft of 10 m"),
        ({"water": {"density": -1}}, "water.density", "-1"),
        ({"name": "../etc"}, "name", "pattern"),
        ({"mean_drift": "some"}, "mean_drift", "free"),
        ({"colour": "red"}, "colour", "not known"),
        ({"geometry": {"hull": {**BARGE["geometry"]["hull"], "length": "240 parsec"}}}, "geometry.hull.length", "parsec"),
    ],
)  # fmt: skip
def test_a_fault_names_its_field(change: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(CaseError) as caught:
        parse_job({**BARGE, **change})
    assert field in [error.field for error in caught.value.errors]
    assert words in str(caught.value)


def test_text_gives_lines() -> None:
    with pytest.raises(CaseError) as caught:
        load_job("name: a\ngeometry:\n  hull:\n    kind: barge\n    length: -3\n    breadth: 1\n    draft: 1\n")
    lines = {error.field: error.line for error in caught.value.errors}
    assert lines["geometry.hull.length"] == 5


def test_a_preview_needs_the_geometry_only() -> None:
    job = parse_job({"geometry": BARGE["geometry"], "coarsest": 1.2}, compute=False)
    assert (job.highest(), job.omega().size) == (1.2, 0)
    assert parse_job(BARGE).highest() == pytest.approx(0.5)
