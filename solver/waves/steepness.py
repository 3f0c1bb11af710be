"""Waves steeper than they can be, as warnings (docs/theory-vessel.md, W10, W11)."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..case.environment import Environment, RegularWave, Tabulated
from .dispersion import wave_number
from .spectra import Sea, significant_height

SHORT, STEEP = 8.0, 1.0 / 15.0  # s, limit of the average steepness at and below that peak period
LONG, FLAT = 15.0, 1.0 / 25.0  # s, at and above it
BREAKING = 0.142  # of a regular wave in deep water


def steepness_limit(peak_period: float) -> float:
    """Largest average steepness S_p of a random sea (W10)."""
    return float(np.interp(peak_period, (SHORT, LONG), (STEEP, FLAT)))


def breaking_height(period: float, depth: float, gravity: float) -> float:
    """Height at which a regular wave breaks (W11) [m]."""
    k = float(wave_number(2.0 * math.pi / period, depth, gravity))
    return BREAKING * math.tanh(k * depth) * 2.0 * math.pi / k


def steepness_warnings(environment: Environment) -> Iterator[str]:
    """What to say of each wave system that is too steep, with the values and the limits."""
    gravity, depth = float(environment.water.gravity), float(environment.depth)
    for index, sea in enumerate(environment.seastates):
        where = f"environment.seastates.{index}"
        if isinstance(sea, RegularWave):
            limit = breaking_height(float(sea.period), depth, gravity)
            if sea.height > limit:
                yield (
                    f"{where}: a regular wave of {sea.height:.3g} m and {sea.period:.3g} s in a depth of {depth:.4g} m is "
                    f"higher than a wave can be before it breaks, {limit:.3g} m; linear waves are computed all the same: "
                    "use a lower or a longer wave"
                )
            continue
        hs, tp = _height_and_period(sea)
        steepness, most = 2.0 * math.pi * hs / (gravity * tp**2), steepness_limit(tp)
        if steepness > most:
            yield (
                f"{where}: Hs {hs:.3g} m with Tp {tp:.3g} s has a steepness 2πHs/(gTp²) of {steepness:.3g}, more than seas "
                f"have (limit {most:.3g}, which is Hs {most * gravity * tp**2 / (2 * math.pi):.3g} m); use a lower Hs or a "
                "longer Tp"
            )


def _height_and_period(sea: Sea) -> tuple[float, float]:
    """Hs [m] and Tp [s]; of a table, those of its own moments and peak."""
    if isinstance(sea, Tabulated):
        peak = float(sea.frequencies[int(np.argmax(sea.densities))])
        return significant_height(sea), 2.0 * math.pi / peak
    return float(sea.hs), sea.peak_period
