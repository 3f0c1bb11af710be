"""Airy kinematics: water velocity and acceleration per unit elevation amplitude (W2)-(W5)."""

from __future__ import annotations

import numpy as np

from .dispersion import wave_number

Array = np.ndarray


def direction_vector(direction: float) -> Array:
    """Unit vector, shape (2,), of the horizontal direction in which the wave travels [rad, ccw from +x]."""
    return np.array([np.cos(direction), np.sin(direction)])


def elevation(omega: Array, direction: float, points: Array, depth: float, gravity: float) -> Array:
    """Elevation at points per unit amplitude at (0, 0): e^{-i k.x} (W2).

    omega : (W,) [rad/s]; points : (P, >=2) [m]. Returns complex (W, P) [m/m], time factor e^{+i omega t}.
    """
    k = wave_number(np.atleast_1d(omega), depth, gravity)
    along = np.atleast_2d(points)[:, :2] @ direction_vector(direction)
    return np.exp(-1j * k[:, None] * along[None, :])


def velocity(omega: Array, direction: float, points: Array, depth: float, gravity: float) -> Array:
    """Water velocity at points per unit elevation amplitude at (0, 0) (W3, W4).

    omega : (W,) [rad/s]; direction the wave travels TO [rad]; points : (P, 3) [m], z up from the mean water level.
    Returns complex (W, P, 3) [m/s per m], time factor e^{+i omega t}: horizontal in phase with the elevation, vertical
    +i omega times it at z = 0. Zero above z = 0; below the seabed the value at the seabed.
    Written with decaying exponentials only, so that k d of 1e4 and an infinite depth are as exact as shallow water.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    points = np.atleast_2d(np.asarray(points, dtype=float))
    k = wave_number(omega, depth, gravity)
    horizontal, vertical = _profiles(omega, k, points[:, 2], depth, gravity)
    heading = direction_vector(direction)
    phase = np.exp(-1j * k[:, None] * (points[:, :2] @ heading)[None, :]) * (points[:, 2] <= 0.0)
    result = np.empty((omega.size, points.shape[0], 3), dtype=complex)
    result[..., 0] = heading[0] * horizontal * phase
    result[..., 1] = heading[1] * horizontal * phase
    result[..., 2] = 1j * vertical * phase
    return result


def acceleration(omega: Array, direction: float, points: Array, depth: float, gravity: float) -> Array:
    """Water acceleration at points, i omega times the velocity (W5): complex (W, P, 3) [m/s2 per m]."""
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    return 1j * omega[:, None, None] * velocity(omega, direction, points, depth, gravity)


def _profiles(omega: Array, k: Array, z: Array, depth: float, gravity: float) -> tuple[Array, Array]:
    """omega cosh k(z+d) / sinh kd and omega sinh k(z+d) / sinh kd, each (W, P), without overflow (W4)."""
    z = np.clip(z, -depth, 0.0)
    decay = np.exp(k[:, None] * z)
    if not np.isfinite(depth):
        return omega[:, None] * decay, omega[:, None] * decay
    below = -2.0 * k[:, None] * (z + depth)
    full = -np.expm1(-2.0 * k * depth)  # 1 - e^{-2kd}
    still = full == 0.0  # omega = 0: the shallow limit, sqrt(g/d)
    scale = np.where(still, 0.5 * np.sqrt(gravity / depth), omega / np.where(still, 1.0, full))[:, None]
    vertical = np.where(still, 0.0, omega / np.where(still, 1.0, full))[:, None]
    return scale * decay * (1.0 + np.exp(below)), vertical * decay * -np.expm1(below)
