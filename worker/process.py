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
from collections.abc import Iterator
from pathlib import Path

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


def host_prefix() -> str:
    return f"{socket.gethostname()}/"


def worker_name() -> str:
    """host/pid of the worker/pid of the child."""
    return f"{host_prefix()}{os.getppid()}/{os.getpid()}"


def is_dead(worker: str) -> bool:
    """Whether a worker of this host, named as above, has no process any more."""
    try:
        pid = int(worker.rsplit("/", 1)[1])
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    except (ValueError, IndexError, PermissionError):
        return False
    return False


def die_with_parent(interval: float = 0.5) -> None:
    """End this process soon after its parent has ended, however that came about."""
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(interval)
        os._exit(1)

    threading.Thread(target=watch, name="watch-parent", daemon=True).start()
