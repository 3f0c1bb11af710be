"""Canonical form, hash and schema: one case, however it is written."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema_rs
import pytest

from solver.case import Case, load_case, to_yaml

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.yaml"))
IDS = [path.stem for path in EXAMPLES]


@pytest.mark.parametrize("path", EXAMPLES, ids=IDS)
def test_canonical_json_and_yaml_give_back_the_same_case(path: Path) -> None:
    case = load_case(path.read_bytes())
    assert load_case(case.canonical()) == case
    assert load_case(to_yaml(case)) == case
    assert load_case(to_yaml(case)).canonical() == case.canonical()
    assert load_case(case.canonical()).content_hash() == case.content_hash()
    assert re.fullmatch(r"[0-9a-f]{64}", case.content_hash())


SPELLINGS = [
    ("depth: 2000 m", "depth: 2 km"), ("15.7 m", "1570 cm"), ("13.5 s", "0.225 min"),
    ("202.5 deg", "202.5°"), ("110000 t", "1.1e8 kg"),
    ("4370 kN", "4.37 MN"), ("1000 MN", "1e9"), ("50 kN m2", "50000 N·m²"), ("30 kN/m", "3e4"), ("3300 m", "3300"),
    ("{density: 1025, gravity: 9.807}", "{gravity: 9.807 m/s2, density: 1.025 t/m3}"), ("0.5 m", "50 cm"),
    ("name: FPSO 2000 m", "'name': \"FPSO 2000 m\""), ("step: 0.005", "step: 0.005 rad/s"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new"), SPELLINGS)
def test_the_hash_does_not_see_spelling_or_units(old: str, new: str) -> None:
    text = next(path for path in EXAMPLES if path.stem == "fpso-2000m").read_text()
    if old not in text:
        pytest.skip(f"{old!r} is not in the example")
    body = text[text.index("slowdrift: 1") :]
    assert load_case(body.replace(old, new)).content_hash() == load_case(text).content_hash()


def test_the_hash_sees_every_change_of_meaning() -> None:
    text = next(path for path in EXAMPLES if path.stem == "fpso-2000m").read_text()
    changes = [("15.7 m", "15.71 m"), ("202.5 deg", "202.4 deg"),
               ("multiplicity: 6", "multiplicity: 5"),
               ("gamma: 2", "gamma: 2.1"), ("bow-port", "port-bow"), ("exclude", "include")]  # fmt: skip
    hashes = {load_case(text).content_hash()} | {load_case(text.replace(a, b)).content_hash() for a, b in changes}
    assert len(hashes) == len(changes) + 1


def test_the_schema_is_a_valid_json_schema_that_describes_its_fields() -> None:
    schema = Case.model_json_schema()
    try:
        from jsonschema import Draft202012Validator
    except ImportError:
        pass
    else:
        Draft202012Validator.check_schema(schema)
    assert json.loads(json.dumps(schema)) == schema
    definitions = schema["$defs"]
    for reference in re.findall(r'"\$ref": "([^"]+)"', json.dumps(schema)):
        assert reference.removeprefix("#/$defs/") in definitions
    undescribed = []
    for name, definition in definitions.items():
        assert definition.get("additionalProperties") is False, name
        for field, value in definition.get("properties", {}).items():
            text = json.dumps(value)
            if "description" not in text and "$ref" not in text:
                undescribed.append(f"{name}.{field}")
    total = sum(len(d.get("properties", {})) for d in definitions.values())
    assert len(undescribed) < 0.35 * total, undescribed


def test_the_schema_says_units_and_limits() -> None:
    definitions = Case.model_json_schema()["$defs"]
    length = definitions["Environment"]["properties"]["depth"]
    assert length["x-unit"] == "m"
    assert length["x-gt"] == 0
    direction = definitions["Jonswap"]["properties"]["direction"]
    assert direction["type"] == "string", "a bare number for an angle must not validate"


@pytest.mark.parametrize("path", EXAMPLES, ids=IDS)
def test_examples_validate_against_the_schema(path: Path) -> None:
    schema = jsonschema_rs.validator_for(Case.model_json_schema())
    case = json.loads(load_case(path.read_bytes()).canonical())
    schema.validate(case)
    with pytest.raises(jsonschema_rs.ValidationError, match="depth"):
        schema.validate(case | {"environment": case["environment"] | {"depth": []}})
