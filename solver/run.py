"""The doors of the solver: check, plan, run_chunk, merge; and run, the four in a row."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any

from .analyses import linear_analysis, modes_analysis, natural_modes, seeds_in_linear_system
from .case import Case
from .case.analysis import Analyses
from .check import check
from .model.build import Model, build
from .model.line import harmonic_omega
from .model.slack import push_limits
from .modes.natural import longest_period
from .modes.vessel import unreached_modes
from .outcome import CaseError, FieldError, Interrupted, NotConverged, numerical
from .plan import plan
from .results.channels import make_channels, make_time_channels
from .results.doubt import add_doubtful
from .results.line_types import line_types_summary
from .results.part import Chunk, OnProgress, Part, Progress, Result
from .results.solved import Solved
from .results.strain import allowed_tension
from .results.summary import make_summary, provenance
from .results.time import KEY, merge_time, time_part, time_summary, time_warnings
from .statics.solve import StaticState, solve_statics
from .time_domain.ensemble import march_ensemble
from .time_domain.probe import StepTooLong
from .time_domain.sea import low_border, whole_period
from .vessel.data import DataSource
from .warm import warm_up, warm_up_time_domain

__all__ = [
    "check", "collect", "merge", "natural_modes", "plan", "run", "run_chunk", "select", "warm_up", "warm_up_time_domain",
]  # fmt: skip

LOADING = "loading compiled kernels (a first start compiles them, a minute or more)"
INTERRUPTED = "interrupted before it was done; run the case again"


def select(case: Case, analyses: tuple[str, ...]) -> Case:
    """The case with only some of its analyses; one it does not name gets its defaults. Raises CaseError on a wrong name."""
    known = tuple(Analyses.model_fields)
    wrong = [name for name in analyses if name not in known]
    if wrong or not analyses:
        said = f"no analysis {wrong[0]!r}" if wrong else "no analysis is named"
        raise CaseError([FieldError(("analyses",), f"{said}; allowed: {', '.join(known)}")])
    wanted = {
        name: getattr(case.analyses, name) or Analyses.model_validate({name: {}}).__dict__[name] for name in analyses
    }
    return case.model_copy(update={"analyses": Analyses(**wanted)})


def run(
    case: Case,
    data: DataSource | None,
    on_progress: OnProgress | None = None,
    threads: int | None = None,
    parts: list[Part] | None = None,
) -> Result:
    """Check, plan and do everything here, time-domain seeds in `threads` (default: all cores). Raises as `check`.

    parts : a list that gets the part of each chunk as soon as it is done. When `on_progress` raises Interrupted, the
    result holds the analyses that are done; the others are in its failures.
    """
    doubts = check(case, data)
    chunks = plan(case)
    workers = threads or os.cpu_count() or 1
    total, before = sum(chunk.weight for chunk in chunks), 0.0
    done: list[Part] = [] if parts is None else parts
    follow = on_progress or (lambda _progress: None)
    try:
        for chunk in _together(chunks):

            def tell(progress: Progress, chunk: Chunk = chunk, before: float = before) -> None:
                with suppress(*([Interrupted] if progress.fraction >= 1.0 else [])):  # its part is done
                    follow(Progress((before + progress.fraction * chunk.weight) / total, progress.message))

            done.append(run_chunk(case, data, chunk, None, tell, workers))
            before += chunk.weight
    except Interrupted:
        pass
    return collect(case, done, doubts)


def collect(case: Case, parts: list[Part], doubts: list[str]) -> Result:
    """One result of the parts that are done; an analysis without one is in `failures`. doubts : warnings of `check`."""
    result = merge(case, parts)
    summary = result.summary
    summary["warnings"] = list(dict.fromkeys([*doubts, *summary["warnings"]]))
    cut = [name for name in case.analyses.requested() if name not in summary and name not in summary["failures"]]
    summary["failures"].update(dict.fromkeys(cut, INTERRUPTED))
    return result


def _together(chunks: list[Chunk]) -> list[Chunk]:
    """All time-domain chunks as one, for a single machine's threads."""
    others = [chunk for chunk in chunks if chunk.kind != "time"]
    seeds = [chunk.seeds for chunk in chunks if chunk.seeds is not None]
    if not seeds:
        return others
    weight = sum(chunk.weight for chunk in chunks if chunk.kind == "time")
    return [*others, Chunk("time", (seeds[0][0], seeds[-1][1]), weight)]


