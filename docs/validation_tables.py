"""The tables of docs/validation.md: what was solved beside the paper's and the independent check's numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import validation_runs as runs
from validation_runs import Pair, Study, Summary, gap, mode

DOF = ("surge", "sway", "heave", "roll", "pitch", "yaw")
UNITS = dict(zip(DOF, ("m", "m", "m", "deg", "deg", "deg"), strict=True))
LABELS = ("surge", "sway", "yaw")
LINE = "bow-port"

# Low & Langley (2006), tables 2, 6 and 7
PAPER_STATICS = {
    "top tension": (47.11, 47.11, 47.14),
    "bottom tension": (26.60, 26.60, 26.63),
    "vertical reaction, top": (45.71, 45.71, 45.72),
    "horizontal reaction": (11.40, 11.40, 11.47),
    "vertical reaction, bottom": (24.04, 24.04, 24.03),
}
PAPER_SIGMA = {
    ("wf", "surge"): (1.785, 1.783),
    ("wf", "sway"): (1.192, 1.191),
    ("wf", "heave"): (2.344, 2.341),
    ("wf", "roll"): (0.631, 0.639),
    ("wf", "pitch"): (1.501, 1.500),
    ("wf", "yaw"): (1.336, 1.334),
    ("lf", "surge"): (4.270, 4.163),
    ("lf", "sway"): (4.320, 4.268),
    ("lf", "roll"): (0.236, 0.220),
    ("lf", "yaw"): (6.869, 7.331),
    ("wf", "top"): (186.3, 180.6),
    ("wf", "bottom"): (156.4, 153.1),
    ("lf", "top"): (24.79, 24.47),
    ("lf", "bottom"): (25.01, 24.17),
}
PAPER_MODES = {
    "surge": (256.1, 4.53, 31.10, 4.46),
    "sway": (259.8, 4.79, 27.57, 4.32),
    "yaw": (299.7, 0.66, 46.17, 6.31),
}
CHECK_MODES = {"surge": (262.0, 36.7, 4.3), "sway": (313.0, 30.6, 3.0), "yaw": (301.0, 45.8, 5.6)}
CHECK_SIGMA = {
    ("wf", "surge"): 2.0,
    ("wf", "sway"): 0.83,
    ("wf", "heave"): 2.4,
    ("wf", "roll"): 1.04,
    ("wf", "pitch"): 2.0,
    ("wf", "yaw"): 0.80,
    ("lf", "surge"): 4.6,
    ("lf", "sway"): 4.1,
    ("lf", "yaw"): 6.9,
}
RANGES = {
    1: {"MoorDyn": (41.64, 52.28), "digitised": (41.48, 52.24)},
    2: {"MoorDyn": (42.39, 52.85), "digitised": (42.01, 53.15)},
}
CHECK_HALF = {1: (24.5, 9.1, 4.5, 3.3), 2: (12.2, 21.9, 27.8, 13.7)}
CHECK_FIRST = {1: (11.7, 4.2, 1.3, 0.45), 2: (0.8, 1.1, 0.8, 0.4)}


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of the page."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def sigma(value: float, dof: str) -> float:
    """A standard deviation in the table's unit."""
    return float(np.degrees(value)) if UNITS[dof] == "deg" else value


def same_waves(summary: Summary, band: str, dof: str) -> float:
    """σ of the linear system under the time domain's waves [m, rad]."""
    return float(summary["frequency_domain"]["same_waves"]["vessel_std"][band][dof])


def ratio(summary: Summary, against: Summary, band: str, dof: str) -> float:
    """σ of one summary's linear system in the waves of the other's time domain, over that time domain's."""
    return same_waves(summary, band, dof) / float(against["time_domain"]["vessel_std"][band][dof])


def tension(summary: Summary, domain: str, band: str, element: int, line: str = LINE) -> float:
    """σ of a line's tension [kN]; element 0 at the bottom, -1 at the top."""
    return 1e-3 * float(summary[f"{domain}_domain"]["lines"][line]["tension_std"][band][element])


# ---------------------------------------------------------------- riser


def statics_table(summary: Summary) -> str:
    line = summary["statics"]["lines"]["riser"]
    top, bottom = line["end_b"], line["end_a"]
    ours = (
        top["tension"],
        bottom["tension"],
        abs(top["force"][2]),
        abs(top["force"][0]),
        abs(bottom["force"][2]),
    )
    rows = [
        [name, f"{1e-3 * value:.2f}", *(f"{one:.2f}" for one in paper)]
        for (name, paper), value in zip(PAPER_STATICS.items(), ours, strict=True)
    ]
    return table(("kN", "Slowdrift", "paper, in-house", "paper, Orcaflex", "catenary"), rows)


