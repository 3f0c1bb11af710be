"""Writes docs/validation-steps.md: errors of peaks and σ against what the march sees of its own steps (T16, T17).

Run: python docs/make_step_study.py
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from solver.case import parse_case
from solver.model.build import build
from solver.outcome import NotConverged
from solver.statics.solve import solve_statics
from solver.time_domain import lanes, resolution
from solver.time_domain.ensemble import Record, march_ensemble
from solver.time_domain.statistics import band_variances, over_seeds
from solver.vessel.data import FileSource

EXAMPLES = Path(__file__).parents[1] / "examples"
Case = dict[str, Any]
RISER = (0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.004)
BED = (0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
WEIGHED = 0.05  # of the largest range: elements with less are left out


def riser(case: int, size: float, period: float, elements: int = 34) -> Case:
    """The example riser with its top moved by `size` [m], or in a wave of that height."""
    data: Case = yaml.safe_load((EXAMPLES / f"hanging-riser-case{case}.yaml").read_text(encoding="utf-8"))
    data["lines"]["riser"]["segments"][0]["elements"] = elements
    if case == 1:
        data["lines"]["riser"]["end_b"]["motion"]["surge"].update(amplitude=size, period=period)
    else:
        data["environment"]["seastates"][0].update(height=size, period=period)
    return timed(data, 4 * period, 4 * period)


def span(length: float, a: Any, b: Any, elements: int, depth: float, **kind: Any) -> Case:
    """One line between two points."""
    line = {"segments": [{"type": "wire", "length": length, "elements": elements}],
            "end_a": {"pinned": list(a)}, "end_b": {"pinned": list(b)}, "allow_stretch": True}  # fmt: skip
    return {
        "slowdrift": 1, "name": "span", "environment": {"depth": depth, "water": {"density": 1000, "gravity": 9.807}},
        "line_types": {"wire": kind}, "lines": {"line": line}, "analyses": {},
    }  # fmt: skip


def bed(stiffness: float, transition: float, damping: float = 0.0, heave: float = 5.0, period: float = 12.0) -> Case:
    """A chain that is lifted off the bed and dropped on it."""
    data = span(420.0, (0, 0, -100), (380, 0, -5), 20, 100.0, mass=140.0, diameter=0.12, EA=6e8, EI=2e4)
    data["environment"]["seabed"] = {"node_stiffness": stiffness, "transition": transition, "damping": damping}
    return heaved(data, heave, period)


def taut(heave: float, period: float, elements: int = 20, EA: float = 6e8) -> Case:
    """A stretched line."""
    return heaved(
        span(400.0, (0, 0, -300), (270, 0, -5), elements, 300.0, mass=140.0, diameter=0.12, EA=EA), heave, period
    )


def heaved(data: Case, amplitude: float, period: float) -> Case:
    data["lines"]["line"]["end_b"]["motion"] = {"heave": {"amplitude": amplitude, "period": period}}
    return timed(data, 60.0, 60.0)


def buoy(current: float) -> Case:
    """A line with a buoy in a wave and a current."""
    data = span(160.0, (0, 0, -100), (60, 0, -2), 20, 100.0, mass=60.0, diameter=0.12, EA=5e7)
    item = {"mass": 500.0, "volume": 8.0, "drag_area": 3.0, "added_mass": 0.5}
    data["attachments"] = [{"line": "line", "arc_length": 120.0, **item}]
    data["environment"]["seastates"] = [{"wave": "regular", "height": 6, "period": 9, "direction": "0 deg"}]
    if current:
        data["environment"]["current"] = {"depths": [0], "speeds": [current], "direction": "30 deg"}
    return timed(data, 45.0, 45.0)


def piercing() -> Case:
    """A line whose top leaves the water and comes back, in a wave."""
    data = span(90.0, (0, 0, -60), (45, 0, 12), 18, 60.0, mass=60.0, diameter=0.25, EA=5e7, EI=5e4)
    data["environment"]["seastates"] = [{"wave": "regular", "height": 5, "period": 8, "direction": "0 deg"}]
    data["lines"]["line"]["end_b"]["motion"] = {"heave": {"amplitude": 4.0, "period": 8.0}}
    return timed(data, 40.0, 40.0)


def fpso() -> Case:
    """The storm of the example, 200 s of one seed."""
    data: Case = yaml.safe_load((EXAMPLES / "fpso-2000m.yaml").read_text(encoding="utf-8"))
    return timed(data, 100.0, 200.0)


def timed(data: Case, build_up: float, duration: float) -> Case:
    data["analyses"] = {"time_domain": {"build_up": build_up, "duration": duration}}
    return data


SYSTEMS: dict[str, tuple[Case, tuple[float, ...]]] = {
    "riser, top 10 m in 27 s": (riser(1, 10, 27), RISER),
    "riser, top 10 m in 14 s": (riser(1, 10, 14), RISER),
    "riser, top 10 m in 10 s, slack": (riser(1, 10, 10), RISER),
    "riser, top 10 m in 8 s, snaps": (riser(1, 10, 8), RISER),
    "riser, top 20 m in 14 s, snaps": (riser(1, 20, 14), RISER),
    "riser, top 5 m in 5 s, snaps": (riser(1, 5, 5), RISER),
    "riser, wave 10 m, 10 s": (riser(2, 10, 10, 68), RISER),
    "riser, wave 13 m, 8 s": (riser(2, 13, 8), RISER),
    "bed 20 kN/m, 0.5 m": (bed(2e4, 0.5), BED),
    "bed 200 kN/m, 0.5 m": (bed(2e5, 0.5), BED),
    "bed 200 kN/m, 0.05 m": (bed(2e5, 0.05), BED),
    "bed 2 MN/m, 0.05 m": (bed(2e6, 0.05), BED),
    "bed 2 MN/m, 0.05 m, damped": (bed(2e6, 0.05, 2e4), BED),
    "bed 20 MN/m, 0.05 m": (bed(2e7, 0.05), BED),
    "bed 20 MN/m, 0.01 m": (bed(2e7, 0.01), BED),
    "bed 200 kN/m, 0.1 m, 10 m in 8 s": (bed(2e5, 0.1, 0.0, 10.0, 8.0), BED),
    "taut, 1 m in 6 s": (taut(1.0, 6.0), RISER),
    "taut, 6 m in 8 s, snaps": (taut(6.0, 8.0), RISER),
    "taut and stiff, 1 m in 3 s": (taut(1.0, 3.0, 40, 3e9), (0.2, 0.1, 0.05, 0.02, 0.01, 0.004)),
    "buoy in waves": (buoy(0.0), RISER),
    "buoy in waves and 2 m/s": (buoy(2.0), RISER),
    "buoy in waves and 3 m/s": (buoy(3.0), RISER),
    "top in and out of the water": (piercing(), (0.4, 0.2, 0.1, 0.05, 0.02, 0.01, 0.004)),
    "FPSO, storm": (fpso(), (0.4, 0.2, 0.1, 0.04, 0.02)),
}


def march(data: Case, h: float) -> Record | str:
    """One seed with steps of h; what the solver said where it gave no answer."""
    data = copy.deepcopy(data)
    data["analyses"]["time_domain"] |= {"step": h, "output_step": h}
    source = FileSource(EXAMPLES)
    model = build(parse_case(data), source)
    spec = model.case.analyses.time_domain
    assert spec is not None
    try:
        return march_ensemble(model, solve_statics(model), spec, [1])[0]
    except NotConverged as failure:
        return str(failure)


def rows(name: str, data: Case, steps: tuple[float, ...]) -> list[tuple[str, float, float, float, float, float, str]]:
    """For every step: name, h, error of the peak and of σ of the worst element [%], kink and blow [%], verdict."""
    found = {h: march(data, h) for h in steps}
    answered = {h: record for h, record in found.items() if isinstance(record, Record)}
    best = answered[min(answered)]
    spread = best.highest - best.lowest
    judged = spread > WEIGHED * spread.max()
    out = []
    for h, record in answered.items():
        if h == min(answered):
            continue
        seen = {
            what: 100 * max([one.value for one in record.findings if one.what == what], default=0.0)
            for what in ("kink", "snatch", "blow")
        }
        peak = 100 * np.abs(record.highest / best.highest - 1)[judged].max()
        sigma = 100 * np.abs(record.tension.std(axis=0) / best.tension.std(axis=0) - 1)[judged].max()
        bend = max(seen["kink"], seen["snatch"])
        out.append((name, h, float(peak), float(sigma), bend, seen["blow"], verdict(seen)))
    return out


LIMITS = (resolution.KINK_WARNED, resolution.KINK_REFUSED, resolution.BLOW_REFUSED, resolution.SNATCH_REFUSED)


def verdict(seen: dict[str, float]) -> str:
    """What a user gets."""
    warned, refused, blown, snatched = (100 * limit for limit in LIMITS)
    if seen["kink"] > refused or seen["blow"] > blown or seen["snatch"] > snatched:
        return "refused"
    if seen["snatch"] > warned:
        return "warned of a snatch"
    return "warned" if seen["kink"] > warned or seen["blow"] > 0 else "silent"


MOTION_STEPS = (0.02, 0.04, 0.1, 0.2)


def motions() -> list[list[str]]:
    """Errors of σ of the FPSO's motions by band and step, against the shortest step with the memory at its every step [%].

    Two seeds of the storm with memory of radiation, 1005 s kept: slow drift decays by what damps it alone, so that its σ
    shows a false damping of the memory (T6).
    """
    data: Case = yaml.safe_load((EXAMPLES / "fpso-2000m.yaml").read_text(encoding="utf-8"))
    found = {}
    for h in MOTION_STEPS:
        data["analyses"] = {"time_domain": {
            "build_up": 600.0, "duration": 1005.2, "step": h, "output_step": 0.4, "seeds": 2
        }}  # fmt: skip
        fine = h == min(MOTION_STEPS)
        found[h] = _motion_sigmas(data, memory_step=h if fine else lanes.MEMORY_STEP)
    best = found[min(MOTION_STEPS)]
    return [
        [
            f"{h:g}",
            *(f"{100 * (one / other - 1):+.2f}" for one, other in zip(sigmas.ravel(), best.ravel(), strict=True)),
        ]
        for h, sigmas in found.items()
        if h > min(MOTION_STEPS)
    ]


def _motion_sigmas(data: Case, memory_step: float) -> np.ndarray:
    """σ of surge, sway and yaw at wave and low frequencies, (3, 2)."""
    model = build(parse_case(data), FileSource(EXAMPLES))
    spec = model.case.analyses.time_domain
    assert spec is not None
    usual, lanes.MEMORY_STEP = lanes.MEMORY_STEP, memory_step
    try:
        record, timing = march_ensemble(model, solve_statics(model), spec, [1, 2], 2)
    finally:
        lanes.MEMORY_STEP = usual
    history = np.moveaxis(record.vessel, 1, -1)[:, [0, 1, 5]]
    bands = over_seeds(*band_variances(history, timing.every * timing.h, 0.2, True))
    return np.stack([bands["wf"], bands["lf"]], axis=-1)


def page(table: list[tuple[str, float, float, float, float, float, str]], moved: list[list[str]]) -> str:
    """The page: what the limits let through, then every run."""
    silent = max(max(row[2], row[3]) for row in table if row[6] == "silent")
    let, snatched = (
        max(max(row[2], row[3]) for row in table if row[6] == said) for said in ("warned", "warned of a snatch")
    )
    good = [row for row in table if row[6] == "refused"]
    hard = sum(max(row[2], row[3]) < 5.0 for row in good)
    lines = [
        "# Steps long and short", "",
        "How far off peaks and standard deviations of tension are when steps are too long, and what the time domain says",
        "of them ([theory](theory.md), T16, T17). Written by `python docs/make_step_study.py` from real runs; each is",
        "compared with the shortest step of its system. Errors are those of the worst element with more than",
        f"{100 * WEIGHED:g} % of the largest range.", "",
        f"Accepted runs: the error is at most {silent:.1f} % without a warning and {let:.1f} % with one of kinks or blows.",
        "Where a line was slack and tightens with a snatch, the warning says so, and the worst element is wrong by up to",
        f"{snatched:.0f} %: stress waves after a snatch are short and hardly damped, and a shorter step shows more of them.",
        "Such a peak is an order of magnitude; a bed of wider transition, or damping, removes most of it.",
        f"{hard} of {len(good)} rejected runs have an error below 5 %.", "",
        "Every run here was marched to its end, its limits off. A user's run that is refused stops as soon as it exceeds",
        "twice a limit; it names the step, or the tolerance, that did in a trial, and what it computed is kept apart as",
        "doubtful ([summary](summary.md#a-time-domain-that-was-refused)).", "",
        "| system | step, s | peak, % | σ, % | kink, % | blow, % | answer |", "| --- | --- | --- | --- | --- | --- | --- |",
    ]  # fmt: skip
    for name, h, peak, sigma, kink, blow, said in table:
        struck = f"{blow:.1f}" if blow else ""
        lines.append(f"| {name} | {h:g} | {peak:.2f} | {sigma:.2f} | {kink:.2f} | {struck} | {said} |")
    lines += [
        "", "## Motion of the vessel", "",
        "Error of the standard deviation of the FPSO's motions in its storm, %, against a step of",
        f"{min(MOTION_STEPS):g} s whose memory of radiation has a sample at every step; two seeds, 1005 s kept. The memory",
        "has a sample every 0.2 s elsewhere. Slow motion is damped so little that its standard deviation shows any false",
        "damping of the memory (theory.md, T6).", "",
        "| step, s | WF surge | LF surge | WF sway | LF sway | WF yaw | LF yaw |",
        "|" + " --- |" * 7,
        *("| " + " | ".join(row) + " |" for row in moved),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def main(tell: Callable[[str], None] = print) -> None:
    """March everything with the limits off, judge with them."""
    resolution.KINK_WARNED, resolution.KINK_REFUSED, resolution.BLOW_REFUSED, resolution.SNATCH_REFUSED = (
        0.0,
        1e9,
        1e9,
        1e9,
    )
    table = []
    for name, (data, steps) in SYSTEMS.items():
        tell(name)
        table += rows(name, data, steps)
    tell("motions")
    Path(__file__).with_name("validation-steps.md").write_text(page(table, motions()), encoding="utf-8")


if __name__ == "__main__":
    main()
