"""One band of frequencies: strips, and the responses that are summed over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..case.analysis import LowBand, WaveBand
from ..kernels.band import LANES

Array = np.ndarray


@dataclass(frozen=True)
class Strips:
    """Frequencies padded to a multiple of LANES. omega (W,) [rad/s]; `count` of them are real, the rest repeat the last."""

    omega: Array
    width: float
    count: int

    def pad(self, values: Array) -> Array:
        """Values (…, count) padded with zeros to (…, W)."""
        gap = self.omega.size - self.count
        return np.concatenate([values, np.zeros((*values.shape[:-1], gap))], axis=-1) if gap else values


def _padded(omega: Array, width: float) -> Strips:
    gap = -omega.size % LANES
    return Strips(np.concatenate([omega, np.full(gap, omega[-1])]), width, omega.size)


def wave_strips(band: WaveBand) -> Strips:
    """Midpoints of equal strips from `from` to `to` (F16)."""
    count = max(round((band.to - band.from_) / band.step), 1)
    width = (band.to - band.from_) / count
    return _padded(band.from_ + width * (np.arange(count) + 0.5), width)


def low_strips(band: LowBand) -> Strips:
    """k·step, k = 1, 2, … up to `to` (F16)."""
    count = max(int(band.to / band.step + 1e-9), 1)
    return _padded(band.step * np.arange(1, count + 1), band.step)


def single(omega: float) -> Strips:
    """One frequency."""
    return _padded(np.array([omega]), 1.0)
