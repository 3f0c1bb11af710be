"""Small cases without symmetry, solved once: what each analysis left behind, beside the summary and channels made of it."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from solver import analyses
from solver.case import Case, parse_case
from solver.model.build import build
from solver.results.channels import make_channels
from solver.results.part import Chunk, Part, Result
from solver.results.solved import Solved
from solver.results.summary import make_summary
from solver.run import merge, run_chunk
from solver.statics.solve import solve_statics
from solver.time_domain.block import Timing
from solver.time_domain.ensemble import Record, march_ensemble
from tests.frequency_domain.conftest import coupled, sea
from tests.systems import Source, example
from tests.time_domain.systems import timed

Array = np.ndarray
STIFFER = 3 * 120.8e3  # N m2, of the upper pipe of `shaken`
ROPE = {"diameter": 0.2, "mass": 45.0, "EA": 2.5e8, "EI": 6e4, "breaking_load": 3.1e6,
        "drag": {"normal": 1.1, "tangential": 0.05}, "added_mass": {"normal": 1.0, "tangential": 0.0}}  # fmt: skip


def moored(seas: list[dict[str, Any]], **frequency: Any) -> dict[str, Any]:
    """The box on three unlike lines, turned by 25°: two kinds of rope in one, one that starts at the vessel, one without
    a breaking load, of three multiplicities."""
    data = coupled(seas, elements=8, lines=3, **frequency)
    data["vessel"]["heading"] = "25 deg"
    data["line_types"]["chain"]["breaking_load"] = 5.2e6
    data["line_types"]["rope"] = copy.deepcopy(ROPE)
    data["line_types"]["plain"] = {
        key: value for key, value in data["line_types"]["chain"].items() if key != "breaking_load"
    }
    first, second, third = (data["lines"][f"line-{k}"] for k in range(3))
    first["segments"] = [
        {"type": "chain", "length": 260.0, "elements": 5},
        {"type": "rope", "length": 160.0, "elements": 4},
    ]
    first["multiplicity"] = 3
    second["end_a"], second["end_b"] = second["end_b"], second["end_a"]
    third["segments"][0]["type"] = "plain"
    third["multiplicity"] = 1
    return data


def storm() -> dict[str, Any]:
    """Two wave systems; slow drift whose difference frequencies reach into the wave band."""
    data = moored([sea(4.0, 9.0, 200.0), sea(2.0, 13.0, 150.0)])
    data["vessel"]["hydrodynamics"]["drift"] = "newman"
    data["analyses"]["modes"] = {"count": 7}
    data["analyses"]["frequency_domain"]["low"] = {"to": 0.5, "step": 0.02}
    data["analyses"]["frequency_domain"]["storm_duration"] = "2 h"
    data["analyses"]["statics"] = {}
    return data


def calm() -> dict[str, Any]:
    """First order only, mean drift included in statics, quadratic damping, drag as a vector."""
    data = moored([sea(3.0, 8.0, 240.0)], linearisation="vector")
    data["vessel"]["mean_drift"] = "include"
    data["vessel"]["hydrodynamics"]["drift"] = "none"
    data["analyses"]["statics"] = {}
    return data


def regular() -> dict[str, Any]:
    data = moored([{"wave": "regular", "height": 3.0, "period": 9.0, "direction": "200 deg"}])
    data["vessel"]["hydrodynamics"]["drift"] = "none"
    data["analyses"]["statics"] = {}
    return data


def shaken() -> dict[str, Any]:
    """The example riser, of two pipes that bend unlike, with a moving top."""
    data = example("hanging-riser-case1")
    segment = data["lines"]["riser"]["segments"][0]
    data["line_types"]["stiffer"] = {**data["line_types"][segment["type"]], "EI": STIFFER}
    data["lines"]["riser"]["segments"] = [
        {**segment, "length": 70.0, "elements": 10}, {**segment, "type": "stiffer", "length": 100.0, "elements": 12},
    ]  # fmt: skip
    data["analyses"] = {"statics": {}, "frequency_domain": {}}
    return data


@dataclass(frozen=True)
class Linear:
    """Statics, frequency domain and modes of a case, and what is said of them."""

    case: Case
    solved: Solved

    @classmethod
    def of(cls, data: dict[str, Any], source: Source | None) -> Linear:
        case = parse_case(data)
        model = build(case, source)
        static, asked, failures = solve_statics(model), case.analyses.requested(), {}
        frequency = analyses.linear_analysis(model, static, asked, lambda _progress: None, failures)
        modes = analyses.modes_analysis(model, static, frequency, asked, lambda _progress: None, failures)
        assert failures == {}
        return cls(case, Solved(model, static if frequency is None else frequency.static, frequency, modes))

    def summary(self) -> dict[str, Any]:
        return make_summary(self.solved, self.case.analyses.requested(), 1.25)

    def channels(self) -> dict[str, Any]:
        # without what the object remembers, so that a planted fault is not hidden by it
        fresh = Solved(self.solved.model, self.solved.static, self.solved.frequency, self.solved.modes)
        return {one.name: one for one in make_channels(fresh)}

    def fresh(self) -> Linear:
        return Linear(
            self.case, Solved(self.solved.model, self.solved.static, self.solved.frequency, self.solved.modes)
        )


@dataclass(frozen=True)
class Timed:
    """A time domain in two chunks of seeds, and what the same seeds recorded when marched here."""

    case: Case
    parts: list[Part]
    record: Record
    timing: Timing
    lines: dict[str, Any]  # as statics built them
    solved: Solved

    @classmethod
    def of(cls, data: dict[str, Any], source: Source | None, chunks: list[tuple[int, int]]) -> Timed:
        case = parse_case(data)
        parts = [run_chunk(case, source, Chunk("time", seeds)) for seeds in reversed(chunks)]
        model = build(case, source)
        static = solve_statics(model)
        spec = case.analyses.time_domain
        assert spec is not None
        marched = [march_ensemble(model, static, spec, list(range(*seeds))) for seeds in chunks]
        record = _joined([record for record, _ in marched])
        return cls(
            case, parts, record, marched[0][1], {line.name: line for line in static.lines}, Solved(model, static)
        )

    def result(self) -> Result:
        return merge(self.case, [Part.from_bytes(part.to_bytes()) for part in self.parts])

    @cached_property
    def made(self) -> Result:
        return self.result()


def _joined(records: list[Record]) -> Record:
    """Records of several chunks side by side: seeds are the last axis, of the vessel the second."""
    axes = {"vessel": 1, "tension": -1, "ends": -1, "lowest": -1, "highest": -1, "ends_range": -1, "slack": -1}
    arrays = {key: np.concatenate([getattr(one, key) for one in records], axis) for key, axis in axes.items()}
    seeds = [seed for one in records for seed in one.seeds]
    return Record(seeds, **arrays, retries=sum(one.retries for one in records))


def storm_in_time() -> dict[str, Any]:
    """Three seeds of a minute, every output of two steps, part of the record below the border."""
    data = moored([sea(4.0, 9.0, 200.0)])
    data["vessel"]["hydrodynamics"]["drift"] = "newman"
    return timed(data, step=0.1, build_up=10, duration=90, output_step=0.2, seeds=3, first_seed=4)


def shaken_in_time() -> dict[str, Any]:
    return timed(shaken(), step=0.1, build_up=27, duration=27, output_step=0.1)
