"""What a client needs to write a case: the schema, the examples, the catalogue of lines, and statics at once."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any

from fastapi import APIRouter, Query, Response
from fastapi.exceptions import RequestValidationError

from solver.case import Case, load_case
from solver.case.catalogue_entries import describe, list_entries
from solver.catalogue import entries
from solver.outcome import CaseError
from store.bundled import examples_dir
from store.errors import NotFoundError

from ..access import needs
from ..bodies import BodyDep
from ..context import ContextDep, ScopeDep
from ..schemas import CatalogueEntry, CatalogueType, Example
from ..services.preview import preview
from .common import CASE_BYTES, Key, case_body, problems

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


Size = Annotated[str | None, Query(max_length=40, description="nominal diameter: a number in m, or with a unit")]
Stiffness = Annotated[str | None, Query(max_length=20, description="which EA of a chain: e301 (default) or orcaflex")]
Water = Annotated[str, Query(max_length=40, description="water density for the weight in water, kg/m3")]


@router.get("/catalogue")
@needs("account")
def list_catalogue() -> list[CatalogueEntry]:
    """Chain, wire and fibre ropes that `line_types: {NAME: {catalogue: …, diameter: …}}` may name."""
    return [CatalogueEntry(**item) for item in list_entries()]


@router.get("/catalogue/{name}", responses=problems(404, 422))
@needs("account")
def get_catalogue_entry(
    name: Key, diameter: Size = None, stiffness: Stiffness = None, density: Water = "1025"
) -> CatalogueType:
    """One of them; with a diameter, its values in SI with formula, source and status, and its weight in water."""
    if name not in entries():
        raise NotFoundError("catalogue entry", name)
    try:
        return CatalogueType(**describe(name, diameter, stiffness, density))
    except CaseError as error:
        raise RequestValidationError([{"loc": each.loc, "msg": each.message} for each in error.errors]) from None


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
