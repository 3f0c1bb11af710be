"""Saved and put back, on both databases: every row as it was."""

from __future__ import annotations

import shutil
import sqlite3
from pathlib import Path

import pytest
from sqlalchemy import text

from cli.main import main
from solver.results.part import Chunk
from store.backup import BackupError, backup, restore
from store.database import Database
from store.repositories import CaseRepository, RunRepository
from store.repositories.cases import NewCase
from store.scope import Scope


def insert(database: Database, name: str) -> str:
    with database.write() as session:
        version, _ = CaseRepository(session, Scope()).save(NewCase(name, name.ljust(64, "0"), "{}", "x: 1"))
        run, _ = RunRepository(session, Scope()).create(version, ["statics"], [Chunk("frequency")])
        return run.id


def names(database: Database) -> set[str]:
    with database.read() as session:
        return {view.run.case_name for view in RunRepository(session, Scope()).page(10, None)}


def test_what_was_saved_comes_back(database: Database, tmp_path: Path) -> None:
    if database.engine.dialect.name == "postgresql" and shutil.which("pg_dump") is None:
        pytest.skip("no pg_dump here")
    insert(database, "before")
    copy = tmp_path / "copy"
    url = database.engine.url.render_as_string(hide_password=False)
    assert backup(url, copy) > 1000
    insert(database, "after")
    with pytest.raises(BackupError, match="there already"):
        backup(url, copy)
    with pytest.raises(BackupError, match="--replace"):
        restore(url, copy)
    assert names(database) == {"before", "after"}
    database.close()
    restore(url, copy, replace=True)
    assert names(database) == {"before"}
    insert(database, "later")  # it goes on


def test_what_is_no_copy_is_refused(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'slowdrift.db'}"
    rubbish = tmp_path / "rubbish"
    for content, says in (
        (b"hello", "no copy of a SQLite"),
        (b"SQLite format 3\0" + b"x" * 4000, "damaged or not ours"),
    ):
        rubbish.write_bytes(content)
        with pytest.raises(BackupError, match=says):
            restore(url, rubbish)
    with pytest.raises(BackupError, match="cannot be read"):
        restore(url, tmp_path / "nothing")
    assert not (tmp_path / "slowdrift.db").exists()


def test_saved_while_somebody_writes(database: Database, tmp_path: Path) -> None:
    if database.engine.dialect.name != "sqlite":
        pytest.skip("SQLite only")
    insert(database, "committed")
    with database.write() as session:
        session.execute(text("DELETE FROM tasks"))
        backup(database.url, tmp_path / "copy")
    with sqlite3.connect(tmp_path / "copy") as copy:
        assert copy.execute("SELECT count(*) FROM tasks").fetchone() == (1,)


def test_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = (["--data-dir", str(tmp_path / name)] for name in ("first", "second"))
    assert main(["migrate", *first]) == 0
    database = Database(f"sqlite:///{tmp_path / 'first' / 'slowdrift.db'}")
    insert(database, "kept")
    database.close()
    copy = str(tmp_path / "copy.db")
    assert main(["backup", copy, *first]) == 0
    assert main(["restore", copy, *second]) == 0
    assert main(["restore", copy, *second]) == 2
    assert "--replace" in capsys.readouterr().err
    assert main(["queue", *second]) == 0
    assert "1 queued" in " ".join(capsys.readouterr().out.split())
    assert main(["queue", "--failed", *second]) == 0
    assert capsys.readouterr().out.strip() == "nothing"
    assert main(["retention", *second]) == 2
    assert main(["retention", "--days", "30", *second]) == 0
    assert "0 ended run(s)" in capsys.readouterr().out
