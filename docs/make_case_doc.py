"""Writes docs/case.md from the schema of a case: `python docs/make_case_doc.py`; a test holds the page to it."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from solver.case import Case
from solver.case.units import UNITS

PAGE = Path(__file__).with_name("case.md")
INTRODUCTION = Path(__file__).with_name("case-introduction.md")
Schema = dict[str, Any]


def page() -> str:
    """The whole page: introduction, units, one section per part of a case."""
    schema = Case.model_json_schema()
    order = _places()
    parts = [INTRODUCTION.read_text(encoding="utf-8").rstrip(), _units(), "## Fields", _section("Case", "case", schema)]
    parts += [_section(name, place, schema["$defs"][name]) for name, place in order.items()]
    return "\n\n".join(parts) + "\n"


def _units() -> str:
    rows = [f"| {name.replace('_', ' ')} | {si} | {', '.join(table)} |" for name, (si, table) in UNITS.items()]
    return "\n".join(["| quantity | SI | written as |", "|---|---|---|", *rows])


def _in_reading_order(schema: Schema, definitions: dict[str, Schema]) -> dict[str, str]:
    """Every part of a case and where it is first used, depth first."""
    found: dict[str, str] = {}

    def visit(part: Schema, place: str) -> None:
        for key, field in part.get("properties", {}).items():
            where = f"{place}.{key}" if place else key
            for name, below in _references(field, where):
                if name not in found:
                    found[name] = below
                    visit(definitions[name], below)

    visit(schema, "")
    return found


def _references(field: Schema, place: str) -> list[tuple[str, str]]:
    """Names of the parts a field refers to, with their places."""
    if "$ref" in field:
        return [(field["$ref"].rsplit("/", 1)[1], place)]
    found = [pair for key in ("anyOf", "oneOf") for choice in field.get(key, ()) for pair in _references(choice, place)]
    for choice in field.get("patternProperties", {}).values():
        found += _references(choice, f"{place}.NAME")
    if isinstance(field.get("items"), dict):
        found += _references(field["items"], f"{place}[]")
    return found


def _section(name: str, place: str, part: Schema) -> str:
    lines = [f"### {name}: `{place}`", ""]
    if "description" in part:
        lines += [_flat(part["description"]), ""]
    lines += ["| field | takes | default | meaning |", "|---|---|---|---|"]
    required = part.get("required", ())
    for key, field in part.get("properties", {}).items():
        default = "required" if key in required else _default(field)
        lines.append(f"| `{key}` | {_kind(field)} | {default} | {_flat(field.get('description', ''))} |")
    return "\n".join(lines)


def _default(field: Schema) -> str:
    if "patternProperties" in field:
        return "empty"
    if "x-required-unless" in field:
        return f"required without `{field['x-required-unless']}`"
    value = field.get("default", {})
    if value is None:
        return "none"
    if isinstance(value, dict):
        return "its own defaults"
    if isinstance(value, list):
        return "empty" if not value else ", ".join(f"{item:g}" for item in value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f"`{value}`" if value else "empty"
    return f"{value:g}"


def _kind(field: Schema) -> str:
    """What a field takes, in words: unit, choices, limits, or the part it holds."""
    if "$ref" in field:
        name = field["$ref"].rsplit("/", 1)[1]
        return f"[{name}](#{_anchor(name)})"
    if "const" in field:
        return f"`{field['const']}`"
    if "enum" in field:
        return " or ".join(f"`{choice}`" for choice in field["enum"])
    if "x-unit" in field:
        limits = _limits(field, "x-")
        return f"{field['x-unit']}{limits}"
    choices = [item for key in ("anyOf", "oneOf") for item in field.get(key, ()) if item.get("type") != "null"]
    if choices:
        return " or ".join(dict.fromkeys(_kind(item) for item in choices))
    return _plain(field)


def _plain(field: Schema) -> str:
    if "patternProperties" in field:
        (value,) = field["patternProperties"].values()
        return f"names → {_kind(value)}"
    if "prefixItems" in field:
        kinds = [_kind(item) for item in field["prefixItems"]]
        return f"{len(kinds)} × {kinds[0]}"
    if "items" in field:
        fixed = field.get("minItems") == field.get("maxItems")
        return f"{field['maxItems']} rows of {_kind(field['items'])}" if fixed else f"list of {_kind(field['items'])}"
    words = {"string": "text", "number": "number", "integer": "whole number", "boolean": "true or false"}
    return words[field["type"]] + _limits(field, "")


def _limits(field: Schema, prefix: str) -> str:
    names = {"gt": ">", "ge": "≥", "exclusiveMinimum": ">", "minimum": "≥", "maximum": "≤"}
    found = [f"{sign} {field[prefix + key]:g}" for key, sign in names.items() if prefix + key in field]
    return f", {' and '.join(found)}" if found else ""


@cache
def _places() -> dict[str, str]:
    schema = Case.model_json_schema()
    return _in_reading_order(schema, schema["$defs"])


def _anchor(name: str) -> str:
    """The anchor of a part's heading: its letters and digits in lower case."""
    place = _places()[name]
    kept = [sign for sign in f"{name} {place}".lower() if sign.isalnum() or sign in " _-"]
    return "".join(kept).replace(" ", "-")


def _flat(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
