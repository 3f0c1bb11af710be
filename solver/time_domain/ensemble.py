"""Marches an ensemble of seeds: blocks of seeds in threads, blocks of time between progress, cancel and checkpoint."""

from __future__ import annotations

import io
import threading
import time as clock
from collections.abc import Callable
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np

from ..case.analysis import TimeDomain
from ..kernels.march import FAILED, SHARP, Sea, State, march
from ..model.build import Model
from ..outcome import Cancelled, CaseError, FieldError, NotConverged
from ..statics.solve import StaticState
from .facing import facing, turn_back
from .lanes import make_body, make_lines, make_memory, make_state, make_work, padded_shapes
from .pace import stride
from .scheme import SCHEMES
from .sea import Components, VesselLoads, WaterTables, components

Array = np.ndarray
LANES_WANTED = 8
STIFFEST_BED = 36.0  # rad a step of a node on its seabed spring: at 41 tension was seen to go wrong
LONGEST_SNAP_STEP = 0.1  # s: tested with a snapping riser, 2 % at 0.1 s, 20 % at 0.2 s
REFRESH = 8  # steps between renewals of Newton's matrix

#: (share done 0…1, function that gives a checkpoint) -> None; may raise Cancelled
Tell = Callable[[float, Callable[[], bytes]], None]


@dataclass(frozen=True)
class Timing:
    """Steps of a run: h, steps of the build-up and of the kept part, steps between outputs."""

    h: float
    build_up: int
    kept: int
    every: int

    @property
    def duration(self) -> float:
        return self.kept * self.h

    @property
    def outputs(self) -> int:
        return self.kept // self.every


def timing(spec: TimeDomain) -> Timing:
    """Whole numbers of steps and of outputs. Raises CaseError where the output step is no multiple of the step."""
    every = round(spec.output_step / spec.step)
    if every < 1 or abs(every * spec.step - spec.output_step) > 1e-6 * spec.output_step:
        raise CaseError([FieldError(
            ("analyses", "time_domain", "output_step"),
            f"{spec.output_step:g} s is no multiple of the step, {spec.step:g} s; allowed: {spec.step:g}, {2 * spec.step:g} …",
        )])  # fmt: skip
    kept = max(round(spec.duration / spec.step / every), 1) * every
    return Timing(float(spec.step), round(spec.build_up / spec.step), kept, every)


@dataclass
class Record:
    """What some seeds did over the kept time.

    seeds : numbers; vessel : (n, S, 6) from the static position [m, rad]; tension : (n, N, L, S) float32 of elements,
    padding included; ends : (n, 2, L, S) reaction at end b and end a [N]; lowest, highest : (N, L, S) over every step.
    """

    seeds: list[int]
    vessel: Array
    tension: Array
    ends: Array
    lowest: Array
    highest: Array
    iterations: int = 0
    retries: int = 0
    wall_time: float = 0.0


