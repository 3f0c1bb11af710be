"""The real migrations, up and down, and equal to the models."""

from __future__ import annotations

import pytest
from alembic import command
from alembic.script import ScriptDirectory
from sqlalchemy import inspect, select, text

from store import migrations
from store.database import Database
from store.models import DEFAULT_PROJECT, DEFAULT_TEAM, Project


def test_up_down_up(empty: Database) -> None:
    assert not migrations.is_current(empty)
    migrations.upgrade(empty)
    assert migrations.is_current(empty)
    command.check(migrations._config(empty))  # the models hold nothing that the migrations do not make
    migrations.downgrade(empty)
    assert set(inspect(empty.engine).get_table_names()) <= {"alembic_version"}
    migrations.upgrade(empty)
    with empty.read() as session:
        project = session.scalars(select(Project)).one()
    assert (project.id, project.team_id) == (DEFAULT_PROJECT, DEFAULT_TEAM)


def test_the_constant_is_the_newest_revision(empty: Database) -> None:
    assert ScriptDirectory.from_config(migrations._config(empty)).get_current_head() == migrations.HEAD


def test_blobs_are_not_compressed_twice(database: Database) -> None:
    if database.engine.dialect.name != "postgresql":
        pytest.skip("PostgreSQL only")
    query = "SELECT attstorage FROM pg_attribute WHERE attrelid = 'channels'::regclass AND attname = 'payload'"
    with database.read() as session:
        assert str(session.scalar(text(query))) in ("e", "b'e'")


def test_sqlite_is_set_up_for_several_processes(database: Database) -> None:
    if database.engine.dialect.name != "sqlite":
        pytest.skip("SQLite only")
    with database.read() as session:
        assert session.scalar(text("PRAGMA journal_mode")) == "wal"
        assert session.scalar(text("PRAGMA foreign_keys")) == 1
        assert session.scalar(text("PRAGMA busy_timeout")) == 30_000
