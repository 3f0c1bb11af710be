"""Statics, frequency domain and modes of a scene, worked out again from raw shapes, forces and complex responses.

Nothing of solver/results is used: geometry, statistics and names of places are written out here.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from .compare import Close, Holds
from .scenes import Linear

Array = np.ndarray
DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
RHO_G = 9.807


class Raw:
    """A scene's case as numbers, and what the solver left: shapes, end forces, responses."""

    def __init__(self, scene: Linear) -> None:
        self.case, solved = scene.case, scene.solved
        self.solved, self.static, self.frequency, self.modes = solved, solved.static, solved.frequency, solved.modes
        vessel = self.case.vessel
        self.heading = float(vessel.heading) if vessel is not None else 0.0
        self.names = list(self.case.lines)
        self.shapes = dict(zip(self.names, self.static.state.shapes, strict=True))
        self.forces = dict(zip(self.names, self.static.state.end_forces, strict=True))

    def earth(self, vector: Any) -> Array:
        """Turn by the heading, counter-clockwise seen from above."""
        c, s = np.cos(self.heading), np.sin(self.heading)
        v = np.asarray(vector)
        return np.stack([c * v[..., 0] - s * v[..., 1], s * v[..., 0] + c * v[..., 1], v[..., 2]], axis=-1)

    def along(self, name: str, key: str) -> Array:
        """A property of the line type of every element (N,)."""
        kinds = self.case.line_types
        return np.array([
            np.nan if getattr(kinds[s.type], key) is None else getattr(kinds[s.type], key)
            for s in self.case.lines[name].segments for _ in range(s.elements)
        ], dtype=float)  # fmt: skip

    def lengths(self, name: str) -> Array:
        return np.concatenate([np.full(s.elements, s.length / s.elements) for s in self.case.lines[name].segments])

    def nodes(self, name: str) -> Array:
        return np.append(0.0, np.cumsum(self.lengths(name)))

    def middles(self, name: str) -> Array:
        nodes = self.nodes(name)
        return nodes[:-1] + 0.5 * self.lengths(name)

    def per_metre(self, kind: Any) -> tuple[float, float]:
        """Displaced volume and weight in water per metre: solid cylinders."""
        water = self.case.environment.water
        volume = np.pi * kind.diameter**2 / 4
        return volume, (kind.mass - water.density * volume) * water.gravity

    def tension(self, name: str) -> Array:
        stretched = np.linalg.norm(np.diff(self.shapes[name], axis=0), axis=1)
        return self.along(name, "EA") * (stretched / self.lengths(name) - 1.0)

    def breaking(self, name: str) -> Array:
        own = self.along(name, "breaking_load")
        return np.concatenate([own[:1], own, own[-1:]])

    def weights(self, name: str) -> Array:
        """Weight in water of the elements (N,)."""
        kinds = [self.case.line_types[s.type] for s in self.case.lines[name].segments for _ in range(s.elements)]
        return np.array([self.per_metre(kind)[1] for kind in kinds]) * self.lengths(name)


def largest(arc: Array, values: Array) -> dict[str, float]:
    order = np.argsort(values, kind="stable")
    return {"tension": values[order[-1]], "arc_length": arc[order[-1]]}


def used(values: Array, breaking: Array) -> dict[str, float]:
    ratios = [value / load for value, load in zip(values, breaking, strict=True) if not np.isnan(load)]
    return {"utilisation": max(ratios)} if ratios else {}


def with_ends(raw: Raw, name: str, end_a: float, inner: Array, end_b: float) -> tuple[Array, Array]:
    arc = np.concatenate([[0.0], raw.middles(name), [raw.nodes(name)[-1]]])
    return arc, np.concatenate([[end_a], inner, [end_b]])


