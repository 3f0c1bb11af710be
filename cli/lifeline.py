"""A pipe from the supervisor to its children: when it ends, by whatever death, they end too.

Works on any Unix. The supervisor alone holds the writing end; a child waits in a thread for the pipe to break.
"""

from __future__ import annotations

import os
import threading

VARIABLE = "SLOWDRIFT_LIFELINE"


def hold_on() -> None:
    """In a child: end this process once the supervisor is gone. Does nothing without a supervisor."""
    number = os.environ.pop(VARIABLE, "")
    if not number:
        return

    def wait() -> None:
        os.read(int(number), 1)
        os._exit(1)

    threading.Thread(target=wait, name="lifeline", daemon=True).start()
