"""Calls of a function in a child process: from this process where it has one thread, else through a template process."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any

from solver.outcome import CaseError, DataError, FieldError, SlowdriftError

from ..errors import UnavailableError
from . import plain
from .child import MESSAGE, NO_MEMORY, Limits, fork

MODULES = ("solver.vessel.data", "solver.vessel.quality", "h5py", "scipy.io", "solver.bem.quality", "solver.io.moordyn")
"""What a template process loads before the first call."""
GRACE_SECONDS = 5.0
"""Beside the limit that the kernel keeps, until the process that asked kills the child."""
TOO_LONG = -1000
"""In place of an exit status: it did not end, and was killed."""
MOST_AT_A_TIME, MOST_WAITING = 2, 8
_places = threading.BoundedSemaphore(MOST_AT_A_TIME)
_queue = threading.BoundedSemaphore(MOST_AT_A_TIME + MOST_WAITING)


class Stopped(SlowdriftError):
    """The child gave no answer. `cause`: time, memory or died; the message is the end of a sentence about the file."""

    def __init__(self, cause: str, message: str):
        self.cause = cause
        super().__init__(message)


def call(function: str, *arguments: Any, limits: Limits | None = None, attached: IO[bytes] | None = None) -> Any:
    """What `module:function` returns for the arguments, computed in a child; see `stream`."""
    return next(iter(stream(function, *arguments, limits=limits, attached=attached)))


def stream(
    function: str, *arguments: Any, limits: Limits | None = None, attached: IO[bytes] | None = None
) -> Iterator[Any]:
    """What a generator function yields, or the one value of another, once the child has ended well.

    Arguments and values: what store/isolation/plain.py writes. `attached` is an open file that becomes the function's
    first argument. Raises the function's own CaseError or DataError, Stopped where it passes a limit or dies, and
    UnavailableError where too many calls wait already.
    """
    limits = limits or Limits()
    with contextlib.ExitStack() as stack:
        request = stack.enter_context(tempfile.TemporaryFile())
        answer = stack.enter_context(tempfile.TemporaryFile())
        plain.write(request, (function, list(arguments)))
        request.flush()
        with _place():
            code = _ended(request, answer, attached, limits)
        _judge(code, limits)
        yield from _values(answer, limits)


@contextlib.contextmanager
def _place() -> Iterator[None]:
    """Few at a time, and few that wait: the threads that answer other requests must not all wait here."""
    if not _queue.acquire(blocking=False):
        raise UnavailableError("Too many files are being read now; send this one again in a few seconds.")
    try:
        with _places:
            yield
    finally:
        _queue.release()


def _ended(request: IO[bytes], answer: IO[bytes], attached: IO[bytes] | None, limits: Limits) -> int:
    """Exit status of the child, minus the signal that ended it."""
    files = [request, answer] + ([] if attached is None else [attached])
    for attempt in (1, 2):
        for file in files:
            file.seek(0)
        try:
            if _single_threaded():
                return _forked_here([file.fileno() for file in files], limits)
            return _template.run([file.fileno() for file in files], limits)
        except _TemplateLost:
            answer.truncate(0)
            if attempt == 2:
                break
    raise UnavailableError("The process that reads files ended twice; try again in a moment.")


def _single_threaded() -> bool:
    """Whether this process may fork: the command line may, a service with threads may not."""
    return threading.active_count() == 1 and not _template.started


def _forked_here(descriptors: Sequence[int], limits: Limits) -> int:
    request, answer, attached = [*descriptors, -1][:3]
    pid = fork(request, answer, attached, limits)
    deadline = time.monotonic() + limits.wall_seconds + GRACE_SECONDS
    pause = 0.001
    try:
        while True:
            done, status = os.waitpid(pid, os.WNOHANG)
            if done:
                return os.waitstatus_to_exitcode(status)
            if time.monotonic() > deadline:
                break
            time.sleep(pause)
            pause = min(2 * pause, 0.05)
    except BaseException:
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
        raise
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    return TOO_LONG


def _judge(code: int, limits: Limits) -> None:
    if code == 0:
        return
    if code == NO_MEMORY:
        raise Stopped("memory", f"reading it needs more than {limits.memory_bytes / 2**20:.0f} MB of memory")
    if code == TOO_LONG or -code in (signal.SIGXCPU, signal.SIGALRM):
        raise Stopped("time", f"reading it did not end within {limits.cpu_seconds:.0f} s of computing")
    if -code == signal.SIGXFSZ:
        raise Stopped("memory", f"what it holds takes more than {limits.answer_bytes / 2**20:.0f} MB")
    name = signal.Signals(-code).name if code < 0 else f"exit status {code}"
    raise Stopped("died", f"the process that read it ended ({name})")


def _values(answer: IO[bytes], limits: Limits) -> Iterator[Any]:
    answer.seek(0)
    try:
        while True:
            found = plain.read(answer, limits.answer_bytes)
            if "fault" in found:
                raise _error(found)
            if "end" in found:
                return
            yield found["value"]
    except (EOFError, plain.PlainError, KeyError, TypeError) as error:
        raise Stopped("died", f"the process that read it gave no whole answer ({type(error).__name__})") from None


def _error(found: dict[str, Any]) -> Exception:
    if found["fault"] == "CaseError" and all(isinstance(error, FieldError) for error in found["errors"]):
        return CaseError(found["errors"])
    if found["fault"] == "DataError":
        return DataError(str(found["message"]))
    return RuntimeError(f"in the child process: {str(found['message'])[:2000]}")


class _TemplateLost(Exception):
    """The template process is gone, and nothing is known of the call."""


class _Template:
    """The one template process of this process, started when it is first needed and again when it is gone."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        self._owner = 0
        self._modules: tuple[str, ...] = MODULES

    @property
    def started(self) -> bool:
        return self._process is not None and self._owner == os.getpid()

    def start(self, modules: tuple[str, ...]) -> None:
        with self._lock:
            self._modules = modules
            self._ensure()

    def run(self, descriptors: Sequence[int], limits: Limits) -> int:
        here, there = socket.socketpair()
        with here:
            with there, self._lock:
                control = self._ensure()
                try:
                    socket.send_fds(control, [MESSAGE.pack(*limits.as_tuple())], [there.fileno(), *descriptors])
                except OSError:
                    self._forget()
                    raise _TemplateLost from None
            ready, _, _ = select.select([here], [], [], limits.wall_seconds + START_SECONDS)
            if not ready:
                return TOO_LONG  # closing `here` makes the template kill it
            told = here.recv(32)
            if not told:
                with self._lock:
                    self._forget()
                raise _TemplateLost
            return int(told)

    def _ensure(self) -> socket.socket:
        if self._control is not None and self._owner == os.getpid() and self._alive():
            return self._control
        self._forget()
        here, there = socket.socketpair()
        root = str(Path(__file__).resolve().parents[2])
        paths = [root, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join(dict.fromkeys(paths)),
            "OPENBLAS_NUM_THREADS": "1",  # one thread alone may fork
            "OMP_NUM_THREADS": "1",
        }
        with there:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "store.isolation.template", str(there.fileno()), *self._modules],
                stdin=subprocess.DEVNULL,
                pass_fds=(there.fileno(),),
                env=environment,
            )
        self._control, self._owner = here, os.getpid()
        return here

    def _alive(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def _forget(self) -> None:
        if self._control is not None:
            self._control.close()
        if self._process is not None and self._owner == os.getpid():
            self._process.kill()
            self._process.wait()
        self._process = self._control = None


START_SECONDS = 60.0
"""Until a template that has just been started has loaded its modules."""
_template = _Template()


def warm_up(*modules: str) -> None:
    """Start the template process of this process now, with these modules too. It ends with this process."""
    _template.start((*MODULES, *modules))