def grounded(raw: Raw, name: str) -> Any:
    """Length on the bed from the balance of each node: what of its weight its elements do not carry (L21)."""
    x, tension, weight = raw.shapes[name], raw.tension(name), raw.weights(name)
    lift = tension * np.diff(x[:, 2]) / np.linalg.norm(np.diff(x, axis=0), axis=1)
    nodes = 0.5 * (np.append(weight, 0.0) + np.append(0.0, weight))
    carried = np.zeros(len(x))
    carried[1:-1] = np.clip((nodes[1:-1] - (lift[1:] - lift[:-1])) / nodes[1:-1], 0.0, 1.0)
    depth, diameter = raw.case.environment.depth, raw.along(name, "diameter")
    for end, beside, size in ((0, 1, diameter[0]), (-1, -2, diameter[-1])):
        if x[end, 2] + depth <= size:
            carried[end] = carried[beside]
    total = 0.0
    for length, one, two in zip(raw.lengths(name), carried[:-1], carried[1:], strict=True):
        fine = np.linspace(one, two, 20001)
        total += length * np.mean(fine >= 0.5)
    return Close(total, 5e-3) if total else 0.0


def statics(raw: Raw) -> dict[str, Any]:
    lines = {}
    for name, line in raw.case.lines.items():
        end_b, end_a = raw.forces[name][:3], raw.forces[name][3:]
        sizes = np.sqrt(np.sum(end_a**2)), np.sqrt(np.sum(end_b**2))
        arc, values = with_ends(raw, name, sizes[0], raw.tension(name), sizes[1])
        lines[name] = {
            "end_a": {"tension": sizes[0], "force": raw.earth(end_a), "position": raw.earth(raw.shapes[name][0])},
            "end_b": {"tension": sizes[1], "force": raw.earth(end_b), "position": raw.earth(raw.shapes[name][-1])},
            "arc_length": raw.middles(name), "tension": raw.tension(name), "length": raw.nodes(name)[-1],
            "weight_in_water": raw.weights(name).sum(), "grounded_length": grounded(raw, name),
            "multiplicity": line.multiplicity, "largest": largest(arc, values), **used(values, raw.breaking(name)),
        }  # fmt: skip
    out: dict[str, Any] = {
        "converged": True, "iterations": Holds(lambda n: isinstance(n, int) and 1 <= n <= 200),
        "residual": Holds(lambda size: 0.0 <= size < 1e-4 * max(raw.tension(name).max() for name in raw.names)),
        "lines": lines,
    }  # fmt: skip
    if raw.case.vessel is not None:
        out["vessel"] = {"position": raw.static.state.position, "mean_drift": mean_drift(raw)}
    return out


def mean_drift(raw: Raw) -> Any:
    """2 ∫ S T dω of the synthetic data (tests/vessel/synthetic.py) at the heading relative to the turned vessel."""
    vessel = raw.case.vessel
    if vessel.mean_drift == "exclude" or vessel.hydrodynamics is None or vessel.hydrodynamics.drift == "none":
        return np.zeros(6)
    yaw, out = raw.static.state.position[5], np.zeros(6)
    omega = np.linspace(0.1, 2.0, 4001)
    for sea in raw.case.environment.random:
        beta = sea.direction - raw.heading - yaw
        per_square = np.stack([2e4 * omega * np.cos(beta), 5e4 * omega * np.sin(beta), 3e5 * omega * np.sin(2 * beta)])
        force = 2.0 * np.trapezoid(
            jonswap(omega, sea.hs, 2 * np.pi / sea.peak_period, sea.gamma) * per_square, omega, axis=1
        )
        c, s = np.cos(yaw), np.sin(yaw)
        out[[0, 1, 5]] += [c * force[0] - s * force[1], s * force[0] + c * force[1], force[2]]
    return Close(out, 0.03)


def jonswap(omega: Array, hs: float, peak: float, gamma: float) -> Array:
    """Its area made Hs²/16 by a fine sum."""
    return np.asarray(hs**2 / 16 / _area(peak, gamma) * _jonswap(np.asarray(omega), peak, gamma))


def _jonswap(w: Array, peak: float, gamma: float) -> Array:
    width = np.where(w > peak, 0.09, 0.07)
    return w**-5.0 * np.exp(-1.25 * (peak / w) ** 4) * gamma ** np.exp(-((w - peak) ** 2) / (2 * (width * peak) ** 2))


@cache
def _area(peak: float, gamma: float) -> float:
    fine = peak * np.geomspace(0.2, 60.0, 400_000)
    return float(np.trapezoid(_jonswap(fine, peak, gamma), fine))


