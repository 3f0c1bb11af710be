"""Studies: many runs of one saved case, made, counted, cancelled and deleted as one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import case, delete, func, insert, select, update

from solver.results.part import Chunk

from ..broker import RUNS
from ..clock import clock, utc_now
from ..effective import identity
from ..errors import ConflictError
from ..estimate import Amount, snapshot
from ..ids import new_id
from ..models import (
    ACTIVE,
    CANCELLED,
    CANCELLING,
    QUEUED,
    RUNNING,
    SUCCEEDED,
    CaseVersion,
    DataSet,
    Run,
    Study,
    Task,
)  # fmt: skip
from ..priority import BATCH, INTERACTIVE, doors
from .runs import Labels, RunRepository
from .scoped import Scoped
from .turns import TurnRepository


@dataclass(frozen=True)
class Variant:
    """One run of a study to be: what it changes in the base case, and what that makes of it."""

    overrides: dict[str, Any]
    content_hash: str
    case_name: str
    analyses: tuple[str, ...]
    chunks: tuple[Chunk, ...]
    data_set: DataSet | None
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class StudyView:
    """A study with the number of its runs by state, their progress and an estimate of the seconds left."""

    study: Study
    counts: dict[str, int]
    progress: float
    seconds_left: float | None


@dataclass(frozen=True)
class Row:
    """What a table needs of a run."""

    run_id: str
    index: int
    state: str
    reason: str | None
    overrides: dict[str, Any]
    summary: str | None
    seconds: float | None
    figures: str | None = None
    """What is kept of the summary for tables (store/figures.py)."""


class StudyRepository(Scoped):
    def create(self, study: Study, version: CaseVersion, variants: Sequence[Variant], labels: Labels) -> list[str]:
        """The study with all its runs, queued; gives the doors to ring at, one per task."""
        study.project_id, study.created_by = self.scope.project_id, self.scope.user_id
        study.case_version_id, study.size = version.id, len(variants)
        self.session.add(study)
        self.session.flush()
        now, moment = self.session.scalar(select(clock(self.session))), utc_now()
        priority = BATCH if labels.priority is None else labels.priority
        chunks = [chunk for variant in variants for chunk in variant.chunks]
        if priority == INTERACTIVE:
            priority = RunRepository(self.session, self.scope).class_of(chunks)
        turns = iter(
            TurnRepository(self.session, self.scope).of([chunk.weight for chunk in chunks], RUNS, priority)
            if chunks
            else []
        )
        runs, tasks = [], []
        for index, variant in enumerate(variants):
            run_id = new_id()
            shared = {"created_at": moment, "study_id": study.id, "study_index": index, "tags": list(labels.tags)}
            runs.append(
                {"id": run_id, "case_version_id": version.id, "name": labels.name} | shared | self._run(variant)
            )
            tasks += [
                {
                    "run_id": run_id,
                    "number": number,
                    "chunk": chunk.as_dict(),
                    "weight": chunk.weight,
                    "priority": priority,
                    "turn": next(turns),
                    "rung_at": now,
                }
                for number, chunk in enumerate(variant.chunks)
            ]
        self.session.execute(insert(Run), runs)
        self.session.execute(insert(Task), tasks)
        return [door for _ in tasks for door in doors(RUNS, priority)]

    def _run(self, variant: Variant) -> dict[str, Any]:
        data_hash = None if variant.data_set is None else variant.data_set.content_hash
        return {
            "project_id": self.scope.project_id,
            "created_by": self.scope.user_id,
            "data_set_id": None if variant.data_set is None else variant.data_set.id,
            "data_hash": data_hash,
            "case_name": variant.case_name,
            "content_hash": variant.content_hash,
            "identity": identity(variant.content_hash, data_hash, variant.analyses),
            "overrides": variant.overrides,
            "analyses": list(variant.analyses),
            "warnings": list(variant.warnings),
            "state": QUEUED,
            "outcomes": {},
        }

    def get(self, key: str) -> Study:
        return self._one(Study, key, "study")

    def view(self, key: str) -> StudyView:
        return self._views([self.get(key)])[0]

    def page(self, limit: int, cursor: str | None) -> list[StudyView]:
        """Newest first, from below the id `cursor`."""
        query = self._select(Study).order_by(Study.id.desc()).limit(limit)
        if cursor:
            query = query.where(Study.id < cursor)
        return self._views(self.session.scalars(query).all())

    def run_ids(self, key: str, limit: int, after: int, states: Sequence[str]) -> list[tuple[str, int]]:
        """(id, index) of its runs in their order, from beyond the index `after`."""
        query = self._runs(key).where(Run.study_index > after).order_by(Run.study_index).limit(limit)
        if states:
            query = query.where(Run.state.in_(states))
        rows = self.session.execute(query.with_only_columns(Run.id, Run.study_index))
        return [(row[0], row[1]) for row in rows]

    def rows(self, key: str, after: int = -1, limit: int | None = None, whole: bool = False) -> Iterator[Row]:
        """Its runs in their order, one at a time, with what is kept of their summaries; with the summaries themselves
        where nothing is kept, or they are wanted as a `whole`."""
        spent = select(func.sum(Task.seconds)).where(Task.run_id == Run.id).scalar_subquery()
        summary = Run.summary if whole else case((Run.figures.is_(None), Run.summary))
        columns = (Run.id, Run.study_index, Run.state, Run.reason, Run.overrides, summary, spent, Run.figures)
        query = self._runs(key).where(Run.study_index > after).order_by(Run.study_index).limit(limit)
        found = self.session.execute(query.with_only_columns(*columns).execution_options(yield_per=200))
        for run_id, index, state, reason, overrides, text, seconds, figures in found:
            yield Row(run_id, index, state, reason, overrides or {}, text, seconds, figures)

    def cancel(self, key: str) -> int:
        """Queued runs end at once, running ones within a heartbeat; gives how many were active. ConflictError: none."""
        self.get(key)
        query = self._runs(key).where(Run.state.in_(ACTIVE)).order_by(Run.id).with_for_update()
        runs = self.session.scalars(query.execution_options(populate_existing=True)).all()
        if not runs:
            raise ConflictError("No run of this study is active.")
        mine = Task.run_id.in_(select(Run.id).where(Run.study_id == key, Run.state.in_(ACTIVE)))
        quietly = {"synchronize_session": False}
        stop = update(Task).where(mine, Task.state == QUEUED).values(state=CANCELLED)
        self.session.execute(stop.execution_options(**quietly))
        working = set(self.session.scalars(select(Task.run_id).where(mine, Task.state == RUNNING)))
        moment = utc_now()
        ended = [
            {
                "id": run.id,
                "state": CANCELLED,
                "finished_at": moment,
                "outcomes": dict.fromkeys(run.analyses, CANCELLED),
            }
            for run in runs
            if run.id not in working
        ]
        if ended:
            self.session.execute(update(Run), ended)
        still = update(Run).where(Run.id.in_(working)).values(state=CANCELLING)
        self.session.execute(still.execution_options(**quietly))
        self.session.expire_all()
        return len(runs)

    def delete(self, key: str) -> None:
        """With all its runs, their tasks and channels."""
        study = self.get(key)
        active = self.session.scalar(select(func.count()).select_from(self._runs(key, ACTIVE).subquery()))
        if active:
            raise ConflictError(f"{active} run(s) of the study are active; cancel it first.")
        self.session.execute(delete(Run).where(Run.study_id == key))
        self.session.delete(study)

    def _runs(self, key: str, states: Sequence[str] = ()) -> Any:
        query = self._select(Run).where(Run.study_id == key)
        return query.where(Run.state.in_(states)) if states else query

    def _views(self, studies: Sequence[Study]) -> list[StudyView]:
        keys = [study.id for study in studies]
        counts: dict[str, dict[str, int]] = {key: {} for key in keys}
        grouped = select(Run.study_id, Run.state, func.count()).where(Run.study_id.in_(keys), self._mine(Run))
        for study_id, state, count in self.session.execute(grouped.group_by(Run.study_id, Run.state)):
            counts[str(study_id)][state] = count
        amounts = self._amounts([key for key in keys if any(state in counts[key] for state in ACTIVE)])
        queue = snapshot(self.session) if amounts else None
        made = []
        for study in studies:
            amount, left = amounts.get(study.id), None
            if amount is not None and queue is not None:
                left = queue.left(amount, study.id)
            progress = 1.0 if amount is None else amount.done / amount.total if amount.total else 0.0
            made.append(StudyView(study, counts[study.id], progress, left))
        return made

    def _amounts(self, keys: Sequence[str]) -> dict[str, Amount]:
        working, waiting = Task.state == RUNNING, Task.state == QUEUED
        over = Task.state.not_in((QUEUED, RUNNING))
        query = (
            select(
                Run.study_id,
                func.sum(Task.weight),
                func.sum(case((over, Task.weight), else_=Task.weight * Task.progress)),
                func.sum(case((working, 1), else_=0)),
                func.count(),
                func.min(Task.priority),
                func.min(case((waiting, Task.id))),
                func.sum(case((Task.state == SUCCEEDED, Task.seconds), else_=0.0)),
                func.sum(case((Task.state == SUCCEEDED, Task.weight), else_=0.0)),
            )
            .join(Task, Task.run_id == Run.id)
            .where(Run.study_id.in_(keys))
            .group_by(Run.study_id)
        )
        found = {}
        for key, total, done, at_work, tasks, priority, first, seconds, paid in self.session.execute(query):
            at = None if first is None else (priority, first)
            spent = (seconds or 0.0) * done / paid if paid else 0.0
            found[key] = Amount(total, done, at_work, tasks, spent, at)
        return found
