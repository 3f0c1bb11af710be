"""The pages from a hull to data: templates that the service takes, panels in space, a job's progress."""

from __future__ import annotations

import json
from typing import Any

import flask
import numpy as np
import plotly.utils
import pytest

from frontend.figures.mesh import mesh
from frontend.pages import hull, hull_job
from solver.bem.spec import load_job


def text_of(component: Any) -> str:
    return json.dumps(component, cls=plotly.utils.PlotlyJSONEncoder, ensure_ascii=False)


@pytest.mark.parametrize("kind", list(hull.SHAPES))
def test_every_template_is_a_valid_job(kind: str) -> None:
    spec = load_job(hull.template(kind))
    assert spec.name == kind


def test_mesh_draws_triangles_and_quadrilaterals_and_their_edges() -> None:
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, -1], [0, 1, -1], [2, 0, 0]]
    made = mesh({"vertices": vertices, "faces": [[0, 1, 2, 3], [1, 4, 2, 2]]})
    skin, wire, _ = made["data"]
    assert len(skin["i"]) == 4
    assert np.isnan(wire["x"][5])
    np.testing.assert_allclose(wire["x"][:5], [0, 1, 1, 0, 0])


def test_a_mesh_that_came_in_becomes_a_job(request_context: flask.Flask) -> None:
    quality = {"panels": 8, "volume": 1.0, "closed": True, "normals_outward": True, "symmetry": ["x"]}
    added = {"id": "m1", "name": "hull.gdf", "quality": quality, "warnings": [], "preview": None}
    text, message, _ = hull.uploaded(added)
    assert load_job(text).geometry.mesh == "m1"
    assert message is None
    _, message, _ = hull.uploaded(
        {"problem": {"title": "Not read", "errors": [{"field": "file", "message": "line 3"}]}}
    )
    assert "line 3" in text_of(message)


def test_facts_of_a_job(request_context: flask.Flask) -> None:
    job = {
        "created_at": "2026-01-01T10:00:00Z", "started_at": "2026-01-01T10:00:00Z", "finished_at": "2026-01-01T10:02:00Z",
        "estimate": {"panels": 1000, "lid_panels": 200, "memory_mb": 310.0, "solutions": 240},
    }  # fmt: skip
    rows = dict(hull_job.about(job))
    assert rows["Panels"] == "1000, lid 200"
    assert rows["Took"] == "2 min 00 s"
    assert "310" in rows["Memory, estimated"]
