"""A worker is taken for dead only when that is proven: host names and process numbers are the same in many containers."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from store.database import Database
from store.repositories import TaskRepository
from worker import process

from .running import ROOT
from .test_execute import insert, look, worker  # noqa: F401  (a fixture)

CODE = (
    "import sys, pathlib; from worker.process import Identity; who = Identity(pathlib.Path(sys.argv[1])); "
    "print(who.name, flush=True); input()"
)


@contextmanager
def another(folder: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A process with an identity of its own, and its name."""
    one = subprocess.Popen(
        [sys.executable, "-c", CODE, str(folder)], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert one.stdout is not None
        yield one, one.stdout.readline().strip()
    finally:
        one.kill()
        one.wait()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_lock_tells_who_has_ended(tmp_path: Path, number: signal.Signals) -> None:
    with another(tmp_path) as (one, name), another(tmp_path) as (_, other):
        assert process.ended(tmp_path) == {}
        one.send_signal(number)
        one.wait()
        assert set(process.ended(tmp_path)) == {process.id_of(name)}
        assert process.id_of(other) not in process.ended(tmp_path)


def test_of_a_worker_elsewhere_nothing_is_known(tmp_path: Path) -> None:
    """Another container with this one's host name: its process number is no process here."""
    with another(tmp_path / "there") as (one, name):
        one.kill()
        one.wait()
        assert process.ended(tmp_path / "here") == {}
        assert process.id_of(name) in process.ended(tmp_path / "there")
    assert process.id_of(f"{socket.gethostname()}/1/999999") == ""  # a name of an earlier version


def test_a_new_process_frees_what_the_dead_held_and_nothing_else(
    worker: object,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from worker import tasks

    settings = worker.settings.model_copy(update={"data_dir": tmp_path, "max_attempts": 1})  # type: ignore[attr-defined]
    database: Database = worker.database  # type: ignore[attr-defined]
    monkeypatch.setattr(tasks, "settings", settings)
    monkeypatch.setattr(tasks, "_database", lambda: database)
    monkeypatch.setattr(tasks, "_ring", lambda _: None)
    folder = tmp_path / "workers"
    elsewhere = f"{socket.gethostname()}/1/999999/{'0' * 32}"
    with another(folder) as (one, dead), another(folder) as (_, alive):
        names = {"dead": dead, "alive": alive, "elsewhere": elsewhere}
        runs = {key: insert(worker) for key in names}  # type: ignore[arg-type]
        for key, name in names.items():
            with database.write() as session:
                assert TaskRepository(session).claim(runs[key][1][0], name, 60, 1) is not None
        one.kill()
        one.wait()
        tasks._clear_up_after_the_dead()
        states = {key: look(worker, run_id).run.state for key, (run_id, _) in runs.items()}  # type: ignore[arg-type]
    assert states == {"dead": "failed", "alive": "running", "elsewhere": "running"}  # one attempt was allowed
    assert process.ended(folder).keys() == {process.id_of(alive)}  # the file of the dead one is gone
