"""Studies: many runs of one case, and the queue they wait in."""

from __future__ import annotations

from collections.abc import Iterator
from typing import IO, Annotated, Any, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse

from store.repositories import StudyRepository

from ..bodies import StudyRequestDep, takes
from ..context import ContextDep, ScopeDep
from ..idempotency import OnceDep
from ..schemas import RunPage
from ..services import studies as service
from ..services import study_table
from ..study_schemas import StudyInfo, StudyPage, StudyRequest, StudyTable
from .common import CASE_BYTES, Cursor, Key, Limit, StatesQuery, problems, states_of

router = APIRouter(prefix="/studies", tags=["studies"])
STUDY_BYTES = 16_000_000
MEDIA = {"csv": "text/csv; charset=utf-8", "parquet": "application/vnd.apache.parquet"}
_REQUEST: dict[str, Any] = {
    "requestBody": {"required": True, "content": {"application/json": {"schema": StudyRequest.model_json_schema()}}}
}


@router.post("", status_code=202, responses=problems(404, 409, 422), openapi_extra=_REQUEST, max_body_size=CASE_BYTES)
@takes(STUDY_BYTES)
def start_study(context: ContextDep, scope: ScopeDep, request: StudyRequestDep, once: OnceDep) -> StudyInfo:
    """Queue all runs of a study, at most 20 000. One that is at fault is answered field by field; then none is stored."""
    return service.start(context, scope, request, once)


@router.get("")
def list_studies(context: ContextDep, scope: ScopeDep, limit: Limit = 50, cursor: Cursor = None) -> StudyPage:
    """Newest first."""
    items = service.page(context, scope, limit, cursor)
    return StudyPage(items=items, next_cursor=items[-1].id if len(items) == limit else None)


@router.get("/{study_id}", responses=problems(404))
def get_study(context: ContextDep, scope: ScopeDep, study_id: Key) -> StudyInfo:
    with context.database.read() as session:
        return service.show(StudyRepository(session, scope).view(study_id))


@router.get("/{study_id}/runs", responses=problems(404))
def list_study_runs(
    context: ContextDep,
    scope: ScopeDep,
    study_id: Key,
    limit: Limit = 50,
    cursor: Cursor = None,
    state: StatesQuery = None,
) -> RunPage:
    """In the order of the study."""
    return service.runs_of(context, scope, study_id, limit, cursor, states_of(state))


@router.get(
    "/{study_id}/table",
    response_model=StudyTable,
    responses={200: {"content": {media: {} for media in MEDIA.values()}}, **problems(404, 422)},
)
def get_table(
    context: ContextDep,
    scope: ScopeDep,
    study_id: Key,
    columns: Annotated[str | None, Query(max_length=20_000, description="docs/rest.md; with commas")] = None,
    format: Literal["json", "csv", "parquet"] = "json",
    limit: Annotated[int, Query(ge=1, le=5000, description="of the JSON")] = 1000,
    cursor: Cursor = None,
) -> Any:
    """A row per run: what it changes, and picks from its summary."""
    if format == "json":
        return study_table.table(context, scope, study_id, columns, limit, service.place(cursor))
    if format == "csv":
        pieces = study_table.as_csv(context, scope, study_id, columns)
    else:
        pieces = _pieces(study_table.as_parquet(context, scope, study_id, columns))
    headers = {"Content-Disposition": f'attachment; filename="study-{study_id[:32]}.{format}"'}
    return StreamingResponse(pieces, media_type=MEDIA[format], headers=headers)


def _pieces(file: IO[bytes]) -> Iterator[bytes]:
    with file:
        while piece := file.read(256 * 1024):
            yield piece


@router.post("/{study_id}/cancel", status_code=202, responses=problems(404, 409))
def cancel_study(context: ContextDep, scope: ScopeDep, study_id: Key) -> StudyInfo:
    """Queued runs end at once, running ones within about two seconds."""
    return service.cancel(context, scope, study_id)


@router.delete("/{study_id}", status_code=204, responses=problems(404, 409))
def delete_study(context: ContextDep, scope: ScopeDep, study_id: Key) -> Response:
    """With all its runs."""
    with context.change() as unit:
        StudyRepository(unit.session, scope).delete(study_id)
    return Response(status_code=204)
