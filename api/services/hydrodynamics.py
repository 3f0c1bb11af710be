"""Meshes looked at, and jobs that compute hydrodynamic data: checked in full before anything is stored."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from solver.bem import Hull, HydrodynamicJob, parse_job, prepare
from solver.bem.geometry import wetted
from solver.bem.job import Estimate, check, estimate, wet
from solver.bem.quality import doubts, measures, preview
from solver.bem.read import MAX_BYTES, read_mesh
from solver.case.text import MAX_BYTES as TEXT_BYTES
from solver.case.text import read_text
from solver.outcome import CaseError, DataError, FieldError
from store.errors import NotFoundError
from store.hydrodynamics import Mesh
from store.repositories.hydrodynamics import HydrodynamicsRepository, JobView, MeshRepository, NewJob
from store.scope import Scope

from ..bodies import Body, read_json
from ..context import Context
from ..hydrodynamics_schemas import HydrodynamicInfo, MeshDetail, MeshInfo, MeshLook
from ..idempotency import Once
from .data_sets import harmless

MESH = ("geometry", "mesh")


def upload(context: Context, scope: Scope, payload: bytes, filename: str, name: str | None) -> tuple[MeshDetail, bool]:
    """Read, measured, then stored. Raises CaseError on the field `file`."""
    if len(payload) > MAX_BYTES:
        raise _fault(("file",), f"more than {MAX_BYTES} bytes; allowed: at most {MAX_BYTES}")
    filename = harmless(filename) or "mesh"
    label = harmless(name or "") or filename
    job = parse_job({"geometry": {"mesh": label}}, compute=False)
    try:
        hull, kind = _standing(payload, filename)
    except DataError as error:
        raise _fault(("file",), str(error)) from None
    found = measures(hull, job)
    summary = {"format": kind, "quality": found, "warnings": [item.as_dict() for item in doubts(hull, job, found)]}
    content_hash = hashlib.sha256(payload).hexdigest()
    with context.change() as unit:
        row, made = MeshRepository(unit.session, scope).save(label, content_hash, payload, summary)
    return MeshDetail(**mesh_info(row).model_dump(), preview=preview(hull)), made


def _standing(payload: bytes, filename: str) -> tuple[Hull, str]:
    """The wetted part of a mesh where it stands."""
    mesh, kind = read_mesh(payload, filename)
    return wetted(mesh, kind, 1.0, np.zeros(3), filename), kind


def show_mesh(context: Context, scope: Scope, mesh_id: str) -> MeshDetail:
    with context.database.read() as session:
        repository = MeshRepository(session, scope)
        row = repository.find(repository.get(mesh_id).id)
        payload, info = row.payload, mesh_info(row)
    return MeshDetail(**info.model_dump(), preview=preview(_standing(payload, info.name)[0]))


def mesh_info(row: Mesh) -> MeshInfo:
    return MeshInfo(
        id=row.id, name=row.name, content_hash=row.content_hash, size=row.size, created_at=row.created_at, **row.summary
    )


def look(context: Context, scope: Scope, body: Body) -> MeshLook:
    """Quality and preview of the geometry of a job; nothing is stored."""
    job = parse_job(_data(body), compute=False)
    hull, _ = _hull(context, scope, job)
    found = measures(hull, job)
    return MeshLook(
        quality=found,
        warnings=[item.as_dict() for item in doubts(hull, job, found)],
        preview=preview(hull),
        estimate=estimate(job, wet(job, hull)).as_dict(),
    )


def start(context: Context, scope: Scope, body: Body, once: Once) -> HydrodynamicInfo:
    """Check everything, then insert the run with its task and commit, then ring."""
    job = parse_job(_data(body))
    hull, mesh = _hull(context, scope, job)
    shape = wet(job, hull)
    check(job, hull, shape, context.settings.bem_memory_mb)
    needed = estimate(job, shape)
    new = _new(job, hull, needed, mesh)
    with context.change() as unit:
        repository = HydrodynamicsRepository(unit.session, scope)

        def make() -> str:
            run, doors = repository.start(new)
            unit.rings.extend(doors)
            return run.id

        return info(repository.job(once.make(unit.session, scope, make)))


def _new(job: HydrodynamicJob, hull: Hull, needed: Estimate, mesh: Mesh | None) -> NewJob:
    found = doubts(hull, job, measures(hull, job))
    return NewJob(
        name=job.name,
        spec=job.model_dump(mode="json", exclude_none=True),
        content_hash=job.content_hash("" if mesh is None else mesh.content_hash),
        estimate=needed.as_dict(),
        weight=needed.seconds,
        mesh_id=None if mesh is None else mesh.id,
        warnings=tuple(item.message for item in found),
    )


def _data(body: Body) -> Any:
    if body.is_json:
        if len(body.content) > TEXT_BYTES:
            raise _fault((), f"the request has {len(body.content)} bytes; allowed: at most {TEXT_BYTES}")
        return read_json(body)
    return read_text(body.content)[0]


def _hull(context: Context, scope: Scope, job: HydrodynamicJob) -> tuple[Hull, Mesh | None]:
    found: list[Mesh] = []

    def fetch(reference: str) -> tuple[bytes, str]:
        with context.database.read() as session:
            row = MeshRepository(session, scope).find(reference)
            found.append(row)
            return row.payload, row.name

    try:
        hull = prepare(job, fetch)
    except NotFoundError:
        message = f"there is no mesh {job.geometry.mesh!r} here; upload it first (POST /hydrodynamics/meshes)"
        raise _fault(MESH, message) from None
    except DataError as error:
        raise _fault(MESH, str(error)) from None
    return hull, found[0] if found else None


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
