"""Speed beside MoorDyn: the four lines of the FPSO example, the same harmonic motion of the fairleads, no waves, one thread.

    pip install moordyn
    python benchmarks/against_moordyn.py [--quick] [--repeat 5]

Each code runs at the setting (step, and integrator or tolerance) at which it is fastest among those whose tension at the
fairlead is right: standard deviation, least and largest value over 600 s, of every line, within 1 % of its own refined
solution. Runs alternate; medians of processor time are shown, so that a busy machine spoils little. MoorDyn's initial
relaxation and Slowdrift's statics are not timed.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import yaml

from solver.case import parse_case
from solver.model.build import build
from solver.outcome import NotConverged
from solver.statics.solve import solve_statics
from solver.time_domain.ensemble import march_ensemble
from solver.vessel.data import FileSource
from solver.warm import warm_up, warm_up_time_domain

try:
    import moordyn
except ImportError:
    moordyn = None

Array = np.ndarray
EXAMPLES = Path(__file__).parents[1] / "examples"
PERIOD, SURGE, HEAVE, LEAD = 13.5, 2.8, 3.3, 70.0  # s, m, m, degrees: the storm's motion of a fairlead
BUILD_UP = 81.0
SAMPLE = 0.1  # s between tensions taken from MoorDyn
GOOD = 0.01
MOORDYN_SETTINGS = (
    ("RK2", (0.04, 1 / 30, 0.025, 0.0125, 0.00625, 0.003125)),
    ("RK4", (0.05, 0.04, 1 / 30, 0.025, 0.0125, 0.00625)),
    ("midpoint5", (0.1, 0.05, 1 / 30, 0.025, 0.0125, 0.00625)),
    ("BEuler20", (0.1, 0.05, 0.025)),
    ("ACA5", (0.05, 0.025, 0.0125)),
    ("Wilson5", (0.05, 0.025, 0.0125)),
)
OUR_STEPS = (0.5, 0.45, 0.4, 0.375, 0.35, 0.3, 0.25, 0.2, 0.15, 0.1, 0.05)
OUR_TOLERANCES = (1e-3, 3e-4, 1e-4, 1e-6)


@dataclass(frozen=True)
class Setting:
    """How a code marches: name of integrator or tolerance, and step [s]."""

    how: str
    step: float

    def __str__(self) -> str:
        return f"{self.how} {1e3 * self.step:.4g} ms"


@dataclass(frozen=True)
class Answer:
    """Tension of the uppermost element over the kept time: rows σ, least, largest, mean; a column per line [N]."""

    tension: Array
    seconds: float
    simulated: float
    setting: Setting

    @property
    def speed(self) -> float:
        """Simulated over real time."""
        return self.simulated / self.seconds

    def misses(self, other: Answer) -> float:
        """Largest relative difference of σ, least and largest tension over the lines."""
        return float(np.abs(self.tension[:3] / other.tension[:3] - 1).max())


def described(tension: Array) -> Array:
    return np.array([tension.std(axis=0), tension.min(axis=0), tension.max(axis=0), tension.mean(axis=0)])


def ends_of_the_lines() -> tuple[list[Array], list[Array]]:
    """Anchors and fairleads of the example in its static position."""
    data = yaml.safe_load((EXAMPLES / "fpso-2000m.yaml").read_text())
    data["analyses"] = {"statics": {}}
    static = solve_statics(build(parse_case(data), FileSource(EXAMPLES)))
    return [shape[0] for shape in static.state.shapes], [shape[-1] for shape in static.state.shapes]


class Ours:
    """Slowdrift on those lines. seabed : as in a case."""

    def __init__(self, ends: tuple[list[Array], list[Array]], kept: float, elements: int, seabed: dict[str, float]):
        self.ends, self.kept, self.elements, self.seabed = ends, kept, elements, seabed

    def case(self, setting: Setting) -> dict[str, Any]:
        data: dict[str, Any] = yaml.safe_load((EXAMPLES / "fpso-2000m.yaml").read_text())
        del data["vessel"], data["environment"]["seastates"]
        motion = {
            "surge": {"amplitude": SURGE, "period": PERIOD},
            "heave": {"amplitude": HEAVE, "period": PERIOD, "phase": f"{LEAD} deg"},
        }
        for line, anchor, fairlead in zip(data["lines"].values(), *self.ends, strict=True):
            line.pop("multiplicity")
            line["segments"][0]["elements"] = self.elements
            line["end_a"] = {"pinned": anchor.tolist()}
            line["end_b"] = {"pinned": fairlead.tolist(), "motion": motion}
        data["environment"]["seabed"] = self.seabed
        h = setting.step
        data["analyses"] = {"time_domain": {"step": h, "build_up": round(BUILD_UP / h) * h, "duration": self.kept,
                                            "output_step": h, "tolerance": float(setting.how)}}  # fmt: skip
        return data

    def run(self, setting: Setting) -> Answer | None:
        model = build(parse_case(self.case(setting)), None)
        static, spec = solve_statics(model), model.case.analyses.time_domain
        assert spec is not None
        started = time.process_time()
        try:
            record, _ = march_ensemble(model, static, spec, [1], 1)
        except NotConverged:  # a step that Slowdrift itself refuses
            return None
        seconds = time.process_time() - started
        return Answer(described(record.tension[:, -1, :, 0].astype(float)), seconds, BUILD_UP + self.kept, setting)


class Theirs:
    """MoorDyn on those lines. stiffness [Pa/m], damping [Pa s/m] of its seabed; axial damping at its usual 0.8."""

    def __init__(
        self, ends: tuple[list[Array], list[Array]], kept: float, elements: int, stiffness: float, damping: float
    ):
        self.ends, self.kept, self.elements, self.bed = ends, kept, elements, (stiffness, damping)

    def deck(self, setting: Setting) -> str:
        points, lines = [], []
        for k, (anchor, fairlead) in enumerate(zip(*self.ends, strict=True)):
            for number, kind, at in ((2 * k + 1, "Fixed", anchor), (2 * k + 2, "Coupled", fairlead)):
                points.append(f"{number} {kind} {at[0]:.9f} {at[1]:.9f} {at[2]:.9f} 0 0 0 0")
            lines.append(f"{k + 1} wire {2 * k + 1} {2 * k + 2} 3300 {self.elements} -")
        options = {
            "dtM": setting.step, "tScheme": setting.how, "WtrDnsty": 1025, "g": 9.807, "WtrDpth": 2000,
            "kBot": self.bed[0], "cBot": self.bed[1], "writeLog": 0, "dtOut": 1e6, "disableOutTime": 1, "dtIC": 2.0,
            "TmaxIC": 60, "threshIC": 1e-3, "CdScaleIC": 4.0,
        }  # fmt: skip
        return "\n".join([
            "MoorDyn input", "four lines",
            "--- LINE TYPES ---", "Name Diam Mass EA BA EI Cd Ca CdAx CaAx", "(-) (-) (-) (-) (-) (-) (-) (-) (-) (-)",
            "wire 0.15 150.0 1.0e9 -0.8 5.0e4 1.0 1.0 0.0 0.0",
            "--- POINTS ---", "ID Attachment X Y Z M V CdA CA", "(-) (-) (-) (-) (-) (-) (-) (-) (-)", *points,
            "--- LINES ---", "ID LineType A B UnstrLen NumSegs Outputs", "(-) (-) (-) (-) (-) (-) (-)", *lines,
            "--- OPTIONS ---", *(f"{value} {name}" for name, value in options.items()), "--- END ---", "",
        ])  # fmt: skip

    def run(self, setting: Setting) -> Answer | None:
        h = setting.step
        count, every = round((BUILD_UP + self.kept) / h), max(round(SAMPLE / h), 1)
        start = np.array(self.ends[1]).ravel()
        places = [list(row) for row in start + _motion(h * np.arange(count + 1) - BUILD_UP, len(self.ends[1]))]
        rates = [list(row) for row in np.diff(places, axis=0) / h]
        with tempfile.TemporaryDirectory() as folder, _Silence():
            path = Path(folder) / "lines.txt"
            path.write_text(self.deck(setting))
            system = moordyn.Create(str(path))
            try:
                moordyn.Init(system, list(start), [0.0] * start.size)
                lines = [moordyn.GetLine(system, k + 1) for k in range(len(self.ends[1]))]
                tension = []
                started = time.process_time()
                for k in range(count):
                    moordyn.Step(system, places[k], rates[k], k * h, h)
                    if (k + 1) % every == 0 and (k + 1) * h > BUILD_UP:
                        tension.append([moordyn.GetLineFairTen(line) for line in lines])
                seconds = time.process_time() - started
            except Exception:  # MoorDyn's own errors have no class of their own
                return None
            finally:
                moordyn.Close(system)
        return Answer(described(np.array(tension)), seconds, BUILD_UP + self.kept, setting)


def _motion(times: Array, lines: int) -> Array:
    """Displacement of all fairleads, (T, 3 lines), with Slowdrift's smooth rise over half the build-up (T4)."""
    u = np.clip((times + BUILD_UP) / (0.5 * BUILD_UP), 0.0, 1.0)
    rise, w = u**3 * (10 - 15 * u + 6 * u * u), 2 * math.pi / PERIOD
    moved = np.zeros((times.size, lines, 3))
    moved[:, :, 0] = (rise * SURGE * np.cos(w * times))[:, None]
    moved[:, :, 2] = (rise * HEAVE * np.cos(w * times + math.radians(LEAD)))[:, None]
    return moved.reshape(times.size, -1)


