"""Puts right what faults leave behind: lost messages, lost workers. Safe to run in several processes at once."""

from __future__ import annotations

import logging
import math
import threading
import time

from sqlalchemy.exc import SQLAlchemyError

from . import retention
from .database import Database
from .doorbell import Doorbell
from .repositories import PreviewRepository, RecoveryRepository
from .settings import Settings

BATCH = 100
SOME, FEW = 16, 2
"""Tasks rung for in a round when nobody works, and when workers that live go from task to task by themselves."""
SWEEP_SECONDS, SWEEP_MOST = 600.0, 2000
log = logging.getLogger(__name__)


def reconcile(database: Database, doorbell: Doorbell, settings: Settings) -> int:
    """One round; gives the number of tasks rung for."""
    with database.read() as session:
        expired = RecoveryRepository(session).expired(BATCH, settings.lease_seconds)
    for task_id in expired:
        with database.write() as session:
            RecoveryRepository(session).settle_expired(task_id, settings.max_attempts, settings.lease_seconds)
    with database.write() as session:
        recovery = RecoveryRepository(session)
        due = recovery.ring_stale(settings.stale_seconds, FEW if recovery.at_work() else SOME)
        PreviewRepository(session).sweep()
    doorbell.ring(due)
    return len({task_id for task_id, _ in due})


class Reconciler(threading.Thread):
    """Rounds at an interval until stopped; a round that fails is told in the log and tried again."""

    def __init__(self, database: Database, doorbell: Doorbell, settings: Settings):
        super().__init__(name="reconciler", daemon=True)
        self._context = (database, doorbell, settings)
        self._interval = settings.reconcile_seconds
        self._swept_at = -math.inf
        self._halt = threading.Event()

    def run(self) -> None:
        while not self._halt.is_set():
            try:
                reconcile(*self._context)
                self._sweep()
            except SQLAlchemyError as error:
                log.warning("The reconciler could not reach the database: %s", error)
            except Exception:
                log.exception("A round of the reconciler failed")
            self._halt.wait(self._interval)

    def _sweep(self) -> None:
        database, _, settings = self._context
        if time.monotonic() - self._swept_at <= SWEEP_SECONDS:
            return
        self._swept_at = time.monotonic()
        if not settings.retention_days:
            retention.forget_keys(database)
        elif gone := retention.sweep(database, settings.retention_days, most=SWEEP_MOST):
            log.info("%d runs older than %g days deleted", gone, settings.retention_days)

    def stop(self) -> None:
        self._halt.set()
        self.join(5)
