"""The schema's history, run from an installed package: `slowdrift migrate`, or `upgrade()` here."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from sqlalchemy import text
from sqlalchemy.exc import DatabaseError

from ..database import Database

if TYPE_CHECKING:
    from alembic.config import Config

HEAD = "0008"
"""The newest revision; a constant, so that asking whether a database is current loads no Alembic."""
_LOCK = 7_345_001  # any number of our own: one migration at a time on a PostgreSQL server's database


def _config(database: Database) -> Config:
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", "store:migrations")
    config.attributes["engine"] = database.engine
    return config


def upgrade(database: Database, revision: str = "head") -> None:
    """Bring the schema up; safe to call from several processes at once on PostgreSQL."""
    from alembic import command

    if database.engine.dialect.name != "postgresql":
        return command.upgrade(_config(database), revision)
    with database.engine.connect() as connection:
        # asked again and again: an index made CONCURRENTLY waits for every statement, so for one that waits for the lock
        while not connection.scalar(text("SELECT pg_try_advisory_lock(:key)"), {"key": _LOCK}):
            connection.rollback()
            time.sleep(0.2)
        connection.commit()
        try:
            command.upgrade(_config(database), revision)
        finally:
            connection.execute(text("SELECT pg_advisory_unlock(:key)"), {"key": _LOCK})
    return None


def downgrade(database: Database, revision: str = "base") -> None:
    from alembic import command

    command.downgrade(_config(database), revision)


def is_current(database: Database) -> bool:
    """Whether the database is at the newest revision."""
    try:
        with database.engine.connect() as connection:
            return connection.scalar(text("SELECT version_num FROM alembic_version")) == HEAD
    except DatabaseError:  # no such table: never migrated
        return False
