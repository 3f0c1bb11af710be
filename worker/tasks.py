"""The only place where Celery meets the solver: two tasks by name, and what a worker's child does at its start."""

from __future__ import annotations

import importlib
import logging
from functools import cache
from typing import Any

from celery.signals import worker_process_init, worker_shutting_down

from store.broker import PREVIEW_TASK, RUN_TASK
from store.database import Database
from store.doorbell import Doorbell
from store.reconcile import reconcile
from store.repositories import RecoveryRepository

from . import process
from .app import app, settings
from .execute import Worker, execute
from .preview import answer_preview

log = logging.getLogger(__name__)


@app.task(name=RUN_TASK)
def run_task(task_id: str) -> None:
    log.info("Task %s: %s", task_id, execute(_worker(), task_id))


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
def _worker() -> Worker:
    return Worker(_database(), _solver(), settings, process.worker_name(), process.shutting_down)


@worker_shutting_down.connect
def _on_shutdown(**_: Any) -> None:
    process.announce_shutdown()


@worker_process_init.connect
def _on_child_start(**_: Any) -> None:
    process.die_with_parent()
    try:
        _clear_up_after_the_dead()
    except Exception:
        log.exception("Could not look for tasks of workers that died on this host")
    with process.one_at_a_time(settings.data_dir / "warm-up.lock"):  # the others then load what the first compiled
        warm_up = getattr(_solver(), "warm_up", None)
        if warm_up is not None:
            warm_up()


def _clear_up_after_the_dead() -> None:
    """A child that takes the place of a killed one frees its task now, not when the lease runs out."""
    with _database().read() as session:
        held = RecoveryRepository(session).held_by(process.host_prefix())
    dead = [(task_id, worker) for task_id, worker in held if process.is_dead(worker)]
    if not dead:
        return
    with _database().write() as session:
        RecoveryRepository(session).expire([task_id for task_id, _ in dead], {worker for _, worker in dead})
    reconcile(_database(), Doorbell(settings), settings)
