"""Tasks as workers see them: claimed, kept alive, handed in, given up.

The row is the truth. Whoever changes a run's state locks the run's row first, then its tasks; every write of a worker
is fenced by the attempt it claimed, so that a late worker changes nothing and learns so (LostLeaseError).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session, undefer

from solver.results.part import Chunk

from ..broker import RUNS
from ..clock import clock, utc_now
from ..errors import LostLeaseError
from ..models import CANCELLED, CANCELLING, FAILED, QUEUED, RUNNING, SUCCEEDED, CaseVersion, DataSet, Project, Run, Task
from ..sources import PinnedSource

STATED = "wamit"
"""In a case's text where it states conventions of WAMIT files."""
NEXT_TRIES = 5
EARLY = 5
"""Times max_attempts: how many attempts are made of a task whose workers lose their leases while they live."""


@dataclass(frozen=True)
class Ticket:
    """What a claim gives: the right to write to this task until the lease ends."""

    task_id: str
    run_id: str
    attempt: int
    weight: float = 1.0
    queue: str = RUNS


@dataclass(frozen=True)
class Job:
    """A claimed chunk with its case and data; `part` is there when only the merge is left to do."""

    canonical: str
    analyses: tuple[str, ...]
    overrides: dict[str, Any] | None
    data: PinnedSource
    chunk: Chunk
    checkpoint: bytes | None
    part: bytes | None
    alone: bool
    """Whether it is its run's only task."""


@dataclass(frozen=True)
class Outcome:
    """How a run ends: its state with a reason, an outcome per analysis, and the summary as JSON text."""

    state: str
    reason: str | None
    outcomes: dict[str, str]
    summary: str
    warnings: tuple[str, ...]
    solver_version: str | None
    figures: str | None = None
    """Of the summary, what tables show (store/figures.py)."""


