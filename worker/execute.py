"""One task from claim to final state. Knows no Celery: it gets a database, a solver and the id of a row."""

from __future__ import annotations

import contextlib
import json
import logging
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
from sqlalchemy.exc import OperationalError
from sqlalchemy.orm import Session

from solver.case import Case
from solver.outcome import Cancelled, SlowdriftError
from solver.results.part import Chunk, OnProgress, Part, Result
from solver.vessel.data import DataSource
from store.broker import HYDRODYNAMICS
from store.database import Database
from store.effective import solver_version, stored_case
from store.errors import LostLeaseError
from store.estimate import snapshot
from store.figures import figures_text
from store.logs import about
from store.models import FAILED, SUCCEEDED
from store.repositories import ChannelRepository, TaskRepository
from store.repositories.hydrodynamics import Assignment, HydrodynamicTasks
from store.repositories.tasks import Job, Outcome, Ticket
from store.settings import Settings

from . import hydrodynamics
from .keeper import Exceeded, Keeper, Limits, Lost, Released

log = logging.getLogger(__name__)
UNKNOWN_RATE = 30.0
"""Seconds that a frequency-domain run is thought to take where none has been seen."""
RATES = {HYDRODYNAMICS: 1.0}
"""Seconds per weight where weights are seconds by themselves: a hydrodynamic job's is its estimate."""
Answer = TypeVar("Answer")


class Solver(Protocol):
    """The doors of solver.run that a worker uses."""

    def run_chunk(
        self,
        case: Case,
        data: DataSource,
        chunk: Chunk,
        checkpoint: bytes | None = None,
        on_progress: OnProgress | None = None,
    ) -> Part: ...

    def merge(self, case: Case, parts: Sequence[Part]) -> Result: ...


@dataclass(frozen=True)
class Worker:
    """What every task of a process shares."""

    database: Database
    solver: Solver
    settings: Settings
    name: str
    shutting_down: Callable[[], bool] = lambda: False
    leave: Callable[[int], None] = os._exit
    """How the process ends when a computation does not stop."""


def execute(worker: Worker, task_id: str) -> str:
    """Do this task if it is to be had. Gives a word on how it went, for the log; the row has the truth."""
    with worker.database.write() as session:
        ticket = TaskRepository(session).claim(
            task_id, worker.name, worker.settings.lease_seconds, worker.settings.max_attempts
        )
    return "not to be had" if ticket is None else _kept(worker, ticket)


def execute_next(worker: Worker, queue: str, up_to: int | None = None) -> tuple[str, str] | None:
    """Do the most urgent task of the queue; id and word. None when nothing waits (of priority number `up_to`)."""
    with worker.database.write() as session:
        settings = worker.settings
        ticket = TaskRepository(session).claim_next(
            queue, worker.name, settings.lease_seconds, settings.max_attempts, up_to, settings.quota_running_runs
        )
    return None if ticket is None else (ticket.task_id, _kept(worker, ticket))


def _kept(worker: Worker, ticket: Ticket) -> str:
    with about(run_id=ticket.run_id, task_id=ticket.task_id, attempt=ticket.attempt):
        limits = _limits(worker, ticket)
        try:
            with Keeper(worker.database, ticket, worker.settings, worker.shutting_down, limits, worker.leave) as keeper:
                return _attempt(worker, ticket, keeper)
        except (Lost, LostLeaseError) as error:
            log.warning("The lease of this task ended before its work: %s", error)
            with contextlib.suppress(OperationalError), worker.database.write() as session:
                TaskRepository(session).lost_early(ticket, worker.settings.max_attempts)
            return "lost"


def _limits(worker: Worker, ticket: Ticket) -> Limits:
    """Time by the estimate of the task, with much to spare; memory by the setting."""
    settings = worker.settings
    with worker.database.read() as session:
        rate = RATES.get(ticket.queue) or snapshot(session).rates.get(None, UNKNOWN_RATE)
    seconds = max(settings.task_timeout_seconds, settings.timeout_factor * rate * ticket.weight)
    return Limits(seconds, settings.task_memory_mb)


