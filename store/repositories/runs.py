"""Runs as their owner sees them: made, listed, followed, cancelled, deleted."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import case, delete, func, select, update

from solver.results.part import Chunk

from ..clock import clock, utc_now
from ..errors import ConflictError, NotFoundError
from ..models import ACTIVE, CANCELLED, CANCELLING, FINAL, QUEUED, RUNNING, CaseVersion, Run, Task
from .scoped import Scoped


@dataclass(frozen=True)
class RunView:
    """A run with what its tasks add up to: `progress` 0 to 1 by weight, the words of one at work, the top attempt."""

    run: Run
    progress: float
    message: str
    attempt: int


class RunRepository(Scoped):
    def create(
        self,
        version: CaseVersion,
        analyses: Sequence[str],
        chunks: Iterable[Chunk],
        data_set_id: str | None = None,
        warnings: Sequence[str] = (),
    ) -> tuple[Run, list[str]]:
        """A queued run and the ids of its tasks, which the caller rings for after the commit."""
        run = Run(
            project_id=self.scope.project_id,
            case_version_id=version.id,
            data_set_id=data_set_id,
            case_name=version.name,
            content_hash=version.content_hash,
            analyses=list(analyses),
            warnings=list(warnings),
        )
        self.session.add(run)
        self.session.flush()
        now = self.session.scalar(select(clock(self.session)))
        tasks = [
            Task(run_id=run.id, number=number, chunk=chunk.as_dict(), weight=chunk.weight, rung_at=now)
            for number, chunk in enumerate(chunks)
        ]
        if not tasks:
            raise ValueError("a run needs at least one chunk")
        self.session.add_all(tasks)
        self.session.flush()
        return run, [task.id for task in tasks]

    def get(self, key: str) -> Run:
        return self._one(Run, key, "run")

    def view(self, key: str) -> RunView:
        return self._with_tasks([self.get(key)])[0]

    def page(self, limit: int, cursor: str | None, state: str | None) -> tuple[list[RunView], int]:
        """Newest first, from below the id `cursor`; and how many there are in all."""
        query = self._select(Run)
        if state:
            query = query.where(Run.state == state)
        total = self.session.scalar(select(func.count()).select_from(query.subquery())) or 0
        if cursor:
            query = query.where(Run.id < cursor)
        rows = self.session.scalars(query.order_by(Run.id.desc()).limit(limit)).all()
        return self._with_tasks(rows), total

    def active(self, limit: int) -> list[RunView]:
        query = self._select(Run).where(Run.state.in_(ACTIVE)).order_by(Run.id.desc()).limit(limit)
        return self._with_tasks(self.session.scalars(query).all())

    def views(self, keys: Sequence[str]) -> list[RunView]:
        return self._with_tasks(self.session.scalars(self._select(Run).where(Run.id.in_(keys))).all())

    def summary(self, key: str) -> str:
        """The summary as JSON text; ConflictError while there is none."""
        found = self.session.execute(
            select(Run.state, Run.reason, Run.summary).where(Run.id == key, Run.project_id == self.scope.project_id)
        ).one_or_none()
        if found is None:
            raise NotFoundError("run", key)
        if found.summary is None:
            because = f": {found.reason}" if found.reason else ""
            raise ConflictError(f"The run has no results; it is {found.state}{because}.")
        return str(found.summary)

    def cancel(self, key: str) -> None:
        """A queued run ends at once; a running one is asked to, and its workers see it within a heartbeat."""
        run = self._locked(key)
        if run.state in FINAL:
            raise ConflictError(f"The run is already {run.state}.")
        self.session.execute(update(Task).where(Task.run_id == key, Task.state == QUEUED).values(state=CANCELLED))
        working = self.session.scalar(
            select(func.count()).select_from(Task).where(Task.run_id == key, Task.state == RUNNING)
        )
        if working:
            run.state = CANCELLING
        else:
            run.state, run.finished_at = CANCELLED, utc_now()
            run.outcomes = dict.fromkeys(run.analyses, CANCELLED)
        self.session.flush()

    def delete(self, key: str) -> None:
        """The run with its tasks and channels."""
        run = self._locked(key)
        if run.state not in FINAL:
            raise ConflictError(f"The run is {run.state}; cancel it first.")
        self.session.execute(delete(Run).where(Run.id == key))  # the database cascades

    def _locked(self, key: str) -> Run:
        query = self._select(Run).where(Run.id == key).with_for_update()
        run = self.session.scalars(query.execution_options(populate_existing=True)).one_or_none()
        if run is None:
            raise NotFoundError("run", key)
        return run

    def _with_tasks(self, runs: Sequence[Run]) -> list[RunView]:
        sums = {row.run_id: row for row in self.session.execute(_totals([run.id for run in runs]))} if runs else {}
        return [_view(run, sums.get(run.id)) for run in runs]


def _totals(keys: Sequence[str]) -> Any:
    at_work = case((Task.state == RUNNING, Task.message))
    return (
        select(
            Task.run_id,
            (func.sum(Task.weight * Task.progress) / func.sum(Task.weight)).label("progress"),
            func.max(at_work).label("message"),
            func.max(Task.attempt).label("attempt"),
        )
        .where(Task.run_id.in_(keys))
        .group_by(Task.run_id)
    )


def _view(run: Run, sums: Any) -> RunView:
    if sums is None:
        return RunView(run, 0.0, "", 0)
    progress = 1.0 if run.state == "succeeded" else min(1.0, float(sums.progress or 0.0))
    return RunView(run, progress, sums.message or "", sums.attempt)