class Block:
    """Seeds that march together in lanes."""

    def __init__(self, run: Run, seeds: list[int]):
        self.run, self.seeds = run, seeds
        S, L = len(seeds), len(run.static.lines)
        amplitudes = [
            run.waves.amplitudes(seed, run.spec.amplitudes == "random") if run.waves else None for seed in seeds
        ]
        force, force_step = np.zeros((1, S, 6)), 1.0
        if run.vessel is not None:
            force = np.ascontiguousarray(np.stack([run.vessel.table(a) for a in amplitudes if a is not None], axis=1))
            force_step = run.vessel.step
        first, water, water_step = (
            padded_shapes(run.static)[0].shape[0],
            np.zeros((0, 0, 6, S * L), dtype=np.float32),
            1.0,
        )
        if run.water is not None:
            first, water_step = run.water.first, run.water.step
            tables = [run.water.table(line, a) for a in amplitudes if a is not None for line in range(L)]
            water = np.ascontiguousarray(np.stack(tables, axis=-1))
        self.sea = Sea(force, force_step, water, water_step)
        self.lines = make_lines(run.model, run.static, S, first)
        self.body = make_body(run.model, run.static, S)
        self.memory = make_memory(run.model, run.static, run.time.h)
        self.state = make_state(run.static, S, self.memory.rows.shape[1])
        self.work, self.spare = make_work(self.state, self.lines), make_work(self.state, self.lines)
        self.base = np.ascontiguousarray(np.stack([self.state.x[-1], self._bottoms()]))
        self.step = 0
        N, Q, n = self.work.length.shape[0], S * L, run.time.outputs
        self.out: tuple[Array, Array, Array] = (
            np.zeros((n, S, 6)),
            np.zeros((n, N, Q), dtype=np.float32),
            np.zeros((n, 2, Q)),
        )
        self.seen = np.stack([np.full((N, Q), np.inf), np.full((N, Q), -np.inf)])
        self.counts = np.zeros(3, dtype=np.int64)
        self._mark()

    def _bottoms(self) -> Array:
        return np.stack([self.state.x[self.lines.bottom[q], :, q] for q in range(self.state.x.shape[2])], axis=-1)

    @property
    def done(self) -> bool:
        return self.step >= self.run.total

    def go(self, count: int) -> None:
        """March `count` steps. Raises NotConverged with the seed, the time and a remedy."""
        run = self.run
        count = min(count, run.total - self.step)
        status, at, seed = march(
            self.lines, self.body, self.sea, self.memory, self.state, self.work, self.spare, self.base, run.scheme.table(),
            self.step, count, run.time.h, run.time.build_up * run.time.h, run.limits, run.time.every, self.out, self.seen,
            self.counts,
        )  # fmt: skip
        when = at * run.time.h - run.time.build_up * run.time.h
        if status == FAILED:
            raise NotConverged(
                "time_domain",
                f"seed {self.seeds[seed]} does not converge at t = {when:.2f} s, even in sixteenths of {run.time.h:g} s.",
                "Use a smaller step, a softer or wider seabed transition, or look for a line that snaps slack there.",
            )
        if status == SHARP:
            raise NotConverged(
                "time_domain", f"a line folds by more than 75 degrees at one node at t = {when:.2f} s.",
                "Use shorter elements there, or check whether the line goes slack.",
            )  # fmt: skip
        self.step += count
        self._sane(when)
        self._mark()

    def _mark(self) -> None:
        """Copy what a checkpoint holds: another thread may ask for one while this block marches on."""
        kept = {f"state/{name}": value.copy() for name, value in self.state._asdict().items()}
        self.mark = {**kept, "step": np.array(self.step), "seen": self.seen.copy(), "counts": self.counts.copy()}

    def _sane(self, when: float) -> None:
        """Refuse what is not finite, and element forces beyond all strength."""
        high = (
            float(self.seen[1].max(initial=0.0))
            if self.step * self.run.time.h > self.run.time.build_up * self.run.time.h
            else 0.0
        )
        if not np.all(np.isfinite(self.state.x)) or high > 0.5 * self.run.stiffest:
            raise NotConverged(
                "time_domain", f"the motion grew without bound before t = {when:.2f} s (strain above 50 %).",
                "Use a smaller step; check masses, stiffnesses and damping.",
            )  # fmt: skip

    def release(self) -> None:
        """Let go of the wave tables: only the record is still wanted."""
        self.sea = Sea(np.zeros((1, len(self.seeds), 6)), 1.0, np.zeros((0, 0, 6, 1), dtype=np.float32), 1.0)

    def arrays(self) -> dict[str, Array]:
        """Everything needed to go on elsewhere, as of the last stride; output after that is written again."""
        vessel, tension, ends = (values[: self.mark["counts"][2]] for values in self.out)
        return {**self.mark, "out/vessel": vessel, "out/tension": tension, "out/ends": ends}

    def restore(self, arrays: dict[str, Array]) -> None:
        self.state = State(*(np.ascontiguousarray(arrays[f"state/{name}"]) for name in State._fields))
        self.step = int(arrays["step"])
        self.seen[:], self.counts[:] = arrays["seen"], arrays["counts"]
        for values, name in zip(self.out, ("vessel", "tension", "ends"), strict=True):
            values[: self.counts[2]] = arrays[f"out/{name}"]
        self._mark()


