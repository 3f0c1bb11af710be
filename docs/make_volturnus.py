"""Writes docs/validation-volturnus.md and its plots from real runs: `python docs/make_volturnus.py [--keep FOLDER]`.

Needs the public files of VolturnUS-S (examples/volturnus-s.yaml says where they are) in the folder that
SLOWDRIFT_VOLTURNUS names, and the extra `docs`. About four minutes on two cores.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

from make_validation import _filled, version
from validation_tables import table
from volturnus_runs import ROOT, Runner, Solved, Summary, example, linear_hull, modes_only
from volturnus_text import TEXT

MOTIONS = {"surge": ("m", 1.0), "heave": ("m", 1.0), "pitch": ("deg", 180 / np.pi)}
RAFT = {"surge": 128.4, "heave": 20.4, "pitch": 27.5}
REPORT = {"surge": 142.9, "heave": 20.4, "pitch": 27.8, "yaw": 90.9}
MOTION_AND_LINES = ("surge", "heave", "pitch", "head", "port")


def periods(summary: Summary) -> dict[str, float]:
    found: dict[str, float] = {}
    for mode in summary["modes"]:
        found.setdefault(mode["label"], mode["period"])
    return found


def periods_table(runner: Runner) -> str:
    deck, thin = periods(runner(modes_only(0.333)).summary), periods(runner(modes_only(0.185)).summary)
    moved = periods(runner(modes_only(0.333, **moved_centre())).summary)
    fine = periods(runner(modes_only(0.333, environment__seabed__transition=0.02, lines=finer())).summary)
    rows = []
    for motion in ("surge", "heave", "pitch", "yaw"):
        raft = RAFT.get(motion)
        against = [f"{raft:.1f}", f"{100 * (thin[motion] / raft - 1):+.1f}"] if raft else ["", ""]
        rows.append([
            motion, f"{thin[motion]:.1f}", *against,
            f"{deck[motion]:.1f}", f"{REPORT[motion]:.1f}", f"{100 * (deck[motion] / REPORT[motion] - 1):+.1f}",
            f"{fine[motion]:.1f}", f"{moved[motion]:.1f}",
        ])  # fmt: skip
    head = ["period, s", "chain of 0.185 m", "RAFT", "gap, %", "example", "report", "gap, %"]
    return table([*head, "150 elements, bed 0.02 m", "centre at -14.40 m"], rows)


def moved_centre() -> dict[str, Any]:
    """The platform's centre as the OpenFAST files have it: all at -1.7 m, 4.45e10 kg m2."""
    lines = example().model_dump(mode="json", exclude_none=True)["lines"]
    for line in lines.values():
        line["end_b"]["fairlead"][2] = -12.3
    inertia = [[4.45e10, 0, 0], [0, 4.45e10, 0], [0, 0, 2.4e10]]
    return {
        "vessel__mass": 2.0118e7,
        "vessel__centre_of_gravity": [0, 0, -1.7],
        "vessel__inertia": inertia,
        "lines": lines,
    }


def finer() -> dict[str, Any]:
    lines: dict[str, Any] = example().model_dump(mode="json", exclude_none=True)["lines"]
    for line in lines.values():
        line["segments"][0]["elements"] = 150
    return lines


def value(summary: Summary, domain: str, band: str, what: str, same_waves: bool = False) -> float:
    """σ of a motion [m, rad], or of the tension of a line's element at the fairlead [N]."""
    part = summary[domain]
    if what in MOTIONS:
        place = part["same_waves"] if same_waves else part
        return float(place["vessel_std"][band][what])
    return float(part["lines"][what]["tension_std"][band][-1])


def error(summary: Summary, band: str, what: str) -> float:
    part = summary["time_domain"]
    return float(
        part["vessel_std_error"][band][what] if what in MOTIONS else part["lines"][what]["tension_std_error"][band][-1]
    )


def sigma_table(summary: Summary) -> str:
    rows = []
    for what in MOTION_AND_LINES:
        unit, factor = MOTIONS.get(what, ("kN", 1e-3))
        label = f"{what}, {unit}" if what in MOTIONS else f"tension of {what}, kN"
        for band in ("wf", "lf"):
            time = value(summary, "time_domain", band, what)
            frequency = value(summary, "frequency_domain", band, what)
            same = f"{value(summary, 'frequency_domain', band, what, True) / time:.3f}" if what in MOTIONS else ""
            numbers = (factor * frequency, factor * time, factor * error(summary, band, what))
            rows.append(
                [label, band.upper(), *(f"{number:.4g}" for number in numbers), f"{frequency / time:.3f}", same]
            )
    return table(["σ of", "band", "frequency domain", "time domain", "± s.e.", "ratio", "ratio, same waves"], rows)


def variants_table(named: dict[str, Summary]) -> str:
    rows = []
    for name, summary in named.items():
        cells = []
        for what, band in (("surge", "wf"), ("heave", "wf"), ("pitch", "wf"), ("surge", "lf"), ("heave", "lf"), ("pitch", "lf"),
                           ("head", "wf"), ("head", "lf"), ("port", "wf"), ("port", "lf")):  # fmt: skip
            same = what in MOTIONS
            ratio = value(summary, "frequency_domain", band, what, same) / value(summary, "time_domain", band, what)
            cells.append(f"{ratio:.3f}")
        rows.append([name, *cells])
    head = ["frequency / time domain", *(f"{what} {band}" for what, band in (
        ("surge", "WF"), ("heave", "WF"), ("pitch", "WF"), ("surge", "LF"), ("heave", "LF"), ("pitch", "LF"), ("head", "WF"),
        ("head", "LF"), ("port", "WF"), ("port", "LF")))]  # fmt: skip
    return table(head, rows)


