"""Marches an ensemble of seeds: blocks of seeds in threads, blocks of time between progress, cancel and checkpoint."""

from __future__ import annotations

import io
import threading
import time as clock
from collections.abc import Callable
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass, field

import numpy as np

from ..case.analysis import TimeDomain
from ..model.build import Model
from ..outcome import Cancelled
from ..statics.solve import StaticState
from .block import Block, Run, Timing
from .facing import turn_back
from .probe import Probe, StepTooLong
from .resolution import Finding, Seen, by_line, observed

Array = np.ndarray
FEWEST_OUTPUTS = 10  # that are kept of a refused run

#: (share done 0…1, function that gives a checkpoint) -> None; may raise Cancelled
Tell = Callable[[float, Callable[[], bytes]], None]


@dataclass
class Record:
    """What some seeds did over the kept time.

    seeds : numbers; vessel : (n, S, 6) from the static position [m, rad]; tension : (n, N, L, S) float32 of elements,
    padding included; ends : (n, 6, L, S), rows ENDS: size and vertical part of the force on the supports at end b and end a
    [N], length on the bed, arc length of the touchdown point [m]; lowest, highest : (N, L, S) over every step;
    ends_range : (2, 4, L, S) least and largest of the first four rows of `ends` over every step; slack : (N, L, S) share of
    the kept time in which an element is slack; findings : what speaks against the length of the step.
    """

    seeds: list[int]
    vessel: Array
    tension: Array
    ends: Array
    lowest: Array
    highest: Array
    ends_range: Array
    slack: Array
    iterations: int = 0
    retries: int = 0
    wall_time: float = 0.0
    findings: list[Finding] = field(default_factory=list)


def march_ensemble(
    model: Model,
    static: StaticState,
    spec: TimeDomain,
    seeds: list[int],
    threads: int = 1,
    tell: Tell | None = None,
    checkpoint: bytes | None = None,
) -> tuple[Record, Timing]:
    """March every seed to the end.

    threads : blocks of seeds that march at once; the kernels hold no lock. The result does not depend on it.
    tell : called between blocks of time with the share done and a function that gives a checkpoint; what it raises
    passes through. checkpoint : what such a function gave in a former attempt at the same seeds.
    Raises NotConverged for a step that cannot be done, StepTooLong (with what was computed) for one that does not follow
    the motion, CaseError for what the time domain does not take.
    """
    started = clock.perf_counter()
    run = Run(model, static, spec)
    groups = run.blocks(seeds)
    stored = _load(checkpoint)
    blocks: dict[int, Block] = {}
    report = tell or (lambda _share, _save: None)

    def told() -> None:
        steps = sum(block.step for block in list(blocks.values()))
        report(min(steps / (run.total * len(groups)), 1.0), lambda: _save(blocks))

    def finish(index: int, between: Callable[[], None]) -> None:
        block = Block(run, groups[index])
        if index in stored:
            block.restore(stored[index])
        blocks[index] = block
        probe = Probe(block)
        try:
            while not block.done:
                between()
                block.go(block.stride)
                probe.look(between)
        except StepTooLong as failure:
            failure.partial = _partial(run, block)
            raise
        block.release()

    if threads <= 1 or len(groups) == 1:
        for index in range(len(groups)):
            finish(index, told)
    else:
        _in_threads(finish, len(groups), threads, told)
    record = _gather(run, [blocks[index] for index in range(len(groups))])
    record.wall_time = clock.perf_counter() - started
    return record, run.time


def _in_threads(
    finish: Callable[[int, Callable[[], None]], None], count: int, threads: int, told: Callable[[], None]
) -> None:
    """Finish all blocks in a pool; `told` runs in this thread, and what it raises stops the others at their next stride."""
    stop = threading.Event()

    def between() -> None:
        if stop.is_set():
            raise Cancelled("another block of seeds stopped the run")

    with ThreadPoolExecutor(threads) as pool:
        futures = [pool.submit(finish, index, between) for index in range(count)]
        try:
            left = set(futures)
            while left:
                done, left = wait(left, timeout=0.2, return_when=FIRST_EXCEPTION)
                for future in done:
                    future.result()
                told()
        except BaseException:
            stop.set()
            for future in futures:
                future.cancel()
            raise


def _save(blocks: dict[int, Block]) -> bytes:
    buffer = io.BytesIO()
    np.savez(
        buffer,
        allow_pickle=False,
        **{f"{k}/{name}": v for k, block in blocks.items() for name, v in block.arrays().items()},
    )
    return buffer.getvalue()


def _load(checkpoint: bytes | None) -> dict[int, dict[str, Array]]:
    if not checkpoint:
        return {}
    out: dict[int, dict[str, Array]] = {}
    with np.load(io.BytesIO(checkpoint), allow_pickle=False) as stored:
        for key in stored.files:
            index, name = key.split("/", 1)
            out.setdefault(int(index), {})[name] = stored[key]
    return out


def _partial(run: Run, block: Block) -> tuple[Record, Timing] | None:
    """What a block that was stopped wrote; None with too few outputs for any statistics."""
    rows = int(block.counts[2])
    if rows < FEWEST_OUTPUTS:
        return None
    time = run.time
    return _gather(run, [block], rows), Timing(time.h, time.build_up, rows * time.every, time.every)


def _gather(run: Run, blocks: list[Block], rows: int | None = None) -> Record:
    """The record of some blocks; of their first `rows` outputs only, where given."""
    L = len(run.static.lines)
    parts = [Seen.of(block.watch, L) for block in blocks]
    seen = Seen(*(np.concatenate(values, axis=-1) for values in zip(*parts, strict=True)))
    watched = lambda name: np.concatenate([by_line(getattr(block.watch, name), L) for block in blocks], axis=-1)  # noqa: E731
    steps = max(blocks[0].step - run.time.build_up, 1)  # kept ones, of every block
    record = Record(
        [seed for block in blocks for seed in block.seeds],
        np.concatenate([block.out[0][:rows] for block in blocks], axis=1),
        np.concatenate([by_line(block.out[1][:rows], L) for block in blocks], axis=-1),
        np.concatenate([by_line(block.out[2][:rows], L) for block in blocks], axis=-1),
        seen.lowest, seen.highest, watched("ends"), watched("slack") / steps,
        int(sum(block.counts[0] for block in blocks)), int(sum(block.counts[1] for block in blocks)),
        findings=observed(run, seen),
    )  # fmt: skip
    elements = (record.tension, record.lowest, record.highest, record.slack)
    turn_back(run.static, run.turned, elements, record.ends, record.ends_range)
    return record