def range_table(study: Study) -> str:
    rows = []
    for case in (1, 2):
        found = study.riser[case, 1.0].summary["time_domain"]["lines"]["riser"]["end_b_tension"]
        shown = [1e-3 * found["min"], 1e-3 * found["max"]]
        _, _, rms = runs.aligned(study.riser[case, 1.0], case)
        rows.append(
            [
                str(case),
                f"{shown[0]:.2f} to {shown[1]:.2f}",
                *(f"{low:.2f} to {high:.2f}" for low, high in RANGES[case].values()),
                f"{rms:.2f}",
            ]
        )
    return table(("case", "Slowdrift", "MoorDyn", "digitised", "rms difference from digitised"), rows)


def gap_table(study: Study) -> str:
    rows = []
    for case in (1, 2):
        for k, factor in enumerate(runs.FACTORS):
            one = study.riser[case, factor]
            linear = runs.amplitude(one)
            first = runs.harmonic(one)
            rows.append(
                [
                    str(case),
                    f"{factor:g}",
                    f"{1e-3 * runs.half_range(one).mean():.3f}",
                    f"{1e-3 * linear.mean():.3f}",
                    f"{gap(linear, runs.half_range(one)):.1f}",
                    f"{CHECK_HALF[case][k]:g}",
                    f"{gap(linear, first):.2f}",
                    f"{CHECK_FIRST[case][k]:g}",
                    f"{100 * np.abs(linear / first - 1).max():.1f}",
                ]
            )
    head = (
        "case",
        "amplitude factor",
        "half-range, kN",
        "frequency domain, kN",
        "gap to half-range, %",
        "check",
        "gap to first harmonic, %",
        "check",
        "largest of an element, %",
    )
    return table(head, rows)


# ---------------------------------------------------------------- FPSO


def sigma_table(pair: Pair) -> str:
    s, v = pair.summary, pair.vector.summary
    time = s["time_domain"]
    rows = []
    for band in ("wf", "lf"):
        for dof in DOF:
            if band == "lf" and dof in ("heave", "pitch"):
                continue
            digits = 4 if (band, dof) == ("lf", "roll") else 3
            mean, error = (sigma(time[key][band][dof], dof) for key in ("vessel_std", "vessel_std_error"))
            shown = (s["frequency_domain"]["vessel_std"][band][dof], same_waves(s, band, dof), same_waves(v, band, dof))
            paper = PAPER_SIGMA.get((band, dof))
            check = CHECK_SIGMA.get((band, dof))
            rows.append(
                [
                    f"{band.upper()} {dof}, {UNITS[dof]}",
                    f"{mean:.{digits}f} ± {error:.{digits}f}",
                    *(f"{sigma(value, dof):.{digits}f}" for value in shown),
                    f"{ratio(s, s, band, dof):.3f}",
                    f"{ratio(v, s, band, dof):.3f}",
                    f"{paper[0]:.3f} / {paper[1]:.3f}" if paper else "-",
                    f"{check:g}" if check else "-",
                ]
            )
    head = (
        "σ",
        "time ± s.e.",
        "frequency",
        "same waves",
        "same waves, vector",
        "same waves / time",
        "vector / time",
        "paper time / frequency",
        "check",
    )
    return table(head, rows)


def tension_table(pair: Pair) -> str:
    s, v = pair.summary, pair.vector.summary
    rows = []
    for band in ("wf", "lf"):
        for where, element in (("top", -1), ("bottom", 0)):
            for name, line in s["time_domain"]["lines"].items():
                time, frequency, vector = (
                    tension(one, domain, band, element, name)
                    for one, domain in ((s, "time"), (s, "frequency"), (v, "frequency"))
                )
                error = 1e-3 * line["tension_std_error"][band][element]
                rows.append(
                    [
                        f"{band.upper()} {where}",
                        name,
                        f"{time:.1f} ± {error:.1f}",
                        f"{frequency:.1f}",
                        f"{frequency / time:.3f}",
                        f"{vector / time:.3f}",
                        " / ".join(f"{x:g}" for x in PAPER_SIGMA[band, where]) if name == LINE else "",
                    ]
                )
    head = ("σ, kN", "line", "time ± s.e.", "frequency", "frequency / time", "vector / time", "paper time / frequency")
    return table(head, rows)


def agreement_table(pair: Pair) -> str:
    """What must hold between the domains, and whether it does."""
    rows = []
    for name, limit, value, holds in agreement(pair):
        rows.append([name, limit, value, "holds" if holds else "**falls short**"])
    return table(("same case, both domains", "limit", "found", ""), rows)


