"""MoorDyn decks: read into the text of a case, written from a saved one."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from ..access import needs
from ..bodies import BodyDep
from ..context import ContextDep, ScopeDep
from ..schemas import ImportInfo
from ..services import moordyn as service
from .common import CASE_BYTES, Key, problems

router = APIRouter(tags=["cases"])
_BODY = {
    "requestBody": {
        "required": True,
        "content": {
            "text/plain": {"schema": {"type": "string", "description": "a MoorDyn deck"}},
            "application/json": {"schema": service.ImportRequest.model_json_schema()},
        },
    }
}


@router.post("/imports/moordyn", responses=problems(422), openapi_extra=_BODY, max_body_size=CASE_BYTES)
@needs("read")
def import_moordyn(scope: ScopeDep, body: BodyDep) -> ImportInfo:
    """A deck as a case's text, with what was read, assumed and left out; nothing is stored (docs/moordyn.md)."""
    return service.read(body)


@router.get(
    "/cases/{case_id}/moordyn",
    responses={200: {"content": {"text/plain": {}}}, **problems(404, 409, 422)},
    response_class=Response,
)
def export_moordyn(
    context: ContextDep,
    scope: ScopeDep,
    case_id: Key,
    run: Annotated[
        str | None,
        Query(pattern=r"^[0-9A-Za-z-]{1,64}$", description="a run of this case whose statics placed its anchors"),
    ] = None,
) -> Response:
    """The lines of a case as a MoorDyn v2 deck, the report at its head."""
    written = service.write(context, scope, case_id, run)
    headers = {"Content-Disposition": f'attachment; filename="slowdrift-{case_id[:32]}-moordyn.dat"'}
    return Response(written.text, media_type="text/plain; charset=utf-8", headers=headers)
