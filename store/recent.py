"""Numbers that were counted a moment ago, so that a script that sends one request after another does not count anew."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Hashable
from typing import Any

SECONDS, KEPT = 5.0, 10_000


class Recent:
    """What was put here within SECONDS; of this process only."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._found: OrderedDict[Hashable, tuple[float, Any]] = OrderedDict()

    def get(self, key: Hashable) -> Any:
        """The value, or None."""
        with self._lock:
            at, value = self._found.get(key, (0.0, None))
        return value if value is not None and time.monotonic() - at < SECONDS else None

    def put(self, key: Hashable, value: Any) -> None:
        """A value that has just been counted."""
        with self._lock:
            self._found[key] = (time.monotonic(), value)
            self._found.move_to_end(key)
            while len(self._found) > KEPT:
                self._found.popitem(last=False)

    def change(self, key: Hashable, value: Any) -> None:
        """Another value that is as old as the one it replaces; nothing where there is none."""
        with self._lock:
            if key in self._found:
                self._found[key] = (self._found[key][0], value)
