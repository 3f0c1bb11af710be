"""The time domain's outcome: parts of chunks, merged over seeds; its summary and channels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..case.quantities import DOF
from ..kernels.arrays import GROUNDED, TENSION_A, TENSION_B, TOUCHDOWN, VERTICAL_A, VERTICAL_B
from ..time_domain.block import Timing
from ..time_domain.ensemble import Record
from ..time_domain.resolution import TOLERANCE, worst
from ..time_domain.statistics import band_variances, first_harmonic, over_seeds, spectrum
from .channel import Axis
from .channels import Made, channel
from .part import Part
from .sampling import sampling_summary, sampling_warnings
from .slack import time_slack, time_slack_warnings
from .strain import strain_warnings

Array = np.ndarray
KEY = "time_domain_part"
RANGES = 50  # of rainflow counts
#: what is recorded at the ends of a line, with its row in the record; the anchor's vertical force is at either end
END_VALUES = {
    "end_b_tension": TENSION_B, "end_a_tension": TENSION_A, "anchor_vertical": VERTICAL_A, "grounded_length": GROUNDED,
    "touchdown": TOUCHDOWN,
}  # fmt: skip


def time_part(
    record: Record, timing: Timing, lines: list[dict[str, Any]], border: float, omega: float | None, random: bool,
    periodic: bool,
) -> Part:  # fmt: skip
    """One chunk's seeds as arrays that merge. lines : name, gap (padding elements), arc_length, length, anchor, allowed
    and push_limits of each.

    omega : the frequency of regular waves or prescribed motion, None without; random : whether there are random waves.
    periodic : whether the record is a whole number of periods of everything that moves.
    """
    step = timing.every * timing.h
    low, high, mean = band_variances(record.tension, step, border, periodic)
    arrays = {
        "vessel": record.vessel.astype(np.float32), "top": record.tension[:, -1].copy(), "ends": record.ends.astype(np.float32),
        "tension_low": low, "tension_high": high, "tension_mean": mean, "lowest": record.lowest, "highest": record.highest,
        "ends_range": record.ends_range, "slack": record.slack,
    }  # fmt: skip
    if omega is not None:
        arrays["harmonic"] = first_harmonic(record.tension, step, omega)
    head = {
        "seeds": record.seeds, "lines": lines, "border": border, "omega": omega, "h": timing.h, "every": timing.every,
        "build_up": timing.build_up, "kept": timing.kept, "iterations": record.iterations, "retries": record.retries,
        "wall_time": record.wall_time, "findings": [one.as_dict() for one in record.findings], "random": random,
        "periodic": periodic,
    }  # fmt: skip
    return Part({KEY: head}, (), arrays)


@dataclass(frozen=True)
class TimeResult:
    """All seeds together, in rising order. Arrays end with the seed axis; tensions of elements are (N, L, seeds)."""

    head: dict[str, Any]
    seeds: list[int]
    arrays: dict[str, Array]

    @property
    def step(self) -> float:
        """Interval of the histories [s]."""
        return float(self.head["every"] * self.head["h"])

    @property
    def periodic(self) -> bool:
        return bool(self.head["periodic"])

    @property
    def random(self) -> bool:
        """Whether there are random waves, so that a spectrum says something."""
        return bool(self.head["random"])

    @property
    def border(self) -> float:
        return float(self.head["border"])

    @property
    def time(self) -> Array:
        """Times of the histories, from the end of the build-up (n,) [s]."""
        return self.step * np.arange(1, self.arrays["vessel"].shape[0] + 1)

    def line(self, name: str) -> tuple[int, int]:
        """Index of a line and its number of padding elements."""
        index = next(i for i, line in enumerate(self.head["lines"]) if line["name"] == name)
        return index, int(self.head["lines"][index]["gap"])

    def elements(self, key: str, name: str) -> Array:
        """One array of element values of a line, (N, seeds)."""
        index, gap = self.line(name)
        return self.arrays[key][gap:, index]

    def history(self, name: str, what: str) -> Array:
        """`top` (element tension) or one of END_VALUES of a line over time, (n, seeds)."""
        index, _ = self.line(name)
        if what == "top":
            return self.arrays["top"][:, index]
        return self.arrays["ends"][:, self.row(name, what), index]

    def row(self, name: str, what: str) -> int:
        """Row of one of END_VALUES in the recorded values of a line's ends."""
        if what == "anchor_vertical":
            index, _ = self.line(name)
            return VERTICAL_B if self.head["lines"][index]["anchor"] == "end_b" else VERTICAL_A
        return END_VALUES[what]

    def end_range(self, name: str, what: str) -> tuple[Array, Array]:
        """Least and largest value at an end over every step, (seeds,) each."""
        index, _ = self.line(name)
        lowest, highest = self.arrays["ends_range"][:, self.row(name, what), index]
        return lowest, highest

    def motion(self, dof: str) -> Array:
        """Displacement from the static position over time, (n, seeds) [m or rad]."""
        return self.arrays["vessel"][:, :, DOF.index(dof)]


