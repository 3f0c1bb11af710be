"""One seed's sea: amplitudes, and forces on the vessel as a table over time (T10-T12)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..case.analysis import FrequencyDomain, TimeDomain
from ..case.environment import RegularWave
from ..model.build import Model
from ..model.line import harmonic_omega
from ..outcome import CaseError, FieldError
from ..vessel.drift import Drift, difference_sum
from ..waves.spectra import spectrum

Array = np.ndarray
LEAST_STEPS = 10  # of the march in the shortest wave or prescribed motion


@dataclass(frozen=True)
class Components:
    """Wave components of every wave system on one even grid.

    omega (N,) = (first + n) dω [rad/s]; directions of the systems [rad]; densities (N,) of each, zero outside `band`
    and for a regular wave; fixed : complex amplitudes (N,) of a regular wave [m], None for a random system.
    """

    omega: Array
    step: float
    first: int
    directions: tuple[float, ...]
    densities: tuple[Array, ...]
    fixed: tuple[Array | None, ...]
    band: slice

    @property
    def period(self) -> float:
        """Time after which every component repeats [s]."""
        return 2 * math.pi / self.step

    @property
    def regular(self) -> bool:
        """Whether every system is a regular wave."""
        return all(one is not None for one in self.fixed)

    @property
    def variances(self) -> Array:
        """Mean variance of elevation of every component of every system (systems, N) [m2]."""
        return np.array([
            density * self.step if fixed is None else 0.5 * np.abs(fixed) ** 2
            for density, fixed in zip(self.densities, self.fixed, strict=True)
        ])  # fmt: skip

    def amplitudes(self, seed: int, random: bool) -> Array:
        """Complex amplitudes (systems, N) [m]: of random systems E|A|² = 2 S dω, with random phase or Gaussian (T10)."""
        out = np.zeros((len(self.directions), self.omega.size), dtype=complex)
        drawn = 0
        for row, density, fixed in zip(out, self.densities, self.fixed, strict=True):
            if fixed is not None:
                row[:] = fixed
                continue
            draw = np.random.default_rng(np.random.SeedSequence([seed, drawn]))
            size = np.sqrt(2.0 * density[self.band] * self.step)
            if random:
                row[self.band] = size * (draw.standard_normal(size.size) + 1j * draw.standard_normal(size.size))
                row /= math.sqrt(2.0)
            else:
                row[self.band] = size * np.exp(2j * math.pi * draw.random(size.size))
            drawn += 1
        return out


def components(model: Model, spec: TimeDomain, kept: float) -> Components | None:
    """The wave components of a case; None in still water. kept : kept duration, a whole number of steps [s].

    Raises CaseError for a step that is too coarse for what moves.
    """
    seas = model.wave_systems
    moves = harmonic_omega(model.case)
    if moves is not None:
        _resolved(spec, moves)
    if not seas:
        return None
    regular = [sea for sea, _ in seas if isinstance(sea, RegularWave)]
    if any(abs(sea.period - regular[0].period) > 1e-9 for sea in regular):
        raise CaseError([FieldError(("environment", "seastates"), "the time domain takes regular waves of one period")])
    single = 2 * math.pi / regular[0].period if regular else None
    if single is not None and len(regular) == len(seas):
        return _on_grid(seas, single, single, (1, 0))
    band = (model.case.analyses.frequency_domain or FrequencyDomain()).wave
    step = float(spec.wave_step) if spec.wave_step else 2 * math.pi / kept
    if single is not None:
        step = single / max(round(single / step), 1)
    lowest, highest = math.ceil(band.from_ / step - 1e-9), math.floor(band.to / step + 1e-9)
    if highest < lowest:
        raise CaseError([FieldError(
            ("analyses", "time_domain", "wave_step" if spec.wave_step else "duration"),
            f"components {step:.3g} rad/s apart leave none between {band.from_:g} and {band.to:g} rad/s; "
            "use a longer duration or a smaller wave_step",
        )])  # fmt: skip
    _resolved(spec, highest * step)
    return _on_grid(seas, single, step, (lowest, highest))


def _on_grid(seas: list[tuple[object, float]], single: float | None, step: float, band: tuple[int, int]) -> Components:
    """Random systems in `band` (whole multiples of the step) and regular waves of frequency `single` on one grid."""
    own = round(single / step) if single is not None else band[0]
    first, last = min(band[0], own), max(band[1], own)
    omega = step * np.arange(first, last + 1)
    inside = slice(band[0] - first, band[1] + 1 - first)
    densities, fixed = [], []
    for sea, _ in seas:
        density, amplitude = np.zeros(omega.size), None
        if isinstance(sea, RegularWave):
            amplitude = np.zeros(omega.size, dtype=complex)
            amplitude[own - first] = 0.5 * sea.height * np.exp(1j * sea.phase)
        else:
            density[inside] = spectrum(omega[inside], sea)  # type: ignore[arg-type]
        densities.append(density)
        fixed.append(amplitude)
    directions = tuple(heading for _, heading in seas)
    return Components(omega, step, first, directions, tuple(densities), tuple(fixed), inside)


def _resolved(spec: TimeDomain, omega: float) -> None:
    """Refuse a step longer than a tenth of the shortest wave or prescribed motion."""
    longest = 2 * math.pi / omega / LEAST_STEPS
    if spec.step > longest * (1 + 1e-9):
        raise CaseError([FieldError(
            ("analyses", "time_domain", "step"),
            f"{spec.step:g} s is too coarse for a period of {2 * math.pi / omega:.3g} s; allowed: ≤ {longest:.3g} s",
            f"{spec.step:g}",
        )])  # fmt: skip


def whole_period(spec: TimeDomain, kept: float) -> bool:
    """Whether a kept duration [s] is a whole number of periods of the random components."""
    periods = kept * float(spec.wave_step) / (2 * math.pi) if spec.wave_step else 1.0
    return periods > 0.5 and abs(periods - round(periods)) < 1e-6


def low_border(model: Model) -> float:
    """Frequency that parts low from wave frequencies, `low.to` [rad/s]."""
    return float((model.case.analyses.frequency_domain or FrequencyDomain()).low.to)


class VesselLoads:
    """First- and second-order loads on the vessel of any seed, on one time grid (T11, T12)."""

    def __init__(self, model: Model, waves: Components, yaw: float, step: float):
        assert model.vessel is not None
        self.waves = waves
        self.count = max(round(waves.period / step), 8)
        self.step = waves.period / self.count
        self.first_order = [model.vessel.excitation(waves.omega, heading, yaw) for heading in waves.directions]
        self.sums: dict[tuple[int, int], Callable[[Array, Array], Array]] = {}
        if model.vessel.has_drift and not waves.regular:
            force = Drift(model.vessel.data, model.vessel.drift, yaw)
            last = int(model.vessel.difference_to / waves.step + 1e-9)
            for m, one in enumerate(waves.directions):
                for n, other in enumerate(waves.directions):
                    self.sums[m, n] = difference_sum(force, waves.omega, one, other, last)

    def difference(self, amplitudes: Array) -> Array:
        """G_k of the slow drift force, k = 0 … (K, 6); empty without drift."""
        parts = [collected(amplitudes[m], amplitudes[n]) for (m, n), collected in self.sums.items()]
        return np.sum(parts, axis=0) if parts else np.zeros((0, 6), dtype=complex)

    def table(self, amplitudes: Array) -> Array:
        """Force over one period, (T, 6) [N, N m]. The mean drift is left out: it acts in the static position."""
        half = np.zeros((self.count // 2 + 1, 6), dtype=complex)
        index = self.waves.first + np.arange(self.waves.omega.size)
        for force, amplitude in zip(self.first_order, amplitudes, strict=True):
            half[index] += force * amplitude[:, None]
        G = self.difference(amplitudes)
        half[1 : G.shape[0]] += 2.0 * G[1:]
        return np.asarray(np.fft.irfft(half * (0.5 * self.count), self.count, axis=0))