def draw(solved: Solved, folder: Path) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt
    from validation_plots import FREQUENCY, TIME, _save

    folder.mkdir(parents=True, exist_ok=True)
    figure, axes = plt.subplots(2, 2, figsize=(10, 6.4))
    for axis, what in zip(axes.flat, ("surge", "heave", "pitch", "head"), strict=True):
        names = (
            (f"frequency/vessel/{what}", f"time/vessel/{what}_spectrum")
            if what in MOTIONS
            else (f"frequency/line/{what}/top_tension", f"time/line/{what}/top_tension_spectrum")
        )
        factor = MOTIONS.get(what, ("kN", 1e-3))[1] ** 2
        for name, color, label in zip(names, (FREQUENCY, TIME), ("frequency domain", "time domain"), strict=True):
            omega, spectrum = solved.channel(name)
            axis.semilogy(omega, factor * np.maximum(spectrum, 1e-30), color=color, lw=1.2, label=label)
            top = factor * float(spectrum.max())
        unit = MOTIONS.get(what, ("kN", 1.0))[0]
        axis.set(xlim=(0, 1.2), ylim=(1e-5 * top, 3 * top), xlabel="ω [rad/s]", ylabel=f"S [{unit}² s/rad]")
        axis.set_title(what if what in MOTIONS else f"tension of {what} at the fairlead")
        axis.legend(fontsize=8)
    _save(figure, folder / "spectra.png")
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.4))
    for axis, line in zip(axes, ("head", "port"), strict=True):
        for domain, color in (("frequency", FREQUENCY), ("time", TIME)):
            for band, style in (("wf", "-"), ("lf", "--")):
                arc, sigma = solved.channel(f"{domain}/line/{line}/tension_std_{band}")
                axis.plot(arc, 1e-3 * sigma, style, color=color, lw=1.2, label=f"{domain} domain, {band.upper()}")
        axis.set(xlabel="arc length from the anchor [m]", ylabel="σ of tension [kN]", title=line, ylim=(0, None))
        axis.legend(fontsize=7)
    _save(figure, folder / "tension.png")


def page(runner: Runner, folder: Path, seeds: int | None) -> str:
    base = runner(example(seeds))
    hull = {"linear": linear_hull(base)}
    chain = example().model_dump(mode="json", exclude_none=True)["line_types"]["chain"]
    thin = chain | {"drag": {key: 0.1 * value for key, value in chain["drag"].items()}}
    sea = example().model_dump(mode="json", exclude_none=True)["environment"]["seastates"][0]
    few = min(seeds or 4, 4)
    named = {
        "as it is": base.summary,
        "hull damping linear": runner(example(seeds, vessel__damping=hull)).summary,
        "and a tenth of the drag on the lines": runner(
            example(few, vessel__damping=hull, line_types__chain=thin)
        ).summary,
        "as it is, a tenth of the wave height": runner(
            example(few, environment__seastates=[sea | {"hs": 0.1 * sea["hs"]}], analyses__time_domain__build_up=9000.0)
        ).summary,
    }
    halved = runner(example(1)).summary, runner(example(1, analyses__time_domain__step=0.025)).summary
    draw(base, folder)
    return _text(base.summary, periods_table(runner), sigma_table(base.summary), variants_table(named), named, halved)


def _text(
    summary: Summary, made_periods: str, sigmas: str, variants: str, named: dict[str, Summary], halved: Any
) -> str:
    time, frequency = summary["time_domain"], summary["frequency_domain"]
    steps = max(
        abs(value(halved[1], "time_domain", band, what) / value(halved[0], "time_domain", band, what) - 1)
        for what in MOTION_AND_LINES
        for band in ("wf", "lf")
    )
    drift = summary["statics"]["vessel"]["mean_drift"]
    offset = summary["statics"]["vessel"]["position"]
    linear, thin, small = list(named.values())[1:]

    def gap(of: Summary) -> float:
        return 100 * (value(of, "frequency_domain", "wf", "head") / value(of, "time_domain", "wf", "head") - 1)

    slow = value(small, "frequency_domain", "lf", "heave", True) / value(small, "time_domain", "lf", "heave") - 1
    scatter = error(small, "lf", "head") / value(small, "time_domain", "lf", "head")
    surge = [value(linear, domain, "lf", "surge") for domain in ("frequency_domain", "time_domain")]
    return TEXT.format(
        version=version(summary), periods=made_periods, sigmas=sigmas, variants=variants, seeds=time["realisations"],
        step=time["time_step"], wall=time["wall_time"], fd_wall=frequency["wall_time"], iterations=frequency["iterations"],
        retried=time["retried_steps"], halving=100 * steps, drift=drift[0] / 1e3, offset=offset[0],
        linear_gap=100 * (surge[0] / surge[1] - 1), linear_error=100 * error(linear, "lf", "surge") / surge[1],
        lf_gap=100 * (value(summary, "frequency_domain", "lf", "surge") / value(summary, "time_domain", "lf", "surge") - 1),
        head_gap=gap(summary), linear_head=gap(linear), thin_head=gap(thin), small_head=gap(small), scatter=100 * scatter,
        slow_heave=-100 * slow, heave_first=frequency["origin_std"]["first_order"]["heave"],
        heave_second=frequency["origin_std"]["second_order"]["heave"], heave_low=frequency["vessel_std"]["lf"]["heave"],
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--keep", type=Path, help="keep solved cases here between calls")
    parser.add_argument("--seeds", type=int)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        text = page(Runner(args.keep or Path(scratch)), ROOT / "docs" / "validation-volturnus", args.seeds)
    blocks = "\n\n".join(_filled(block.strip()) for block in text.split("\n\n"))
    (ROOT / "docs" / "validation-volturnus.md").write_text(blocks + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