class Bands:
    """The strips of a random frequency domain, from the settings, and the moments of responses on them."""

    def __init__(self, raw: Raw) -> None:
        result = raw.frequency
        settings = raw.case.analyses.frequency_domain
        wave, low = settings.wave, settings.low
        parts = [(wave.from_, low.to), (low.to, wave.to)] if wave.from_ < low.to < wave.to else [(wave.from_, wave.to)]
        edges = np.concatenate([np.linspace(a, b, max(round((b - a) / wave.step), 1) + 1)[:None] for a, b in parts])
        edges = np.unique(edges.round(12))
        self.border = low.to
        self.wave, self.wave_width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
        slow = result.low is not None
        self.low = low.step * np.arange(1, round(low.to / low.step) + 1) if slow else np.zeros(0)
        self.low_width = np.full(self.low.size, low.step)
        seas = raw.case.environment.random
        self.S = np.array([jonswap(self.wave, one.hs, 2 * np.pi / one.peak_period, one.gamma) for one in seas])
        self.duration = float(settings.storm_duration)

    def spectra(self, first: Array, second: Array | None) -> tuple[Array, Array]:
        """Σ S |H|² on the strips of first order, Σ |H|² on those of second order; responses lead, frequencies last."""
        n = self.wave.size
        one = sum(self.S[r] * np.abs(first[r][..., :n]) ** 2 for r in range(len(self.S)))
        if second is None or not self.low.size:
            return one, np.zeros((*one.shape[:-1], 0))
        return one, sum(np.abs(response[..., : self.low.size]) ** 2 for response in second)

    def variance(self, one: Array, two: Array, band: str, order: int = 0) -> Array:
        total = 0.0
        for S, omega, width in ((one, self.wave, self.wave_width), (two, self.low, self.low_width)):
            inside = {"lf": omega <= self.border + 1e-9, "wf": omega > self.border + 1e-9, "total": omega > 0}[band]
            total = total + np.sum(S * omega**order * width * inside, axis=-1)
        return np.asarray(total)

    def on_one_axis(self, one: Array, two: Array) -> tuple[Array, Array]:
        """Both orders over all frequencies: `np.interp` between strips, nothing outside."""
        omega = np.unique(np.concatenate([self.low, self.wave]))
        out = np.zeros((*one.shape[:-1], omega.size))
        for place in np.ndindex(one.shape[:-1]):
            out[place] = np.interp(omega, self.wave, one[place], left=0, right=0)
            if self.low.size:
                out[place] += np.interp(omega, self.low, two[place], left=0, right=0)
        return omega, out

    def maximum(self, m0: Array, m2: Array) -> Array:
        """σ √(2 ln(T/Tz)), at least σ, 0 where nothing moves."""
        m0, m2 = np.atleast_1d(m0), np.atleast_1d(m2)
        out = np.zeros(m0.shape)
        for k, (a, b) in enumerate(zip(m0, m2, strict=True)):
            if a > 0:
                waves = self.duration * np.sqrt(b / a) / (2 * np.pi)
                out[k] = np.sqrt(a) * max(np.sqrt(2 * np.log(max(waves, 1.0))), 1.0)
        return out

    def statistics(self, one: Array, two: Array) -> dict[str, Array]:
        """σ and most probable maximum of each band, and the combination of both (R4)."""
        out: dict[str, Array] = {}
        for band in ("wf", "lf"):
            m0, m2 = (self.variance(one, two, band, order) for order in (0, 2))
            out[band], out[f"{band}_max"] = np.sqrt(m0), self.maximum(m0, m2)
        both = [out["wf_max"] + 2 * out["lf"], out["lf_max"] + 2 * out["wf"]]
        out["max"] = np.where(both[0] > both[1], both[0], both[1])
        return out


def by_dof(values: Any) -> dict[str, float]:
    return {name: value for name, value in zip(DOFS, values, strict=True)}  # noqa: C416


