"""Deletes ended runs after their time, a few at a time, so that nobody waits for it. Pinned runs stay."""

from __future__ import annotations

from .database import Database
from .repositories import IdempotencyRepository, QueueRepository
from .scope import Scope

BATCH = 50


def sweep(database: Database, days: float, dry_run: bool = False, most: int | None = None) -> int:
    """Gives how many runs went, or would go."""
    if dry_run:
        with database.read() as session:
            return len(QueueRepository(session).outdated(days, 1_000_000))
    gone = 0
    while most is None or gone < most:
        with database.write() as session:
            queues = QueueRepository(session)
            found = queues.outdated(days, BATCH)
            gone += queues.remove(found)
        if len(found) < BATCH:
            break
    with database.write() as session:
        IdempotencyRepository(session, Scope()).sweep()
    return gone
