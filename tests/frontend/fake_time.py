"""Synthetic results of a time domain, in the exact shapes of the contract."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.frontend import fake_results as results
from tests.frontend.fake_results import DOFS, LF_SIGMA, LINES, MIDDLE, WF_SIGMA, channel

SEEDS = [1, 2]
TIME = 0.5 * np.arange(1, 6001)  # longer than a picture has points
OMEGA = np.arange(1, 481) * 0.0025
SEED_AXIS = {"time": ("s", TIME), "seed": ("", SEEDS)}


def _history(low: float, high: float) -> np.ndarray:
    both = [low * np.sin(0.024 * TIME + seed) + high * np.sin(0.42 * TIME + 2 * seed) for seed in SEEDS]
    return np.sqrt(2.0) * np.stack(both, axis=1)


def fpso_time_channels() -> dict[str, dict[str, Any]]:
    made: list[dict[str, Any]] = []
    omega = {"omega": ("rad/s", OMEGA)}
    for dof in DOFS:
        turn = "rad" if dof in DOFS[3:] else "m"
        made.append(channel(f"time/vessel/{dof}", _history(LF_SIGMA[dof], WF_SIGMA[dof]), SEED_AXIS, turn))
        density = np.interp(OMEGA, results.OMEGA, results.spectrum(dof))
        made.append(channel(f"time/vessel/{dof}_spectrum", 1.1 * density, omega, f"{turn}2 s/rad"))
    for line in LINES:
        made += _line(line)
    return {item["name"]: item for item in made}


def _line(line: str) -> list[dict[str, Any]]:
    middle, time = {"arc_length": ("m", MIDDLE)}, f"time/line/{line}"
    top, omega = 4.3e6 + _history(5e4, 1e5), {"omega": ("rad/s", OMEGA)}
    mean = 2.6e6 + 1.75e6 * MIDDLE / 3300.0
    density = 1e10 * np.exp(-0.5 * ((OMEGA - 0.42) / 0.08) ** 2)
    return [
        *(channel(f"{time}/{q}", top, SEED_AXIS, "N") for q in ("top_tension", "end_b_tension", "end_a_tension")),
        channel(f"{time}/top_tension_spectrum", density, omega, "N2 s/rad"),
        channel(f"{time}/tension_mean", mean, middle, "N"),
        channel(f"{time}/tension_min", mean - 4e5, middle, "N"),
        channel(f"{time}/tension_max", mean + 5e5, middle, "N"),
        channel(f"{time}/tension_std_wf", np.full_like(MIDDLE, 1.0e5), middle, "N"),
        channel(f"{time}/tension_std_lf", np.full_like(MIDDLE, 0.5e5), middle, "N"),
    ]


def fpso_with_time(summary: dict[str, Any]) -> dict[str, Any]:
    """The summary of a run that has a time domain too."""
    mean = 2.6e6 + 1.75e6 * MIDDLE / 3300.0
    line = {
        "arc_length": MIDDLE.tolist(), "tension_min": (mean - 4e5).tolist(), "tension_max": (mean + 5e5).tolist(),
        "tension_mean": mean.tolist(), "end_b_tension": {"min": 4.08e6, "max": 4.52e6},
        "end_b_max_per_seed": [4.5e6, 4.52e6],
        "tension_std": {"wf": [1.0e5] * len(MIDDLE), "lf": [0.5e5] * len(MIDDLE)},
    }  # fmt: skip
    bands = {"wf": WF_SIGMA, "lf": LF_SIGMA}
    frequency = summary["frequency_domain"] | {"same_waves": {"vessel_std": _times(bands, 0.99)}}
    time = {
        "converged": True, "realisations": 2, "time_step": 0.1, "duration": 3000.0, "build_up": 100.0, "wall_time": 12.0,
        "vessel_std": _times(bands, 1.04), "vessel_std_error": _times(bands, 0.02), "lines": dict.fromkeys(LINES, line),
    }  # fmt: skip
    return summary | {
        "analyses": [*summary["analyses"], "time_domain"], "frequency_domain": frequency, "time_domain": time,
        "provenance": summary["provenance"] | {"seeds": SEEDS},
    }  # fmt: skip


def _times(bands: dict[str, dict[str, float]], factor: float) -> dict[str, dict[str, float]]:
    return {band: {dof: factor * value for dof, value in values.items()} for band, values in bands.items()}


def riser_time_channels() -> dict[str, dict[str, Any]]:
    arc = results.riser_channels()["frequency/line/riser/tension_amplitude"]["axes"][0]["values"]
    middle, time = {"arc_length": ("m", arc)}, "time/line/riser"
    mean, amplitude = 4.0e4 + 200.0 * np.abs(np.array(arc) - 60.0), 1.3e4 + 50.0 * np.array(arc)
    short = TIME[:216]
    top = (6e4 + 2e4 * np.sin(0.58 * short))[:, None]
    made = [
        channel(f"{time}/end_b_tension", top, {"time": ("s", short), "seed": ("", [1])}, "N"),
        channel(f"{time}/tension_first_harmonic", amplitude, middle, "N"),
        channel(f"{time}/tension_min", mean - 0.9 * amplitude, middle, "N"),
        channel(f"{time}/tension_max", mean + 1.3 * amplitude, middle, "N"),
    ]
    return {item["name"]: item for item in made}


def riser_with_time(summary: dict[str, Any]) -> dict[str, Any]:
    channels = riser_time_channels()
    ends = {key: channels[f"time/line/riser/{key}"]["values"] for key in ("tension_min", "tension_max")}
    line = ends | {"end_b_tension": {"min": 4e4, "max": 8e4}}
    time = {
        "converged": True, "realisations": 1, "time_step": 0.05, "duration": 108.0, "build_up": 216.0, "wall_time": 0.4,
        "lines": {"riser": line},
    }  # fmt: skip
    return summary | {
        "analyses": [*summary["analyses"], "time_domain"], "time_domain": time,
        "provenance": summary["provenance"] | {"seeds": [1]},
    }  # fmt: skip


def look(found: dict[str, Any], low: float | None, high: float | None, points: int | None, seed: int | None) -> Any:
    """A slice of a channel as the service gives it: one seed, a stretch of the first axis, every bin's least and largest."""
    values, axes = np.asarray(found["values"]), [dict(axis) for axis in found["axes"]]
    if seed is not None:
        at = [axis["name"] for axis in axes].index("seed")
        values = values.take(axes.pop(at)["values"].index(seed), axis=at)
    first = np.asarray(axes[0]["values"])
    kept = np.flatnonzero((first >= (-np.inf if low is None else low)) & (first <= (np.inf if high is None else high)))
    full = len(kept)
    if points and full > points and values.ndim == 1:
        bins = [b for b in np.array_split(kept, points // 4) if len(b)]
        parts = [(b[0], b[np.argmin(values[b])], b[np.argmax(values[b])], b[-1]) for b in bins]
        kept = np.unique(np.array(parts))
    axes[0] = axes[0] | {"values": first[kept].tolist()}
    return found | {"axes": axes, "values": values[kept].tolist(), "full_size": full}
