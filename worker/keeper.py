"""Keeps a claimed task alive while the solver works on it."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from types import TracebackType

from sqlalchemy.exc import SQLAlchemyError

from solver.outcome import Cancelled
from solver.results.part import Progress
from store.database import Database
from store.errors import LostLeaseError
from store.models import CANCELLING
from store.repositories import TaskRepository
from store.repositories.tasks import Ticket
from store.settings import Settings

log = logging.getLogger(__name__)


class Lost(Cancelled):
    """The lease is gone: stop, and write nothing."""


class Released(Cancelled):
    """The worker shuts down: stop, and give the task back."""


class Keeper:
    """A thread that renews the lease, reports progress and looks for reasons to stop.

    The solver's progress calls raise once there is one: Cancelled, Lost or Released. A lease that could not be renewed
    in time counts as lost, since another worker may have the task by then.
    """

    def __init__(self, database: Database, ticket: Ticket, settings: Settings, shutting_down: Callable[[], bool]):
        self._database, self._ticket, self._settings = database, ticket, settings
        self._shutting_down = shutting_down
        self._progress = Progress(0.0)
        self._saved_at = time.monotonic()
        self._unsaved: bytes | None = None
        self.checkpoint: bytes | None = None
        self._verdict: type[Cancelled] | None = None
        self._deadline = time.monotonic() + settings.lease_seconds
        self._halt = threading.Event()
        self._thread = threading.Thread(target=self._run, name="keeper", daemon=True)

    def __enter__(self) -> Keeper:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._halt.set()
        self._thread.join(5)

    def on_progress(self, progress: Progress) -> None:
        """The solver's callback, in its own thread, between blocks of its work."""
        self._progress = progress
        if self._shutting_down() and self._verdict is None:
            self._verdict = Released
        due = time.monotonic() - self._saved_at > self._settings.checkpoint_seconds
        if progress.checkpoint is not None and (due or self._verdict is Released):
            self.checkpoint = self._unsaved = progress.checkpoint()
            self._saved_at = time.monotonic()
        if self._verdict is not None:
            raise self._verdict

    def _run(self) -> None:
        while not self._halt.wait(self._settings.heartbeat_seconds):
            try:
                self._beat()
            except LostLeaseError:
                self._verdict = Lost
                return
            except SQLAlchemyError as error:
                log.warning("The lease of task %s could not be renewed: %s", self._ticket.task_id, error)
                if time.monotonic() > self._deadline:
                    self._verdict = Lost
                    return

    def _beat(self) -> None:
        progress, unsaved = self._progress, self._unsaved
        began = time.monotonic()
        with self._database.write() as session:
            state = TaskRepository(session).beat(
                self._ticket, self._settings.lease_seconds, progress.fraction, progress.message, unsaved
            )
        self._deadline = began + self._settings.lease_seconds
        if unsaved is self._unsaved:
            self._unsaved = None
        if state == CANCELLING:
            self._verdict = Cancelled
