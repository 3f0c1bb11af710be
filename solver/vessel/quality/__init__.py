"""Whether hydrodynamic data can be right: checks that say threshold, value and remedy (docs/hydrodynamics.md)."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import replace

import numpy as np

from ..data import HydrodynamicData
from .forces import force_checks, long_waves, phase
from .judgement import Check
from .radiation import causality, radiation_checks
from .second import drift_checks

KEEP = 16
_known: OrderedDict[tuple[str, str, float, float], tuple[Check, ...]] = OrderedDict()

__all__ = ["Check", "quality", "quality_warnings"]


def quality(data: HydrodynamicData, low: float = 0.0, high: float = math.inf) -> tuple[Check, ...]:
    """Every check of data about any point, in a fixed order; the last answers are kept by content hash.

    low, high : the band of the waves [rad/s]; what is outside of it, but for one frequency on each side, is not judged.
    """
    key = (data.content_hash, str(data.reference_point), low, high)
    found = _known.get(key)
    if found is None:
        inside = within(data, low, high)
        found = (
            *radiation_checks(inside),
            causality(data, high),
            *force_checks(inside),
            long_waves(data),
            phase(data),
            *drift_checks(data),
        )
        if data.content_hash:
            _known[key] = found
            while len(_known) > KEEP:
                _known.popitem(last=False)
    return found


def quality_warnings(data: HydrodynamicData, low: float, high: float) -> tuple[str, ...]:
    """The sentences of the checks that warn, of data and waves of low to high [rad/s]."""
    return tuple(check.message for check in quality(data, low, high) if check.state == "warning")


def within(data: HydrodynamicData, low: float, high: float) -> HydrodynamicData:
    """The frequencies of low to high and one more on each side, as far as there are any."""
    first = max(int(np.searchsorted(data.omega, low, side="right")) - 1, 0)
    last = min(int(np.searchsorted(data.omega, high)) + 1, data.omega.size)
    if last - first == data.omega.size or last <= first:
        return data
    part = slice(first, last)
    return replace(
        data,
        omega=data.omega[part],
        added_mass=data.added_mass[part],
        damping=data.damping[part],
        excitation=data.excitation[part],
        motions=None if data.motions is None else data.motions[part],
        mean_drift_omega=data.drift_omega,
    )
