"""Runs as their owner sees them: made, listed, followed, cancelled, deleted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from sqlalchemy import bindparam, case, delete, func, select, update

from solver.results.part import Chunk

from ..broker import RUNS
from ..clock import clock, clock_of, utc_now
from ..effective import identity
from ..errors import ConflictError, NotFoundError
from ..estimate import Amount, Snapshot, snapshot
from ..filters import RunFilter
from ..models import (
    ACTIVE,
    CANCELLED,
    CANCELLING,
    FINAL,
    HYDRODYNAMICS,
    QUEUED,
    RUNNING,
    SUCCEEDED,
    CaseVersion,
    DataSet,
    Run,
    Task,
)  # fmt: skip
from ..people import User
from ..priority import INTERACTIVE, MOST_INTERACTIVE, NORMAL, by_size, doors
from .scoped import Scoped
from .turns import TurnRepository


@dataclass(frozen=True)
class RunView:
    """A run with what its tasks add up to: `progress` 0 to 1 by weight, the words of one at work, the top attempt."""

    run: Run
    progress: float
    message: str
    attempt: int
    priority: int = NORMAL
    seconds_left: float | None = None
    """An estimate (store/estimate.py)."""
    created_by: str | None = None
    """Name of the user who started it."""


@dataclass(frozen=True)
class Labels:
    """What the one who starts a run may say of it; `priority` None: by size."""

    name: str = ""
    tags: tuple[str, ...] = ()
    priority: int | None = None


class RunRepository(Scoped):
    def create(
        self,
        version: CaseVersion,
        analyses: Sequence[str],
        chunks: Sequence[Chunk],
        data_set: DataSet | None = None,
        warnings: Sequence[str] = (),
        labels: Labels | None = None,
    ) -> tuple[Run, list[tuple[str, str]]]:
        """A queued run, and where to ring for its tasks after the commit: (id, door) of each."""
        labels = labels or Labels()
        data_hash = None if data_set is None else data_set.content_hash
        run = Run(
            project_id=self.scope.project_id,
            case_version_id=version.id,
            data_set_id=None if data_set is None else data_set.id,
            case_name=version.name,
            content_hash=version.content_hash,
            data_hash=data_hash,
            identity=identity(version.content_hash, data_hash, analyses),
            analyses=list(analyses),
            warnings=list(warnings),
            name=labels.name,
            tags=list(labels.tags),
            created_by=self.scope.user_id,
        )
        return self._queue(run, chunks, labels.priority)

    def again(self, key: str, chunks: Sequence[Chunk]) -> tuple[Run, list[tuple[str, str]]]:
        """Another run of the very same: case version, overrides, data version and analyses."""
        old = self.get(key)
        kept = (
            "project_id", "case_version_id", "data_set_id", "case_name", "content_hash", "data_hash", "overrides",
            "analyses", "name", "tags",
        )  # fmt: skip
        run = Run(**{name: getattr(old, name) for name in kept}, rerun_of=old.id, created_by=self.scope.user_id)
        run.identity = identity(old.content_hash, old.data_hash, old.analyses)
        return self._queue(run, chunks, None)

    def _queue(
        self, run: Run, chunks: Sequence[Chunk], priority: int | None, queue: str = RUNS
    ) -> tuple[Run, list[tuple[str, str]]]:
        if not chunks:
            raise ValueError("a run needs at least one chunk")
        if priority is None or priority == INTERACTIVE:
            priority = self.class_of(chunks)
        turns = TurnRepository(self.session, self.scope).of([chunk.weight for chunk in chunks], queue, priority)
        self.session.add(run)
        self.session.flush()
        now = self.session.scalar(select(clock(self.session)))
        tasks = [
            Task(
                run_id=run.id,
                number=number,
                chunk=chunk.as_dict(),
                weight=chunk.weight,
                queue=queue,
                priority=priority,
                turn=turn,
                rung_at=now,
            )
            for number, (chunk, turn) in enumerate(zip(chunks, turns, strict=True))
        ]
        self.session.add_all(tasks)
        self.session.flush()
        return run, [(task.id, door) for task in tasks for door in doors(queue, priority)]

    def class_of(self, chunks: Sequence[Chunk]) -> int:
        """Small work is interactive as long as few interactive runs of the same user wait."""
        priority = by_size(chunk.weight for chunk in chunks)
        if priority != INTERACTIVE:
            return priority
        waiting = self._select(Run).join(Task, Task.run_id == Run.id)
        waiting = waiting.where(Task.queue == RUNS, Task.state == QUEUED, Task.priority <= INTERACTIVE)
        waiting = waiting.where(Run.created_by == self.scope.user_id).limit(MOST_INTERACTIVE)
        few = len(self.session.scalars(waiting.with_only_columns(Run.id)).all()) < MOST_INTERACTIVE
        return INTERACTIVE if few else NORMAL

    def identical(self, same: str | None) -> Run | None:
        """The newest succeeded run with this identity."""
        if same is None:
            return None
        query = self._select(Run).where(Run.identity == same, Run.state == SUCCEEDED)
        return self.session.scalars(query.order_by(Run.id.desc()).limit(1)).one_or_none()

    def get(self, key: str) -> Run:
        return self._one(Run, key, "run")

    def view(self, key: str) -> RunView:
        return self._with_tasks([self.get(key)])[0]

    def count(self, which: RunFilter) -> int:
        """How many runs the filter lets through."""
        query = self._select(Run).where(*which.conditions())
        return self.session.scalar(query.with_only_columns(func.count(), maintain_column_froms=True)) or 0

    def page(self, limit: int, cursor: str | None, which: RunFilter | None = None) -> list[RunView]:
        """Newest first, from below the id `cursor` (or oldest first, from above)."""
        which = which or RunFilter()
        query = self._select(Run).where(*which.conditions())
        if cursor:
            query = query.where(Run.id > cursor if which.oldest_first else Run.id < cursor)
        query = query.order_by(Run.id if which.oldest_first else Run.id.desc())
        return self._with_tasks(self.session.scalars(query.limit(limit)).all())

    def label(self, key: str, name: str | None, tags: Sequence[str] | None, pinned: bool | None) -> None:
        """Change what is given."""
        run = self._locked(key)
        given = {"name": name, "tags": None if tags is None else list(tags), "pinned": pinned}
        for field, value in given.items():
            if value is not None:
                setattr(run, field, value)
        self.session.flush()

    def active(self, limit: int) -> list[RunView]:
        query = self._select(Run).where(Run.state.in_(ACTIVE)).order_by(Run.id.desc()).limit(limit)
        return self._with_tasks(self.session.scalars(query).all())

    def views(self, keys: Sequence[str]) -> list[RunView]:
        return self._with_tasks(self.session.scalars(self._select(Run).where(Run.id.in_(keys))).all())

    def summary(self, key: str) -> str:
        """The summary as JSON text; ConflictError while there is none."""
        found = self.session.execute(
            select(Run.state, Run.reason, Run.summary).where(Run.id == key, self._mine(Run))
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
        self.session.execute(delete(Run).where(Run.id == key, self._mine(Run)))  # the database cascades

    def _locked(self, key: str) -> Run:
        query = self._select(Run).where(Run.id == key).with_for_update()
        run = self.session.scalars(query.execution_options(populate_existing=True)).one_or_none()
        if run is None:
            raise NotFoundError("run", key)
        return run

    def _with_tasks(self, runs: Sequence[Run]) -> list[RunView]:
        if not runs:
            return []
        totals = _totals(self.session.get_bind().dialect.name)
        sums = {row.run_id: row for row in self.session.execute(totals, {"runs": [run.id for run in runs]})}
        active = any(run.state in ACTIVE for run in runs)
        queue = snapshot(self.session) if active else Snapshot()
        shown = self.scope.run_ids is None  # behind a share link nobody is named
        people = {run.created_by for run in runs if shown} - {None}
        rows = self.session.execute(select(User.id, User.name).where(User.id.in_(people))) if people else ()
        names = {row.id: row.name for row in rows}
        return [_view(run, sums.get(run.id), queue, names) for run in runs]


@cache
def _totals(dialect: str) -> Any:
    """What the tasks of `runs` add up to. Made once: to put it together takes three times as long as to execute it."""
    working, waiting = Task.state == RUNNING, Task.state == QUEUED
    spent = case((working, clock_of(dialect) - Task.claimed_at), else_=func.coalesce(Task.seconds, 0.0))
    return (
        select(
            Task.run_id,
            func.sum(Task.weight).label("total"),
            func.sum(Task.weight * Task.progress).label("done"),
            func.max(case((working, Task.message))).label("message"),
            func.max(Task.attempt).label("attempt"),
            func.min(Task.priority).label("priority"),
            func.sum(case((working, 1), else_=0)).label("at_work"),
            func.count().label("tasks"),
            func.sum(spent).label("seconds"),
            func.min(case((waiting, Task.id))).label("first"),
        )
        .where(Task.run_id.in_(bindparam("runs", expanding=True)))
        .group_by(Task.run_id)
    )


def _view(run: Run, sums: Any, queue: Snapshot, names: dict[str, str]) -> RunView:
    who = names.get(run.created_by or "")
    if sums is None:
        return RunView(run, 0.0, "", 0, created_by=who)
    done = float(sums.done or 0.0)
    progress = 1.0 if run.state == SUCCEEDED else min(1.0, done / sums.total if sums.total else 0.0)
    left = None
    if run.state in ACTIVE:
        apart = run.kind == HYDRODYNAMICS  # with workers of their own: what waits for the others is not before it
        first = None if sums.first is None or apart else (sums.priority, sums.first)
        amount = Amount(sums.total, done, sums.at_work, sums.tasks, float(sums.seconds or 0.0), first)
        left = queue.left(amount, HYDRODYNAMICS if apart else run.study_id)
    return RunView(run, progress, sums.message or "", sums.attempt, sums.priority, left, who)
