"""The real migrations, up and down, and equal to the models."""

from __future__ import annotations

import pytest
from alembic import command
from alembic.script import ScriptDirectory
from sqlalchemy import inspect, select, text

from solver.results.part import Chunk
from store import migrations
from store.database import Database
from store.models import DEFAULT_PROJECT, DEFAULT_TEAM, Project
from store.repositories import CaseRepository, RunRepository
from store.repositories.cases import NewCase
from store.scope import Scope


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


def test_rows_survive_every_step_down_and_up(database: Database) -> None:
    """SQLite alters a table by copy: what refers to it must not be deleted with the old one."""
    with database.write() as session:
        version, _ = CaseRepository(session, Scope()).save(NewCase("kept", "h" * 64, "{}", "x: 1"))
        run, _ = RunRepository(session, Scope()).create(version, ["statics"], [Chunk("frequency")])
    revisions = [
        script.revision for script in ScriptDirectory.from_config(migrations._config(database)).walk_revisions()
    ]
    for revision in revisions[1:]:
        migrations.downgrade(database, revision)
        with database.engine.connect() as connection:
            for table in ("case_versions", "runs", "tasks"):
                assert connection.scalar(text(f"SELECT count(*) FROM {table}")) == 1, (revision, table)
    migrations.upgrade(database)
    with database.read() as session:
        view = RunRepository(session, Scope()).view(run.id)
        assert (view.run.case_name, view.attempt, view.run.tags, view.run.pinned) == ("kept", 0, [], False)
        if database.engine.dialect.name == "sqlite":
            assert session.scalar(text("PRAGMA foreign_keys")) == 1
