"""Meshes looked at, and jobs that compute hydrodynamic data: checked in full before anything is stored."""

from __future__ import annotations

import hashlib
from typing import Any

from solver.bem import HydrodynamicJob, parse_job
from solver.bem.read import MAX_BYTES
from solver.case.text import MAX_BYTES as TEXT_BYTES
from solver.case.text import read_text
from solver.outcome import CaseError, DataError, FieldError
from store.errors import NotFoundError
from store.hydrodynamics import Mesh
from store.isolation import Stopped, call
from store.quotas import check_file, check_runs
from store.reading import HULL_SECONDS, damaged, limits_for
from store.repositories.hydrodynamics import HydrodynamicsRepository, JobView, MeshRepository, NewJob
from store.scope import Scope

from ..bodies import Body, read_json
from ..context import Context
from ..hydrodynamics_schemas import HydrodynamicInfo, MeshDetail, MeshInfo, MeshLook
from ..idempotency import Once
from .data_sets import harmless

READING = "api.services.mesh_reading"
MESH = ("geometry", "mesh")


def upload(context: Context, scope: Scope, payload: bytes, filename: str, name: str | None) -> tuple[MeshDetail, bool]:
    """Read, measured, then stored. Raises CaseError on the field `file`."""
    if len(payload) > MAX_BYTES:
        raise _fault(("file",), f"more than {MAX_BYTES} bytes; allowed: at most {MAX_BYTES}")
    filename = harmless(filename) or "mesh"
    label = harmless(name or "") or filename
    try:
        found = _examined(payload, filename, label)
    except DataError as error:
        raise _fault(("file",), str(error)) from None
    shown = found.pop("preview")
    content_hash = hashlib.sha256(payload).hexdigest()
    with context.change() as unit:
        row, made = MeshRepository(unit.session, scope).save(label, content_hash, payload, found)
        if made:
            check_file(context.settings, unit.session, scope, row.size)
    return MeshDetail(**mesh_info(row).model_dump(), preview=shown), made


def _examined(payload: bytes, filename: str, label: str) -> dict[str, Any]:
    """Raises DataError."""
    limits = limits_for(len(payload), HULL_SECONDS)
    try:
        found: dict[str, Any] = call(f"{READING}:examine", payload, filename, label, limits=limits)
    except Stopped as stopped:
        raise DataError(damaged(filename, stopped)) from None
    return found


def show_mesh(context: Context, scope: Scope, mesh_id: str) -> MeshDetail:
    with context.database.read() as session:
        repository = MeshRepository(session, scope)
        row = repository.find(repository.get(mesh_id).id)
        payload, info = row.payload, mesh_info(row)
    return MeshDetail(**info.model_dump(), preview=_examined(payload, info.name, info.name)["preview"])


def mesh_info(row: Mesh) -> MeshInfo:
    return MeshInfo(
        id=row.id, name=row.name, content_hash=row.content_hash, size=row.size, created_at=row.created_at, **row.summary
    )


def look(context: Context, scope: Scope, body: Body) -> MeshLook:
    """Quality and preview of the geometry of a job; nothing is stored."""
    job = parse_job(_data(body), compute=False)
    found, _ = _of_geometry(context, scope, "look", job)
    return MeshLook(**found)


def start(context: Context, scope: Scope, body: Body, once: Once) -> HydrodynamicInfo:
    """Check everything, then insert the run with its task and commit, then ring."""
    job = parse_job(_data(body))
    found, mesh = _of_geometry(context, scope, "needed", job, context.settings.bem_memory_mb)
    new = _new(job, found, mesh)
    with context.change() as unit:
        repository = HydrodynamicsRepository(unit.session, scope)

        def make() -> str:
            check_runs(context.settings, unit.session, scope, 1)
            run, doors = repository.start(new)
            unit.rings.extend(doors)
            return run.id

        return info(repository.job(once.make(unit.session, scope, make)))


def _new(job: HydrodynamicJob, found: dict[str, Any], mesh: Mesh | None) -> NewJob:
    return NewJob(
        name=job.name,
        spec=job.model_dump(mode="json", exclude_none=True),
        content_hash=job.content_hash("" if mesh is None else mesh.content_hash),
        estimate=found["estimate"],
        weight=found["seconds"],
        mesh_id=None if mesh is None else mesh.id,
        warnings=tuple(found["warnings"]),
    )


def _data(body: Body) -> Any:
    if body.is_json:
        if len(body.content) > TEXT_BYTES:
            raise _fault((), f"the request has {len(body.content)} bytes; allowed: at most {TEXT_BYTES}")
        return read_json(body)
    return read_text(body.content)[0]


def _of_geometry(
    context: Context, scope: Scope, function: str, job: HydrodynamicJob, *further: Any
) -> tuple[dict[str, Any], Mesh | None]:
    """What a function of mesh_reading says of a job, and the mesh the job refers to. Raises CaseError."""
    mesh, content = None, None
    if job.geometry.mesh is not None:
        with context.database.read() as session:
            try:
                mesh = MeshRepository(session, scope).find(job.geometry.mesh)
            except NotFoundError:
                message = f"there is no mesh {job.geometry.mesh!r} here; upload it first (POST /hydrodynamics/meshes)"
                raise _fault(MESH, message) from None
            content = (mesh.payload, mesh.name)
    limits = limits_for(0 if content is None else len(content[0]), HULL_SECONDS)
    try:
        found: dict[str, Any] = call(f"{READING}:{function}", job, content, *further, limits=limits)
    except DataError as error:
        raise _fault(MESH, str(error)) from None
    except Stopped as stopped:
        raise _fault(MESH if mesh else ("geometry",), damaged(mesh.name if mesh else "geometry", stopped)) from None
    return found, mesh


def show(context: Context, scope: Scope, job_id: str) -> HydrodynamicInfo:
    with context.database.read() as session:
        return info(HydrodynamicsRepository(session, scope).job(job_id))


def cancel(context: Context, scope: Scope, job_id: str) -> HydrodynamicInfo:
    with context.change() as unit:
        repository = HydrodynamicsRepository(unit.session, scope)
        repository.cancel_job(job_id)
        return info(repository.job(job_id))


def info(found: JobView) -> HydrodynamicInfo:
    run, view, job = found.view.run, found.view, found.job
    return HydrodynamicInfo(
        id=run.id,
        name=run.case_name,
        state=run.state,
        progress=view.progress,
        message=view.message,
        reason=run.reason,
        created_at=run.created_at,
        started_at=run.started_at,
        finished_at=run.finished_at,
        attempt=view.attempt,
        warnings=run.warnings,
        created_by=view.created_by,
        spec=job.spec,
        estimate=job.estimate,
        mesh_id=job.mesh_id,
        data_set_id=job.data_set_id,
    )


def _fault(loc: tuple[str, ...], message: str) -> CaseError:
    return CaseError([FieldError(loc, message)])
