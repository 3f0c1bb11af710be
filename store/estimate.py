"""How long a run has still to go: an estimate from what like work took here, and from what waits before it.

Weights are the planner's (solver/plan.py); seconds per weight come from the run's own progress once it has some, else
from the study's finished runs, else from the last tasks that any run finished. Nothing of the kind yet: no estimate.
"""

from __future__ import annotations

import bisect
import math
import threading
import time
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import accumulate

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from .broker import RUNS
from .clock import clock
from .models import HYDRODYNAMICS, QUEUED, RUNNING, SUCCEEDED, Run, Task

FRESH_SECONDS = 2.0
RECENT, WAITING = 200, 50_000
OWN_SHARE = 0.05
"""A run's own progress counts from here."""


@dataclass(frozen=True)
class Amount:
    """What the tasks of a run, or of a study, add up to; weights, seconds and numbers of tasks."""

    total: float = 0.0
    done: float = 0.0
    at_work: int = 0
    tasks: int = 0
    seconds: float = 0.0
    """Spent on what is done."""
    first: tuple[int, str] | None = None
    """Priority and id of the first task that waits."""


@dataclass
class Snapshot:
    """The queue as it was a moment ago."""

    taken_at: float = -math.inf
    rates: dict[str | None, float] = field(default_factory=dict)
    """Seconds per weight, of each study, of hydrodynamic jobs (whose weights are seconds) and (None) of all others."""
    waiting: list[tuple[int, str]] = field(default_factory=list)
    before: list[float] = field(default_factory=lambda: [0.0])
    """Weight of the tasks before each of `waiting`."""
    workers: int = 1

    def left(self, amount: Amount, study_id: str | None) -> float | None:
        """Seconds until it ends, in two digits; None where there is no ground for an estimate."""
        rate = self._rate(amount, study_id)
        if rate is None:
            return None
        rest = max(0.0, amount.total - amount.done) * rate
        if amount.at_work:
            return _two_digits(rest / amount.at_work)
        ahead = 0.0
        if amount.first is not None:
            ahead = self.before[bisect.bisect_left(self.waiting, amount.first)] * self.rates.get(None, rate)
        return _two_digits(ahead / self.workers + rest / max(1, min(self.workers, amount.tasks)))

    def _rate(self, amount: Amount, study_id: str | None) -> float | None:
        if amount.total > 0 and amount.done > OWN_SHARE * amount.total and amount.seconds > 0:
            return amount.seconds / amount.done
        return self.rates.get(study_id, self.rates.get(None))


def _two_digits(seconds: float) -> float:
    """Rounded up; more would promise what is not known."""
    if seconds <= 0:
        return 0.0
    step = 10.0 ** (math.floor(math.log10(seconds)) - 1)
    return round(math.ceil(seconds / step - 1e-9) * step, 6)


_kept: dict[str, Snapshot] = {}
_lock = threading.Lock()


def snapshot(session: Session) -> Snapshot:
    """The queue's, at most two seconds old and shared by the process; taken by one request while others use the old."""
    key = str(session.get_bind().engine.url)
    known = _kept.get(key)
    if known is not None and time.monotonic() - known.taken_at < FRESH_SECONDS:
        return known
    if not _lock.acquire(blocking=known is None):
        return known or Snapshot()
    try:
        _kept[key] = _take(session)
        return _kept[key]
    finally:
        _lock.release()


def _take(session: Session) -> Snapshot:
    made = Snapshot(time.monotonic())
    recent = select(Task.id).where(Task.queue == RUNS, Task.state == SUCCEEDED, Task.seconds.is_not(None))
    recent = recent.order_by(Task.id.desc()).limit(RECENT)
    spent: defaultdict[str | None, list[float]] = defaultdict(lambda: [0.0, 0.0])
    query = select(Run.study_id, Task.seconds, Task.weight).join(Task, Task.run_id == Run.id)
    for study_id, seconds, weight in session.execute(query.where(Task.id.in_(recent))):
        for key in {study_id, None}:
            spent[key][0] += seconds or 0.0
            spent[key][1] += weight
    made.rates = {key: seconds / weight for key, (seconds, weight) in spent.items() if weight > 0}
    made.rates[HYDRODYNAMICS] = 1.0
    waiting = select(Task.priority, Task.id, Task.weight).where(Task.queue == RUNS, Task.state == QUEUED)
    rows = session.execute(waiting.order_by(Task.priority, Task.id).limit(WAITING)).all()
    made.waiting = [(row.priority, row.id) for row in rows]
    made.before = [0.0, *accumulate(row.weight for row in rows)]
    fresh = Task.heartbeat_at > clock(session) - 30.0
    working = select(func.count()).select_from(Task).where(Task.state == RUNNING, fresh)
    made.workers = max(1, session.scalar(working) or 0)
    return made
