"""The catalogue over REST, and a bundle made when it had other numbers."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any, cast

import pytest
from fastapi.testclient import TestClient

from api.services.bundle_check import Archive, _case
from solver.case import load_case
from solver.outcome import CaseError

TEXT = """
slowdrift: 1
name: Catalogue
environment: {depth: 100 m}
line_types: {chain: {catalogue: chain-R4-studless, diameter: 120 mm}}
lines:
  leg:
    segments: [{type: chain, length: 100 m, elements: 10}]
    end_a: {pinned: [0, 0, -90]}
    end_b: {pinned: [60, 0, -20]}
analyses: {statics: {}}
"""


def test_the_list(client: TestClient) -> None:
    found = client.get("/api/v1/catalogue").json()
    assert {"chain-R4-studless", "wire", "polyester"} <= {item["name"] for item in found}
    assert next(item for item in found if item["name"] == "chain-R6-studless")["unverified"] == ["breaking_load", "EA"]


@pytest.mark.parametrize("diameter", ["0.12", "120 mm"])
def test_one_entry(client: TestClient, diameter: str) -> None:
    found = client.get("/api/v1/catalogue/chain-R4-studless", params={"diameter": diameter}).json()
    assert (found["diameter"], found["stiffness"]) == (0.12, "e301")
    assert found["values"]["EA"]["value"] == pytest.approx(1164.90e6, rel=1e-5)
    assert found["values"]["EA"]["status"] == "verified"
    assert found["weight_in_water"] == pytest.approx(9.80665 * 286.56 * (1 - 1025 / 7850))
    assert client.get("/api/v1/catalogue/wire").json()["values"] == {}


@pytest.mark.parametrize(
    ("address", "status", "field"),
    [
        ("chain-R7-studless?diameter=0.1", 404, None),
        ("wire?diameter=1", 422, "diameter"),
        ("wire?diameter=ten", 422, "diameter"),
        ("wire?diameter=0.1&stiffness=e301", 422, "stiffness"),
        ("wire?diameter=0.1&density=-1x", 422, "density"),
        ("wire?diameter=0.1&density=-1", 422, "density"),
    ],
)
def test_what_is_wrong_is_said(client: TestClient, address: str, status: int, field: str | None) -> None:
    answer = client.get(f"/api/v1/catalogue/{address}")
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    if field is not None:
        assert [error["field"] for error in answer.json()["errors"]] == [field]


def test_a_saved_case_says_what_was_taken_and_stays_as_it_was_typed(client: TestClient) -> None:
    saved = client.post("/api/v1/cases", content=TEXT, headers={"Content-Type": "application/yaml"})
    assert saved.status_code == 201, saved.text
    found = client.get(f"/api/v1/cases/{saved.json()['id']}").json()
    assert found["yaml"] == TEXT
    assert found["case"]["line_types"]["chain"]["catalogue_values"]["mass"] == pytest.approx(286.56)
    assert client.post("/api/v1/cases", json=found["case"]).json()["content_hash"] == saved.json()["content_hash"]


def archive(canonical: dict[str, Any], content_hash: str) -> Archive:
    """What `_case` reads of a bundle."""
    held = {"case.json": json.dumps(canonical).encode(), "case.yaml": TEXT.encode()}
    run = SimpleNamespace(analyses=["statics"], case_name="Catalogue", name="x", content_hash=content_hash)
    return cast(Archive, SimpleNamespace(manifest=SimpleNamespace(run=run), read=lambda name, _limit: held[name]))


def test_a_bundle_of_an_earlier_catalogue_is_taken_with_its_own_numbers() -> None:
    canonical = json.loads(load_case(TEXT).canonical())
    canonical["line_types"]["chain"]["catalogue_values"]["mass"] = 288.0
    stored = load_case(json.dumps(canonical))
    case = _case(archive(canonical, stored.content_hash()))
    assert case == stored
    assert case.line_types["chain"].mass == 288.0
    canonical["line_types"]["chain"]["EI"] = 5.0
    with pytest.raises(CaseError, match="are not the same"):
        _case(archive(canonical, load_case(json.dumps(canonical)).content_hash()))
