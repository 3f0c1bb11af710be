"""What a worker's processes need to know of each other: who they are, whether to stop, whether the parent lives."""

from __future__ import annotations

import contextlib
import fcntl
import mmap
import os
import resource
import socket
import threading
import time
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import psutil

_flag = mmap.mmap(-1, 1)  # shared with children forked after this import


@contextlib.contextmanager
def one_at_a_time(path: Path) -> Iterator[None]:
    """Hold a file's lock; a file that cannot be had is no reason not to go on."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            file = stack.enter_context(path.open("ab"))
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


@contextlib.contextmanager
def only_one(path: Path) -> Iterator[bool]:
    """Whether this process has the file's lock; it does not wait for it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("ab") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield False
            return
        yield True


def memory_mb() -> float:
    """Resident memory of this process."""
    return float(psutil.Process().memory_info().rss / 2**20)


def bound_memory(more_mb: float) -> None:
    """Let allocations beyond this much more fail (MemoryError) before they take the machine."""
    with contextlib.suppress(OSError, ValueError, AttributeError, psutil.Error):
        now = psutil.Process().memory_info().data
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (now + int(more_mb * 2**20), hard))


def announce_shutdown() -> None:
    """Tell this process's children to give their tasks back at the next progress call."""
    _flag[0] = 1


def shutting_down() -> bool:
    return _flag[0] != 0


class Identity:
    """Who a worker process is: a random id, and a file of that name that it keeps locked for as long as it lives.

    Process numbers and host names will not do: containers have the same ones. A lock that can be had proves that its
    process has ended; of a worker whose file is not in this folder nothing is known, and its lease decides.
    """

    def __init__(self, folder: Path):
        self.id = uuid.uuid4().hex
        self.name = f"{socket.gethostname()}/{os.getppid()}/{os.getpid()}/{self.id}"
        """host/pid of the worker/pid of the child/id; all but the id only tells people where to look."""
        self._file: IO[bytes] | None = None
        with contextlib.suppress(OSError):  # without a lock it is never taken for dead before its lease is over
            folder.mkdir(parents=True, exist_ok=True)
            new = folder / f"{self.id}.new"
            self._file = new.open("wb")
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            new.rename(folder / f"{self.id}.lock")


def ended(folder: Path) -> dict[str, Path]:
    """Ids of worker processes that have ended, and the files they had locked."""
    found = {}
    for path in folder.glob("*.lock"):
        with contextlib.suppress(OSError), path.open("rb") as file:  # BlockingIOError: it lives
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            found[path.stem] = path
    return found


def id_of(worker: str) -> str:
    """The random id in a worker's name; empty in names of earlier versions."""
    parts = worker.split("/")
    return parts[3] if len(parts) == 4 else ""


def die_with_parent(interval: float = 0.5) -> None:
    """End this process soon after its parent has ended, however that came about."""
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(interval)
        os._exit(1)

    threading.Thread(target=watch, name="watch-parent", daemon=True).start()
