"""The form's changes to a text: only what was meant changes, comments stay, and the case stays a case."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import flask
import pytest
import yaml

from frontend.editor.edits import apply
from frontend.editor.text import EditError, read
from solver.case import load_case

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*.yaml"))
FPSO = next(path for path in EXAMPLES if path.stem == "fpso-2000m-design").read_text()


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_one_scalar_changes_its_own_characters_only(path: Path) -> None:
    text = path.read_text()
    changed = apply(text, [{"op": "set", "path": ["environment", "depth"], "value": "123.5 m"}])
    before, after = text.split("\n"), changed.split("\n")
    different = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert len(different) == 1
    assert "123.5 m" in different[0][1]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_a_change_of_structure_keeps_comments_and_values(path: Path) -> None:
    text = path.read_text()
    changed = apply(text, [{"op": "set", "path": ["description"], "value": "Two: words # here", "words": True}])
    kept = {line.strip() for line in text.split("\n") if line.lstrip().startswith("#")}
    assert kept <= {line.strip() for line in changed.split("\n")}
    assert load_case(changed).description == "Two: words # here"
    back = apply(changed, [{"op": "remove", "path": ["description"]}])
    assert load_case(back) == load_case(text)


def test_free_text_stays_text_and_numbers_stay_numbers() -> None:
    for value in ("42", "true", "null", "1e9", 'say "so"', "a: b", "- x", "two\nlines", "#1", "ß·ω"):
        changed = apply(FPSO, [{"op": "set", "path": ["name"], "value": value, "words": True}])
        assert yaml.safe_load(changed)["name"] == value
    changed = apply(FPSO, [{"op": "set", "path": ["vessel", "mass"], "value": "1.2e8"}])
    assert load_case(changed).vessel.mass == 1.2e8  # type: ignore[union-attr]
    assert read(changed)["vessel"]["mass"] == "1.2e8"


def test_a_line_type_and_its_references_take_a_new_name() -> None:
    changed = apply(FPSO, [{"op": "rename", "path": ["line_types", "wire"], "to": "spiral strand"}])
    case = load_case(changed)
    assert list(case.line_types) == ["spiral strand"]
    assert {segment.type for line in case.lines.values() for segment in line.segments} == {"spiral strand"}
    with pytest.raises(EditError, match="already"):
        apply(FPSO, [{"op": "rename", "path": ["lines", "bow-port"], "to": "stern-port"}])


def test_a_mirror_twice_is_the_line_itself() -> None:
    for axis, twin in (("x", "bow-starboard"), ("y", "stern-port")):
        edit: dict[str, Any] = {"op": "mirror", "path": ["lines", "bow-port"], "axis": axis, "to": "image"}
        once = apply(FPSO, [edit])
        case = load_case(once)
        assert case.lines["image"] == case.lines[twin]
        twice = load_case(apply(once, [{**edit, "path": ["lines", "image"], "to": "back"}]))
        assert twice.lines["back"] == twice.lines["bow-port"]


def test_a_ring_by_azimuth() -> None:
    one = apply(
        FPSO, [{"op": "remove", "path": ["lines", name]} for name in ("stern-port", "stern-starboard", "bow-starboard")]
    )
    case = load_case(apply(one, [{"op": "pattern", "path": ["lines", "bow-port"], "count": 3}]))
    assert list(case.lines) == ["bow-port", "bow-port 2", "bow-port 3"]
    azimuths = [math.degrees(line.end_a.anchor.azimuth) for line in case.lines.values()]  # type: ignore[union-attr,arg-type]
    assert azimuths == pytest.approx([45, 165, 285])
    for line in case.lines.values():
        assert math.hypot(*line.end_b.fairlead[:2]) == pytest.approx(math.hypot(80, 23), abs=1e-5)  # type: ignore[index]


def test_a_ring_of_points_turns_about_the_vessel_with_a_heading() -> None:
    edits = [
        {"op": "set", "path": ["vessel", "heading"], "value": "30 deg"},
        {"op": "set", "path": ["vessel", "centre_of_gravity"], "value": ["10", "0", "5"]},
        {"op": "set", "path": ["lines", "bow-port", "end_a"], "value": {"anchor": {"point": ["1800", "100"]}}},
        {"op": "pattern", "path": ["lines", "bow-port"], "count": 4},
    ]
    case = load_case(apply(FPSO, edits))
    cx, cy = 10 * math.cos(math.radians(30)), 10 * math.sin(math.radians(30))
    points = [line.end_a.anchor.point for name, line in case.lines.items() if name.startswith("bow-port")]  # type: ignore[union-attr]
    assert {round(math.hypot(p[0] - cx, p[1] - cy), 3) for p in points if p} == {
        round(math.hypot(1800 - cx, 100 - cy), 3)
    }
    assert sum(p[0] - cx for p in points if p) == pytest.approx(0, abs=1e-4)


def test_what_cannot_be_read_says_the_line() -> None:
    for text, line in (("a: 1\nb: [1, 2", 2), ("a: &x 1\nb: *x", 1), ("- 1", 1)):
        with pytest.raises(EditError) as error:
            read(text)
        assert error.value.line == line
    with pytest.raises(EditError, match="nested"):
        read("a: " + "[" * 60)


def test_the_routes_change_nothing_when_they_refuse(server: flask.Flask) -> None:
    asking = server.test_client()
    good = asking.post("/editor/apply", json={"text": FPSO, "edits": [{"op": "remove", "path": ["vessel"]}]}).json
    assert good["error"] is None
    assert "vessel" not in good["tree"]
    for edit in (
        {"op": "remove", "path": ["nothing", "here"]},
        {"op": "explode", "path": []},
        {"op": "copy", "path": ["lines", "no"]},
    ):
        answer = asking.post("/editor/apply", json={"text": FPSO, "edits": [edit]}).json
        assert answer["text"] == FPSO
        assert answer["refused"]
    assert asking.post("/editor/read", json={"text": 1}).status_code == 400
    assert asking.post("/editor/read", json={"text": "a: [", "x": 1}).json["error"]["line"] is not None