def merge_time(parts: list[Part]) -> TimeResult | None:
    """All seeds of the time-domain parts; None without any. Where refused chunks ended early, those that went farthest."""
    found = sorted((part for part in parts if KEY in part.summary), key=lambda part: part.summary[KEY]["seeds"][0])
    if not found:
        return None
    farthest = max(part.summary[KEY]["kept"] for part in found)
    found = [part for part in found if part.summary[KEY]["kept"] == farthest]
    heads = [part.summary[KEY] for part in found]
    arrays = {
        name: np.concatenate([part.arrays[name] for part in found], axis=1 if name == "vessel" else -1)
        for name in found[0].arrays
    }
    head = {**heads[0], **{key: sum(one[key] for one in heads) for key in ("iterations", "retries", "wall_time")}}
    head["findings"] = [found for one in heads for found in one["findings"]]
    return TimeResult(head, [seed for one in heads for seed in one["seeds"]], arrays)


def time_warnings(result: TimeResult) -> list[str]:
    """What speaks against the length of the step and of the record, lines that go slack, and strains, as sentences."""
    h, tolerance = result.head["h"], result.head.get("tolerance", TOLERANCE)
    steps = [one.sentence(h, tolerance) for one in worst(result.head["findings"])]
    return [*steps, *time_slack_warnings(result), *sampling_warnings(result), *_strains(result)]


def _strains(result: TimeResult) -> Iterator[str]:
    for line in result.head["lines"]:
        highest = result.elements("highest", line["name"]).max(axis=-1)
        allowed = line.get("allowed", np.zeros_like(highest))  # a part that an older version stored has none
        yield from strain_warnings(line["name"], line["arc_length"], highest, allowed, "in the time domain")


def time_summary(result: TimeResult) -> dict[str, Any]:
    """The summary's `time_domain` (docs/summary.md)."""
    head = result.head
    steps = head["build_up"] + head["kept"]
    out: dict[str, Any] = {
        "converged": True, "realisations": len(result.seeds), "time_step": head["h"], "steps": steps,
        "build_up": head["build_up"] * head["h"], "duration": head["kept"] * head["h"],
        "wall_time": head["wall_time"], "retried_steps": head["retries"],
    }  # fmt: skip
    if np.any(result.arrays["vessel"]):
        moved = _over_seeds(result)
        out["vessel_std"] = {band: _by_dof(moved[band]) for band in ("wf", "lf")}
        out["vessel_std_error"] = {band: _by_dof(moved[f"{band}_error"]) for band in ("wf", "lf")}
        out["vessel_mean"] = _by_dof(result.arrays["vessel"].mean(axis=(0, 1), dtype=float))
    out["lines"] = {line["name"]: _line(result, line) for line in head["lines"]}
    return {**out, **sampling_summary(result)}