def _attempt(worker: Worker, ticket: Ticket, keeper: Keeper) -> str:
    try:
        return _compute(worker, ticket, keeper)
    except Exceeded:
        return _fail(worker, ticket, keeper.reason)
    except Released:
        _persist(worker, lambda session: TaskRepository(session).release(ticket, keeper.checkpoint))
        return "released"
    except (Lost, LostLeaseError):
        raise
    except Cancelled:
        _persist(worker, lambda session: TaskRepository(session).give_up(ticket))
        return "cancelled"
    except SlowdriftError as error:
        return _fail(worker, ticket, str(error))
    except MemoryError:
        return _fail(worker, ticket, "The computation ran out of memory; make the case smaller or give workers more.")
    except OperationalError:
        log.exception("Task %s lost the database; its lease will run out and it will be tried again", ticket.task_id)
        return "no database"
    except Exception as error:
        log.exception("Task %s of run %s failed unexpectedly", ticket.task_id, ticket.run_id)
        kind = type(error).__name__
        return _fail(
            worker, ticket, f"An error inside Slowdrift ({kind}); the worker's log has it under {ticket.run_id}."
        )


def _compute(worker: Worker, ticket: Ticket, keeper: Keeper) -> str:
    with worker.database.read() as session:
        assignment = HydrodynamicTasks(session).assignment(ticket)
        if assignment is None:
            job = TaskRepository(session).job(ticket)
    if assignment is not None:
        return _hydrodynamics(worker, ticket, keeper, assignment)
    case = stored_case(job.canonical, job.analyses, job.overrides)
    if job.part is None:
        part = worker.solver.run_chunk(case, job.data, job.chunk, job.checkpoint, keeper.on_progress)
        if not job.alone:
            payload = part.to_bytes()
            keeper.writing = True
            if not _persist(worker, lambda session: TaskRepository(session).hand_in(ticket, payload)):
                return "handed in"
    keeper.writing = False
    parts = [part] if job.alone and job.part is None else _parts(worker, ticket)
    result = worker.solver.merge(case, parts)
    outcome = conclude(result, job)
    keeper.writing = True

    def complete(session: Session) -> bool:
        tasks = TaskRepository(session)
        if not tasks.complete(ticket, outcome):
            return False
        ChannelRepository(session).put(ticket.run_id, result.channels)
        return True

    return outcome.state if _persist(worker, complete) else "cancelled"


def _hydrodynamics(worker: Worker, ticket: Ticket, keeper: Keeper, assignment: Assignment) -> str:
    name, made, summary, warnings = hydrodynamics.compute(assignment, worker.settings.data_dir, keeper.on_progress)
    text = to_json({hydrodynamics.ANALYSIS: summary | {"data_set": made.summary}})
    outcome = Outcome(
        SUCCEEDED, None, {hydrodynamics.ANALYSIS: SUCCEEDED}, text, warnings, solver_version() or "unknown"
    )
    keeper.writing = True

    def complete(session: Session) -> bool:
        return HydrodynamicTasks(session).complete(ticket, outcome, name, made)

    return SUCCEEDED if _persist(worker, complete) else "cancelled"


def _parts(worker: Worker, ticket: Ticket) -> list[Part]:
    with worker.database.read() as session:
        return [Part.from_bytes(payload) for payload in TaskRepository(session).parts(ticket.run_id)]


def conclude(result: Result, job: Job) -> Outcome:
    """State, reason and an outcome per analysis. An analysis that neither failed nor answered was skipped."""
    failures = result.failures
    outcomes = {
        name: FAILED if name in failures else SUCCEEDED if name in result.summary else "skipped"
        for name in job.analyses
    }
    reason = " ".join(f"{name}: {words}" for name, words in failures.items()) or None
    text = to_json(result.summary)
    return Outcome(
        state=FAILED if failures else SUCCEEDED,
        reason=reason,
        outcomes=outcomes,
        summary=text,
        warnings=tuple(str(text) for text in result.summary.get("warnings", ())),
        solver_version=str(result.summary.get("provenance", {}).get("solver_version") or solver_version() or "unknown"),
        figures=figures_text(json.loads(text)),
    )


def to_json(value: Any) -> str:
    """JSON without NaN or infinity: a result that holds one is no result."""
    try:
        return json.dumps(value, allow_nan=False, default=_plain)
    except ValueError:
        raise SlowdriftError("The result holds a number that is not finite; this is an error in Slowdrift.") from None


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no place in a summary")


def _fail(worker: Worker, ticket: Ticket, reason: str) -> str:
    _persist(worker, lambda session: TaskRepository(session).fail(ticket, reason, solver_version()))
    return "failed"


def _persist(worker: Worker, write: Callable[[Session], Answer]) -> Answer:
    """One unit of work, tried again while the database is away; the fence makes repeating it safe."""
    patience, pause = time.monotonic() + worker.settings.lease_seconds, 0.5
    while True:
        try:
            with worker.database.write() as session:
                return write(session)
        except OperationalError as error:
            if time.monotonic() > patience:
                raise
            log.warning("The database did not take a result (%s); trying again", error)
            time.sleep(pause)
            pause = min(2 * pause, 4.0)
