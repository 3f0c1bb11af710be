"""The only place where Celery meets the solver: two tasks by name, and what a worker's child does at its start."""

from __future__ import annotations

import importlib
import logging
from collections.abc import Iterable
from functools import cache
from typing import Any

from celery.signals import worker_process_init, worker_shutting_down
from sqlalchemy.exc import OperationalError

from store import priority
from store.broker import PREVIEW_TASK, QUICK, RUNS, WORK_TASK
from store.database import Database
from store.doorbell import Doorbell
from store.repositories import RecoveryRepository

from . import process
from .app import app, settings
from .execute import Worker, execute_next
from .preview import answer_preview

log = logging.getLogger(__name__)
MARGIN = 1.5
"""Allocations fail at so many times the memory of a task; before, its keeper ends it with a better reason."""


@app.task(name=WORK_TASK)
def work(queue: str) -> None:
    """A message says that something waits; what is next, the database knows. Goes on until nothing is left."""
    if queue != QUICK:
        return _go_on(queue, None)
    with process.only_one(settings.data_dir / "quick.lock") as alone:  # the other process stays free for previews
        if alone:
            _go_on(RUNS, priority.INTERACTIVE)
    return None


def _go_on(queue: str, up_to: int | None) -> None:
    try:
        while not process.shutting_down() and (done := execute_next(_worker(), queue, up_to)) is not None:
            log.info("Task %s: %s", *done)
            if process.memory_mb() > settings.worker_memory_mb:
                _ring([queue])  # Celery replaces this process after the message; the next one goes on
                return
    except OperationalError as error:
        log.warning("The database is away (%s); messages will come again", error)


@app.task(name=PREVIEW_TASK)
def preview(preview_id: str) -> None:
    log.info("Preview %s: %s", preview_id, answer_preview(_database(), _solver(), settings, preview_id))


@cache
def _database() -> Database:
    return Database(settings.database)


@cache
def _solver() -> Any:
    return importlib.import_module(settings.solver)


@cache
def _identity() -> process.Identity:
    return process.Identity(settings.data_dir / "workers")


@cache
def _worker() -> Worker:
    return Worker(_database(), _solver(), settings, _identity().name, process.shutting_down)


@worker_shutting_down.connect
def _on_shutdown(**_: Any) -> None:
    process.announce_shutdown()


@worker_process_init.connect
def _on_child_start(**_: Any) -> None:
    process.die_with_parent()
    process.bound_memory(MARGIN * settings.task_memory_mb)
    try:
        _clear_up_after_the_dead()
    except Exception:
        log.exception("Could not look for tasks of workers that ended")
    with process.one_at_a_time(settings.data_dir / "warm-up.lock"):  # the others then load what the first compiled
        warm_up = getattr(_solver(), "warm_up", None)
        if warm_up is not None:
            warm_up()


def _clear_up_after_the_dead() -> None:
    """A child that takes the place of a killed one frees its task now, not when the lease runs out, and rings."""
    ended = process.ended(settings.data_dir / "workers")
    with _database().read() as session:
        held = RecoveryRepository(session).held()
    dead = [(task_id, worker) for task_id, worker in held if process.id_of(worker) in ended]
    if dead:
        with _database().write() as session:
            RecoveryRepository(session).expire([task_id for task_id, _ in dead], {worker for _, worker in dead})
        for task_id, _ in dead:
            with _database().write() as session:
                RecoveryRepository(session).settle_expired(task_id, settings.max_attempts, settings.lease_seconds)
    for path in ended.values():
        path.unlink(missing_ok=True)
    with _database().read() as session:
        _ring(RecoveryRepository(session).waiting())


def _ring(doors: Iterable[str]) -> None:
    bell = Doorbell(settings)
    bell.ring([("", door) for door in doors])
    bell.close()