def agreement(pair: Pair) -> list[tuple[str, str, str, bool]]:
    s = pair.summary
    time, frequency = s["time_domain"], s["frequency_domain"]
    out = []
    gaps = {dof: frequency["vessel_std"]["wf"][dof] / time["vessel_std"]["wf"][dof] - 1 for dof in DOF}
    worst = max((dof for dof in DOF if dof != "roll"), key=lambda dof: abs(gaps[dof]))
    out.append(("WF motion but roll", "1 %", f"{worst} {100 * gaps[worst]:+.2f} %", abs(gaps[worst]) < 0.01))
    out.append(("WF roll", "2 %", f"{100 * gaps['roll']:+.2f} %", abs(gaps["roll"]) < 0.02))
    for dof, limit in (("surge", 5), ("sway", 5), ("yaw", 10), ("roll", 10)):
        off = 100 * (ratio(s, s, "lf", dof) - 1)
        out.append((f"LF {dof}, same waves over time domain", f"{limit} %", f"{off:+.1f} %", abs(off) < limit))
    errors = {
        dof: abs(frequency["vessel_std"]["lf"][dof] - same_waves(s, "lf", dof))
        / max(time["vessel_std_error"]["lf"][dof], 1e-30)
        for dof in (*LABELS, "roll")
    }
    worst = max(errors, key=lambda dof: errors[dof])
    out.append(
        (
            "LF plain frequency domain against same waves",
            "3 s.e.",
            f"{worst} {errors[worst]:.1f} s.e.",
            errors[worst] < 3,
        )
    )
    for where, element in (("top", -1), ("bottom", 0)):
        found = [
            tension(s, "frequency", "wf", element, n) / tension(s, "time", "wf", element, n) for n in time["lines"]
        ]
        out.append(
            (
                f"WF tension, {where}, frequency over time",
                "0.95 to 1",
                f"{min(found):.3f} to {max(found):.3f}",
                min(found) >= 0.95 and max(found) < 1,
            )
        )
    return out


def modes_table(summary: Summary) -> str:
    rows = []
    for label in LABELS:
        one, paper, check = mode(summary, label), PAPER_MODES[label], CHECK_MODES[label]
        rows.append(
            [
                label,
                f"{one['period']:.1f}",
                f"{paper[0]:g}",
                f"{check[0]:g}",
                f"{100 * one['damping_lines']:.1f}",
                f"{paper[2]:.1f}",
                f"{check[1]:g}",
                f"{100 * one['damping_vessel']:.2f}",
                f"{paper[1]:.2f}",
                f"{100 * one['mass_lines']:.1f}",
                f"{paper[3]:.1f}",
                f"{check[2]:g}",
            ]
        )
    first = mode(summary, "line")
    rows.append(["first line mode", f"{first['period']:.1f}", "51.9", "52.4", *["-"] * 8])
    head = (
        "mode",
        "period, s",
        "paper",
        "check",
        "damping by lines, %",
        "paper",
        "check",
        "by the vessel, %",
        "paper",
        "mass by lines, %",
        "paper",
        "check",
    )
    return table(head, rows)


def sweep_table(sweep: dict[float, Summary], label: str) -> str:
    rows = [
        [f"{value:g}", *(f"{100 * mode(summary, name)['damping_lines']:.1f}" for name in LABELS)]
        for value, summary in sweep.items()
    ]
    return table((label, *(f"{name}, %" for name in LABELS)), rows)


def sweep_shape(sweep: dict[float, Summary]) -> str:
    """Which motions rise all along, and with a slope that falls all along."""
    rising, falling = [], []
    x = np.array(list(sweep))
    for name in LABELS:
        slopes = np.diff([100 * mode(summary, name)["damping_lines"] for summary in sweep.values()]) / np.diff(x)
        if np.all(slopes > 0):
            rising.append(name)
        if np.all(np.diff(slopes) < 0):
            falling.append(name)

    def named(names: list[str]) -> str:
        return "all three" if len(names) == 3 else ", ".join(names) or "none"

    return f"Rises at every step: {named(rising)}. Slope falls at every step: {named(falling)}."


def scan_table(scan: dict[str, Summary]) -> str:
    rows = []
    for name, summary in scan.items():
        modes = [mode(summary, label) for label in LABELS]
        wf = summary["frequency_domain"]["vessel_std"]["wf"]
        rows.append(
            [
                "follows the frequency" if name == "follows" else name,
                " / ".join(f"{one['period']:.1f}" for one in modes),
                " / ".join(f"{100 * one['damping_lines']:.1f}" for one in modes),
                " / ".join(f"{100 * one['damping_vessel']:.1f}" for one in modes),
                " / ".join(f"{wf[dof]:.2f}" for dof in DOF[:3]),
                " / ".join(f"{np.degrees(wf[dof]):.2f}" for dof in DOF[3:]),
            ]
        )
    rows.append(["*check*", "262 / 313 / 301", "36.7 / 30.6 / 45.8", "-", "2.0 / 0.83 / 2.4", "1.04 / 2.0 / 0.80"])
    head = (
        "A and B at, rad/s",
        "periods, s",
        "damping by lines, %",
        "damping by the vessel, %",
        "WF σ surge, sway, heave, m",
        "WF σ roll, pitch, yaw, deg",
    )
    return table(head, rows)