class Run:
    """An ensemble: everything that its seeds share."""

    def __init__(self, model: Model, static: StaticState, spec: TimeDomain):
        self.model, self.spec = model, spec
        self.static, self.turned = facing(static)
        static = self.static
        self.time = timing(spec)
        self.total = self.time.build_up + self.time.kept
        self.scheme = SCHEMES[spec.scheme]
        self.waves: Components | None = components(model, spec, self.time.duration)
        self.vessel = None
        self.water = None
        if self.waves is not None:
            if model.vessel is not None and model.vessel.data is not None:
                self.vessel = VesselLoads(model, self.waves, float(static.position[5]), self.time.h)
            if static.lines:
                self.water = WaterTables(model, self.waves, padded_shapes(static))
        _resolved_bed(static, spec)
        element = min(float(line.arrays.L.min()) for line in static.lines)
        tension = max(float(np.abs(force).max()) for force in static.state.end_forces)
        self.stiffest = max(float(line.arrays.EA.max()) for line in static.lines)
        self.limits = np.array(
            [spec.tolerance * element, 100.0 * spec.tolerance * tension, spec.max_iterations, REFRESH]
        )

    def blocks(self, seeds: list[int]) -> list[list[int]]:
        """Seeds cut into blocks of about LANES_WANTED lanes."""
        size = max(round(LANES_WANTED / len(self.static.lines)), 1)
        return [seeds[start : start + size] for start in range(0, len(seeds), size)]


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
    Raises NotConverged for a step that cannot be done, CaseError for what the time domain does not take.
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
            block.go(stride(run.time.h, block.state.x.shape[0], block.state.x.shape[2], REFRESH))
        block.release()

    if threads <= 1 or len(groups) == 1:
        for index in range(len(groups)):
            finish(index, told)
    else:
        _in_threads(finish, len(groups), threads, told)
    record = _gather(run, [blocks[index] for index in range(len(groups))])
    record.wall_time = clock.perf_counter() - started
    _resolved_snaps(run, record)
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

    record = Record(
        [seed for block in blocks for seed in block.seeds],
        np.concatenate([block.out[0] for block in blocks], axis=1),
        np.concatenate([seeds_last(block.out[1]) for block in blocks], axis=-1),
        np.concatenate([seeds_last(block.out[2]) for block in blocks], axis=-1),
        np.concatenate([seeds_last(block.seen[0]) for block in blocks], axis=-1),
        np.concatenate([seeds_last(block.seen[1]) for block in blocks], axis=-1),
        int(sum(block.counts[0] for block in blocks)), int(sum(block.counts[1] for block in blocks)),
    )  # fmt: skip
    turn_back(run.static, run.turned, (record.tension, record.lowest, record.highest), record.ends)
    return record


def _resolved_bed(static: StaticState, spec: TimeDomain) -> None:
    """Refuse a step far above what contact with the seabed needs: h √(a1/m) of any node beyond STIFFEST_BED."""
    for line, shape in zip(static.lines, static.state.shapes, strict=True):
        arrays = line.arrays
        down = shape[1:-1, 2] < arrays.seabed[1] + 8.0 / arrays.seabed[0]
        fastest = float(np.sqrt(np.max((arrays.a1 / arrays.node_mass)[1:-1][down], initial=0.0)))
        if spec.step * fastest > STIFFEST_BED:
            raise NotConverged(
                "time_domain",
                f"line {line.name!r}: a node on the seabed swings in {2 * np.pi / fastest:.2g} s, which a step of "
                f"{spec.step:g} s cannot follow (allowed: up to {STIFFEST_BED / fastest:.2g} s).",
                "Use a smaller step, a softer seabed or longer elements.",
            )


def _resolved_snaps(run: Run, record: Record) -> None:
    """Refuse the answer where a line went slack in a step too coarse for the snap that follows."""
    if run.time.h <= LONGEST_SNAP_STEP:
        return
    floor = -1e-3 * max(float(np.abs(force).max()) for force in run.static.state.end_forces)
    for index, line in enumerate(run.static.lines):
        least = float(record.lowest[:, index].min())
        if least < floor:
            raise NotConverged(
                "time_domain",
                f"line {line.name!r} goes slack ({least / 1e3:.3g} kN): the snaps that follow are not resolved in "
                f"steps of {run.time.h:g} s (allowed where a line goes slack: up to {LONGEST_SNAP_STEP:g} s).",
                "Use a smaller step, and halve it once more to see that the largest tension stays.",
            )
