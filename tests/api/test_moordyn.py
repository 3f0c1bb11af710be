"""MoorDyn decks over REST: a deck becomes a case's text that can be saved; a saved case becomes a deck."""

from __future__ import annotations

import json

from fastapi.testclient import TestClient

from store.database import Database
from store.models import Run
from tests.io.decks import DECK, VESSEL


def _import(client: TestClient, deck: str = DECK, **more: str) -> dict[str, object]:
    response = client.post("/api/v1/imports/moordyn", json={"deck": deck, **more})
    assert response.status_code == 200, response.text
    return dict(response.json())


def test_a_deck_with_a_vessel_can_be_saved_and_written_again(client: TestClient) -> None:
    found = _import(client, case=VESSEL, name="semi")
    assert (found["complete"], found["name"], found["errors"]) == (True, "semi", [])
    saved = client.post("/api/v1/cases", content=found["yaml"], headers={"Content-Type": "application/yaml"})
    assert saved.status_code == 201, saved.text
    again = client.post("/api/v1/cases", json=found["case"])
    assert again.status_code == 200, "the object and the text are one case"
    deck = client.get(f"/api/v1/cases/{saved.json()['id']}/moordyn")
    assert deck.headers["content-type"].startswith("text/plain")
    assert "attachment" in deck.headers["content-disposition"]
    assert _import(client, deck.text, case=VESSEL, name="semi")["case"]["line_types"] == found["case"]["line_types"]


def test_plain_text_is_a_deck_and_a_template_names_its_fields(client: TestClient) -> None:
    response = client.post("/api/v1/imports/moordyn", content=DECK, headers={"Content-Type": "text/plain"})
    assert response.status_code == 200
    found = response.json()
    assert found["complete"] is False
    assert found["case"] is None
    assert "vessel.mass" in {fault["field"] for fault in found["errors"]}
    assert found["report"]["missing"]
    checked = client.post("/api/v1/cases/check", content=found["yaml"], headers={"Content-Type": "application/yaml"})
    assert checked.status_code == 422
    data = {"vessel.hydrodynamics.data"}  # only the service knows that there is no such data set
    assert {fault["field"] for fault in checked.json()["errors"]} == {
        fault["field"] for fault in found["errors"]
    } | data
    assert all(fault["line"] for fault in checked.json()["errors"])


def test_faults_of_a_deck_have_its_lines(client: TestClient) -> None:
    bad = DECK.replace("2 main 2 3", "2 main 2 9")
    response = client.post("/api/v1/imports/moordyn", json={"deck": bad})
    assert response.status_code == 422
    assert response.headers["content-type"].startswith("application/problem+json")
    (fault,) = response.json()["errors"]
    assert bad.splitlines()[fault["line"] - 1].startswith("2 main 2 9")
    for body in ({}, {"deck": DECK, "colour": "red"}, {"deck": 3}, {"deck": DECK, "case": "vessel: 3"}):
        assert client.post("/api/v1/imports/moordyn", json=body).status_code == 422, body
    large = client.post("/api/v1/imports/moordyn", content=b"x" * 1_500_000, headers={"Content-Type": "text/plain"})
    assert large.status_code == 422


def test_letters_that_are_none_are_refused_or_cleaned(client: TestClient) -> None:
    for body in (
        '{"deck": "\\ud800"}',
        '{"deck": "------ LINES ------\\n\\ud800"}',
        '{"deck": "x", "case": "name: \\udfff"}',
        '{"deck": "x", "name": "\\ud800"}',
    ):
        answer = client.post("/api/v1/imports/moordyn", content=body, headers={"Content-Type": "application/json"})
        assert answer.status_code == 422, body
    deck = json.dumps(DECK.replace("1 Vessel", "1 Fixed"))
    named = '{"deck": %s, "name": "a\\u001b b"}' % deck  # noqa: UP031
    answer = client.post("/api/v1/imports/moordyn", content=named, headers={"Content-Type": "application/json"})
    assert answer.status_code == 200, answer.text
    assert answer.json()["name"] == "a? b"
    assert client.get("/api/v1/cases/none/moordyn", params={"run": "no run!"}).status_code == 422


def test_pretensions_take_a_run_that_has_statics(client: TestClient, database: Database, fpso: str) -> None:
    case = fpso.replace("hydrodynamics:", "#").replace(
        "  trim:", "  hydrostatics: {stiffness: " + str(_stiffness()) + "}\n  trim:"
    )
    start = case[case.index("slowdrift: 1") :].partition("analyses:")[0] + "analyses: {statics: {}}\n"
    start = start.replace("  seastates:", "  #").replace("    - {spectrum", "    # - {spectrum")
    saved = client.post("/api/v1/cases", content=start, headers={"Content-Type": "application/yaml"})
    assert saved.status_code == 201, saved.text
    address = f"/api/v1/cases/{saved.json()['id']}/moordyn"
    refused = client.get(address)
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"].endswith("end_a.anchor.pretension")
    run = client.post("/api/v1/runs", json={"case_id": saved.json()["id"]}).json()["id"]
    assert client.get(address, params={"run": run}).status_code == 409
    line = {"end_a": {"position": [2000.0, 0.0, -2000.0]}, "end_b": {"position": [80.0, 0.0, -10.0]}, "length": 3300.0}
    names = ("bow-port", "stern-port", "stern-starboard", "bow-starboard")
    with database.write() as session:
        row = session.get(Run, run)
        assert row is not None
        row.summary = json.dumps({"statics": {"lines": dict.fromkeys(names, line)}})
    deck = client.get(address, params={"run": run})
    assert deck.status_code == 200, deck.text
    assert "Fixed 2000 0 -2000" in deck.text
    assert client.get(address, params={"run": "nobody"}).status_code == 404


def _stiffness() -> list[list[float]]:
    diagonal = (0.0, 0.0, 1e8, 1e10, 1e11, 0.0)
    return [[value if i == j else 0.0 for j in range(6)] for i, value in enumerate(diagonal)]