class TaskRepository:
    def __init__(self, session: Session):
        self.session = session

    # -- claiming and keeping

    def claim(self, task_id: str, worker: str, lease: float, max_attempts: int) -> Ticket | None:
        """The task, if it is queued or its worker has been silent beyond its lease; None if it is not to be had."""
        run = self._lock_run_of(task_id)
        return None if run is None else self._take(run, task_id, worker, lease, max_attempts)

    def claim_next(
        self,
        queue: str,
        worker: str,
        lease: float,
        max_attempts: int,
        up_to: int | None = None,
        most_running: int = 0,
    ) -> Ticket | None:
        """The most urgent queued task, of equals that of the smallest turn; with `up_to`, none of a larger priority number.

        most_running : a team with so many runs at work has no other begun (0: any number). Two workers that look at the
        same time may begin one more each.
        """
        full = self._full(most_running) if most_running else []
        for _ in range(NEXT_TRIES):
            found = self._most_urgent(queue, up_to, full, skip_locked=True) or self._most_urgent(queue, up_to, full)
            if found is None:
                return None
            ticket = self._take(*found, worker, lease, max_attempts)
            if ticket is not None:
                return ticket
        return None

    def _full(self, most_running: int) -> Sequence[str]:
        """Projects of the teams that have so many runs at work."""
        at_work = select(Project.team_id).join(Run, Run.project_id == Project.id).where(Run.state == RUNNING)
        teams = at_work.group_by(Project.team_id).having(func.count() >= most_running)
        return self.session.scalars(select(Project.id).where(Project.team_id.in_(teams))).all()

    def _most_urgent(
        self, queue: str, up_to: int | None, full: Sequence[str], skip_locked: bool = False
    ) -> tuple[Run, str] | None:
        query = (
            select(Run, Task.id)
            .join(Task, Task.run_id == Run.id)
            .where(Task.queue == queue, Task.state == QUEUED, Run.state.in_((QUEUED, RUNNING)))
            .order_by(Task.priority, Task.turn, Task.id)
            .limit(1)
            .with_for_update(of=Run, skip_locked=skip_locked)
            .execution_options(populate_existing=True)
        )
        if full:
            query = query.where((Run.state == RUNNING) | Run.project_id.not_in(full))
        if up_to is not None:
            query = query.where(Task.priority <= up_to)
        found = self.session.execute(query).one_or_none()
        return None if found is None else (found[0], found[1])

    def _take(self, run: Run, task_id: str, worker: str, lease: float, max_attempts: int) -> Ticket | None:
        if run.state not in (QUEUED, RUNNING):
            return None
        now = clock(self.session)
        free = (Task.state == QUEUED) | ((Task.state == RUNNING) & (Task.lease_until < now))
        taken = self.session.execute(
            update(Task)
            .where(Task.id == task_id, free, Task.attempt - Task.releases < max_attempts)
            .values(
                state=RUNNING,
                attempt=Task.attempt + 1,
                worker=worker[:200],
                lease_until=now + lease,
                heartbeat_at=now,
                claimed_at=now,
                message="",
            )
            .returning(Task.attempt, Task.weight, Task.queue)
            .execution_options(synchronize_session=False)
        ).one_or_none()
        if taken is None:
            return None
        if run.state == QUEUED:
            run.state, run.started_at = RUNNING, utc_now()
        return Ticket(task_id, run.id, taken.attempt, taken.weight, taken.queue)

    def job(self, ticket: Ticket) -> Job:
        """What the claimed task needs to be done."""
        options = (undefer(Task.checkpoint), undefer(Task.part))
        task = self.session.get_one(Task, ticket.task_id, options=options)
        run = self.session.get_one(Run, ticket.run_id)
        version = self.session.get_one(CaseVersion, run.case_version_id, options=[undefer(CaseVersion.canonical)])
        data = None if run.data_set_id is None else self.session.get(DataSet, run.data_set_id)
        count = self.session.scalar(select(func.count()).select_from(Task).where(Task.run_id == run.id))
        return Job(
            canonical=version.canonical,
            analyses=tuple(run.analyses),
            overrides=run.overrides,
            data=PinnedSource(data, stated=STATED in version.canonical or STATED in json.dumps(run.overrides)),
            chunk=Chunk.from_dict(task.chunk),
            checkpoint=task.checkpoint,
            part=task.part,
            alone=count == 1,
        )

    def beat(self, ticket: Ticket, lease: float, progress: float, message: str, checkpoint: bytes | None = None) -> str:
        """Renew the lease and report; gives the run's state, in which `cancelling` asks the worker to stop."""
        now = clock(self.session)
        values: dict[str, Any] = {"lease_until": now + lease, "heartbeat_at": now}
        values |= {"progress": progress, "message": message[:500]}
        if checkpoint is not None:
            values["checkpoint"] = checkpoint
        self._fenced(ticket, values)
        return self.session.scalar(select(Run.state).where(Run.id == ticket.run_id)) or CANCELLING

    # -- ending

    def hand_in(self, ticket: Ticket, part: bytes) -> bool:
        """Store this task's part. True if all the others are in: the task then stays claimed, to merge and complete.

        Of a run that was cancelled meanwhile nothing is stored: no worker might be left to end it.
        """
        run = self._lock_run_of(ticket.task_id)
        if run is not None and run.state == CANCELLING:
            self.give_up(ticket)
            return False
        others = select(func.count()).select_from(Task)
        others = others.where(Task.run_id == ticket.run_id, Task.id != ticket.task_id, Task.state != SUCCEEDED)
        last = not self.session.scalar(others)
        done: dict[str, Any] = {} if last else {"state": SUCCEEDED, "lease_until": None}
        done |= {"part": part, "checkpoint": None, "progress": 1.0, "message": "", "seconds": self._at_work()}
        self._fenced(ticket, done)
        return last

    def parts(self, run_id: str) -> Sequence[bytes]:
        """The parts of all tasks, in the order of the plan."""
        rows = self.session.scalars(select(Task.part).where(Task.run_id == run_id).order_by(Task.number))
        return [part for part in rows if part is not None]

    def complete(self, ticket: Ticket, outcome: Outcome) -> bool:
        """End the run with its results. False if it was cancelled meanwhile, and then ends so."""
        run = self._lock_run_of(ticket.task_id)
        if run is None:
            raise LostLeaseError("The run was deleted.")
        if run.state == CANCELLING:
            self.give_up(ticket)
            return False
        ended = {"state": SUCCEEDED, "lease_until": None, "progress": 1.0, "message": "", "seconds": self._at_work()}
        self._fenced(ticket, ended)
        self.session.execute(update(Task).where(Task.run_id == run.id).values(part=None, checkpoint=None))
        run.state, run.reason, run.outcomes = outcome.state, outcome.reason, outcome.outcomes
        run.summary, run.figures, run.solver_version = outcome.summary, outcome.figures, outcome.solver_version
        run.warnings = list(dict.fromkeys([*run.warnings, *outcome.warnings]))
        run.finished_at = utc_now()
        return True

    def fail(self, ticket: Ticket, reason: str, solver_version: str | None = None) -> None:
        """This task cannot be done, so neither can its run: end both, and its other tasks."""
        run = self._lock_run_of(ticket.task_id)
        if run is not None and run.state == CANCELLING:
            return self.give_up(ticket)
        self._fenced(ticket, {"state": FAILED, "reason": reason, "lease_until": None, "checkpoint": None})
        if run is not None:
            run.solver_version = solver_version or run.solver_version
            self._end(run, FAILED, reason)
        return None

    def give_up(self, ticket: Ticket) -> None:
        """The task was cancelled; with the last one at work the run is."""
        run = self._lock_run_of(ticket.task_id)
        self._fenced(ticket, {"state": CANCELLED, "lease_until": None, "checkpoint": None})
        self._cancelled(run)

    def release(self, ticket: Ticket, checkpoint: bytes | None) -> None:
        """Back to the queue, without counting the attempt: the worker shuts down in good order."""
        run = self._lock_run_of(ticket.task_id)
        if run is not None and run.state == CANCELLING:
            return self.give_up(ticket)
        values: dict[str, Any] = {"state": QUEUED, "releases": Task.releases + 1, "lease_until": None, "rung_at": 0.0}
        if checkpoint is not None:
            values["checkpoint"] = checkpoint
        self._fenced(ticket, values)
        return None

    def lost_early(self, ticket: Ticket, max_attempts: int) -> None:
        """The lease ended while its worker lived: an attempt that does not count. Called by that worker.

        At most EARLY times max_attempts attempts are made, so that a task that stops its worker's heartbeat each time
        ends at last.
        """
        again = (Task.attempt > ticket.attempt) | (Task.state == QUEUED)
        live = Task.state.in_((QUEUED, RUNNING)) & (Task.attempt >= ticket.attempt) & again
        few = Task.attempt < EARLY * max_attempts
        query = update(Task).where(Task.id == ticket.task_id, live, few).values(releases=Task.releases + 1)
        self.session.execute(query.execution_options(synchronize_session=False))

    # -- inside

    def _at_work(self) -> Any:
        """Seconds since the claim; what was handed in before counts to then."""
        return func.coalesce(Task.seconds, clock(self.session) - Task.claimed_at)

    def _lock_run_of(self, task_id: str) -> Run | None:
        query = select(Run).join(Task, Task.run_id == Run.id).where(Task.id == task_id)
        locked = query.with_for_update(of=Run).execution_options(populate_existing=True)
        return self.session.scalars(locked).one_or_none()

    def _fenced(self, ticket: Ticket, values: dict[str, Any]) -> None:
        mine = (Task.id == ticket.task_id) & (Task.attempt == ticket.attempt) & (Task.state == RUNNING)
        query = update(Task).where(mine).values(**values).returning(Task.id)
        if self.session.scalar(query.execution_options(synchronize_session=False)) is None:
            raise LostLeaseError(f"Attempt {ticket.attempt} no longer holds task {ticket.task_id}.")

    def _end(self, run: Run, state: str, reason: str | None) -> None:
        left = (Task.run_id == run.id) & Task.state.in_((QUEUED, RUNNING))
        self.session.execute(update(Task).where(left).values(state=CANCELLED, lease_until=None, checkpoint=None))
        run.state, run.reason, run.finished_at = state, reason, utc_now()
        run.outcomes = dict.fromkeys(run.analyses, state)

    def _cancelled(self, run: Run | None) -> None:
        if run is None:
            return
        working = select(func.count()).select_from(Task).where(Task.run_id == run.id, Task.state == RUNNING)
        if not self.session.scalar(working):
            self._end(run, CANCELLED, None)