class _Silence:
    """MoorDyn writes to the process's own output whatever it is told."""

    def __enter__(self) -> None:
        sys.stdout.flush()
        self.kept = [os.dup(1), os.dup(2)]
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        os.close(nowhere)

    def __exit__(self, *_: object) -> None:
        for target, one in zip((1, 2), self.kept, strict=True):
            os.dup2(one, target)
            os.close(one)


def fastest(code: Ours | Theirs, settings: list[list[Setting]], refined: Answer) -> Answer | None:
    """The fastest valid answer: of each integrator or tolerance the largest valid step."""
    best = None
    for one in settings:
        for setting in one:
            answer = code.run(setting)
            if answer is not None and answer.misses(refined) <= GOOD:
                if best is None or answer.seconds < best.seconds:
                    best = answer
                break
    return best


def searched(theirs: Theirs, quick: bool) -> tuple[Answer, Answer | None]:
    """MoorDyn's refined and its fastest valid answer."""
    scale = 50 / theirs.elements  # the largest axial frequency grows with the number of elements
    schemes = MOORDYN_SETTINGS[:1] if quick else MOORDYN_SETTINGS[:3] if scale < 1 else MOORDYN_SETTINGS
    refined = theirs.run(Setting("RK4", 0.00625 * scale)) or theirs.run(Setting("RK4", 0.003125 * scale))
    assert refined is not None
    return refined, fastest(theirs, [[Setting(how, h * scale) for h in steps] for how, steps in schemes], refined)


