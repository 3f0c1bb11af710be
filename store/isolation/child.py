"""One call in a forked process: limits first, then the function, then its answer into a file.

The kernel enforces the limits, so that they hold whatever the code does, also while it holds the interpreter's lock.
"""

from __future__ import annotations

import contextlib
import fcntl
import inspect
import os
import resource
import signal
import struct
from dataclasses import astuple, dataclass
from importlib import import_module
from typing import IO, Any

from . import plain

OPEN_FILES, ABOVE = 64, 128
NICE = 10
NO_MEMORY, NO_ANSWER = 71, 70
"""Exit statuses."""
MESSAGE = struct.Struct("<ddqq")
"""The limits, as a template process is told them."""
WHOLE = 2**40


@dataclass(frozen=True)
class Limits:
    """What one call may take. memory_bytes: beside what the process has before it."""

    cpu_seconds: float = 5.0
    wall_seconds: float = 30.0
    memory_bytes: int = 1500 * 2**20
    answer_bytes: int = 1000 * 2**20

    def as_tuple(self) -> tuple[float, float, int, int]:
        return astuple(self)  # type: ignore[return-value]


def fork(request: int, answer: int, attached: int, limits: Limits) -> int:
    """Start the call that stands in the file `request`; the process id of the child.

    attached : a file for the function's `attached`, or -1.
    """
    pid = os.fork()
    if pid:
        return pid
    status = NO_ANSWER
    try:
        files = _only(request, answer, attached)
        _set(limits)
        _run(*files)
        status = 0
    except MemoryError:
        status = NO_MEMORY
    finally:
        os._exit(status)


def _only(*descriptors: int) -> list[int]:
    """Nothing else stays open: neither sockets of the service nor files of another call."""
    for number in range(1, signal.NSIG):
        with contextlib.suppress(OSError, ValueError):
            signal.signal(number, signal.SIG_DFL)
    signal.set_wakeup_fd(-1)
    high = [fcntl.fcntl(number, fcntl.F_DUPFD, ABOVE) if number >= 0 else -1 for number in descriptors]
    os.closerange(0, ABOVE)
    for _ in range(3):
        os.open(os.devnull, os.O_RDWR)
    kept = [os.dup2(number, 3 + index) if number >= 0 else -1 for index, number in enumerate(high)]
    os.closerange(3 + len(kept), 2**30)
    return kept


def _set(limits: Limits) -> None:
    _stand_back()
    seconds = max(1, round(limits.cpu_seconds))
    _limit(resource.RLIMIT_CPU, seconds, seconds + 1)
    _limit(resource.RLIMIT_FSIZE, limits.answer_bytes)
    _limit(resource.RLIMIT_CORE, 0)
    _limit(resource.RLIMIT_NOFILE, OPEN_FILES)
    with contextlib.suppress(OSError):  # where the system does not say how much there is, the other limits hold
        with open("/proc/self/statm") as file:
            pages = int(file.read().split()[0])
        _limit(resource.RLIMIT_AS, pages * resource.getpagesize() + limits.memory_bytes)
    signal.setitimer(signal.ITIMER_REAL, limits.wall_seconds)


def _stand_back() -> None:
    """The processor goes to those first who answer requests."""
    with contextlib.suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    with contextlib.suppress(OSError):
        os.nice(NICE)


def _limit(kind: int, soft: int, hard: int | None = None) -> None:
    most = resource.getrlimit(kind)[1]
    hard = soft if hard is None else hard
    if most != resource.RLIM_INFINITY:
        soft, hard = min(soft, most), min(hard, most)
    resource.setrlimit(kind, (soft, hard))


def _run(request: int, answer: int, attached: int) -> None:
    from solver.outcome import CaseError, DataError

    with os.fdopen(request, "rb") as source, os.fdopen(answer, "wb") as target:
        name, arguments = plain.read(source, WHOLE)
        try:
            module, _, function = name.partition(":")
            if attached >= 0:
                arguments = [os.fdopen(attached, "rb"), *arguments]
            found = getattr(import_module(module), function)(*arguments)
            for value in found if inspect.isgenerator(found) else [found]:
                plain.write(target, {"value": value})
            plain.write(target, {"end": True})
        except CaseError as error:
            _fail(target, {"fault": "CaseError", "errors": error.errors})
        except DataError as error:
            _fail(target, {"fault": "DataError", "message": str(error)})
        except MemoryError:
            raise
        except Exception as error:
            _fail(target, {"fault": "", "message": f"{type(error).__name__}: {error}"[:2000]})


def _fail(target: IO[bytes], fault: dict[str, Any]) -> None:
    """A fault stands alone, so that whoever reads the answer meets it first."""
    target.seek(0)
    target.truncate()
    plain.write(target, fault)
