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
from .resolution import Finding, Seen, findings

Array = np.ndarray

#: (share done 0…1, function that gives a checkpoint) -> None; may raise Cancelled
Tell = Callable[[float, Callable[[], bytes]], None]


@dataclass
class Record:
    """What some seeds did over the kept time.

    seeds : numbers; vessel : (n, S, 6) from the static position [m, rad]; tension : (n, N, L, S) float32 of elements,
    padding included; ends : (n, 2, L, S) reaction at end b and end a [N]; lowest, highest : (N, L, S) over every step;
    slack : (N, L, S) share of the kept time in which an element is slack; findings : what speaks against the step.
    """

    seeds: list[int]
    vessel: Array
    tension: Array
    ends: Array
    lowest: Array
    highest: Array
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
    Raises NotConverged for a step that cannot be done or was too long, CaseError for what the time domain does not take.
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
        while not block.done:
            between()
            block.go(block.stride)
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


def _gather(run: Run, blocks: list[Block]) -> Record:
    L = len(run.static.lines)

    def seeds_last(values: Array) -> Array:
        return np.moveaxis(values.reshape(*values.shape[:-1], -1, L), -2, -1)

    def joined(name: str) -> Array:
        return np.concatenate([seeds_last(getattr(block.watch, name)) for block in blocks], axis=-1)

    lowest, highest = joined("range")
    found = findings(run, Seen(lowest, highest, joined("kink"), joined("bed"), joined("reach")))
    record = Record(
        [seed for block in blocks for seed in block.seeds],
        np.concatenate([block.out[0] for block in blocks], axis=1),
        np.concatenate([seeds_last(block.out[1]) for block in blocks], axis=-1),
        np.concatenate([seeds_last(block.out[2]) for block in blocks], axis=-1),
        lowest, highest, joined("slack") / run.time.kept, int(sum(block.counts[0] for block in blocks)),
        int(sum(block.counts[1] for block in blocks)), findings=found,
    )  # fmt: skip
    turn_back(run.static, run.turned, (record.tension, record.lowest, record.highest, record.slack), record.ends)
    return record
