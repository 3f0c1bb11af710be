"""Sends the messages. A lost one is harmless: the reconciler rings again."""

from __future__ import annotations

import logging
import queue
import threading
from collections import Counter
from collections.abc import Iterable

from celery import Celery

from .broker import INTERACTIVE, PREVIEW_TASK, WORK_TASK, celery_config, queue_name
from .settings import Settings

AT_ONCE = {"max_retries": 1, "interval_start": 0, "interval_step": 0, "interval_max": 0, "connect_retries_timeout": 1}
WAITING = 10_000
AT_A_DOOR = 32
"""Messages sent at once to one queue: whoever hears one works until nothing is left, so there need not be one a task."""
log = logging.getLogger(__name__)


class Doorbell:
    """Enqueues by task name: whoever sends needs none of the worker's code.

    A thread of its own does the sending, so that a broker that is away delays no request.
    """

    def __init__(self, settings: Settings):
        self.settings = settings
        self.last_error: str | None = None
        self.sent = self.failed = 0
        """Messages that the broker took, and did not take, since the start."""
        self._app = Celery("slowdrift-sender", set_as_current=False)
        config = celery_config(settings)
        self._app.conf.update(config | {"broker_transport_options": config["broker_transport_options"] | AT_ONCE})
        self._waiting: queue.Queue[tuple[str, str, str] | None] = queue.Queue(WAITING)
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()

    def ring(self, tasks: Iterable[tuple[str, str]]) -> None:
        """Say that these tasks (id, queue) wait: their rows are committed. Never raises, never waits."""
        for name, count in Counter(name for _, name in tasks).items():
            for _ in range(min(count, AT_A_DOOR)):
                self._put((WORK_TASK, name, name))

    def ring_preview(self, preview_id: str) -> None:
        self._put((PREVIEW_TASK, preview_id, INTERACTIVE))

    def reachable(self) -> str | None:
        """None if the broker answers, else why not."""
        try:
            with self._app.connection_for_write() as connection:
                connection.ensure_connection(max_retries=1, interval_start=0, interval_step=0, timeout=3)
        except Exception as error:
            return f"{type(error).__name__}: {error}"[:300]
        return None

    @property
    def waiting(self) -> int:
        """Messages that are still to be sent."""
        return self._waiting.qsize()

    def close(self) -> None:
        """Send what still waits, for a moment, then stop."""
        if self._thread is not None:
            self._put(None)
            self._thread.join(2)
        self._app.close()

    def _put(self, message: tuple[str, str, str] | None) -> None:
        with self._lock:
            if self._thread is None:
                self._thread = threading.Thread(target=self._send_all, name="doorbell", daemon=True)
                self._thread.start()
        try:
            self._waiting.put_nowait(message)
        except queue.Full:
            log.warning("More messages wait for the broker than are kept; the rest will be sent again later.")

    def _send_all(self) -> None:
        while (message := self._waiting.get()) is not None:
            name, key, to = message
            try:
                self._app.send_task(
                    name, args=(key,), queue=queue_name(self.settings, to), retry=False, ignore_result=True
                )
                self.last_error = None
                self.sent += 1
            except Exception as error:  # whatever a transport raises: the row is the truth
                self.last_error = f"{type(error).__name__}: {error}"[:300]
                self.failed += 1
                log.warning("The broker did not take the message for %s (%s); it will be sent again.", key, error)
