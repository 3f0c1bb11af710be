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

    @cached_property
    def omega_wave(self) -> Array:
        """Frequencies of the wave band (W,) [rad/s]."""
        assert self.frequency is not None
        strips = self.frequency.driver.wave.strips
        return strips.omega[: strips.count]

    @cached_property
    def omega_low(self) -> Array:
        """Frequencies of the low band (K,), empty without slow drift [rad/s]."""
        if self.frequency is None or self.frequency.driver.low is None:
            return np.zeros(0)
        strips = self.frequency.driver.low.strips
        return strips.omega[: strips.count]

    @cached_property
    def omega(self) -> Array:
        """Both bands on one axis, rising."""
        return np.concatenate([self.omega_low, self.omega_wave])

    @property
    def border(self) -> int:
        """Index of the first wave frequency on `omega`."""
        return int(self.omega_low.size)

    def spectrum(self, wave: Array, low: Array | None) -> Array:
        """Response spectrum over `omega` (…, W) from responses (R, …, W_padded) of both bands (F16)."""
        assert self.frequency is not None
        S = self.frequency.driver.wave.spectra
        count = self.omega_wave.size
        high = np.einsum("rw,r...w->...w", S[:, :count], np.abs(wave[..., :count]) ** 2)
        if low is None:
            return high
        return np.concatenate([np.sum(np.abs(low[..., : self.omega_low.size]) ** 2, axis=0), high], axis=-1)

    @cached_property
    def widths(self) -> Array:
        """Strip widths over `omega`, so that a sum is the variance [rad/s]."""
        assert self.frequency is not None
        drive = self.frequency.driver
        low = drive.low.strips.width if drive.low is not None else 0.0
        return np.concatenate([np.full(self.border, low), np.full(self.omega_wave.size, drive.wave.strips.width)])

    def moments(self, spectrum: Array, band: str, order: int = 0) -> Array:
        """∫ωⁿ S dω over a band (`wf`, `lf`, `total`) of spectra (…, W) on `omega` (R3)."""
        window = {"wf": slice(self.border, None), "lf": slice(0, self.border), "total": slice(None)}[band]
        return np.asarray((spectrum[..., window] * (self.omega**order * self.widths)[window]).sum(axis=-1))

    @cached_property
    def vessel_spectra(self) -> Array | None:
        """Spectra of the six motions over `omega`, (6, W)."""
        if self.frequency is None or self.frequency.wave.vessel is None or not self.is_random:
            return None
        low = self.frequency.low
        return self.spectrum(self.frequency.wave.vessel, low.vessel if low is not None else None)

    def tension_spectra(self, index: int) -> Array:
        """Spectra of tension of every element of a line over `omega`, (N, W) [N² s/rad]."""
        assert self.frequency is not None
        low = self.frequency.low
        return self.spectrum(self.frequency.wave.tension[index], low.tension[index] if low is not None else None)

    def end_spectra(self, index: int) -> Array:
        """Spectra of the forces at the ends of a line (rows END_FORCES) over `omega`, (4, W) [N² s/rad]."""
        assert self.frequency is not None
        low = self.frequency.low
        return self.spectrum(self.frequency.wave.ends[index], low.ends[index] if low is not None else None)

    def end_means(self, index: int) -> Array:
        """Static forces at the ends of a line (rows END_FORCES), (4,) [N]."""
        end_b, end_a = self.static.state.end_forces[index].reshape(2, 3)
        return np.array([np.linalg.norm(end_b), np.linalg.norm(end_a), end_b[2], end_a[2]])

    def moment_spectra(self, index: int) -> Array:
        """Spectra of bending moment in plane and out of plane, (2, N+1, W) [(N m)² s/rad]."""
        assert self.frequency is not None
        low = self.frequency.low
        return self.spectrum(self.frequency.wave.moment[index], low.moment[index] if low is not None else None)
