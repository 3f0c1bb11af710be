"""Many mutants to a child process, each with a limit of processor time; the mutant in which a child hangs or dies is named."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CPU_LIMIT = 20.0  # s of processor time for one mutant, whose file is read in milliseconds
WALL_LIMIT = 600.0  # s, for a child that waits for something


@dataclass
class Tally:
    """counts : outcomes; bad : mutants by number with what should not have come of them."""

    counts: Counter[str] = field(default_factory=Counter)
    bad: dict[int, str] = field(default_factory=dict)

    def add(self, number: int, said: str) -> None:
        known = said if said in ("refused", "same", "entries") else said.split(":")[0]
        self.counts[known] += 1
        if said not in ("refused", "same", "entries"):
            self.bad[number] = said


def fuzz(reader: str, seed: int, count: int, module: str = "tests.fuzz.child", limit: float = CPU_LIMIT) -> Tally:
    """Outcomes of the mutants 0 … count - 1 of a reader. module : of the child; limit : processor time of a mutant [s]."""
    tally, first = Tally(), 0
    while first < count:
        first = _one_child(tally, [sys.executable, "-m", module, reader, str(seed)], first, count, limit)
    return tally


def _one_child(tally: Tally, command: list[str], first: int, count: int, limit: float) -> int:
    """Run one child as far as it gets; the number of the mutant to go on from."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(
        [*command, str(first), str(count)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env=environment,
    ) as child:
        lines: queue.Queue[str] = queue.Queue()
        errors: list[str] = []
        readers = [
            threading.Thread(target=_pass_on, args=(child.stdout, lines.put), daemon=True),
            threading.Thread(target=_pass_on, args=(child.stderr, errors.append), daemon=True),
        ]
        for thread in readers:
            thread.start()
        at, hung = _follow(child, lines, tally, readers[0], limit)
        if hung:
            child.kill()
        status = child.wait()
    if at is None:
        if status == 0:
            return count
        raise RuntimeError(f"the child ended with {status} before its first mutant: {''.join(errors)[-2000:]}")
    tally.add(at, "hung: stopped by the limit of processor time" if hung else f"died: exit status {status}")
    return at + 1


def _follow(
    child: subprocess.Popen[str], lines: queue.Queue[str], tally: Tally, reader: threading.Thread, limit: float
) -> tuple[int | None, bool]:
    """Take down outcomes; the mutant that was begun and not ended, and whether its time is up."""
    at: int | None = None
    begun, spent = time.monotonic(), 0.0
    while True:
        try:
            line = lines.get(timeout=0.5)
        except queue.Empty:
            if not reader.is_alive() and lines.empty():
                return at, False
            if at is not None and (_cpu(child.pid) - spent > limit or time.monotonic() - begun > WALL_LIMIT):
                return at, True
            continue
        if line.startswith('"'):
            assert at is not None
            tally.add(at, json.loads(line))
            at = None
        else:
            at, begun, spent = int(line), time.monotonic(), _cpu(child.pid)


def _pass_on(stream, take) -> None:  # type: ignore[no-untyped-def]
    for line in stream:
        take(line)


def _cpu(pid: int) -> float:
    """Processor time of a process [s]."""
    try:
        words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")
