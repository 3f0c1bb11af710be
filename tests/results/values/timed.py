"""The time domain of a scene worked out again from the recorded histories: bands by a plain Fourier sum, seeds, rainflow."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from .compare import Close, Holds
from .linear import DOFS, by_dof
from .linear_channels import _one
from .scenes import Timed

Array = np.ndarray
FLOAT = 2e-5  # histories are kept in single precision
ROWS = {"end_b_tension": 0, "end_a_tension": 1, "grounded_length": 4, "touchdown": 5}


class History:
    """Histories of a record with the padding of short lines cut off."""

    def __init__(self, scene: Timed) -> None:
        self.scene, self.record, self.timing = scene, scene.record, scene.timing
        self.names = list(scene.case.lines)
        self.step = self.timing.h * self.timing.every
        low = scene.case.analyses.frequency_domain
        self.border = float(low.low.to)
        self.random = bool(scene.case.environment.random)
        self.moves = scene.case.vessel is not None
        self.periodic = self.random  # a whole period of its components, which are 2π/duration apart

    def elements(self, values: Array, name: str) -> Array:
        """(…, N of the line, seeds) from (…, most elements, lines, seeds)."""
        count = len(self.scene.lines[name].arrays.L)
        return values[..., values.shape[-3] - count :, self.names.index(name), :].astype(float)

    def end(self, name: str, what: str) -> Array:
        return self.record.ends[:, self.row(name, what), self.names.index(name), :].astype(np.float32).astype(float)

    def row(self, name: str, what: str) -> int:
        if what != "anchor_vertical":
            return ROWS[what]
        line = self.scene.case.lines[name]
        return 2 if line.end_b.anchor is not None and line.end_a.anchor is None else 3

    def bands(self, values: Array) -> tuple[Array, Array]:
        """Variance (…, seeds) below and above the border by the lines of a discrete Fourier transform; (n, …, seeds)."""
        n = values.shape[0]
        window = self.window(n)
        moved = values - values.mean(axis=0)
        lines = np.fft.fft(moved * window.reshape((n,) + (1,) * (values.ndim - 1)), axis=0) / n
        omega = np.abs(2 * np.pi * np.fft.fftfreq(n, self.step))
        power = np.abs(lines) ** 2 / np.mean(window**2)
        low = (omega > 0) & (omega < self.border - 1e-9)
        return power[low].sum(axis=0), power[omega >= self.border - 1e-9].sum(axis=0)

    def window(self, n: int) -> Array:
        """Ones, or cosine flanks over a tenth of the record at either side."""
        if self.periodic:
            return np.ones(n)
        place = (np.arange(n) + 0.5) / n
        flank = np.clip(np.minimum(place, 1 - place) / 0.1, 0, 1)
        return np.sin(0.5 * np.pi * flank) ** 2

    def over_seeds(self, values: Array) -> dict[str, Array]:
        """σ and its standard error in both bands (R5, R6)."""
        low, high = self.bands(values)
        means = values.mean(axis=0)
        low = low + (means - means.mean(axis=-1)[..., None]) ** 2
        out, count = {}, values.shape[-1]
        for band, variance in (("lf", low), ("wf", high)):
            sigma = np.sqrt(variance.mean(axis=-1))
            spread = np.zeros_like(sigma)
            if count > 1:
                spread = np.sqrt(
                    np.sum((variance - variance.mean(axis=-1)[..., None]) ** 2, axis=-1) / (count - 1) / count
                )
            out[band] = sigma
            out[f"{band}_error"] = np.where(sigma > 0, spread / np.where(sigma > 0, 2 * sigma, 1.0), 0.0)
        return out


def summary(scene: Timed) -> dict[str, Any]:
    h = History(scene)
    spec, record = scene.case.analyses.time_domain, h.record
    kept, built = round(spec.duration / spec.step), round(spec.build_up / spec.step)
    out: dict[str, Any] = {
        "converged": True, "realisations": spec.seeds, "time_step": float(spec.step), "steps": kept + built,
        "build_up": float(spec.build_up), "duration": float(spec.duration), "retried_steps": record.retries,
        "wall_time": Holds(lambda seconds: 0 < seconds < 600), "lines": {name: _line(h, name) for name in h.names},
    }  # fmt: skip
    if h.moves:
        motion = np.moveaxis(record.vessel.astype(np.float32).astype(float), 1, 2)
        found = h.over_seeds(motion)
        out["vessel_std"] = {band: by_dof(found[band]) for band in ("wf", "lf")}
        out["vessel_std_error"] = {band: by_dof(found[f"{band}_error"]) for band in ("wf", "lf")}
        out["vessel_mean"] = {key: Close(value, FLOAT) for key, value in by_dof(motion.mean(axis=(0, 2))).items()}
        out["sampling"] = _sampling(h, motion, found)
    return out


def _sampling(h: History, motion: Array, found: dict[str, Array]) -> dict[str, Any]:
    """Errors of the slow σ that count: a tenth of the largest, rotations at 100 m; the larger of scatter and (R9)."""
    arm = np.array([1, 1, 1, 100, 100, 100.0])
    largest = max(np.max(found["wf"] * arm), np.max(found["lf"] * arm))
    n = motion.shape[0]
    lines = np.fft.rfft(motion - motion.mean(axis=0), axis=0)
    omega = 2 * np.pi * np.arange(lines.shape[0]) / (n * h.step)
    power = np.abs(lines[(omega > 0) & (omega < h.border - 1e-9)]) ** 2
    ratio = (power**2).sum(axis=(0, 2)) / power.sum(axis=(0, 2)) ** 2
    record = 0.5 * np.sqrt(ratio / (2 - ratio))
    errors = {
        dof: max(found["lf_error"][k] / found["lf"][k], record[k])
        for k, dof in enumerate(DOFS)
        if found["lf"][k] * arm[k] > 0.1 * largest
    }
    return {"longest_natural_period": Holds(lambda period: _natural(h, period)), "lf_std_error": errors,
            "longest_natural_motion": Holds(lambda motion: motion in DOFS)}  # fmt: skip


def _natural(h: History, period: float) -> bool:
    """Whether the vessel on its lines, moved quasi-statically, has this period, and none longer."""
    from solver.modes.natural import _reduced

    model, static = h.scene.solved.model, h.scene.solved.static
    lines, stiffness = _reduced(static)
    omega = 2 * np.pi / period
    own = -model.vessel.dynamic(np.array([omega]), float(static.position[5]), np.zeros(6))[0].real / omega**2
    squares = np.linalg.eigvals(np.linalg.solve(0.5 * (own + own.T) + lines, stiffness)).real
    return bool(abs(np.sqrt(squares[squares > 0].min()) / omega - 1) < 1e-4)


def _line(h: History, name: str) -> dict[str, Any]:
    record, line = h.record, h.scene.lines[name]
    L = line.arrays.L
    middles = np.cumsum(L) - 0.5 * L
    tension = h.elements(record.tension, name)
    found = h.over_seeds(tension)
    highest, lowest = (h.elements(part, name) for part in (record.highest, record.lowest))
    slack = h.elements(record.slack, name).mean(axis=-1)
    index = h.names.index(name)
    out: dict[str, Any] = {
        "arc_length": middles, "tension_min": lowest.min(axis=-1), "tension_max": highest.max(axis=-1),
        "tension_mean": Close(tension.mean(axis=(0, 2)), FLOAT),
        "tension_std": {band: Close(found[band], 1e-4) for band in ("wf", "lf")},
        "tension_std_error": {band: Close(found[f"{band}_error"], 1e-3) for band in ("wf", "lf")},
        "end_b_max_per_seed": record.ends_range[1, 0, index],
    }  # fmt: skip
    for what in ("end_a_tension", "end_b_tension", "anchor_vertical"):
        history, row = h.end(name, what), h.row(name, what)
        out[what] = {
            "min": record.ends_range[0, row, index].min(), "max": record.ends_range[1, row, index].max(),
            **_mean_and_std(history),
        }  # fmt: skip
    if np.any(h.end(name, "grounded_length")):
        for what in ("grounded_length", "touchdown"):
            history = h.end(name, what)
            out[what] = {"min": history.min(), "max": history.max(), **_mean_and_std(history)}
    worst = int(np.argmax(slack)) if np.any(slack) else int(np.argmin(lowest.min(axis=-1)))
    out["slack"] = {"share": slack[worst], "arc_length": middles[worst]}
    ends = record.ends_range[1, :2, index].max(axis=-1)
    values = [ends[1], *highest.max(axis=-1), ends[0]]
    place = int(np.argmax(values))
    out["largest"] = {"tension": values[place], "arc_length": [0.0, *middles, L.sum()][place]}
    if not h.random:
        out["tension_first_harmonic"] = Close(_harmonic(h, tension), 1e-4)
    return out


def _mean_and_std(history: Array) -> dict[str, Any]:
    mean = history.sum() / history.size
    return {"mean": Close(mean, FLOAT), "std": Close(np.sqrt(((history - mean) ** 2).sum() / history.size), FLOAT)}


def _harmonic(h: History, tension: Array) -> Array:
    """Amplitude at the frequency of the motion: a Fourier integral over whole periods (the record is one)."""
    period = h.scene.case.lines["riser"].end_b.motion.surge.period
    n = tension.shape[0]
    assert abs(n * h.step / period - round(n * h.step / period)) < 1e-9
    turn = np.exp(-2j * np.pi * h.step * np.arange(1, n + 1) / period)
    return np.asarray((2 * np.abs(np.einsum("t,tes->es", turn, tension)) / n).mean(axis=-1))


def channels(scene: Timed) -> dict[str, Any]:
    h, record = History(scene), scene.record
    n = record.vessel.shape[0]
    time = h.step * (1 + np.arange(n))
    both = [time, record.seeds]
    out: dict[str, Any] = {}
    if h.moves:
        for k, dof in enumerate(DOFS):
            x, history = ("rad" if k > 2 else "m"), record.vessel[:, :, k].astype(np.float32)
            out[f"time/vessel/{dof}"] = _one(history, both, x)
            out[f"time/vessel/{dof}_spectrum"] = _spectrum(h, history.astype(float), f"{x}2 s/rad")
    for name in h.names:
        line = f"time/line/{name}"
        tension, L = h.elements(record.tension, name), scene.lines[name].arrays.L
        middles, found = np.cumsum(L) - 0.5 * L, h.over_seeds(tension)
        out[f"{line}/top_tension"] = _one(tension[:, -1], both, "N")
        whats = {"end_a_tension": "N", "end_b_tension": "N", "anchor_vertical": "N"}
        if np.any(h.end(name, "grounded_length")):
            whats |= {"grounded_length": "m", "touchdown": "m"}
        out |= {f"{line}/{what}": _one(h.end(name, what), both, unit) for what, unit in whats.items()}
        if h.random:
            out[f"{line}/top_tension_spectrum"] = _spectrum(h, tension[:, -1], "N2 s/rad")
        along = {"tension_mean": (tension.mean(axis=(0, 2)), "total"),
                 "tension_min": (h.elements(record.lowest, name).min(axis=-1), "total"),
                 "tension_max": (h.elements(record.highest, name).max(axis=-1), "total"),
                 "tension_std_wf": (found["wf"], "wf"), "tension_std_lf": (found["lf"], "lf")}  # fmt: skip
        if not h.random:
            along["tension_first_harmonic"] = (_harmonic(h, tension), "wf")
        out |= {f"{line}/{key}": _loose(_one(values, [middles], "N", band)) for key, (values, band) in along.items()}
        out[f"{line}/rainflow"] = _loose(rainflow_by_range(h, h.end(name, "end_b_tension")))
    return out


def _loose(channel: dict[str, Any]) -> dict[str, Any]:
    return {**channel, "values": Close(channel["values"], 1e-4)}


def _spectrum(h: History, history: Array, unit: str) -> dict[str, Any]:
    """Mean power of the seeds per rad/s, in bins of 0.005 rad/s or one line of the record, up to 2 rad/s (R8)."""
    n = history.shape[0]
    lines = np.fft.fft(history - history.mean(axis=0), axis=0) / n
    power = 2 * (np.abs(lines) ** 2).mean(axis=1)
    apart = 2 * np.pi / (n * h.step)
    together = max(round(0.005 / apart), 1)
    count = int(2.0 / apart) // together
    density = [power[1 + k * together : 1 + (k + 1) * together].sum() / (together * apart) for k in range(count)]
    omega = [apart * np.mean(1.0 + k * together + np.arange(together)) for k in range(count)]
    return {**_one(density, [omega], unit), "values": Close(np.array(density), 1e-4)}


def rainflow(history: Array) -> list[tuple[float, float]]:
    """(range, cycles) by ASTM E1049-85, 5.4.4: reversals on a stack, half cycles where the start is part of a range."""
    turns = [history[0]]
    for value in history[1:]:
        if value == turns[-1]:
            continue
        if len(turns) > 1 and (turns[-1] - turns[-2]) * (value - turns[-1]) > 0:
            turns[-1] = value
        else:
            turns.append(value)
    stack: list[float] = []
    found = []
    for turn in turns:
        stack.append(turn)
        while len(stack) >= 3:
            last, before = abs(stack[-1] - stack[-2]), abs(stack[-2] - stack[-3])
            if last < before:
                break
            if len(stack) == 3:
                found.append((before, 0.5))
                stack.pop(0)
            else:
                found.append((before, 1.0))
                del stack[-3:-1]
    return found + [(abs(b - a), 0.5) for a, b in pairwise(stack)]


def rainflow_by_range(h: History, history: Array) -> dict[str, Any]:
    """Cycles per hour of one line in fifty equal ranges up to the largest range of any seed."""
    width = max(np.ptp(history[:, k]) for k in range(history.shape[1])) / 50
    counts = np.zeros(50)
    for k in range(history.shape[1]):
        for size, cycles in rainflow(history[:, k]):
            counts[min(int(np.ceil(size / width - 1e-9)), 50) - 1] += cycles
    hours = history.size * h.step / 3600
    return _one(counts / hours, [width * (np.arange(50) + 0.5)], "1/h")
