"""What counts as zero among coefficients of different units: a share of the largest, with a length between the kinds."""

from __future__ import annotations

import math

import numpy as np

from .data import HydrodynamicData

Array = np.ndarray
FLOOR = 1e-6  # of the largest of its kind: what symmetry or rounding leaves of a coefficient that vanishes


def arm(data: HydrodynamicData) -> float:
    """The length that relates moments to forces [m]: the root of the largest rotational over translational added mass."""
    peak = np.abs(np.diagonal(data.added_mass, axis1=1, axis2=2)).max(axis=0)
    if peak[:3].max() <= 0 or peak[3:].max() <= 0:
        return 1.0
    return math.sqrt(float(peak[3:].max() / peak[:3].max()))


def floors(peak: Array, ratio: float) -> Array:
    """The least size of each degree of freedom that is judged, (6,), from the peaks of all six (6,) (Q0).

    ratio : of a moment to a force of the same importance: `arm` for forces, its square for matrices.
    """
    size = max(float(peak[:3].max()), float(peak[3:].max()) / ratio)
    return FLOOR * size * np.array([1.0, 1.0, 1.0, ratio, ratio, ratio])
