"""Judges the steps of a march while it runs, and tries which step or tolerance would do instead (docs/theory.md, T16-T18)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ..model.line import harmonic_omega
from ..outcome import NotConverged
from .block import Block, Run
from .resolution import HEADS, MOVES, REMEDIES, TOLERANCE, Finding, Seen, is_loose, observed, suspect

WAVES = 10  # of a random sea before its ranges are judged
EARLY = 2.0  # times the limit: what is refused before the end (T18)
FINER = (2, 4, 10, 20)  # parts of the step that are tried
MANY = (40, 100, 200, 400, 1000)  # parts that are named without a trial
ENOUGH = 0.5  # of the limits: what a trial must keep


class StepTooLong(NotConverged):
    """The steps did not follow the motion. `partial` : record and timing of what was computed, if anything was."""

    partial: Any = None


def periods_watched(run: Run) -> tuple[int, int]:
    """Steps watched before ranges are judged, and in a trial: ten and three waves at a random sea's peak, else one period."""
    h, waves = run.time.h, run.waves
    if waves is not None and not waves.regular:
        wave = 2.0 * math.pi / float(waves.omega[int(np.argmax(waves.variances.sum(axis=0)))])
        return math.ceil(WAVES * wave / h), math.ceil(3 * wave / h)
    omega = harmonic_omega(run.model.case)
    steps = run.total if omega is None else math.ceil(2.0 * math.pi / omega / h)
    return steps, steps


class Probe:
    """Looks at a block after every stride; keeps where a trial would have to begin."""

    def __init__(self, block: Block):
        self.block = block
        self.least, self.tried = periods_watched(block.run)
        self.marks = [block.mark]  # the ends of the last two strides
        self.worst: Finding | None = None
        self.trial: Finding | None = None
        self.start, self.settled, self.end = block.mark, block.step, block.step

    def look(self, between: Callable[[], None]) -> None:
        """Judge what was watched so far. Raises StepTooLong with a remedy that was tried; `between` runs during trials."""
        block = self.block
        built_up, lines = block.run.time.build_up, len(block.run.static.lines)
        early = block.step <= built_up
        watched = block.step - (int(block.run.limits[4]) if early else built_up)
        watch = block.early if early else block.watch
        if (block.done or watched >= self.least) and suspect(block.run, watch):
            seen = Seen.of(watch, lines)
            worst = max(observed(block.run, seen), key=lambda one: one.severity, default=None)
            if worst is not None and worst.severity > 1.0:
                self._note(worst)
                if block.done or worst.what in ("reach", "snatch") or worst.severity > EARLY:
                    raise self._refusal(worst, seen, between)
        self.marks = [self.marks[-1], block.mark]

    def _note(self, worst: Finding) -> None:
        """Keep the stride of the worst finding: trials begin one stride before it."""
        if self.worst is None or worst.severity > self.worst.severity:
            self.worst, self.start = worst, self.marks[0]
            self.settled = max(int(self.marks[-1]["step"]), int(self.start["step"]) + self.tried // 4)
            self.end = max(self.block.step, self.settled + self.tried)

    def _refusal(self, worst: Finding, seen: Seen, between: Callable[[], None]) -> StepTooLong:
        """The refusal: what was found, when, and what would do."""
        time = self.block.run.time
        now = (self.block.step - time.build_up) * time.h
        head, remedy = HEADS[worst.what], REMEDIES[worst.what]
        if worst.what != "reach":
            head, remedy = self._tried(head, _softer(self.block.run, worst, seen), between)
        return StepTooLong(
            "time_domain", f"{head}: {worst.fact(time.h)}, by t = {now:.4g} s (0 ends the build-up).", remedy
        )

    def _tried(self, head: str, softer: str, between: Callable[[], None]) -> tuple[str, str]:
        """Head and remedy, from trials with the default tolerance where the case's is looser, then with shorter steps."""
        run = self.block.run
        h, given = run.time.h, float(run.spec.tolerance)
        loose, tight = is_loose(given), min(given, TOLERANCE)
        begin, end = ((step - run.time.build_up) * h for step in (self.settled, self.end))
        trial = f"In a trial from t = {begin:.4g} to {end:.4g} s"
        if loose and self._does(1, tight, between):
            return "the tolerance is too loose", (
                f"{trial} the same step did with the default tolerance, {TOLERANCE:g}, instead of {given:g}. "
                f"Set analyses.time_domain.tolerance to {TOLERANCE:g}."
            )
        for parts in FINER:
            if not self._does(parts, tight, between):
                continue
            step = f"a step of {h / parts:.4g} s"
            if loose and not self._does(parts, given, between):
                return "the step is too long and the tolerance too loose", (
                    f"{trial} {step} with the default tolerance, {TOLERANCE:g}, would do. Use both{softer}."
                )
            return head, f"{trial} {step} would do. Use it{softer}."
        with_it = f" with the default tolerance, {TOLERANCE:g}," if loose else ""
        return head, f"{trial} steps down to {h / FINER[-1]:.4g} s{with_it} would not do{self._estimate()}{softer}."

    def _estimate(self) -> str:
        """What may do where no trial did: kinks fall with the square of the step, blows with the step (T16, T17)."""
        last = self.trial
        if last is None:
            return ". Look for a line that snaps slack there, use a still smaller step"
        needed = FINER[-1] * (last.severity / ENOUGH) ** (0.5 if last.what == "kink" else 1.0)
        parts = next((many for many in MANY if many >= needed), MANY[-1])
        return (
            f"; by what was left with the last of them, about {self.block.run.time.h / parts:.2g} s would. Use that and "
            "compare it with half of it"
        )

    def _does(self, parts: int, tolerance: float, between: Callable[[], None]) -> bool:
        """Whether steps of h / parts stay below half of the limits over the stretch where h did not.

        Leaves the worst finding of the trial in `trial`: None where there was none, or the march itself failed.
        """
        one = self.block.finer(self.start, parts, tolerance, self.settled)
        end = parts * self.end
        self.trial = None
        try:
            while one.step < end:
                between()
                one.go(min(one.stride, end - one.step))
        except NotConverged:
            return False
        seen = Seen.of(one.watch, len(one.run.static.lines))
        judged = [one for one in observed(one.run, seen) if one.what != "reach"]
        self.trial = max(judged, key=lambda one: one.severity, default=None)
        return self.trial is None or self.trial.severity < ENOUGH


def _softer(run: Run, worst: Finding, seen: Seen) -> str:
    """The seabed as a remedy, where it acts on the line with more than a small share of the line's range of tension."""
    index = [line.name for line in run.static.lines].index(worst.line)
    with np.errstate(invalid="ignore"):
        bed = (seen.bed[1] - seen.bed[0])[:, index].max()
        tension = (seen.highest - seen.lowest)[:, index].max()
    return ", or a softer seabed with a wider transition" if bed > MOVES * tension else ""