def compare(
    title: str, ours: Ours, theirs: Theirs, found: tuple[Answer, Answer | None], repeat: int, quick: bool
) -> None:
    """Search our fastest valid setting, run both in turn, and print speeds, misses and the ratio."""
    their_refined, them = found
    our_refined = ours.run(Setting("1e-06", 0.0125))
    assert our_refined is not None
    tolerances = OUR_TOLERANCES[:1] if quick else OUR_TOLERANCES
    mine = fastest(ours, [[Setting(f"{tol:g}", h) for h in OUR_STEPS] for tol in tolerances], our_refined)
    if mine is None or them is None:
        print(f"{title:>28}  no valid setting: ours {mine and mine.setting}, MoorDyn {them and them.setting}")
        return
    runs: tuple[list[float], list[float]] = ([mine.seconds], [them.seconds])
    for _ in range(repeat - 1):
        for code, answer, seconds in ((ours, mine, runs[0]), (theirs, them, runs[1])):
            again = code.run(answer.setting)
            assert again is not None
            seconds.append(again.seconds)
    mine, them = (replace(a, seconds=statistics.median(t)) for a, t in zip((mine, them), runs, strict=True))
    print(
        f"{title:>28}  {mine.setting!s:>16} {mine.speed:>7.0f}  {100 * mine.misses(our_refined):>5.2f}"
        f"  {them.setting!s:>18} {them.speed:>7.0f}  {100 * them.misses(their_refined):>5.2f}  {mine.speed / them.speed:>6.1f}"
    )
    gap = 100 * (our_refined.tension[:, 0] / their_refined.tension[:, 0] - 1)
    sigma, low, high, mean = our_refined.tension[:, 0] / 1e3
    print(f"{'refined, kN (off MoorDyn)':>28}  σ {sigma:.1f} ({gap[0]:+.2f} %), least {low:.0f} ({gap[1]:+.2f} %), "
          f"largest {high:.0f} ({gap[2]:+.2f} %), mean {mean:.0f} ({gap[3]:+.2f} %)", flush=True)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one integrator, one tolerance")
    parser.add_argument("--elements", type=int, choices=(50, 200), help="only lines of so many elements")
    parser.add_argument("--repeat", type=int, default=5, help="runs of each; medians are shown")
    parser.add_argument(
        "--kept", type=float, default=600.0, help="seconds of the motion that are kept (default: %(default)g)"
    )
    given = parser.parse_args()
    if moordyn is None:
        sys.exit("This comparison needs MoorDyn, which Slowdrift itself does not: pip install moordyn")
    warm_up()
    warm_up_time_domain()
    ends = ends_of_the_lines()
    print(
        f"{'':>28}  {'Slowdrift':>16} {'× real':>7}  {'off %':>5}  {'MoorDyn':>18} {'× real':>7}  {'off %':>5}  {'ratio':>6}"
    )
    soft, usual = (3e5, 3e4), (3e6, 3e5)  # Pa/m, Pa s/m; the second is MoorDyn's default
    for title, elements, bed in (
        ("50 elements, soft seabed", 50, soft), ("50 elements, default seabed", 50, usual),
        ("200 elements, soft seabed", 200, soft),
    ):  # fmt: skip
        if given.elements not in (None, elements):
            continue
        theirs = Theirs(ends, given.kept, elements, *bed)
        found = searched(theirs, given.quick)
        example = {"node_stiffness": 30e3 * 50 / elements, "transition": 0.5}
        compare(title, Ours(ends, given.kept, elements, example), theirs, found, given.repeat, given.quick)
        same = {"soil": bed[0], "transition": 0.1, "damping": bed[1] * 0.15 * 3300 / elements}
        compare(
            "ours on MoorDyn's seabed", Ours(ends, given.kept, elements, same), theirs, found, given.repeat, given.quick
        )


if __name__ == "__main__":
    main()
