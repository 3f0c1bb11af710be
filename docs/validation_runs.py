"""The runs behind docs/validation.md: examples and their variations, solved for real."""

from __future__ import annotations

import copy
import hashlib
import json
import pickle
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from solver.case import parse_case
from solver.plan import plan
from solver.results.part import Result
from solver.run import merge, run, run_chunk
from solver.vessel.data import DataSource, FileSource, HydrodynamicData

EXAMPLES = Path(__file__).parents[1] / "examples"
FACTORS = (1.0, 0.3, 0.1, 0.03)
DRAG = (0.5, 0.75, 1.0, 1.5, 2.0)
SEAS = (2.0, 4.0, 8.0, 12.0, 16.0)
FREQUENCIES = (0.2, 0.3, 0.34, 0.42)
SIDE_SEEDS = 4
FINER = {"step": "0.02 s", "output_step": "0.02 s", "tolerance": 1e-8, "build_up": "600 s"}
Case = dict[str, Any]
Summary = dict[str, Any]


@dataclass(frozen=True)
class Scaled:
    """The barge with its mean drift multiplied."""

    drift: float

    def open(self, reference: str) -> HydrodynamicData:
        data = FileSource(EXAMPLES).open(reference)
        assert data.mean_drift is not None
        return replace(data, mean_drift=data.mean_drift * self.drift)


@dataclass(frozen=True)
class Pair:
    """One FPSO case in both domains: the whole result by components, and the frequency domain by vector."""

    result: Result
    vector: Result

    @property
    def summary(self) -> Summary:
        return self.result.summary


@dataclass(frozen=True)
class Runner:
    """Solves cases. seeds, duration : of the FPSO's time domain, None as the example has them.

    keep : a folder that holds what was solved.
    """

    seeds: int | None = None
    duration: float | None = None
    threads: int = 2
    keep: Path | None = None
    tell: Callable[[str], None] = print

    def solve(self, label: str, data: Case, source: DataSource | None = None, frequency_only: bool = False) -> Result:
        """The result of plain data; raises when an analysis failed."""
        text = json.dumps([data, repr(source), frequency_only], sort_keys=True)
        kept = self.keep / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.pickle" if self.keep else None
        if kept is not None and kept.exists():
            found: Result = pickle.loads(kept.read_bytes())
            return found
        self.tell(label)
        case = parse_case(data)
        if frequency_only:
            result = merge(case, [run_chunk(case, source, chunk) for chunk in plan(case) if chunk.kind != "time"])
        else:
            result = run(case, source, threads=self.threads)
        if result.summary["failures"]:
            raise RuntimeError(f"{label}: {result.summary['failures']}")
        if kept is not None:
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_bytes(pickle.dumps(result))
        return result

    def fpso(self, **changes: Any) -> Case:
        """Plain data of the FPSO; see `changed`."""
        data = changed(example("fpso-2000m"), **changes)
        time = data["analyses"]["time_domain"]
        time["seeds"] = min(self.seeds or time["seeds"], changes.get("at_most", 10_000))
        if self.duration is not None:
            time["duration"], time["build_up"] = f"{self.duration} s", f"{min(1200.0, self.duration)} s"
        return data

    def pair(self, label: str, data: Case, source: DataSource | None = None) -> Pair:
        """Both domains, drag linearised by components; then the frequency domain alone, by vector."""
        source = source or FileSource(EXAMPLES)
        result = self.solve(label, data, source)
        other = changed(data, linearisation="vector")
        return Pair(result, self.solve(f"{label}, vector", other, source, True))

    def linear(self, label: str, data: Case) -> Summary:
        """Summary without the time domain."""
        data = copy.deepcopy(data)
        data["analyses"].pop("time_domain", None)
        return self.solve(label, data, FileSource(EXAMPLES)).summary


@dataclass
class Study:
    """Everything the page shows. riser : by case (1, 2) and amplitude factor; sweeps and scan by value.

    finer : case 2 with finer settings (`FINER`); slack : the FPSO on lines that carry no compression.
    """

    riser: dict[tuple[int, float], Result]
    fpso: Pair
    drag: dict[float, Summary]
    sea: dict[float, Summary]
    scan: dict[str, Summary]
    no_low: Summary
    finite: Summary
    side: dict[str, Pair] = field(default_factory=dict)
    finer: Result | None = None
    slack: Result | None = None


def example(name: str) -> Case:
    """Plain data of an example."""
    data: Case = yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    return data


def riser_case(case: int, factor: float = 1.0) -> Case:
    """A riser example with its excitation scaled; a small motion has little drag and is given longer to settle."""
    data = example(f"hanging-riser-case{case}")
    data["analyses"]["frequency_domain"]["tolerance"] = 1e-6
    if factor < 1:
        data["analyses"]["time_domain"]["build_up"] = {1: "864 s", 2: "800 s"}[case]
    if case == 1:
        data["lines"]["riser"]["end_b"]["motion"]["surge"]["amplitude"] = f"{10 * factor} m"
    else:
        data["environment"]["seastates"][0]["height"] = f"{10 * factor} m"
    return data


