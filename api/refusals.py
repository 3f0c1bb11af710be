"""What the limits of teams refused of late, so that a team can see it: of this process, in memory."""

from __future__ import annotations

import threading
from collections import OrderedDict, deque
from datetime import datetime

from store.clock import utc_now

KEPT, TEAMS = 20, 1000


class Refusals:
    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._found: OrderedDict[str, deque[tuple[datetime, str]]] = OrderedDict()

    def add(self, team_id: str, detail: str) -> None:
        with self._lock:
            self._found.setdefault(team_id, deque(maxlen=KEPT)).appendleft((utc_now(), detail))
            self._found.move_to_end(team_id)
            while len(self._found) > TEAMS:
                self._found.popitem(last=False)

    def of(self, team_id: str) -> list[tuple[datetime, str]]:
        """The last ones, newest first."""
        with self._lock:
            return list(self._found.get(team_id, ()))
