"""Coefficients of the implicit scheme, as data above the march (docs/theory.md, T1-T3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Scheme:
    """An implicit one-step scheme in the displacement Δ over τ = collocation × h.

    velocity : factors of Δ/τ, v, a·τ in the velocity at t + τ; acceleration : of Δ/τ², v/τ, a.
    The step ends with the acceleration that is linear in time from t through t + τ.
    """

    name: str
    collocation: float
    velocity: tuple[float, float, float]
    acceleration: tuple[float, float, float]

    def table(self) -> Array:
        """One flat array for the kernel: collocation, velocity, acceleration."""
        return np.array([self.collocation, *self.velocity, *self.acceleration])


#: Wilson-θ: linear acceleration over τ = θh; unconditionally stable for θ ≥ 1.37
WILSON_THETA = Scheme("wilson-theta", 1.4, (3.0, -2.0, -0.5), (6.0, -6.0, -2.0))

SCHEMES = {WILSON_THETA.name: WILSON_THETA}
