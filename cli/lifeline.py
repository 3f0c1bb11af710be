"""Two pipes between the supervisor and each of its children.

The lifeline: when it ends, by whatever death of the supervisor, the children end too. The supervisor alone holds its
writing end; a child waits in a thread for the pipe to break. The pulse: the child writes a byte now and then, and is
replaced when it stops doing so. Works on any Unix.
"""

from __future__ import annotations

import contextlib
import os
import threading
import time

VARIABLE, PULSE = "SLOWDRIFT_LIFELINE", "SLOWDRIFT_PULSE"
BEAT_SECONDS = 1.0


def hold_on() -> None:
    """In a child: end this process once the supervisor is gone. Does nothing without a supervisor."""
    number = os.environ.pop(VARIABLE, "")
    if not number:
        return

    def wait() -> None:
        os.read(int(number), 1)
        os._exit(1)

    threading.Thread(target=wait, name="lifeline", daemon=True).start()


class Pulse:
    """In a child: signs of life to the supervisor. Does nothing without one."""

    def __init__(self) -> None:
        number = os.environ.pop(PULSE, "")
        self._pipe = int(number) if number else -1
        self._due = 0.0
        if self._pipe >= 0:
            os.set_blocking(self._pipe, False)

    def beat(self) -> None:
        """Call it often; it writes once a second."""
        now = time.monotonic()
        if self._pipe < 0 or now < self._due:
            return
        self._due = now + BEAT_SECONDS
        with contextlib.suppress(OSError):  # a full pipe: the supervisor has not looked yet
            os.write(self._pipe, b".")

    def keep_beating(self) -> None:
        """In a thread, until the process ends: a sign that the interpreter runs."""

        def beat() -> None:
            while True:
                self.beat()
                time.sleep(BEAT_SECONDS)

        if self._pipe >= 0:
            threading.Thread(target=beat, name="pulse", daemon=True).start()
