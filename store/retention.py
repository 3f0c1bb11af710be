"""Deletes ended runs after their time, a few at a time, so that nobody waits for it. Pinned runs stay.

Keys under which requests were sent are forgotten too, whether or not runs ever are.
"""

from __future__ import annotations

from .database import Database
from .repositories import IdempotencyRepository, QueueRepository
from .scope import Scope

BATCH, MOST = 50, 1_000_000


def sweep(database: Database, days: float, dry_run: bool = False, most: int | None = None) -> int:
    """Gives how many runs went, or would go."""
    if dry_run:
        with database.read() as session:
            return len(QueueRepository(session).outdated(days, MOST))
    with database.read() as session:
        found = QueueRepository(session).outdated(days, most or MOST)
    gone = 0
    for start in range(0, len(found), BATCH):
        with database.write() as session:
            gone += QueueRepository(session).remove(found[start : start + BATCH])
    if gone:
        with database.write() as session:
            QueueRepository(session).remove_empty_studies()
    forget_keys(database)
    return gone


def forget_keys(database: Database) -> None:
    """Forget the idempotency keys that nobody repeats any more."""
    with database.write() as session:
        IdempotencyRepository(session, Scope()).sweep()
