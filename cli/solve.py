"""Solves a case beside the main thread, which stays free for Ctrl-C: compiled code hears nothing of it."""

from __future__ import annotations

import threading
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from solver.case import Case
    from solver.results.part import Part, Progress, Result
    from solver.vessel.data import DataSource

PATIENCE = 10.0  # seconds that an interrupted solver has to come to a place where it can stop


@dataclass
class Outcome:
    """result : None where no analysis was done. hung : the solver's thread is still at work and dies with the process."""

    result: Result | None
    interrupted: bool = False
    hung: bool = False


@dataclass
class Solver:
    """One run of a case in a thread; after `stop` it keeps the analyses that are done."""

    case: Case
    source: DataSource
    doubts: list[str]
    parts: list[Part] = field(default_factory=list)
    progress: Progress | None = None
    result: Result | None = None
    error: BaseException | None = None
    _stop: threading.Event = field(default_factory=threading.Event)

    def __post_init__(self) -> None:
        self._thread = threading.Thread(target=self._work, name="solver", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def wait(self, seconds: float) -> bool:
        """Whether the run has ended. Raises what ended it."""
        self._thread.join(seconds)
        if self.error is not None:
            raise self.error
        return not self._thread.is_alive()

    def stop(self) -> Outcome:
        """Stop at the next place where the solver looks; kernels that are being compiled are not waited for."""
        self._stop.set()
        with suppress(KeyboardInterrupt):  # asked twice: not waited for either
            if not self._compiles():
                self.wait(PATIENCE)
        if self.result is not None:
            done = set(self.case.analyses.requested()) - set(self.result.failures)
            return Outcome(self.result if done else None, interrupted=True)
        return Outcome(self._so_far(), interrupted=True, hung=self._thread.is_alive())

    def _work(self) -> None:
        try:
            from solver.run import run

            self.result = run(self.case, self.source, self._tell, parts=self.parts)
        except BaseException as error:
            self.error = error

    def _tell(self, progress: Progress) -> None:
        from solver.outcome import Interrupted

        self.progress = progress
        if self._stop.is_set():
            raise Interrupted("Ctrl-C")

    def _compiles(self) -> bool:
        if self.progress is None:  # the solver itself is being loaded
            return True
        from solver.run import LOADING

        return self.progress.message == LOADING

    def _so_far(self) -> Result | None:
        if not self.parts:
            return None
        from solver.run import collect

        return collect(self.case, self.parts, self.doubts)


def solve(case: Case, source: DataSource, doubts: list[str], console: Console, quiet: bool) -> Outcome:
    """Solve with a bar on a terminal, until done or Ctrl-C. doubts : warnings of `check`. Raises as the solver does."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("{task.description}"),
    )
    solver = Solver(case, source, doubts)
    with Progress(*columns, console=console, disable=quiet or not console.is_terminal, transient=True) as bar:
        try:
            task = bar.add_task("loading the solver", total=1.0)
            solver.start()
            while not solver.wait(0.1):
                if solver.progress is not None:
                    bar.update(task, completed=solver.progress.fraction, description=solver.progress.message)
        except KeyboardInterrupt:
            for task in bar.task_ids:
                bar.update(task, description="stopping; Ctrl-C again: stop at once")
            return solver.stop()
    return Outcome(solver.result)
