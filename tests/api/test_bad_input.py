"""Every wrong case is answered at its field with 422, and leaves nothing behind: no row, no message."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from fastapi.testclient import TestClient
from sqlalchemy import func, select

from store.database import Database
from store.models import Case, CaseVersion, Run, Task
from store.settings import Settings
from tests.vessel import synthetic

BOMB = "a: &a [x,x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{new}: &{new} [{','.join([f'*{old}'] * 10)}]\n" for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)


def changed(text: str, path: str, value: Any) -> str:
    """The case with one value replaced (or added)."""
    case = yaml.safe_load(text)
    *way, last = path.split(".")
    at = case
    for key in way:
        at = at[int(key)] if isinstance(at, list) else at[key]
    at[last] = value
    return yaml.safe_dump(case)


RISER_FAULTS = [
    ("lines.riser.segments.0.length", "-170 m", "length"),
    ("lines.riser.segments.0.length", 10, "segments"),
    ("lines.riser.segments.0.length", float("nan"), "length"),
    ("environment.depth", float("inf"), "depth"),
    ("lines.riser.colour", "red", "lines.riser.colour"),
    ("environment.seastates", [{"spectrum": "jonswap", "hs": 5, "tp": 10, "direction": 30}], "direction"),
]


def assert_refused(answer: Any, field: str, message: str = "") -> None:
    assert answer.status_code == 422, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert {"type", "title", "status", "detail", "errors"} <= set(problem)
    assert any(field in error["field"] for error in problem["errors"]), problem
    assert message in answer.text
    assert "Traceback" not in answer.text


def assert_untouched(database: Database, settings: Settings) -> None:
    with database.read() as session:
        for model in (Case, CaseVersion, Run, Task):
            assert session.scalar(select(func.count()).select_from(model)) == 0
    assert not list((settings.data_dir / "broker" / "messages").iterdir())


def submit_everywhere(client: TestClient, text: str) -> list[Any]:
    kind = {"content-type": "application/yaml"}
    return [
        client.post("/api/v1/cases", content=text.encode(), headers=kind),
        client.post("/api/v1/cases/check", content=text.encode(), headers=kind),
        client.post("/api/v1/runs", json={"yaml": text}),
        client.post("/api/v1/preview", content=text.encode(), headers=kind),
    ]


@pytest.fixture
def untouched(database: Database, service_settings: Settings):  # type: ignore[no-untyped-def]
    yield
    assert_untouched(database, service_settings)


@pytest.mark.usefixtures("untouched")
@pytest.mark.parametrize(("path", "value", "field"), RISER_FAULTS)
def test_a_faulty_field_is_named(client: TestClient, riser: str, path: str, value: Any, field: str) -> None:
    name = next(iter(yaml.safe_load(riser)["lines"]))
    text = changed(riser, path.replace("riser", name), value)
    for answer in submit_everywhere(client, text):
        assert_refused(answer, field.replace("riser", name))
        assert all(error["line"] for error in answer.json()["errors"])
    as_json = client.post(
        "/api/v1/cases", content=json.dumps(yaml.safe_load(text)), headers={"content-type": "application/json"}
    )
    assert as_json.status_code == 422


@pytest.mark.usefixtures("untouched")
def test_all_faults_of_a_case_and_its_data_come_together(client: TestClient, fpso: str) -> None:
    """Of fields, between fields, of names that the database cannot show, and of data that are not here."""
    line = next(iter(yaml.safe_load(fpso)["lines"]))
    text = changed(fpso, "environment.depth", -5)
    text = changed(text, f"lines.{line}.segments.0.type", "rope")
    text = changed(text, "attachments", [{"line": "bough", "arc_length": 3}])
    text = changed(text, "name", "a\x07bell")
    wrong = {
        "environment.depth",
        f"lines.{line}.segments.0.type",
        "attachments.0.line",
        "name",
        "vessel.hydrodynamics.data",
    }
    for answer in submit_everywhere(client, text):
        assert_refused(answer, "depth")
        errors = answer.json()["errors"]
        assert {error["field"] for error in errors} == wrong
        assert [error["line"] for error in errors] == sorted(error["line"] for error in errors)
        assert all(error["line"] for error in errors)
    kind = {"content-type": "application/json"}
    for route in ("cases", "preview"):
        answer = client.post(f"/api/v1/{route}", content=json.dumps(yaml.safe_load(text)), headers=kind)
        assert {error["field"] for error in answer.json()["errors"]} == wrong


@pytest.mark.usefixtures("untouched")
def test_missing_hydrodynamic_data(client: TestClient, fpso: str) -> None:
    for answer in submit_everywhere(client, fpso):
        assert_refused(answer, "vessel.hydrodynamics.data", "upload it")
        assert answer.json()["errors"][0]["line"] > 1


@pytest.mark.usefixtures("untouched")
@pytest.mark.parametrize(
    "reference", ["../../etc/passwd", "/etc/passwd", "a\0b", "file:///etc/passwd", "http://127.0.0.1/x"]
)
def test_data_references_open_no_files(client: TestClient, fpso: str, reference: str) -> None:
    text = changed(fpso, "vessel.hydrodynamics.data", reference)
    for answer in submit_everywhere(client, text):
        assert_refused(answer, "vessel.hydrodynamics.data", "there is no data set")


@pytest.mark.usefixtures("untouched")
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [1,", "not valid YAML"),
        ("- 1\n- 2\n", "mapping"),
        ("", "mapping"),
        ("slowdrift: 1\nslowdrift: 1\n", "twice"),
        (BOMB, "expands to more than"),
        ("a: " + "[" * 5000 + "]" * 5000, "nested too deeply"),
        ("!!python/object/apply:os.system ['true']", ""),
        ("a: \0", "not valid YAML"),
        ("slowdrift: 1\n" + "# filler\n" * 1_200_000, "bytes"),
    ],
    ids=["broken", "list", "empty", "repeated", "bomb", "deep", "object", "control", "10 MB"],
)
def test_texts_that_are_no_case(client: TestClient, text: str, message: str) -> None:
    for answer in submit_everywhere(client, text):
        assert_refused(answer, "", message)


@pytest.mark.usefixtures("untouched")
@pytest.mark.parametrize(
    ("body", "message"),
    [
        (b'{"a": NaN}', "NaN"),
        (b'{"a": 1, "a": 2}', "twice"),
        (b'{"a": ' + b"[" * 100_000 + b"]" * 100_000 + b"}", ""),
        (b"{", "not valid JSON"),
        (b"\xff\xfe{}", ""),
        (b'{"a": 1e999}', ""),
        (b"[]", ""),
        (b"null", ""),
    ],
)
def test_json_that_is_no_case(client: TestClient, body: bytes, message: str) -> None:
    kind = {"content-type": "application/json"}
    for path in ("/api/v1/cases", "/api/v1/runs", "/api/v1/cases/check"):
        answer = client.post(path, content=body, headers=kind)
        assert answer.status_code == 422, answer.text
        assert message in answer.text


@pytest.mark.usefixtures("untouched")
def test_run_requests(client: TestClient, riser: str) -> None:
    for body, word in (
        ({}, "exactly one"),
        ({"yaml": riser, "case": {}}, "exactly one"),
        ({"yaml": riser, "speed": 9}, "speed"),
        ({"yaml": riser, "analyses": ["modes", "magic"]}, "does not hold"),
        ({"yaml": riser, "analyses": []}, "at least one"),
    ):
        answer = client.post("/api/v1/runs", json=body)
        assert (answer.status_code, word in answer.text) == (422, True), answer.text
    assert client.post("/api/v1/runs", json={"case_id": "nobody"}).status_code == 404


@pytest.mark.usefixtures("untouched")
@pytest.mark.parametrize("text", ["a\0b", "\ud800", "\x1b[31m", "a\u2028b"])
@pytest.mark.parametrize("path", ["name", "description"])
def test_texts_that_cannot_be_shown(client: TestClient, riser: str, path: str, text: str) -> None:
    case = yaml.safe_load(riser) | {path: text}
    case["lines"]["riser"]["segments"][0]["length"] = "170 m"
    if path == "description" and text == "a\u2028b":
        return  # a line separator is white space
    answer = client.post("/api/v1/cases", content=json.dumps(case), headers={"content-type": "application/json"})
    assert_refused(answer, path)
    assert client.post("/api/v1/runs", json={"case": case} if "\ud800" not in text else {}).status_code == 422
    assert client.get("/api/v1/runs/a%00b").status_code == 400
    assert client.get("/api/v1/runs?cursor=%00").status_code == 400
    assert client.post("/api/v1/runs", json={"case_id": "a\0"}).status_code == 422


def test_heading_outside_the_data(client: TestClient, fpso: str, tmp_path: Path) -> None:
    payload = synthetic.to_bytes(synthetic.dataset(headings=np.linspace(0, np.pi / 2, 5)), tmp_path)
    uploaded = client.post("/api/v1/data-sets", files={"file": ("barge-240x46x10.nc", payload)})
    assert uploaded.status_code == 201, uploaded.text
    assert uploaded.json()["summary"]
    answer = client.post("/api/v1/cases", content=changed(fpso, "environment.seastates.0.direction", "300 deg"))
    assert_refused(answer, "environment.seastates.0.direction")


@pytest.mark.parametrize(
    "content", [b"", b"not netcdf", b"\x89HDF\r\n\x1a\n" + b"\0" * 100, b"CDF\x01" + b"\xff" * 100]
)
def test_files_that_are_no_data(client: TestClient, content: bytes) -> None:
    answer = client.post("/api/v1/data-sets", files={"file": ("../../x.nc", content)})
    assert_refused(answer, "file")
    assert client.get("/api/v1/data-sets").json()["items"] == []
