"""Significant values and most probable maxima of Gaussian responses (docs/theory.md, R1-R4)."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def significant(sigma: Array) -> Array:
    """Significant amplitude 2σ (R1)."""
    return 2.0 * np.asarray(sigma)


def most_probable_maximum(sigma: Array, m2: Array, duration: float) -> Array:
    """σ √(2 ln N), N = duration / Tz zero crossings, Tz = 2π √(m0/m2) (R2); 0 where nothing moves.

    sigma : standard deviation; m2 : second spectral moment; duration [s].
    """
    sigma, m2 = np.asarray(sigma, dtype=float), np.asarray(m2, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossings = duration / (2 * np.pi) * np.sqrt(m2) / sigma
    factor = np.sqrt(2.0 * np.log(np.maximum(np.nan_to_num(crossings, nan=1.0), np.e**0.5)))
    return np.where(sigma > 0, sigma * factor, 0.0)


def combined_maximum(wf_sigma: Array, wf_max: Array, lf_sigma: Array, lf_max: Array) -> Array:
    """The larger of WF maximum with LF significant and LF maximum with WF significant (R4, as DNV-OS-E301)."""
    return np.maximum(wf_max + significant(lf_sigma), lf_max + significant(wf_sigma))
