"""Meshes, and the runs that compute hydrodynamic data from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import func, or_, select
from sqlalchemy.orm import Session, undefer

from solver.results.part import Chunk

from ..broker import HYDRODYNAMICS as QUEUE
from ..errors import ConflictError, NotFoundError
from ..hydrodynamics import HydrodynamicJob, Mesh
from ..models import HYDRODYNAMICS, Run, Task
from ..priority import NORMAL
from ..scope import Scope
from .data_sets import DataSetRepository
from .runs import RunRepository, RunView
from .scoped import Scoped
from .tasks import Outcome, TaskRepository, Ticket

ANALYSIS = "hydrodynamics"
"""What such a run's `analyses` and `outcomes` name."""


class MeshRepository(Scoped):
    def save(self, name: str, content_hash: str, payload: bytes, summary: dict[str, Any]) -> tuple[Mesh, bool]:
        """The mesh with this content, and whether it had to be made."""
        same = self._select(Mesh).where(Mesh.content_hash == content_hash)
        known = self.session.scalars(same).one_or_none()
        if known is not None:
            return known, False
        row = Mesh(
            project_id=self.scope.project_id,
            name=name,
            content_hash=content_hash,
            size=len(payload),
            summary=summary,
            payload=payload,
        )
        return self._add_or_find(row, same)

    def get(self, key: str) -> Mesh:
        return self._one(Mesh, key, "mesh")

    def find(self, reference: str) -> Mesh:
        """By id or content hash, else the newest of that name; with its content."""
        if not reference.isprintable():
            raise NotFoundError("mesh", repr(reference))
        keys = or_(Mesh.id == reference, Mesh.content_hash == reference, Mesh.name == reference)
        query = self._select(Mesh).where(keys).order_by(Mesh.id.desc()).limit(1).options(undefer(Mesh.payload))
        row = self.session.scalars(query).one_or_none()
        if row is None:
            raise NotFoundError("mesh", reference)
        return row

    def page(self, limit: int, cursor: str | None) -> Sequence[Mesh]:
        query = self._select(Mesh).order_by(Mesh.id.desc()).limit(limit)
        if cursor:
            query = query.where(Mesh.id < cursor)
        return self.session.scalars(query).all()

    def delete(self, key: str) -> None:
        row = self.get(key)
        jobs = self.session.scalar(
            select(func.count()).select_from(HydrodynamicJob).where(HydrodynamicJob.mesh_id == key)
        )
        if jobs:
            raise ConflictError(f"{jobs} job(s) refer to this mesh; delete them first.")
        self.session.delete(row)


@dataclass(frozen=True)
class JobView:
    """A job with its run."""

    view: RunView
    job: HydrodynamicJob


@dataclass(frozen=True)
class NewJob:
    name: str
    spec: dict[str, Any]
    content_hash: str
    estimate: dict[str, Any]
    weight: float
    mesh_id: str | None = None
    warnings: tuple[str, ...] = ()


class HydrodynamicsRepository(RunRepository):
    def start(self, new: NewJob) -> tuple[Run, list[tuple[str, str]]]:
        """A queued run of kind `hydrodynamics`, and where to ring for its task after the commit."""
        run = Run(
            project_id=self.scope.project_id,
            kind=HYDRODYNAMICS,
            case_name=new.name,
            content_hash=new.content_hash,
            analyses=[ANALYSIS],
            warnings=list(new.warnings),
            created_by=self.scope.user_id,
        )
        run, doors = self._queue(run, [Chunk(ANALYSIS, weight=new.weight)], NORMAL, QUEUE)
        job = HydrodynamicJob(run_id=run.id, spec=new.spec, estimate=new.estimate, mesh_id=new.mesh_id)
        self.session.add(job)
        self.session.flush()
        return run, doors

    def job(self, key: str) -> JobView:
        return self._jobs([self._with_tasks([self._hydrodynamic(key)])[0]])[0]

    def jobs(self, limit: int, cursor: str | None, states: Sequence[str] = ()) -> tuple[list[JobView], int]:
        """Newest first, from below the id `cursor`; and how many there are in all."""
        query = self._select(Run).where(Run.kind == HYDRODYNAMICS)
        if states:
            query = query.where(Run.state.in_(states))
        total = self.session.scalar(select(func.count()).select_from(query.subquery())) or 0
        if cursor:
            query = query.where(Run.id < cursor)
        rows = self.session.scalars(query.order_by(Run.id.desc()).limit(limit)).all()
        return self._jobs(self._with_tasks(rows)), total

    def cancel_job(self, key: str) -> None:
        self.cancel(self._hydrodynamic(key).id)

    def delete_job(self, key: str) -> None:
        """The job; the data set that it made stays."""
        self.delete(self._hydrodynamic(key).id)

    def _hydrodynamic(self, key: str) -> Run:
        run = self.session.scalars(self._select(Run).where(Run.id == key, Run.kind == HYDRODYNAMICS)).one_or_none()
        if run is None:
            raise NotFoundError("hydrodynamic job", key)
        return run

    def _jobs(self, views: Sequence[RunView]) -> list[JobView]:
        keys = [view.run.id for view in views]
        found = self.session.scalars(select(HydrodynamicJob).where(HydrodynamicJob.run_id.in_(keys)))
        jobs = {job.run_id: job for job in found}
        return [JobView(view, jobs[view.run.id]) for view in views]


@dataclass(frozen=True)
class Assignment:
    """What a worker needs of a claimed job: what was asked, the mesh with its name, and where it stopped before."""

    spec: dict[str, Any]
    mesh: tuple[bytes, str] | None
    checkpoint: bytes | None


class HydrodynamicTasks:
    """A worker's side of it. Whoever holds a ticket may write to its run; `TaskRepository` fences every write."""

    def __init__(self, session: Session):
        self.session = session

    def assignment(self, ticket: Ticket) -> Assignment | None:
        """None where the run of the ticket is none of hydrodynamics."""
        job = self.session.get(HydrodynamicJob, ticket.run_id)
        if job is None:
            return None
        task = self.session.get_one(Task, ticket.task_id, options=[undefer(Task.checkpoint)])
        mesh = None if job.mesh_id is None else self.session.get_one(Mesh, job.mesh_id, options=[undefer(Mesh.payload)])
        return Assignment(job.spec, None if mesh is None else (mesh.payload, mesh.name), task.checkpoint)

    def complete(self, ticket: Ticket, outcome: Outcome, name: str, made: Made) -> bool:
        """End the run and store its data set, at once. False if it was cancelled meanwhile."""
        if not TaskRepository(self.session).complete(ticket, outcome):
            return False
        run = self.session.get_one(Run, ticket.run_id)
        data_sets = DataSetRepository(self.session, Scope(project_id=run.project_id))
        row, _ = data_sets.save(name, made.filename, made.content_hash, made.payload, made.summary)
        self.session.get_one(HydrodynamicJob, ticket.run_id).data_set_id = row.id
        return True


@dataclass(frozen=True)
class Made:
    """A file of hydrodynamic data."""

    filename: str
    content_hash: str
    payload: bytes
    summary: dict[str, Any]