def run_chunk(
    case: Case,
    data: DataSource | None,
    chunk: Chunk,
    checkpoint: bytes | None = None,
    on_progress: OnProgress | None = None,
    threads: int = 1,
) -> Part:
    """Do one chunk. An analysis that does not converge, or whose arithmetic breaks down, is in the part's `failures`; what
    does not need it goes on.

    checkpoint : what a former attempt at this chunk offered through its progress.
    Raises CaseError and DataError when the question is wrong; whatever `on_progress` raises passes through.
    """
    tell = on_progress or (lambda _progress: None)
    tell(Progress(0.0, LOADING))
    compile_time = warm_up() + (warm_up_time_domain() if chunk.kind == "time" else 0.0)
    asked = case.analyses.requested()
    warnings: tuple[str, ...] = ()
    try:
        with numerical("statics"):
            model = build(case, data)
            warnings = model.warnings
            tell(Progress(0.02, "statics"))
            static = solve_statics(model)
        if model.case.environment.random and {"frequency_domain", "time_domain"} & set(asked):
            with numerical("modes"):
                static = replace(static, warnings=(*static.warnings, *unreached_modes(model, static)))
        if chunk.kind == "time":
            return _time_chunk(model, static, chunk, checkpoint, tell, threads, compile_time)
        with numerical("results"):
            return _frequency_chunk(model, static, tell, compile_time)
    except NotConverged as failure:
        return Part({
            "case": case.name, "analyses": list(asked), "warnings": list(warnings),
            "failures": dict.fromkeys(asked, f"{failure}"), "compile_time": compile_time,
        })  # fmt: skip


def _frequency_chunk(model: Model, static: StaticState, tell: OnProgress, compile_time: float) -> Part:
    """All but the time domain; when it is interrupted, the analyses that are done."""
    case, asked = model.case, model.case.analyses.requested()
    failures: dict[str, str] = {}
    frequency, modes, stopped = None, None, False
    try:
        frequency = linear_analysis(model, static, asked, tell, failures)
        modes = modes_analysis(model, static, frequency, asked, tell, failures)
        tell(Progress(0.97, "collecting results"))
    except Interrupted:
        stopped = True
    shown = frequency if "frequency_domain" in asked else None
    solved = Solved(model, static if frequency is None else frequency.static, shown, modes, failures)
    summary = make_summary(solved, asked, compile_time)
    compared = shown is not None and case.analyses.time_domain is not None and not stopped
    if compared and model.vessel is not None and solved.is_random:
        assert shown is not None
        summary["frequency_domain"]["same_waves"] = {"vessel_std": seeds_in_linear_system(model, static, shown)}
    part = Part(summary, tuple(make_channels(solved)))
    tell(Progress(1.0, "done"))
    return part


def merge(case: Case, parts: list[Part]) -> Result:
    """One result from the parts of all chunks, in any order."""
    asked = list(case.analyses.requested())
    summary: dict[str, Any] = {"case": case.name, "analyses": asked, "warnings": [], "failures": {}}
    channels = [channel for part in parts for channel in part.channels]
    for part in parts:
        own = {
            key: value
            for key, value in part.summary.items()
            if key not in (KEY, "warnings", "failures", "compile_time")
        }
        summary.update(own)
        summary["warnings"] = list(dict.fromkeys([*summary["warnings"], *part.summary.get("warnings", [])]))
        summary["failures"].update(part.summary.get("failures", {}))
        summary["compile_time"] = summary.get("compile_time", 0.0) + part.summary.get("compile_time", 0.0)
    time_result = merge_time(parts)
    if "time_domain" in summary["failures"]:
        add_doubtful(summary, time_result)
        time_result = None
    if time_result is not None:
        summary["time_domain"] = time_summary(time_result)
        summary["warnings"] += time_warnings(time_result)
        channels += make_time_channels(time_result, list(case.lines))
    return Result(summary, tuple(channels))


def _time_chunk(
    model: Model,
    static: StaticState,
    chunk: Chunk,
    checkpoint: bytes | None,
    tell: OnProgress,
    threads: int,
    compile_time: float,
) -> Part:
    """March a chunk's seeds."""
    spec = model.case.analyses.time_domain
    assert spec is not None
    assert chunk.seeds is not None
    seeds = list(range(*chunk.seeds))
    turned = model.vessel.damping_warnings(float(static.position[5])) if model.vessel is not None else ()
    about: dict[str, Any] = {
        "line_types": line_types_summary(model.case),
        "warnings": [*model.warnings, *static.warnings, *turned],
        "compile_time": compile_time,
        "provenance": provenance(model),
    }

    def report(share: float, save: Callable[[], bytes]) -> None:
        tell(Progress(0.05 + 0.93 * share, f"time domain, {len(seeds)} seeds, {100 * share:.0f} %", save))

    try:
        with numerical("time_domain"):
            record, timing = march_ensemble(model, static, spec, seeds, threads, report, checkpoint)
    except NotConverged as failure:
        about["failures"] = {"time_domain": str(failure)}
        if not isinstance(failure, StepTooLong) or failure.partial is None:
            return Part(about)
        record, timing = failure.partial
    most = max(line.nodes for line in static.lines)
    lines = [
        {"name": line.name, "gap": most - line.nodes, "arc_length": line.element_arc.tolist(), "length": line.length,
         "anchor": line.anchor_end, "allowed": allowed_tension(line).tolist(),
         "push_limits": push_limits(line.arrays)} for line in static.lines
    ]  # fmt: skip
    omega, random = harmonic_omega(model.case), bool(model.case.environment.random)
    periodic = omega is None and "failures" not in about and whole_period(spec, timing.duration)
    part = time_part(record, timing, lines, low_border(model), omega, random, periodic)
    longest = longest_period(model, static) if random else None
    part.summary[KEY] |= {"longest_period": longest, "tolerance": float(spec.tolerance)}
    tell(Progress(1.0, "done"))
    return Part({**about, **part.summary}, (), part.arrays)