SIDE_NAMES = {
    "base": "the example itself",
    "similar": "a tenth of every motion, drag kept",
    "sea": "Hs × 0.3",
}


def side_table(side: dict[str, Pair]) -> str:
    """same waves / time domain of the side studies, by components and as a vector."""
    rows = []
    for name, label in SIDE_NAMES.items():
        if name not in side:
            continue
        s, v = side[name].summary, side[name].vector.summary
        lf = [f"{ratio(s, s, 'lf', dof):.3f} / {ratio(v, s, 'lf', dof):.3f}" for dof in (*LABELS, "roll")]
        ends = []
        for element in (-1, 0):
            found = [
                tension(s, "frequency", "wf", element, n) / tension(s, "time", "wf", element, n)
                for n in s["time_domain"]["lines"]
            ]
            ends.append(f"{min(found):.3f} to {max(found):.3f}")
        rows.append([label, *lf, *ends])
    head = ("run", *(f"LF {dof}" for dof in (*LABELS, "roll")), "WF top tension", "WF bottom tension")
    return table(head, rows)


def waves_table(base: Pair, waves: Pair) -> str:
    """Slow motion and tension with and without drift forces, and the parts added by their variances."""
    a, b = base.summary, waves.summary
    rows = []

    def add(label: str, time: float, alone: float, linear: float, digits: int) -> None:
        both = float(np.hypot(alone, linear))
        rows.append([label, *(f"{x:.{digits}f}" for x in (time, alone, linear, both)), f"{both / time:.3f}"])

    for dof in (*LABELS, "roll"):
        add(
            f"{dof}, {UNITS[dof]}",
            *(sigma(one["time_domain"]["vessel_std"]["lf"][dof], dof) for one in (a, b)),
            sigma(same_waves(a, "lf", dof), dof),
            4 if dof == "roll" else 3,
        )
    for name in a["time_domain"]["lines"]:
        parts = (tension(one, domain, "lf", -1, name) for one, domain in ((a, "time"), (b, "time"), (a, "frequency")))
        add(f"top tension, {name}, kN", *parts, 1)
    head = (
        "LF σ",
        "time domain",
        "its part without drift forces",
        "frequency domain",
        "both parts",
        "over time domain",
    )
    return table(head, rows)


def compression_table(allowed: Summary, none: Summary) -> str:
    """The time domain of lines that may push beside that of lines that may not, the largest of the four lines."""

    def worst(summary: Summary, value: Callable[[dict[str, Any]], float]) -> float:
        return max(value(line) for line in summary["time_domain"]["lines"].values())

    def row(label: str, find: Callable[[Summary], float], digits: int) -> tuple[str, str, str, str]:
        with_push, without = find(allowed), find(none)
        change = (
            f"{100 * (without / with_push - 1):+.1f} %" if abs(with_push) > 1e-9 and without * with_push > 0 else "-"
        )
        return label, f"{with_push:.{digits}f}", f"{without:.{digits}f}", change

    def motion(dof: str) -> Callable[[Summary], float]:
        return lambda summary: sigma(summary["time_domain"]["vessel_std"]["lf"][dof], dof)

    def top(band: str) -> Callable[[Summary], float]:
        return lambda summary: 1e-3 * worst(summary, lambda line: line["tension_std"][band][-1])

    rows = [
        row("least axial force, kN", lambda s: -1e-3 * worst(s, lambda line: -min(line["tension_min"])), 1),
        row("longest share of time slack, %", lambda s: 100 * worst(s, lambda line: line["slack"]["share"]), 2),
        row("largest force at the top, mean of the seeds, kN",
            lambda s: 1e-3 * worst(s, lambda line: float(np.mean(line["end_b_max_per_seed"]))), 0),
        row("the same, largest of the seeds, kN", lambda s: 1e-3 * worst(s, lambda line: line["end_b_tension"]["max"]), 0),
        row("σ at the top, WF, kN", top("wf"), 1), row("σ at the top, LF, kN", top("lf"), 1),
        row("σ of LF surge, m", motion("surge"), 3), row("σ of LF sway, m", motion("sway"), 3),
        row("σ of LF yaw, °", motion("yaw"), 3),
    ]  # fmt: skip
    return table(("of the four lines the worst", "`allowed`", "`none`", "change"), rows)
