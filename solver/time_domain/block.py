"""Seeds that march together: what an ensemble shares, and one block of its lanes (docs/theory.md, T7-T17)."""

from __future__ import annotations

import copy
import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from ..case.analysis import TimeDomain
from ..kernels.arrays import ENDS, EXACT, FAILED, MEAN, OK, SHARP, Sea, Setup, State, Watch
from ..kernels.march import march
from ..model.build import Model
from ..outcome import CaseError, FieldError, NotConverged
from ..statics.solve import StaticState
from .facing import facing
from .lanes import make_body, make_lines, make_memory, make_state, make_watch, make_work, padded_shapes
from .pace import stride
from .scheme import SCHEMES
from .sea import Components, VesselLoads, components
from .water import Water

Array = np.ndarray
LANES_WANTED = 8
REFRESH = 8  # steps between renewals of Newton's matrix
WATER_BYTES = 160e6  # of water tables in a block: longer records are cut into windows


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
            self.water = Water(model, self.waves, padded_shapes(static), spec.wave_kinematics)
        self.stiffest = max(float(line.arrays.EA.max()) for line in static.lines)
        self.limits = self._limits(float(spec.tolerance), self.time.build_up // 2)

    def _limits(self, tolerance: float, watched: int) -> Array:
        """Limits of the march: what ends a step (T3), and the number of the first step watched."""
        element = min(float(line.arrays.L.min()) for line in self.static.lines)
        weight = max(float(line.arrays.w_dry.sum()) for line in self.static.lines)
        tension = max(*(float(np.abs(force).max()) for force in self.static.state.end_forces), 1e-3 * weight)
        return np.array(
            [tolerance * element, 100.0 * tolerance * tension, self.spec.max_iterations, REFRESH, watched], dtype=float
        )

    def finer(self, parts: int, tolerance: float, watched: int) -> Run:
        """The same ensemble in steps of h / parts, without outputs and without an end, watched from a step of its own."""
        one = copy.copy(self)
        total = parts * (self.time.build_up + self.time.kept)
        one.time = replace(self.time, h=self.time.h / parts, build_up=parts * self.time.build_up, kept=0, every=1)
        one.total, one.limits = 100 * total, self._limits(tolerance, watched)
        return one

    def blocks(self, seeds: list[int]) -> list[list[int]]:
        """Seeds cut into blocks of about LANES_WANTED lanes."""
        size = max(round(LANES_WANTED / len(self.static.lines)), 1)
        return [seeds[start : start + size] for start in range(0, len(seeds), size)]


class Block:
    """Seeds that march together in lanes."""

    def __init__(self, run: Run, seeds: list[int]):
        self.run, self.seeds = run, seeds
        S, L = len(seeds), len(run.static.lines)
        self.amplitudes = [run.waves.amplitudes(s, run.spec.amplitudes == "random") for s in seeds] if run.waves else []
        sea, first = self._sea()
        lines = make_lines(run.model, run.static, S, first)
        memory = make_memory(run.model, run.static, run.time.h)
        self.state = make_state(run.static, S, memory.rows.shape[1])
        bottoms = [self.state.x[lines.bottom[q], :, q] for q in range(S * L)]
        base = np.ascontiguousarray(np.stack([self.state.x[-1], np.stack(bottoms, axis=-1)]))
        self.setup = Setup(
            lines, make_body(run.model, run.static, S), sea, memory, base, run.scheme.table(), run.limits,
            run.time.build_up * run.time.h,
        )  # fmt: skip
        rows = run.water.rows if run.water is not None else 6
        self.work, self.spare = (make_work(self.state, rows, first) for _ in range(2))
        self.step = 0
        P, Q, n = self.state.x.shape[0], S * L, run.time.outputs
        self.out: tuple[Array, Array, Array] = (
            np.zeros((n, S, 6)),
            np.zeros((n, P - 1, Q), dtype=np.float32),
            np.zeros((n, len(ENDS), Q)),
        )
        self.watch = make_watch(P, Q)
        self.early = make_watch(P, Q)  # of the second half of the build-up, for the probe alone
        self.counts = np.zeros(3, dtype=np.int64)
        self._mark()

    def _sea(self) -> tuple[Sea, int]:
        """Loads of the block's seeds, the water's table still empty, and the first node in waves."""
        run, S, L = self.run, len(self.seeds), len(self.run.static.lines)
        force, force_step = np.zeros((1, S, 6)), 1.0
        if run.vessel is not None:
            force = np.ascontiguousarray(np.stack([run.vessel.table(a) for a in self.amplitudes], axis=1))
            force_step = run.vessel.step
        none = np.zeros((0, 0, 6, S * L))
        water = run.water
        if water is None:
            P = padded_shapes(run.static)[0].shape[0]
            return Sea(
                force,
                force_step,
                none,
                0,
                1.0,
                MEAN,
                1,
                np.zeros((0, 2)),
                np.zeros((0, 4)),
                0.0,
                0.0,
                np.zeros((0, 3, S * L)),
            ), P
        origin = np.ascontiguousarray(np.tile(water.origin, S))
        return Sea(
            force, force_step, none, 0, water.step, water.kind, water.parts, water.headings(), water.regular(),
            float(water.depth), float(water.waves.omega[0]), origin,
        ), water.first  # fmt: skip

    def _cover(self, count: int) -> None:
        """Have the water's table reach over the next `count` steps; a long one is made a window at a time."""
        water, sea, run = self.run.water, self.setup.sea, self.run
        if water is None or water.kind == EXACT:
            return
        now = self.step * run.time.h - self.setup.build_up
        low, high = (math.floor(t / water.step) for t in (now, now + (count + 2) * run.time.h))
        low, high, held = low - 1, high + 3, sea.water.shape[0]
        if held == water.count or (sea.water_first <= low and high <= sea.water_first + held):
            return
        points = max(
            int(WATER_BYTES / (8 * max(water.origin[:, 0].size, 1) * water.rows * len(self.seeds))), high - low
        )
        first, points = (0, water.count) if points >= water.count else (low, points)
        index = (first + np.arange(points)) % water.count
        lines = range(len(run.static.lines))
        table = np.empty((points, sea.origin.shape[0], water.rows, sea.origin.shape[2]))
        for lane, (amplitudes, line) in enumerate(itertools.product(self.amplitudes, lines)):
            table[..., lane] = water.table(line, amplitudes, index)
        self.setup = self.setup._replace(sea=sea._replace(water=table, water_first=first))

    @property
    def stride(self) -> int:
        """Steps between progress reports."""
        return stride(self.run.time.h, self.state.x.shape[0], self.state.x.shape[2], REFRESH)

    @property
    def done(self) -> bool:
        return self.step >= self.run.total

    def go(self, count: int) -> None:
        """March `count` steps. Raises NotConverged with the seed, the time and a remedy."""
        run = self.run
        count = min(count, run.total - self.step)
        self._cover(count)
        left = min(max(run.time.build_up - self.step, 0), count)
        status, at, seed = self._march(self.step, left, self.early)
        if status == OK:
            status, at, seed = self._march(self.step + left, count - left, self.watch)
        when = (at - run.time.build_up) * run.time.h
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

    def _march(self, first: int, count: int, watch: Watch) -> tuple[int, int, int]:
        time = self.run.time
        return march(  # type: ignore[no-any-return]
            self.setup,
            self.state,
            self.work,
            self.spare,
            first,
            count,
            time.h,
            time.every,
            self.out,
            watch,
            self.counts,
        )

    def finer(self, mark: dict[str, Array], parts: int, tolerance: float, settled: int) -> Block:
        """The same seeds from a mark of this block on, in steps of h / parts; watched from step `settled` of this block on."""
        one = copy.copy(self)
        one.run = self.run.finer(parts, tolerance, parts * settled)
        memory = self.setup.memory
        one.setup = self.setup._replace(limits=one.run.limits, memory=memory._replace(every=parts * memory.every))
        one.work, one.spare = (
            make_work(self.state, self.work.terms.shape[1], self.setup.lines.first_wave) for _ in range(2)
        )
        one.state = State(*(mark[f"state/{name}"].copy() for name in State._fields))
        one.step, one.counts = parts * int(mark["step"]), np.zeros_like(self.counts)
        P, _, Q = one.state.x.shape
        one.out = (np.zeros((0, *self.out[0].shape[1:])), self.out[1][:0], self.out[2][:0])
        one.watch = one.early = make_watch(P, Q)
        return one

    def _mark(self) -> None:
        """Copy what a checkpoint holds: another thread may ask for one while this block marches on."""
        state = {f"state/{name}": value.copy() for name, value in self.state._asdict().items()}
        watch = {f"watch/{name}": value.copy() for name, value in self.watch._asdict().items()}
        self.mark = {**state, **watch, "step": np.array(self.step), "counts": self.counts.copy()}

    def _sane(self, when: float) -> None:
        """Refuse what is not finite, and element forces beyond all strength."""
        high = float(max(watch.range[1].max(initial=0.0) for watch in (self.early, self.watch)))
        if not np.all(np.isfinite(self.state.x)) or high > 0.5 * self.run.stiffest:
            raise NotConverged(
                "time_domain", f"the motion grew without bound before t = {when:.2f} s (strain above 50 %).",
                "Use a smaller step; check masses, stiffnesses and damping.",
            )  # fmt: skip

    def release(self) -> None:
        """Let go of the wave tables: only the record is still wanted."""
        sea = self.setup.sea
        empty = sea._replace(force=sea.force[:0].copy(), water=sea.water[:0].copy())
        self.setup = self.setup._replace(sea=empty)

    def arrays(self) -> dict[str, Array]:
        """Everything needed to go on elsewhere, as of the last stride; output after that is written again."""
        vessel, tension, ends = (values[: self.mark["counts"][2]] for values in self.out)
        return {**self.mark, "out/vessel": vessel, "out/tension": tension, "out/ends": ends}

    def restore(self, arrays: dict[str, Array]) -> None:
        """Go on from what `arrays` gave."""
        self.state = State(*(np.ascontiguousarray(arrays[f"state/{name}"]) for name in State._fields))
        self.watch = Watch(*(np.ascontiguousarray(arrays[f"watch/{name}"]) for name in Watch._fields))
        self.step = int(arrays["step"])
        self.counts[:] = arrays["counts"]
        for values, name in zip(self.out, ("vessel", "tension", "ends"), strict=True):
            values[: self.counts[2]] = arrays[f"out/{name}"]
        self._mark()
