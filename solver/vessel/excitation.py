"""First-order wave force on the vessel at its static yaw (V13)."""

from __future__ import annotations

import numpy as np

from .data import HydrodynamicData
from .rigid import turned_force

Array = np.ndarray


def excitation(data: HydrodynamicData, omega: Array, direction: float, yaw: float = 0.0) -> Array:
    """Force per unit elevation amplitude at (0, 0): complex (W, 6) [N/m, N m/m], earth axes, e^{+i omega t} (V13).

    data : about the CG (rigid.about_cg); omega : (W,) [rad/s]; direction the wave travels TO and static yaw of the
    vessel, earth axes [rad]. The data are taken at direction - yaw and turned by yaw. Raises DataError outside them.
    """
    return turned_force(data.excitation_at(omega, direction - yaw), yaw)
