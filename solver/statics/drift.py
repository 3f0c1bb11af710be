"""A vessel under the mean drift force that its yaw causes (docs/theory.md, S11)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ..model.body import VesselBody

Array = np.ndarray
TURN = 1e-5  # rad: difference that gives the slope of the drift force


@dataclass(frozen=True)
class DriftingBody:
    """A vessel whose constant loads include the mean drift force at its present yaw.

    still : the vessel without drift; force : mean drift force at a yaw [rad] -> (6,) [N, N m], frame axes.
    """

    still: VesselBody
    force: Callable[[float], Array]
    _known: dict[float, Array] = field(default_factory=dict)

    def drift(self, yaw: float) -> Array:
        """Mean drift force at a yaw (6,) [N, N m]."""
        if yaw not in self._known:
            self._known[yaw] = self.force(yaw)
        return self._known[yaw]

    def load(self, position: Array) -> Array:
        """Loads without the lines (6,) [N, N m] (S11, S12)."""
        return self.still.load(position) + self.drift(float(position[5]))

    def stiffness(self, position: Array) -> Array:
        """-∂load/∂position (6, 6): the drift force adds its slope over yaw (S11)."""
        yaw = float(position[5])
        K = self.still.stiffness(position).copy()
        K[:, 5] -= (self.drift(yaw + TURN) - self.drift(yaw)) / TURN
        return K

    def arm_matrix(self, position: Array, arm: Array) -> Array:
        return self.still.arm_matrix(position, arm)

    def fairlead(self, position: Array, arm: Array) -> Array:
        return self.still.fairlead(position, arm)

    def geometric(self, position: Array, arm: Array, force: Array) -> Array:
        return self.still.geometric(position, arm, force)

    def moved(self, position: Array, step: Array) -> Array:
        return self.still.moved(position, step)