def _over_seeds(result: TimeResult) -> dict[str, Array]:
    history = np.moveaxis(result.arrays["vessel"].astype(float), 1, -1)  # (n, 6, seeds)
    return over_seeds(*band_variances(history, result.step, result.border, result.periodic))


def _by_dof(values: Array) -> dict[str, float]:
    return {dof: float(value) for dof, value in zip(DOF, values, strict=True)}


def _line(result: TimeResult, line: dict[str, Any]) -> dict[str, Any]:
    name = line["name"]
    stats = _tension(result, name)
    highest = result.elements("highest", name).max(axis=-1)
    out = {
        "arc_length": line["arc_length"],
        "tension_min": result.elements("lowest", name).min(axis=-1).tolist(),
        "tension_max": highest.tolist(),
        "tension_mean": result.elements("tension_mean", name).mean(axis=-1).tolist(),
        "tension_std": {band: stats[band].tolist() for band in ("wf", "lf")},
        "tension_std_error": {band: stats[f"{band}_error"].tolist() for band in ("wf", "lf")},
        **{what: _end_statistics(result, name, what) for what in ("end_a_tension", "end_b_tension", "anchor_vertical")},
        "end_b_max_per_seed": result.end_range(name, "end_b_tension")[1].tolist(),
        "slack": time_slack(result, name),
        **_bed_statistics(result, name),
    }
    out["largest"] = _largest(line, highest, out)
    if "harmonic" in result.arrays:
        out["tension_first_harmonic"] = result.elements("harmonic", name).mean(axis=-1).tolist()
    return out


def _end_statistics(result: TimeResult, name: str, what: str) -> dict[str, float]:
    """Extremes over every step, mean and standard deviation over all seeds, of a force at an end."""
    lowest, highest = result.end_range(name, what)
    history = result.history(name, what).astype(float)
    return {
        "min": float(lowest.min()), "max": float(highest.max()), "mean": float(history.mean()), "std": float(history.std()),
    }  # fmt: skip


def _bed_statistics(result: TimeResult, name: str) -> dict[str, dict[str, float]]:
    """Length on the bed and arc length of the touchdown point; nothing for a line that never touches the bed."""
    if not np.any(result.history(name, "grounded_length")):
        return {}
    out = {}
    for what in ("grounded_length", "touchdown"):
        values = result.history(name, what).astype(float)
        out[what] = {
            "min": float(values.min()), "max": float(values.max()), "mean": float(values.mean()),
            "std": float(values.std()),
        }  # fmt: skip
    return out


def _largest(line: dict[str, Any], highest: Array, out: dict[str, Any]) -> dict[str, float]:
    """The largest tension of a line over all steps and seeds, its ends included, and where it was."""
    arc = [0.0, *line["arc_length"], line["length"]]
    values = [out["end_a_tension"]["max"], *highest.tolist(), out["end_b_tension"]["max"]]
    place = int(np.argmax(values))
    return {"tension": float(values[place]), "arc_length": float(arc[place])}


def _tension(result: TimeResult, name: str) -> dict[str, Array]:
    return over_seeds(*(result.elements(f"tension_{key}", name) for key in ("low", "high", "mean")))


def _time(result: TimeResult) -> tuple[Axis, Axis]:
    return Axis("time", "s", result.time), Axis("seed", "", np.array(result.seeds, dtype=float))


def _arc(result: TimeResult, name: str) -> Axis:
    return Axis("arc_length", "m", np.array(result.head["lines"][result.line(name)[0]]["arc_length"]))


@channel("time", "vessel", "{dof}", "[x]", "History of {which} about the static position")
def _motion(result: TimeResult, dof: str) -> Made:
    return (result.motion(dof), _time(result)) if np.any(result.arrays["vessel"]) else None


