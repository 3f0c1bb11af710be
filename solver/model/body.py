"""The vessel as statics and the linearised analyses see it: loads, stiffness and fairlead kinematics."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from ..vessel.rigid import turned

Array = np.ndarray


def cross_matrix(r: Array) -> Array:
    """The matrix of r × of vectors (..., 3): (..., 3, 3)."""
    r = np.asarray(r, dtype=float)
    out = np.zeros((*r.shape, 3))
    out[..., 2, 1], out[..., 0, 2], out[..., 1, 0] = r[..., 0], r[..., 1], r[..., 2]
    return out - out.swapaxes(-1, -2)


def rotation(vector: Array) -> Array:
    """Rotation matrix of a rotation vector [rad] (Rodrigues); read only."""
    return _rotation(float(vector[0]), float(vector[1]), float(vector[2]))


@lru_cache(maxsize=64)
def _rotation(x: float, y: float, z: float) -> Array:
    angle = math.hypot(x, y, z)
    S = cross_matrix(np.array([x, y, z]))
    if angle < 1e-8:
        R = np.eye(3) + S + 0.5 * S @ S
    else:
        R = np.eye(3) + math.sin(angle) / angle * S + (1 - math.cos(angle)) / angle**2 * S @ S
    R.setflags(write=False)
    return R


def rotation_vector(R: Array) -> Array:
    """Rotation vector [rad] of a rotation matrix, for angles below π."""
    axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = float(np.linalg.norm(axis))
    angle = math.atan2(sine, 0.5 * (float(np.trace(R)) - 1.0))
    return axis * (angle / sine if sine > 1e-12 else 1.0)


@dataclass(frozen=True)
class VesselBody:
    """Loads on the vessel without its lines, and where its fairleads are (docs/theory.md, S7-S8, S12).

    hydrostatic : K_V about the CG, body axes (6, 6); extra : equivalent stiffness of lines not modelled (6, 6);
    constant : steady load, frame axes (6,); finite : whether fairleads turn with the vessel.
    """

    cg: Array
    hydrostatic: Array
    extra: Array
    finite: bool
    constant: Array = field(default_factory=lambda: np.zeros(6))

    def with_constant(self, load: Array) -> VesselBody:
        return replace(self, constant=load)

    def stiffness(self, position: Array) -> Array:
        """K_V turned with the static yaw (V12), and the extra stiffness (6, 6)."""
        return turned(self.hydrostatic + self.extra, float(position[5]))

    def load(self, position: Array) -> Array:
        """Constant loads less K_V times the displacement (6,) [N, N m] (S12)."""
        return self.constant - self.stiffness(position) @ position

    def turned_arm(self, position: Array, arm: Array) -> Array:
        """Arms from the CG to fairleads (..., 3), in frame axes (..., 3) [m]."""
        return arm @ rotation(position[3:]).T if self.finite else arm

    def fairlead(self, position: Array, arm: Array) -> Array:
        """Fairleads of arms (..., 3) in the solver's frame (..., 3) [m] (S7)."""
        if self.finite:
            return self.cg + position[:3] + self.turned_arm(position, arm)
        return self.cg + arm + self.arm_matrix(position, arm) @ position

    def arm_matrix(self, position: Array, arm: Array) -> Array:
        """A of P = P0 + A s for arms (..., 3): (..., 3, 6) (S7)."""
        out = np.zeros((*arm.shape, 6))
        out[..., :3] = np.eye(3)
        out[..., 3:] = -cross_matrix(self.turned_arm(position, arm))
        return out

    def geometric(self, position: Array, arm: Array, force: Array) -> Array:
        """K_g = (r·f) I - r fᵀ in the rotations, for forces f (..., 3) of lines on the vessel: (..., 6, 6) (S8)."""
        out = np.zeros((*arm.shape[:-1], 6, 6))
        if self.finite:
            r = self.turned_arm(position, arm)
            product = np.sum(r * force, axis=-1)[..., None, None]
            out[..., 3:, 3:] = product * np.eye(3) - r[..., :, None] * force[..., None, :]
        return out

    def moved(self, position: Array, step: Array) -> Array:
        """Position after a step whose rotation is about the present position (S7)."""
        new = position + step
        if self.finite:
            new[3:] = rotation_vector(rotation(step[3:]) @ rotation(position[3:]))
        return new
