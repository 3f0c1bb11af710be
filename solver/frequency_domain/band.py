"""One band of frequencies: strips, and the responses that are summed over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..case.analysis import LowBand, WaveBand
from ..kernels.band import LANES

Array = np.ndarray


@dataclass(frozen=True)
class Strips:
    """Frequencies padded to a multiple of LANES. omega (W,) [rad/s]; `count` of them are real, the rest repeat the last.

    widths : (count,) [rad/s], so that a sum over strips is an integral; below : strips up to the border of lf and wf.
    """

    omega: Array
    widths: Array
    count: int
    below: int

    def pad(self, values: Array) -> Array:
        """Values (…, count) padded with zeros to (…, W)."""
        gap = self.omega.size - self.count
        return np.concatenate([values, np.zeros((*values.shape[:-1], gap))], axis=-1) if gap else values


def _padded(omega: Array, widths: Array, below: int) -> Strips:
    gap = -omega.size % LANES
    return Strips(np.concatenate([omega, np.full(gap, omega[-1])]), widths, omega.size, below)


def _middles(start: float, end: float, step: float) -> tuple[Array, Array]:
    """Midpoints and widths of equal strips between two frequencies, as near to `step` as a whole number allows."""
    count = max(round((end - start) / step), 1)
    width = (end - start) / count
    return start + width * (np.arange(count) + 0.5), np.full(count, width)


def wave_strips(band: WaveBand, border: float) -> Strips:
    """Midpoints of equal strips from `from` to `to`; a border [rad/s] inside the band is an edge of two strips (F16)."""
    if not band.from_ * (1 + 1e-9) < border < band.to * (1 - 1e-9):
        omega, widths = _middles(band.from_, band.to, band.step)
        return _padded(omega, widths, omega.size if border >= band.to * (1 - 1e-9) else 0)
    parts = [_middles(band.from_, border, band.step), _middles(border, band.to, band.step)]
    omega, widths = (np.concatenate(column) for column in zip(*parts, strict=True))
    return _padded(omega, widths, parts[0][0].size)


def difference_strips(band: LowBand, to: float, step: float) -> Strips:
    """k·step, k = 1, 2, … up to the border `band.to`, then midpoints of wider strips from the border up to `to` (F16)."""
    count = max(int(band.to / band.step + 1e-9), 1)
    omega, widths = band.step * np.arange(1, count + 1), np.full(count, band.step)
    if to > band.to * (1 + 1e-9):
        widths[-1] = band.to - (count - 0.5) * band.step
        above = _middles(band.to, to, step)
        omega, widths = np.concatenate([omega, above[0]]), np.concatenate([widths, above[1]])
    return _padded(omega, widths, count)


def single(omega: float) -> Strips:
    """One frequency."""
    return _padded(np.array([omega]), np.ones(1), 0)
