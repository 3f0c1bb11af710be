"""Pages of hydrodynamic data: what the service says becomes facts, doubts and curves."""

from __future__ import annotations

import json
from typing import Any

import flask
import numpy as np
import plotly.utils
import pytest

from frontend.figures import hydrodynamics as figures
from frontend.pages import data, data_set

OMEGA = [0.2, 0.6, 1.0]
ITEM = {
    "id": "d1", "name": "hull", "version": 2, "size": 1_500_000, "content_hash": "ab" * 32,
    "created_at": "2026-01-01T10:00:00Z",
    "summary": {
        "frequencies": {"count": 3, "from": 0.2, "to": 1.0}, "has_zero_frequency": True, "headings_deg": [0.0, 90.0],
        "mean_drift": True, "qtf": None, "density": 1025.0, "gravity": 9.81, "depth": None, "warnings": ["one"],
        "provenance": {"format": "WAMIT", "assumed": ["first column: periods"]},
    },
    "checks": [
        {"name": "spikes", "state": "ok", "value": 0.01, "threshold": 0.05, "message": "fine"},
        {"name": "reciprocity", "state": "warning", "value": 0.03, "threshold": 0.02, "message": "refine the mesh"},
    ],
}  # fmt: skip


def text_of(component: Any) -> str:
    return json.dumps(component, cls=plotly.utils.PlotlyJSONEncoder, ensure_ascii=False)


def series(quantity: str, pairs: list[tuple[int, int]]) -> dict[str, Any]:
    made = [{"i": i, "j": j, "values": [1e9 * (1 + i), 2e9, 3e9 + 1e8 * j]} for i, j in pairs]
    return {"quantity": quantity, "unit": "kg, kg m, kg m2", "omega": OMEGA, "series": made}


def test_diagonal_and_row_of_coefficients() -> None:
    found = series("added_mass", [(i, j) for i in range(6) for j in range(6)])
    made = figures.coefficients(found, "diagonal", rotation=True)
    assert made is not None
    assert [trace["name"] for trace in made["data"]] == ["roll", "pitch", "yaw"]
    assert made["layout"]["yaxis"]["title"]["text"] == "A [10⁹ kg m2]"
    np.testing.assert_allclose(made["data"][0]["y"], [4.0, 2.0, 3.3])
    row = figures.coefficients(found, "surge", rotation=True)
    assert row is not None
    assert [trace["name"] for trace in row["data"]] == ["surge, roll", "surge, pitch", "surge, yaw"]
    assert row["layout"]["yaxis"]["title"]["text"] == "A [10⁹ kg m]"


def test_excitation_is_the_size_of_the_complex_load() -> None:
    one = {"i": 2, "heading_deg": 0.0, "values": [3.0, 0.0, 1.0], "imaginary": [4.0, 2.0, 0.0]}
    made = figures.excitation({"unit": "N/m, N m/m, N m/m", "omega": OMEGA, "series": [one]}, rotation=False)
    np.testing.assert_allclose(made["data"][0]["y"], [5.0, 2.0, 1.0])


def test_a_pair_that_was_not_computed_is_a_gap() -> None:
    one = {"i": 0, "values": [[1.0, None], [None, 3.0]], "imaginary": [[0.0, None], [None, 4.0]]}
    made = figures.qtf({"unit": "N/m2", "omega": OMEGA[:2], "series": [one]})
    assert made is not None
    z = made["data"][0]["z"]
    assert np.isnan(z[0, 1])
    assert z[1, 1] == pytest.approx(5.0)
    assert figures.qtf({"unit": "N/m2", "omega": [], "series": []}) is None


def test_doubts_come_first_with_their_remedy(request_context: flask.Flask) -> None:
    drawn = text_of(data_set.checked(ITEM))
    assert drawn.index("reciprocity") < drawn.index("spikes")
    assert "refine the mesh" in drawn
    assert "doubtful" in drawn


def test_facts_and_list(request_context: flask.Flask) -> None:
    drawn = text_of(data_set.described(ITEM))
    for words in (
        "3 from 0.200 to 1.00 rad/s, with zero frequency",
        "infinitely deep",
        "first column: periods",
        "1.50 MB",
    ):
        assert words in drawn
    listed = text_of(data.listed([ITEM]))
    assert "hull, version 2" in listed
    assert "mean drift" in listed
    assert "No hydrodynamic data yet" in text_of(data.listed([]))


def test_a_refused_upload_names_its_field(request_context: flask.Flask) -> None:
    problem = {
        "title": "Not read",
        "detail": "2 faults",
        "errors": [{"field": "length", "message": "is asked for", "line": 3}],
    }
    drawn = text_of(data.told({"problem": problem}))
    assert "Not read" in drawn
    assert "length" in drawn
    assert "is asked for" in drawn
    assert "is stored" in text_of(data.told({"id": "x", "name": "hull", "version": 1}))