def changed(
    data: Case,
    cd: float | None = None,
    hs: float | None = None,
    drift: str | None = None,
    low: bool = True,
    kinematics: str | None = None,
    frequency: float | None = None,
    coarse: bool = False,
    linearisation: str | None = None,
    at_most: int | None = None,
    compression: str | None = None,
) -> Case:
    """A copy of the FPSO's data with what is named replaced. coarse : strips twice as wide."""
    data = copy.deepcopy(data)
    spec = data["analyses"]["frequency_domain"]
    if cd is not None:
        data["line_types"]["wire"]["drag"]["normal"] = cd
    if hs is not None:
        data["environment"]["seastates"][0]["hs"] = f"{hs} m"
    if drift is not None:
        data["vessel"]["hydrodynamics"]["drift"] = drift
    if kinematics is not None:
        data["vessel"]["fairlead_kinematics"] = kinematics
    if frequency is not None:
        data["vessel"]["hydrodynamics"] |= {"radiation": "constant", "frequency": frequency}
    if linearisation is not None:
        spec["linearisation"] = linearisation
    if compression is not None:
        data["line_types"]["wire"]["compression"] = compression
    if not low:
        spec["include_low_velocities"] = False
    if coarse:
        for band in ("wave", "low"):
            spec[band]["step"] *= 2.0
    return data


def whole_study(runner: Runner, side: bool = True) -> Study:
    """Every run of the page."""
    riser = {
        (case, factor): runner.solve(f"riser, case {case}, factor {factor:g}", riser_case(case, factor))
        for case in (1, 2)
        for factor in FACTORS
    }
    finer = riser_case(2)
    finer["analyses"]["time_domain"] |= FINER
    base = runner.fpso()
    study = Study(
        riser,
        runner.pair("FPSO, all seeds", base),
        {cd: runner.linear(f"drag coefficient {cd:g}", changed(base, cd=cd, coarse=True)) for cd in DRAG},
        {hs: runner.linear(f"Hs {hs:g} m", changed(base, hs=hs, coarse=True)) for hs in SEAS},
        {
            **{f"{w:g}": runner.linear(f"radiation at {w:g} rad/s", changed(base, frequency=w)) for w in FREQUENCIES},
            "follows": runner.linear("radiation follows the frequency", base),
        },
        runner.linear("no low velocities", changed(base, low=False)),
        runner.linear("finite kinematics", changed(base, kinematics="finite")),
        finer=runner.solve("riser, case 2, finer", finer),
    )
    if side:
        none = changed(base, compression="none")
        study.slack = runner.solve("FPSO without compression, all seeds", none, FileSource(EXAMPLES))
        for name, (label, changes, source) in SIDE.items():
            study.side[name] = runner.pair(label, runner.fpso(at_most=SIDE_SEEDS, **changes), source)
    return study


SIDE: dict[str, tuple[str, dict[str, Any], DataSource | None]] = {
    "similar": ("a tenth of the motion, the same drag per motion", {"hs": 1.57, "cd": 10.0}, Scaled(10.0)),
    "sea": ("Hs times 0.3", {"hs": 0.3 * 15.7}, None),
    "waves": ("waves without drift forces", {"drift": "none"}, None),
}


def half_range(result: Result) -> np.ndarray:
    """Half the range of element tension along the riser [N]."""
    line = result.summary["time_domain"]["lines"]["riser"]
    return 0.5 * (np.array(line["tension_max"]) - np.array(line["tension_min"]))


def harmonic(result: Result) -> np.ndarray:
    """First harmonic of element tension along the riser, time domain [N]."""
    return np.array(result.summary["time_domain"]["lines"]["riser"]["tension_first_harmonic"])


def amplitude(result: Result) -> np.ndarray:
    """Amplitude of element tension along the riser, frequency domain [N]."""
    return np.array(result.summary["frequency_domain"]["lines"]["riser"]["tension_amplitude"])


def gap(of: np.ndarray, against: np.ndarray) -> float:
    """Mean over the line of the relative difference, percent."""
    return float(100.0 * np.mean(np.abs(of / against - 1.0)))


def channel(result: Result, name: str) -> Any:
    """A channel by name."""
    return next(one for one in result.channels if one.name == name)


def end_tension(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Time [s] and the riser's top end tension [kN]."""
    found = channel(result, "time/line/riser/end_b_tension")
    return found.axes[0].values, 1e-3 * found.values[:, 0].astype(float)


def digitised(case: int) -> np.ndarray:
    """Time [s] and top tension [kN] of the digitised plot (n, 2)."""
    return np.loadtxt(Path(__file__).with_name("data") / f"riser-top-tension-case{case}.csv", delimiter=",")


def aligned(result: Result, case: int) -> tuple[np.ndarray, np.ndarray, float]:
    """The digitised time axis, our tension on it at the shift of the largest correlation [kN], and the rms difference."""
    period = {1: 27.0, 2: 10.0}[case]
    time, tension = end_tension(result)
    paper = digitised(case)
    last = time > time[-1] - period
    phase = np.mod(time[last], period)
    order = np.argsort(phase)

    def at(shift: float) -> np.ndarray:
        return np.interp(np.mod(paper[:, 0] + shift, period), phase[order], tension[last][order], period=period)

    late = paper[:, 0] > paper[-1, 0] - np.floor((paper[-1, 0] - 1.0) / period) * period
    shifts = np.arange(0.0, period, 0.02)
    fit = [float(np.corrcoef(at(shift)[late], paper[late, 1])[0, 1]) for shift in shifts]
    ours = at(float(shifts[int(np.argmax(fit))]))
    return paper[:, 0], ours, float(np.sqrt(np.mean((ours - paper[:, 1])[late] ** 2)))


def mode(summary: Summary, label: str) -> dict[str, Any]:
    """The mode of longest period with a label."""
    found: dict[str, Any] = next(one for one in summary["modes"] if one["label"] == label)
    return found
