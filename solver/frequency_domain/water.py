"""Wave kinematics at the nodes of a line, laid out for the kernels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class WaterMotion:
    """Water velocity at the nodes per unit of each load, real and imaginary, (R, N+1, 3, W)."""

    real: Array
    imag: Array


def water_motion(velocities: list[Callable[[Array], Array]], x: Array, width: int) -> WaterMotion:
    """Evaluate `velocities` (each nodes (N+1, 3) -> complex (W, N+1, 3)) at a shape, frequencies last."""
    real = np.zeros((len(velocities), x.shape[0], 3, width))
    imag = np.zeros_like(real)
    for r, velocity in enumerate(velocities):
        u = np.moveaxis(velocity(x), 0, -1)
        real[r], imag[r] = u.real, u.imag
    return WaterMotion(real, imag)
