"""The plots of docs/validation.md (matplotlib, extra `docs`)."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import validation_runs as runs
from PIL import Image

mpl.use("Agg")
import matplotlib.pyplot as plt

DOF = ("surge", "sway", "heave", "roll", "pitch", "yaw")
TIME, FREQUENCY, OTHER = "#1f77b4", "#d62728", "#2a2a2a"
LINE = "bow-port"


def draw_all(study: runs.Study, folder: Path) -> list[Path]:
    """Writes every plot; their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    made = {
        "riser-top-tension": _top_tension(study),
        "riser-along": _along(study),
        "fpso-spectra": _spectra(study),
        "fpso-tension-along": _tension_along(study),
        "fpso-damping": _damping(study),
        "fpso-yaw": _yaw(study),
    }
    return [_save(figure, folder / f"{name}.png") for name, figure in made.items()]


def _save(figure: Any, path: Path) -> Path:
    """The figure in a palette of few colours, which keeps the file small."""
    figure.tight_layout()
    buffer = BytesIO()
    figure.savefig(buffer, dpi=80)
    plt.close(figure)
    image = Image.open(buffer).convert("RGB").quantize(32)
    image.save(path, optimize=True)
    return path


def _top_tension(study: runs.Study) -> Any:
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6))
    for case, axis in zip((1, 2), axes, strict=True):
        time, ours, _ = runs.aligned(study.riser[case, 1.0], case)
        paper = runs.digitised(case)
        axis.plot(time, ours, color=TIME, label="Slowdrift, time domain")
        axis.plot(paper[:, 0], paper[:, 1], ".", color=OTHER, ms=3, label="digitised")
        axis.set(xlabel="time [s]", ylabel="top end tension [kN]", title=f"case {case}", ylim=(40, 58))
        axis.legend(loc="upper right", fontsize=8)
    return figure


def _along(study: runs.Study) -> Any:
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6))
    for case, axis in zip((1, 2), axes, strict=True):
        result = study.riser[case, 1.0]
        arc = result.summary["time_domain"]["lines"]["riser"]["arc_length"]
        axis.plot(arc, 1e-3 * runs.half_range(result), color=TIME, label="time domain, half-range")
        axis.plot(arc, 1e-3 * runs.harmonic(result), "--", color=TIME, label="time domain, first harmonic")
        axis.plot(arc, 1e-3 * runs.amplitude(result), color=FREQUENCY, label="frequency domain, amplitude")
        axis.set(
            xlabel="arc length from the bottom [m]", ylabel="dynamic tension [kN]", title=f"case {case}", ylim=(0, None)
        )
        axis.legend(fontsize=8)
    return figure


def _spectra(study: runs.Study) -> Any:
    result = study.fpso.result
    figure, axes = plt.subplots(4, 2, figsize=(10, 11))
    for axis, name in zip(axes.flat, (*DOF, "tension"), strict=False):
        if name == "tension":
            low, high = f"frequency/line/{LINE}/top_tension", f"time/line/{LINE}/top_tension_spectrum"
            factor, unit, title = 1e-6, "kN² s/rad", f"top tension, {LINE}"
        else:
            low, high = f"frequency/vessel/{name}", f"time/vessel/{name}_spectrum"
            turned = name in DOF[3:]
            factor, unit, title = (np.degrees(1.0) ** 2, "deg² s/rad", name) if turned else (1.0, "m² s/rad", name)
        top = 0.0
        for which, label, style in (
            (high, "time domain", {"color": TIME}),
            (low, "frequency domain", {"color": FREQUENCY, "ls": "--"}),
        ):
            found = runs.channel(result, which)
            values = factor * found.values
            top = max(top, float(values.max()))
            axis.semilogy(found.axes[0].values, np.maximum(values, 1e-12), label=label, lw=1.1, **style)
        axis.set(
            xlim=(0, 1.2), ylim=(1e-6 * top, 3 * top), xlabel="frequency [rad/s]", ylabel=f"S [{unit}]", title=title
        )
        axis.legend(fontsize=8)
    axes.flat[7].axis("off")
    return figure


def _tension_along(study: runs.Study) -> Any:
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6))
    for axis, name in zip(axes, (LINE, "stern-starboard"), strict=True):
        for domain, color in (("time", TIME), ("frequency", FREQUENCY)):
            line = study.fpso.summary[f"{domain}_domain"]["lines"][name]
            total = np.hypot(*(np.array(line["tension_std"][band]) for band in ("wf", "lf")))
            axis.plot(line["arc_length"], 1e-3 * total, color=color, label=f"{domain} domain")
        axis.set(xlabel="arc length from the anchor [m]", ylabel="σ of tension [kN]", title=name, ylim=(0, None))
        axis.legend(fontsize=8, loc="lower right")
    return figure


def _damping(study: runs.Study) -> Any:
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6))
    for axis, sweep, label in zip(axes, (study.drag, study.sea), ("drag coefficient [-]", "Hs [m]"), strict=True):
        for name, marker in (("surge", "o"), ("sway", "s"), ("yaw", "^")):
            values = [100 * runs.mode(summary, name)["damping_lines"] for summary in sweep.values()]
            axis.plot(list(sweep), values, marker=marker, label=name)
        axis.set(xlabel=label, ylabel="damping by lines [% of critical]", ylim=(0, None))
        axis.legend(fontsize=8)
    return figure


def _yaw(study: runs.Study) -> Any:
    figure, axis = plt.subplots(figsize=(6, 3.6))
    found = runs.channel(study.fpso.result, "time/vessel/yaw_spectrum")
    axis.plot(found.axes[0].values, np.degrees(1.0) ** 2 * found.values, color=TIME, label="time domain")
    for result, label, style in (
        (study.fpso.result, "frequency domain, drag by components", {"ls": "--", "color": FREQUENCY}),
        (study.fpso.vector, "frequency domain, drag as a vector", {"ls": ":", "color": OTHER}),
    ):
        found = runs.channel(result, "frequency/vessel/yaw")
        axis.plot(found.axes[0].values, np.degrees(1.0) ** 2 * found.values, label=label, **style)
    axis.set(xlim=(0, 0.08), xlabel="frequency [rad/s]", ylabel="S [deg² s/rad]", title="slow yaw")
    axis.legend(fontsize=8)
    return figure