@channel(
    "time", "vessel", "{dof}_spectrum", "[x]2 s/rad", "Spectrum of {which}: mean periodogram, smoothed over 0.005 rad/s"
)
def _motion_spectrum(result: TimeResult, dof: str) -> Made:
    if not np.any(result.arrays["vessel"]) or not result.random:
        return None
    return _spectrum(result, result.motion(dof))


def _spectrum(result: TimeResult, history: Array) -> Made:
    omega, density, _ = spectrum(history.astype(float), result.step, result.periodic, 2.0)
    return density, (Axis("omega", "rad/s", omega),)


def _history(what: str, quantity: str, text: str, unit: str = "N") -> None:
    @channel("time", "line", quantity, unit, text)
    def _make(result: TimeResult, name: str) -> Made:
        if unit == "m" and not np.any(result.history(name, "grounded_length")):
            return None
        return result.history(name, what), _time(result)


_history("top", "top_tension", "History of tension of the element at end b")
_history("end_b_tension", "end_b_tension", "History of the reaction at end b")
_history("end_a_tension", "end_a_tension", "History of the reaction at end a")
_history("anchor_vertical", "anchor_vertical", "History of the vertical force on the anchor, up positive")
_history("grounded_length", "grounded_length", "History of the length of line that lies on the bed", "m")
_history("touchdown", "touchdown", "History of the arc length from end a to the touchdown point", "m")


@channel(
    "time",
    "line",
    "top_tension_spectrum",
    "N2 s/rad",
    "Spectrum of tension of the element at end b, smoothed over 0.005 rad/s",
)
def _top_spectrum(result: TimeResult, name: str) -> Made:
    return _spectrum(result, result.history(name, "top")) if result.random else None


def _along(quantity: str, text: str, band: str, make: Any) -> None:
    @channel("time", "line", quantity, "N", text, band)
    def _make(result: TimeResult, name: str) -> Made:
        values = make(result, name)
        return None if values is None else (values, (_arc(result, name),))


_along(
    "tension_mean", "Mean tension of the elements", "total", lambda r, n: r.elements("tension_mean", n).mean(axis=-1)
)
_along(
    "tension_min",
    "Least tension of the elements, all seeds",
    "total",
    lambda r, n: r.elements("lowest", n).min(axis=-1),
)
_along(
    "tension_max",
    "Largest tension of the elements, all seeds",
    "total",
    lambda r, n: r.elements("highest", n).max(axis=-1),
)
_along("tension_std_wf", "Standard deviation of tension at wave frequencies", "wf", lambda r, n: _tension(r, n)["wf"])
_along("tension_std_lf", "Standard deviation of tension at low frequencies", "lf", lambda r, n: _tension(r, n)["lf"])
_along(
    "tension_first_harmonic", "Amplitude of tension at the frequency of the motion", "wf",
    lambda r, n: r.elements("harmonic", n).mean(axis=-1) if "harmonic" in r.arrays else None,
)  # fmt: skip


@channel(
    "time", "line", "rainflow", "1/h", "Rainflow cycles of the reaction at end b per hour of one line, by tension range"
)
def _rainflow(result: TimeResult, name: str) -> Made:
    """Counts of all seeds in RANGES equal ranges up to the largest (the library `rainflow`, ASTM E1049)."""
    from rainflow import count_cycles

    history = result.history(name, "end_b_tension").astype(float)
    largest = float((history.max(axis=0) - history.min(axis=0)).max())
    if largest <= 0.0:
        return None
    width = largest / RANGES
    counts = np.zeros(RANGES)
    for seed in range(history.shape[1]):
        for upper, cycles in count_cycles(history[:, seed], binsize=width):
            counts[min(round(upper / width), RANGES) - 1] += cycles
    hours = history.shape[0] * history.shape[1] * result.step / 3600.0
    return counts / hours, (Axis("tension_range", "N", width * (np.arange(RANGES) + 0.5)),)
