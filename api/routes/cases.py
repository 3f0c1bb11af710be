"""Cases: checked, saved, listed, deleted."""

from __future__ import annotations

from fastapi import APIRouter, Response

from store.repositories import CaseRepository

from ..access import needs
from ..bodies import BodyDep
from ..context import ContextDep, ScopeDep
from ..schemas import CaseCheck, CaseDetail, CaseInfo, CasePage
from ..services import cases as service
from .common import CASE_BYTES, Cursor, Key, Limit, case_body, problems

router = APIRouter(prefix="/cases", tags=["cases"])


@router.post(
    "",
    status_code=201,
    responses={200: {"model": CaseInfo, "description": "This very case is saved already."}, **problems(422)},
    openapi_extra=case_body(),
    max_body_size=CASE_BYTES,
)
def save_case(context: ContextDep, scope: ScopeDep, body: BodyDep, response: Response) -> CaseInfo:
    """Check a case and save it as a version under its name. A faulty one is answered field by field, not stored."""
    version, made = service.save(context, scope, service.check_body(context, scope, body))
    response.status_code = 201 if made else 200
    return service.info(version)


@router.post("/check", responses=problems(422), openapi_extra=case_body(), max_body_size=CASE_BYTES)
@needs("read")
def check_case(context: ContextDep, scope: ScopeDep, body: BodyDep) -> CaseCheck:
    """Check a case; nothing is stored."""
    checked = service.check_body(context, scope, body)
    case = checked.case
    return CaseCheck(name=case.name, analyses=list(case.analyses.requested()), warnings=list(checked.warnings))


@router.get("")
def list_cases(context: ContextDep, scope: ScopeDep, limit: Limit = 50, cursor: Cursor = None) -> CasePage:
    """Newest first."""
    with context.database.read() as session:
        rows = CaseRepository(session, scope).page(limit, cursor)
    return CasePage(items=[service.info(row) for row in rows], next_cursor=rows[-1].id if len(rows) == limit else None)


@router.get("/{case_id}", responses=problems(404))
def get_case(context: ContextDep, scope: ScopeDep, case_id: Key) -> CaseDetail:
    """The case as an object in SI and as the text that was submitted."""
    with context.database.read() as session:
        return service.detail(CaseRepository(session, scope).get_with_text(case_id))


@router.delete("/{case_id}", status_code=204, responses=problems(404, 409))
def delete_case(context: ContextDep, scope: ScopeDep, case_id: Key) -> None:
    with context.change() as unit:
        CaseRepository(unit.session, scope).delete(case_id)