def frequency(raw: Raw) -> dict[str, Any]:
    result = raw.frequency
    settings = raw.case.analyses.frequency_domain
    out: dict[str, Any] = {
        "converged": True, "iterations": Holds(lambda n: isinstance(n, int) and 1 <= n <= settings.max_iterations),
        "last_change": Holds(lambda change: 0 <= change <= settings.tolerance),
        "wall_time": Holds(lambda seconds: 0 < seconds < 600), "linearisation": settings.linearisation,
    }  # fmt: skip
    if not raw.case.environment.random:
        return {**out, **harmonic(raw)}
    bands = Bands(raw)
    out["storm_duration"] = bands.duration
    low = result.low
    if result.wave.vessel is not None:
        one, two = bands.spectra(result.wave.vessel, low.vessel if low else None)
        found = bands.statistics(one, two)
        out["vessel_std"] = {band: by_dof(found[band]) for band in ("wf", "lf")}
        out["vessel_significant"] = {band: by_dof(2 * found[band]) for band in ("wf", "lf")}
        out["vessel_most_probable_max"] = {
            "wf": by_dof(found["wf_max"]), "lf": by_dof(found["lf_max"]), "combined": by_dof(found["max"]),
        }  # fmt: skip
        out["origin_std"] = {
            "first_order": by_dof(np.sqrt(np.sum(one * bands.wave_width, axis=-1))),
            "second_order": by_dof(np.sqrt(np.sum(two * bands.low_width, axis=-1))),
        }  # fmt: skip
    out["lines"] = {name: _line(raw, bands, k, name) for k, name in enumerate(raw.names)}
    return out


def _line(raw: Raw, bands: Bands, k: int, name: str) -> dict[str, Any]:
    wave, low = raw.frequency.wave, raw.frequency.low
    one, two = bands.spectra(wave.tension[k], low.tension[k] if low else None)
    found, mean = bands.statistics(one, two), raw.tension(name)
    ends = _ends(raw, bands, k, name)
    arc, values = with_ends(raw, name, ends["end_a_tension"]["most_probable_max"], mean + found["max"],
                            ends["end_b_tension"]["most_probable_max"])  # fmt: skip
    return {
        "arc_length": raw.middles(name), "tension_mean": mean, "tension_most_probable_max": mean + found["max"],
        "tension_std": {band: found[band] for band in ("wf", "lf")},
        "tension_significant": {band: 2 * found[band] for band in ("wf", "lf")},
        "tension_origin_std": {"first_order": np.sqrt(np.sum(one * bands.wave_width, axis=-1)),
                               "second_order": np.sqrt(np.sum(two * bands.low_width, axis=-1))},
        **ends, "largest": largest(arc, values), **used(values, raw.breaking(name)),
    }  # fmt: skip


def anchor_row(raw: Raw, name: str) -> int:
    """Row of the vertical force on the anchor: end b (2) where only end b is anchored, else end a (3)."""
    line = raw.case.lines[name]
    return 2 if line.end_b.anchor is not None and line.end_a.anchor is None else 3


def _ends(raw: Raw, bands: Bands, k: int, name: str) -> dict[str, Any]:
    wave, low = raw.frequency.wave, raw.frequency.low
    found = bands.statistics(*bands.spectra(wave.ends[k], low.ends[k] if low else None))
    force = raw.forces[name]
    rest = [np.sqrt(force[:3] @ force[:3]), np.sqrt(force[3:] @ force[3:]), force[2], force[5]]
    rows = {"end_b_tension": 0, "end_a_tension": 1, "anchor_vertical": anchor_row(raw, name)}
    return {
        key: {"mean": rest[row], "std": {band: found[band][row] for band in ("wf", "lf")},
              "most_probable_max": rest[row] + found["max"][row]} for key, row in rows.items()
    }  # fmt: skip


def harmonic(raw: Raw) -> dict[str, Any]:
    wave = raw.frequency.wave
    out: dict[str, Any] = {"lines": {}}
    for k, name in enumerate(raw.names):
        size = np.hypot(wave.ends[k][0, :, 0].real, wave.ends[k][0, :, 0].imag)
        tension = wave.tension[k][0, :, 0]
        out["lines"][name] = {
            "arc_length": raw.middles(name), "tension_amplitude": np.hypot(tension.real, tension.imag),
            "end_a_tension_amplitude": size[1], "end_b_tension_amplitude": size[0],
            "anchor_vertical_amplitude": size[anchor_row(raw, name)],
        }  # fmt: skip
    if wave.vessel is not None:
        out["vessel_amplitude"] = by_dof(np.hypot(wave.vessel[0, :, 0].real, wave.vessel[0, :, 0].imag))
    return out
