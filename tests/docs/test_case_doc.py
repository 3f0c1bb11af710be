"""docs/case.md is what docs/make_case_doc.py makes of the schema; every field says what it means."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

from solver.case import Case, load_case

DOCS = Path(__file__).parents[2] / "docs"


def _maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_case_doc", DOCS / "make_case_doc.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_the_schemas() -> None:
    made = _maker().page()
    assert (DOCS / "case.md").read_text(encoding="utf-8") == made, "run: python docs/make_case_doc.py"


def test_every_field_has_a_meaning() -> None:
    schema = Case.model_json_schema()
    shared = {"Diagonal", "ConstantLoad"}  # one field a degree of freedom: the class says what they are
    parts = {"Case": schema, **schema["$defs"]}
    silent = [
        f"{name}.{key}"
        for name, part in parts.items()
        if name not in shared
        for key, field in part.get("properties", {}).items()
        if not field.get("description")
    ]
    assert silent == []


def test_the_introductions_example_is_a_case() -> None:
    text = (DOCS / "case-introduction.md").read_text(encoding="utf-8")
    example = text.split("```yaml\n", 1)[1].split("```", 1)[0]
    assert load_case(example).analyses.requested() == ("statics", "frequency_domain")
