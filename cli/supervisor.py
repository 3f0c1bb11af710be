"""One process that starts the others, restarts what dies, and ends them together."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

from . import lifeline
from .log_files import LogFile
from .options import say

GRACE_SECONDS = 8.0
ABORT_SECONDS = 0.5
FIRST_PAUSE, LONGEST_PAUSE = 0.5, 15.0
STEADY_SECONDS = 30.0
START_SECONDS = 180.0
"""How long a child may take until its first sign of life."""


@dataclass
class Child:
    """One process to keep alive: arguments after `slowdrift`, and file descriptors it inherits."""

    name: str
    arguments: Sequence[str]
    descriptors: tuple[int, ...] = ()
    process: subprocess.Popen[bytes] | None = None
    started_at: float = 0.0
    pause: float = FIRST_PAUSE
    due_at: float = field(default=0.0)
    silence: float | None = None
    """Seconds without a sign of life after which it is replaced; None: it gives none."""
    pulse: int = -1
    heard_at: float = 0.0
    heard: bool = False


class Supervisor:
    """Call `start`, then `tick` again and again, then `stop`. Children are process groups of their own."""

    def __init__(self, children: Sequence[Child], environment: dict[str, str], log_dir: Path | None):
        self.children, self._log_dir = list(children), log_dir
        self._read, self._write = os.pipe()
        self._environment = os.environ | environment | {lifeline.VARIABLE: str(self._read)}
        root = str(Path(__file__).resolve().parent.parent)  # so that children find the same code, installed or not
        paths = [root, *filter(None, self._environment.get("PYTHONPATH", "").split(os.pathsep))]
        self._environment["PYTHONPATH"] = os.pathsep.join(dict.fromkeys(paths))
        self._logs: dict[str, LogFile] = {}
        self.ending = False

    def start(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)
        for child in self.children:
            self._launch(child)

    def tick(self) -> None:
        """Restart what has died, after a pause that doubles while it keeps dying."""
        now = time.monotonic()
        for child in self.children:
            if child.process is None:
                if now >= child.due_at and not self.ending:
                    self._launch(child)
            elif (code := child.process.poll()) is not None:
                self._replace(child, now, f"ended ({_cause(code)})")
            elif self._silent(child, now):
                _send(child, signal.SIGABRT)  # it writes where it hangs into its log (faulthandler)
                time.sleep(ABORT_SECONDS)
                self._replace(child, now, f"gave no sign of life for {now - child.heard_at:.0f} s")

    def _replace(self, child: Child, now: float, reason: str) -> None:
        self._bury(child)
        steady = now - child.started_at > STEADY_SECONDS
        child.pause = FIRST_PAUSE if steady else min(2 * child.pause, LONGEST_PAUSE)
        child.due_at = now + child.pause
        say(f"slowdrift: {child.name} {reason}; starting it again in {child.pause:g} s")

    def _silent(self, child: Child, now: float) -> bool:
        """Whether it has to be taken for hanging."""
        if child.silence is None:
            return False
        with contextlib.suppress(BlockingIOError):
            if os.read(child.pulse, 4096):
                child.heard_at, child.heard = now, True
        return now - child.heard_at > (child.silence if child.heard else max(child.silence, START_SECONDS))

    def run(self) -> None:
        while not self.ending:
            self.tick()
            time.sleep(0.2)

    def stop(self) -> None:
        """End all children: asked first, killed after a grace."""
        self.ending = True
        living = [child for child in self.children if child.process is not None]
        for child in living:
            _send(child, signal.SIGTERM)
        deadline = time.monotonic() + GRACE_SECONDS
        for child in living:
            if child.process is not None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    child.process.wait(max(0.0, deadline - time.monotonic()))
        for child in living:
            self._bury(child)
        for number in (self._read, self._write):
            with contextlib.suppress(OSError):
                os.close(number)

    def _launch(self, child: Child) -> None:
        command = [sys.executable, "-P", "-m", "cli.main", *child.arguments]
        output = self._output(child.name)
        child.pulse, pulse = os.pipe()
        os.set_blocking(child.pulse, False)
        try:
            child.process = subprocess.Popen(
                command,
                env=self._environment | {lifeline.PULSE: str(pulse)},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                pass_fds=(self._read, pulse, *child.descriptors),
                start_new_session=True,
            )
        finally:
            os.close(pulse)
            if output is not None:
                os.close(output)
        child.started_at = child.heard_at = time.monotonic()
        child.heard = False

    def _bury(self, child: Child) -> None:
        """Whatever a child has left of its group goes with it."""
        if child.process is None:
            return
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(child.process.pid, signal.SIGKILL)
        child.process.wait()
        child.process = None
        os.close(child.pulse)

    def _output(self, name: str) -> int | None:
        """Where a child writes: a pipe into its log file, or None for this process's own output."""
        if self._log_dir is None:
            return None
        read, write = os.pipe()
        self._logs.setdefault(name, LogFile(self._log_dir / f"{name}.log")).copy_from(read)
        return write

    def _on_signal(self, _: int, __: FrameType | None) -> None:
        self.ending = True


def _send(child: Child, number: int) -> None:
    if child.process is not None:
        with contextlib.suppress(ProcessLookupError):
            child.process.send_signal(number)


def _cause(code: int) -> str:
    if code >= 0:
        return f"exit status {code}"
    try:
        return signal.Signals(-code).name
    except ValueError:
        return f"signal {-code}"
