"""Which task is next: the smallest priority first, then the oldest.

A run is interactive when its estimate is small, so that somebody who waits for a frequency-domain answer never waits
for a study; studies come last. Interactive tasks are rung for at two doors: the workers', and that of a process that
takes nothing else, so that they need not wait for the task at hand either.
"""

from __future__ import annotations

from collections.abc import Iterable

from .broker import QUICK, RUNS

INTERACTIVE, NORMAL, BATCH = 10, 20, 30
NAMES = {"interactive": INTERACTIVE, "normal": NORMAL, "batch": BATCH}
QUICK_WEIGHT = 3.0
"""A run of at most so much work, in frequency-domain runs, is interactive by itself (solver/plan.py)."""

MOST_INTERACTIVE = 20
"""Tasks of one user that may wait as interactive; further small runs are normal until some have begun."""


def by_size(weights: Iterable[float]) -> int:
    return INTERACTIVE if sum(weights) <= QUICK_WEIGHT else NORMAL


def name_of(priority: int) -> str:
    """The class a number stands in."""
    return "interactive" if priority <= INTERACTIVE else "normal" if priority <= NORMAL else "batch"


def doors(queue: str, priority: int) -> tuple[str, ...]:
    """The message queues at which to ring for a task of this queue."""
    return (queue, QUICK) if queue == RUNS and priority <= INTERACTIVE else (queue,)
