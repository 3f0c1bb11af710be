"""Hydrodynamic data from hulls: meshes, their quality, boundary-element jobs."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Form, Response, UploadFile

from solver.bem.read import MAX_BYTES
from solver.bem.spec import HydrodynamicJob
from store.repositories.hydrodynamics import HydrodynamicsRepository, MeshRepository

from ..access import needs
from ..bodies import BodyDep
from ..context import ContextDep, ScopeDep
from ..hydrodynamics_schemas import HydrodynamicInfo, HydrodynamicPage, MeshDetail, MeshLook, MeshPage
from ..idempotency import OnceDep
from ..services import hydrodynamics as service
from .common import CASE_BYTES, Cursor, Key, Limit, StatesQuery, problems, states_of

router = APIRouter(prefix="/hydrodynamics", tags=["hydrodynamics"])
UPLOAD_BYTES = 2 * MAX_BYTES
_EXAMPLE = {
    "name": "barge",
    "geometry": {"hull": {"kind": "barge", "length": 240, "breadth": 46, "draft": 10}, "panel_size": 4},
    "body": {"centre_of_gravity": [0, 0, 5], "mass": 1.1e8, "radii_of_gyration": [26, 60, 60]},
    "frequencies": {"from": 0.1, "to": 1.5, "step": 0.05},
}
_REQUEST = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"type": "object", "description": "see GET /hydrodynamics/schema"},
                "example": _EXAMPLE,
            },
            "application/yaml": {"schema": {"type": "string"}},
        },
    }
}


@router.get("/schema")
def job_schema() -> dict[str, object]:
    """JSON Schema of a job."""
    return HydrodynamicJob.model_json_schema()


@router.post(
    "/meshes",
    status_code=201,
    responses={200: {"model": MeshDetail, "description": "This very mesh is here already."}, **problems(422)},
    max_body_size=UPLOAD_BYTES,
)
def upload_mesh(
    context: ContextDep,
    scope: ScopeDep,
    response: Response,
    file: UploadFile,
    name: Annotated[str | None, Form(max_length=200)] = None,
) -> MeshDetail:
    """STL, GDF, MSH (gmsh, text), Nemoh's .dat or HAMS' .pnl, in metres, z = 0 in the still water (jobs may scale and move)."""
    mesh, made = service.upload(context, scope, file.file.read(MAX_BYTES + 1), file.filename or "", name)
    response.status_code = 201 if made else 200
    return mesh


@router.get("/meshes")
def list_meshes(context: ContextDep, scope: ScopeDep, limit: Limit = 50, cursor: Cursor = None) -> MeshPage:
    with context.database.read() as session:
        rows = MeshRepository(session, scope).page(limit, cursor)
    items = [service.mesh_info(row) for row in rows]
    return MeshPage(items=items, next_cursor=rows[-1].id if len(rows) == limit else None)


@router.get("/meshes/{mesh_id}", responses=problems(404))
def get_mesh(context: ContextDep, scope: ScopeDep, mesh_id: Key) -> MeshDetail:
    return service.show_mesh(context, scope, mesh_id)


@router.delete("/meshes/{mesh_id}", status_code=204, responses=problems(404, 409))
def delete_mesh(context: ContextDep, scope: ScopeDep, mesh_id: Key) -> None:
    with context.change() as unit:
        MeshRepository(unit.session, scope).delete(mesh_id)


@router.post("/mesh", responses=problems(422), openapi_extra=_REQUEST, max_body_size=CASE_BYTES)
@needs("read")
def look_at_mesh(context: ContextDep, scope: ScopeDep, body: BodyDep) -> MeshLook:
    """Quality, preview and estimate of a job's geometry; of the body only `geometry` is needed. Nothing is stored."""
    return service.look(context, scope, body)


@router.post("", status_code=202, responses=problems(409, 422), openapi_extra=_REQUEST, max_body_size=CASE_BYTES)
def start_job(context: ContextDep, scope: ScopeDep, body: BodyDep, once: OnceDep) -> HydrodynamicInfo:
    """Queue a boundary-element job. Refused, with the field, when it is not valid or needs more memory than allowed."""
    return service.start(context, scope, body, once)


@router.get("")
def list_jobs(
    context: ContextDep, scope: ScopeDep, limit: Limit = 50, cursor: Cursor = None, state: StatesQuery = None
) -> HydrodynamicPage:
    """Newest first."""
    with context.database.read() as session:
        found, total = HydrodynamicsRepository(session, scope).jobs(limit, cursor, states_of(state))
    items = [service.info(job) for job in found]
    return HydrodynamicPage(items=items, next_cursor=items[-1].id if len(items) == limit else None, total=total)


@router.get("/{job_id}", responses=problems(404))
def get_job(context: ContextDep, scope: ScopeDep, job_id: Key) -> HydrodynamicInfo:
    return service.show(context, scope, job_id)


@router.post("/{job_id}/cancel", status_code=202, responses=problems(404, 409))
def cancel_job(context: ContextDep, scope: ScopeDep, job_id: Key) -> HydrodynamicInfo:
    """A queued job ends at once; a running one between two solutions."""
    return service.cancel(context, scope, job_id)


@router.delete("/{job_id}", status_code=204, responses=problems(404, 409))
def delete_job(context: ContextDep, scope: ScopeDep, job_id: Key) -> None:
    """The job; the data set that it made stays."""
    with context.change() as unit:
        HydrodynamicsRepository(unit.session, scope).delete_job(job_id)
