"""What a client needs to write a case: the schema, the examples, and statics at once."""

from __future__ import annotations

from functools import cache
from typing import Any

from fastapi import APIRouter, Response

from solver.case import Case, load_case
from store.bundled import examples_dir

from ..access import needs
from ..bodies import BodyDep
from ..context import ContextDep, ScopeDep
from ..schemas import Example
from ..services.preview import preview
from .common import CASE_BYTES, case_body, problems

router = APIRouter(tags=["cases"])


@router.get("/schema")
@needs("account")
def get_schema() -> dict[str, Any]:
    """JSON Schema of a case."""
    return _schema()


@router.get("/examples")
@needs("account")
def list_examples() -> list[Example]:
    """The bundled cases; the data they refer to are registered under their names."""
    return _examples()


@router.post("/preview", responses=problems(422, 503, 504), openapi_extra=case_body(), max_body_size=CASE_BYTES)
@needs("read")
def make_preview(context: ContextDep, scope: ScopeDep, body: BodyDep) -> dict[str, Any]:
    """Statics and the shape of every line, in about a second or not at all; nothing is stored."""
    answer = preview(context, scope, body)
    return Response(answer, media_type="application/json")  # type: ignore[return-value]  # it is JSON already


@cache
def _schema() -> dict[str, Any]:
    return Case.model_json_schema()


@cache
def _examples() -> list[Example]:
    found = []
    for path in sorted(examples_dir().glob("*.yaml")):
        text = path.read_text()
        case = load_case(text)
        found.append(
            Example(name=path.stem, title=case.name, description=case.description or _comment(text), yaml=text)
        )
    return found


def _comment(text: str) -> str:
    """The comment at the top of the text."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.lstrip("# "))
    return "\n".join(lines)
