"""The faults. Each strikes while runs are submitted and computed, and returns once what it broke is there again."""

from __future__ import annotations

import contextlib
import os
import signal
import sqlite3
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sqlalchemy import create_engine, text

from store.broker import QUICK, RUNS
from store.doorbell import Doorbell

from ..running import command_line, processes_of
from .rig import Rig

AWAY_SECONDS = 6.0
JUMP_SECONDS = 3600.0


def _parent(pid: int) -> int:
    with contextlib.suppress(OSError):
        return int(Path(f"/proc/{pid}/stat").read_text().split(") ")[1].split()[1])
    return 0


def _processes(rig: Rig, words: str) -> tuple[list[int], list[int]]:
    """Processes of the service with these words in their command: those that started others of the kind, the others."""
    found = [pid for pid in processes_of(rig.settings) if words in command_line(pid)]
    parents = {_parent(pid) for pid in found}
    return [pid for pid in found if pid in parents], [pid for pid in found if pid not in parents]


def _kill(pids: list[int]) -> None:
    for pid in pids[:1]:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def worker_child(rig: Rig) -> None:
    for _ in range(4):
        _kill(_processes(rig, "cli.main worker --concurrency")[1])
        time.sleep(3)


def worker(rig: Rig) -> None:
    for _ in range(2):
        _kill(_processes(rig, "cli.main worker --concurrency")[0])
        time.sleep(5)


def api(rig: Rig) -> None:
    for _ in range(3):
        _kill(_processes(rig, "cli.main api")[1])
        time.sleep(3)


def broker(rig: Rig) -> None:
    """Gone with all its messages, and back empty."""
    if rig.broker is not None:
        rig.broker.kill(forget=True)
        time.sleep(AWAY_SECONDS)
        rig.broker.start()
        return
    until = time.monotonic() + AWAY_SECONDS
    while time.monotonic() < until:
        for path in (rig.settings.data_dir / "broker" / "messages").glob("*"):
            path.unlink(missing_ok=True)
        time.sleep(0.01)


def database(rig: Rig) -> None:
    """PostgreSQL loses its power; SQLite is locked by somebody else."""
    if rig.postgres is not None:
        rig.postgres.kill()
        time.sleep(AWAY_SECONDS)
        rig.postgres.start()
        return
    connection = sqlite3.connect(rig.settings.data_dir / "slowdrift.db", timeout=30, isolation_level=None)
    connection.execute("BEGIN IMMEDIATE")
    time.sleep(AWAY_SECONDS)
    connection.execute("ROLLBACK")
    connection.close()


def disk(rig: Rig) -> None:
    """No byte is left where database and messages are; then there is room again."""
    assert rig.disk is not None
    filler = rig.disk / "filler"
    until = time.monotonic() + AWAY_SECONDS
    with filler.open("wb", buffering=0) as file:
        while time.monotonic() < until:
            with contextlib.suppress(OSError):
                while True:
                    file.write(b"\0" * 65536)
            time.sleep(0.05)
    filler.unlink()
    if rig.postgres is not None and not rig.postgres.alive():
        rig.postgres.start()  # it may stop when it cannot write its log; an operator starts it again


def clock(rig: Rig) -> None:
    """An hour forward, then an hour back: of this machine, and of the database server."""
    for offset in (JUMP_SECONDS, -JUMP_SECONDS, 0.0):
        rig.clock_file.write_text(str(offset))
        if rig.postgres is not None:
            _set_server_clock(rig, offset)
        time.sleep(4)


def _set_server_clock(rig: Rig, offset: float) -> None:
    """A function of ours before the server's own."""
    engine = create_engine(rig.settings.database, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.execute(
            text(
                "CREATE OR REPLACE FUNCTION public.clock_timestamp() RETURNS timestamptz LANGUAGE sql AS "
                f"$$ SELECT pg_catalog.clock_timestamp() + interval '{offset} s' $$"
            )
        )
        connection.execute(text("ALTER DATABASE postgres SET search_path = public, pg_catalog"))
        connection.execute(
            text(
                "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = 'postgres' AND pid <> pg_backend_pid()"
            )
        )
    engine.dispose()


def duplicates(rig: Rig) -> None:
    """Every message many times over."""
    bell = Doorbell(rig.settings)
    for _ in range(20):
        bell.ring([("", door) for door in (RUNS, QUICK) for _ in range(20)])
        time.sleep(0.2)
    bell.close()


def memory(_: Rig) -> None:
    """Nothing from outside: some of the runs eat memory."""
    time.sleep(1)


@dataclass(frozen=True)
class Fault:
    strike: Callable[[Rig], None]
    settings: dict[str, Any] = field(default_factory=dict)
    on_small_disk: bool = False
    hogs: int = 0
    """How many of the runs take more memory than is allowed."""


FAULTS: dict[str, Fault] = {
    "worker child killed": Fault(worker_child),
    "worker killed": Fault(worker),
    "API killed in submissions": Fault(api),
    "broker killed, data lost": Fault(broker),
    "database killed": Fault(database),
    "disk full": Fault(disk, on_small_disk=True),
    "clock jumps": Fault(clock),
    "duplicate delivery": Fault(duplicates),
    "memory eaten": Fault(memory, {"task_memory_mb": 700}, hogs=4),
}


def in_background(strike: Callable[[Rig], None], rig: Rig) -> tuple[threading.Thread, list[float]]:
    """The fault on its way; the list gets the moment (monotonic) at which it was over."""
    over: list[float] = []

    def run() -> None:
        try:
            strike(rig)
        finally:
            over.append(time.monotonic())

    thread = threading.Thread(target=run, name="fault")
    thread.start()
    return thread, over
