"""Everything that was solved of one case: what channels and the summary are made from."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..frequency_domain.solve import FrequencyResult
from ..model.build import Model
from ..model.line import LineModel, turned
from ..modes.equivalent import Equivalent
from ..modes.solve import Mode
from ..statics.solve import StaticState

Array = np.ndarray
#: rows of the forces of a line on its supports, as `frequency_domain.ends` gives them
END_FORCES = ("end_b_tension", "end_a_tension", "end_b_vertical", "end_a_vertical")
ORIGINS = ("first_order", "second_order")


@dataclass(frozen=True)
class Spectra:
    """Spectra of one response by origin, each on its own strips: first order (…, W), second order (…, K), K = 0 without."""

    first: Array
    second: Array

    def __getitem__(self, index: int) -> Spectra:
        return Spectra(self.first[index], self.second[index])


@dataclass(frozen=True)
class ModesResult:
    """Modes from the longest period down, their line shapes (per line, (modes, N+1, 3)) and equivalent coefficients."""

    modes: list[Mode]
    shapes: list[Array]
    equivalent: Equivalent | None
    asymmetry: float


@dataclass(frozen=True)
class Solved:
    """Model and the outcome of each analysis that ran and converged."""

    model: Model
    static: StaticState
    frequency: FrequencyResult | None = None
    modes: ModesResult | None = None
    failures: dict[str, str] = field(default_factory=dict)

    @property
    def lines(self) -> tuple[LineModel, ...]:
        return self.static.lines

    def index(self, name: str) -> int:
        return next(i for i, line in enumerate(self.lines) if line.name == name)

    def earth(self, vectors: Array) -> Array:
        """Vectors (…, 3) of the solver's frame in earth axes."""
        return turned(vectors, self.model.frame)

    @property
    def is_random(self) -> bool:
        return self.frequency is not None and self.frequency.driver.is_random

    @property
    def has_slow_drift(self) -> bool:
        return self.frequency is not None and self.frequency.driver.low is not None

    @cached_property
    def omega_wave(self) -> Array:
        """Frequencies of the first-order response (W,) [rad/s]."""
        assert self.frequency is not None
        strips = self.frequency.driver.wave.strips
        return strips.omega[: strips.count]

    @cached_property
    def omega_low(self) -> Array:
        """Frequencies of the second-order response (K,), empty without slow drift [rad/s]."""
        if self.frequency is None or self.frequency.driver.low is None:
            return np.zeros(0)
        strips = self.frequency.driver.low.strips
        return strips.omega[: strips.count]

    @cached_property
    def omega(self) -> Array:
        """Frequencies of both orders on one axis, rising."""
        if self._apart:
            return np.concatenate([self.omega_low, self.omega_wave])
        return np.unique(np.concatenate([self.omega_low, self.omega_wave]))

    @property
    def _apart(self) -> bool:
        """Whether all frequencies of second order lie below those of first order."""
        return self.omega_low.size == 0 or bool(self.omega_low[-1] < self.omega_wave[0])

    def spectra(self, wave: Array, low: Array | None) -> Spectra:
        """Response spectra (…, W) and (…, K) from responses (R, …, W_padded) and (R', …, K_padded) (F16)."""
        assert self.frequency is not None
        S, count = self.frequency.driver.wave.spectra, self.omega_wave.size
        first = np.einsum("rw,r...w->...w", S[:, :count], np.abs(wave[..., :count]) ** 2)
        if low is None:
            return Spectra(first, np.zeros((*first.shape[:-1], 0)))
        return Spectra(first, np.sum(np.abs(low[..., : self.omega_low.size]) ** 2, axis=0))

    def total(self, spectra: Spectra) -> Array:
        """Spectra of both orders together over `omega`; linear between strips where the bands overlap."""
        parts = ((self.omega_low, spectra.second), (self.omega_wave, spectra.first))
        if self._apart:
            return np.concatenate([values for _, values in parts], axis=-1)
        return np.asarray(sum(_between(self.omega, omega, values) for omega, values in parts))

    def moments(self, spectra: Spectra, band: str, order: int = 0) -> Array:
        """∫ωⁿ S dω over a band of frequency (`wf`, `lf`, `total`), each order of the waves on its own strips (R3)."""
        return np.asarray(sum(self._moment(spectra, origin, band, order) for origin in ORIGINS))

    def variance(self, spectra: Spectra, origin: str) -> Array:
        """Variance of the `first_order` or the `second_order` response at all frequencies (R3)."""
        return self._moment(spectra, origin, "total", 0)

    def _moment(self, spectra: Spectra, origin: str, band: str, order: int) -> Array:
        assert self.frequency is not None
        drive = self.frequency.driver
        part, S = (drive.wave, spectra.first) if origin == "first_order" else (drive.low, spectra.second)
        if part is None:
            return np.zeros(S.shape[:-1])
        strips = part.strips
        window = {"wf": slice(strips.below, None), "lf": slice(0, strips.below), "total": slice(None)}[band]
        weights = strips.omega[: strips.count] ** order * strips.widths
        return np.asarray((S[..., window] * weights[window]).sum(axis=-1))

    @cached_property
    def vessel_spectra(self) -> Spectra | None:
        """Spectra of the six motions, (6, …)."""
        if self.frequency is None or self.frequency.wave.vessel is None or not self.is_random:
            return None
        low = self.frequency.low
        return self.spectra(self.frequency.wave.vessel, low.vessel if low is not None else None)

    def tension_spectra(self, index: int, elements: slice = slice(None)) -> Spectra:
        """Spectra of tension of the elements of a line, (N, …) [N² s/rad]."""
        assert self.frequency is not None
        low = self.frequency.low
        slow = low.tension[index][:, elements] if low is not None else None
        return self.spectra(self.frequency.wave.tension[index][:, elements], slow)

    def end_spectra(self, index: int) -> Spectra:
        """Spectra of the forces at the ends of a line (rows END_FORCES), (4, …) [N² s/rad]."""
        assert self.frequency is not None
        low = self.frequency.low
        return self.spectra(self.frequency.wave.ends[index], low.ends[index] if low is not None else None)

    def end_means(self, index: int) -> Array:
        """Static forces at the ends of a line (rows END_FORCES), (4,) [N]."""
        end_b, end_a = self.static.state.end_forces[index].reshape(2, 3)
        return np.array([np.linalg.norm(end_b), np.linalg.norm(end_a), end_b[2], end_a[2]])

    def moment_spectra(self, index: int) -> Spectra:
        """Spectra of bending moment in plane and out of plane, (2, N+1, …) [(N m)² s/rad]."""
        assert self.frequency is not None
        low = self.frequency.low
        return self.spectra(self.frequency.wave.moment[index], low.moment[index] if low is not None else None)


def _between(omega: Array, own: Array, values: Array) -> Array:
    """Values (…, K) at rising frequencies `own`, linear between them at omega (W,) and zero outside: (…, W)."""
    upper = np.clip(np.searchsorted(own, omega), 1, max(own.size - 1, 1))
    lower = np.minimum(upper - 1, own.size - 1)
    upper = np.minimum(upper, own.size - 1)
    gap = np.where(upper > lower, own[upper] - own[lower], 1.0)
    share = np.clip((omega - own[lower]) / gap, 0.0, 1.0)
    inside = (omega >= own[0]) & (omega <= own[-1])
    return np.asarray(((1.0 - share) * values[..., lower] + share * values[..., upper]) * inside)
