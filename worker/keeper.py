"""Keeps a claimed task alive while the solver works on it, and within its limits."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType

import psutil
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from solver.outcome import Cancelled
from solver.results.part import Progress
from store.database import Database
from store.errors import LostLeaseError
from store.models import CANCELLING
from store.repositories import TaskRepository
from store.repositories.tasks import Ticket
from store.settings import Settings

log = logging.getLogger(__name__)
TICK_SECONDS = 0.25
GRACE_SECONDS = 15.0
"""A computation that does not heed its verdict for so long ends with its process."""
FAR_BEYOND = 1.25
"""Times the memory limit at which nothing is waited for."""
EXIT_STATUS = 70


class Lost(Cancelled):
    """The lease is gone: stop, and write nothing."""


class Released(Cancelled):
    """The worker shuts down: stop, and give the task back."""


class Exceeded(Cancelled):
    """A limit of time or memory is passed: stop, and fail with the reason."""


@dataclass(frozen=True)
class Limits:
    """What one attempt may use."""

    seconds: float
    memory_mb: float

    def passed(self, seconds: float, memory_mb: float) -> str | None:
        """The reason to stop, if there is one."""
        if memory_mb > self.memory_mb:
            return (
                f"The computation needed more than {self.memory_mb:.0f} MB of memory, so it was ended. Make the case "
                "smaller (fewer elements, seeds or stored samples), or raise SLOWDRIFT_TASK_MEMORY_MB."
            )
        if seconds > self.seconds:
            return (
                f"The computation took longer than {self.seconds:.0f} s, many times its estimate, so it was ended. "
                "Make the case smaller, or raise SLOWDRIFT_TASK_TIMEOUT_SECONDS."
            )
        return None


class Keeper:
    """A thread that renews the lease, reports progress and looks for reasons to stop.

    The solver's progress calls raise once there is one: Cancelled, Lost, Released or Exceeded. A lease that could not
    be renewed in time counts as lost, since another worker may have the task by then. Where the solver makes no more
    progress calls, the row is ended from here and the process with it: its parent starts another.
    """

    def __init__(
        self,
        database: Database,
        ticket: Ticket,
        settings: Settings,
        shutting_down: Callable[[], bool],
        limits: Limits,
        leave: Callable[[int], None] = os._exit,
    ):
        self._database, self._ticket, self._settings = database, ticket, settings
        self._shutting_down, self._limits, self._leave = shutting_down, limits, leave
        self._progress = Progress(0.0)
        self._began = self._saved_at = time.monotonic()
        self._unsaved: bytes | None = None
        self.checkpoint: bytes | None = None
        self.reason = ""
        self.writing = False
        """Set while results are written: there is nothing left to stop."""
        self._verdict: type[Cancelled] | None = None
        self._judged_at = 0.0
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
            self._judge(Released)
        due = time.monotonic() - self._saved_at > self._settings.checkpoint_seconds
        if progress.checkpoint is not None and (due or self._verdict is Released):
            self.checkpoint = self._unsaved = progress.checkpoint()
            self._saved_at = time.monotonic()
        if self._verdict is not None:
            self.writing = True
            raise self._verdict

    def _judge(self, verdict: type[Cancelled]) -> None:
        self._verdict, self._judged_at = verdict, time.monotonic()

    def _run(self) -> None:
        beat_at = time.monotonic() + self._settings.heartbeat_seconds
        while not self._halt.wait(min(TICK_SECONDS, self._settings.heartbeat_seconds)):
            if not self.writing:
                self._look_at_limits()
                self._force()
            if self._verdict is not Lost and time.monotonic() >= beat_at:
                self._try_to_beat()
                beat_at = time.monotonic() + self._settings.heartbeat_seconds

    def _look_at_limits(self) -> None:
        memory = psutil.Process().memory_info().rss / 2**20
        reason = self._limits.passed(time.monotonic() - self._began, memory)
        if reason is None or self._verdict is Lost:
            return
        if self._verdict is not Exceeded:
            self.reason = reason
            self._judge(Exceeded)
        if memory > FAR_BEYOND * self._limits.memory_mb:
            self._judged_at = 0.0  # it may take the machine with it: do not wait

    def _force(self) -> None:
        if self._verdict is None or self._verdict is Released or time.monotonic() - self._judged_at < GRACE_SECONDS:
            return
        log.error("Task %s does not stop (%s); its process ends", self._ticket.task_id, self._verdict.__name__)
        try:
            with self._database.write() as session:
                self._end_row(session)
        except (SQLAlchemyError, LostLeaseError) as error:
            log.warning("The row of task %s was not ended: %s", self._ticket.task_id, error)
        self._halt.set()
        self._leave(EXIT_STATUS)

    def _end_row(self, session: Session) -> None:
        tasks = TaskRepository(session)
        if self._verdict is Exceeded:
            tasks.fail(self._ticket, self.reason)
        elif self._verdict is not Lost:
            tasks.give_up(self._ticket)

    def _try_to_beat(self) -> None:
        try:
            self._beat()
        except LostLeaseError:
            self._judge(Lost)
        except SQLAlchemyError as error:
            log.warning("The lease of task %s could not be renewed: %s", self._ticket.task_id, error)
            if time.monotonic() > self._deadline:
                self._judge(Lost)

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
        if state == CANCELLING and self._verdict is None:
            self._judge(Cancelled)
