"""One seed's sea: amplitudes, and forces on the vessel as a table over time (T10-T12)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..case.analysis import FrequencyDomain, TimeDomain
from ..case.environment import RegularWave
from ..model.build import Model
from ..model.line import harmonic_omega
from ..outcome import CaseError, FieldError
from ..vessel.drift import Drift, collect, difference_table
from ..waves.spectra import spectrum

Array = np.ndarray
LEAST_STEPS = 10  # of the march in the shortest wave or prescribed motion


@dataclass(frozen=True)
class Components:
    """Wave components on an even grid. omega (N,) = (first + n) dω; direction, spectrum density (N,) of each system."""

    omega: Array
    step: float
    first: int
    directions: tuple[float, ...]
    densities: tuple[Array, ...]
    regular: tuple[complex, ...] = ()

    @property
    def period(self) -> float:
        """Time after which every component repeats [s]."""
        return 2 * math.pi / self.step

    def amplitudes(self, seed: int, random: bool) -> Array:
        """Complex amplitudes (systems, N) [m] with E|A|² = 2 S dω: fixed with random phase, or Gaussian (T10)."""
        if self.regular:
            return np.array([[amplitude] for amplitude in self.regular])
        out = []
        for system, density in enumerate(self.densities):
            draw = np.random.default_rng(np.random.SeedSequence([seed, system]))
            size = np.sqrt(2.0 * density * self.step)
            if random:
                out.append(
                    size * (draw.standard_normal(size.size) + 1j * draw.standard_normal(size.size)) / math.sqrt(2.0)
                )
            else:
                out.append(size * np.exp(2j * math.pi * draw.random(size.size)))
        return np.array(out)


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
    directions = tuple(heading for _, heading in seas)
    if regular:
        if len(regular) < len(seas) or any(abs(sea.period - regular[0].period) > 1e-9 for sea in regular):
            raise CaseError([FieldError(
                ("environment", "seastates"),
                "the time domain takes random waves, or regular waves of one period, not both together",
            )])  # fmt: skip
        single = 2 * math.pi / regular[0].period
        amplitudes = tuple(complex(0.5 * sea.height * np.exp(1j * sea.phase)) for sea in regular)
        return Components(np.array([single]), single, 1, directions, (), amplitudes)
    band = (model.case.analyses.frequency_domain or FrequencyDomain()).wave
    step = float(spec.wave_step) if spec.wave_step else 2 * math.pi / kept
    first, last = math.ceil(band.from_ / step - 1e-9), math.floor(band.to / step + 1e-9)
    omega = step * np.arange(first, last + 1)
    if omega.size == 0:
        raise CaseError([FieldError(
            ("analyses", "time_domain", "wave_step" if spec.wave_step else "duration"),
            f"components {step:.3g} rad/s apart leave none between {band.from_:g} and {band.to:g} rad/s; "
            "use a longer duration or a smaller wave_step",
        )])  # fmt: skip
    _resolved(spec, float(omega[-1]))
    densities = tuple(spectrum(omega, sea) for sea in model.case.environment.random)
    return Components(omega, step, first, directions, densities)


def _resolved(spec: TimeDomain, omega: float) -> None:
    """Refuse a step longer than a tenth of the shortest wave or prescribed motion."""
    longest = 2 * math.pi / omega / LEAST_STEPS
    if spec.step > longest * (1 + 1e-9):
        raise CaseError([FieldError(
            ("analyses", "time_domain", "step"),
            f"{spec.step:g} s is too coarse for a period of {2 * math.pi / omega:.3g} s; allowed: ≤ {longest:.3g} s",
            f"{spec.step:g}",
        )])  # fmt: skip


def low_border(model: Model) -> float:
    """Frequency that parts low from wave frequencies [rad/s]."""
    return float((model.case.analyses.frequency_domain or FrequencyDomain()).wave.from_)


class VesselLoads:
    """First- and second-order loads on the vessel of any seed, on one time grid (T11, T12)."""

    def __init__(self, model: Model, waves: Components, yaw: float, step: float):
        assert model.vessel is not None
        self.waves = waves
        self.count = max(round(waves.period / step), 8)
        self.step = waves.period / self.count
        self.first_order = [model.vessel.excitation(waves.omega, heading, yaw) for heading in waves.directions]
        self.tables: dict[tuple[int, int], Array] = {}
        if model.vessel.has_drift and not waves.regular:
            t2 = Drift(model.vessel.data, model.vessel.drift, yaw)
            last = int(low_border(model) / waves.step + 1e-9)
            for m, one in enumerate(waves.directions):
                for n, other in enumerate(waves.directions):
                    self.tables[m, n] = difference_table(waves.omega, t2, one, other, last)

    def difference(self, amplitudes: Array) -> Array:
        """G_k of the slow drift force, k = 0 … (K, 6); empty without drift."""
        parts = [collect(table, amplitudes[m], amplitudes[n]) for (m, n), table in self.tables.items()]
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
