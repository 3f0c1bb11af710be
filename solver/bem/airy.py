"""Airy waves on the hull: potential and velocity, time factor e^{-i omega t} (that of the boundary elements)."""

from __future__ import annotations

import math

import numpy as np

from ..waves.dispersion import wave_number

Array = np.ndarray


def profile(z: Array, k: float, depth: float) -> tuple[Array, Array]:
    """cosh k(z + h) / cosh kh and sinh k(z + h) / cosh kh; both e^{kz} in deep water."""
    if k * depth > 20:
        return np.exp(k * z), np.exp(k * z)
    up, down = np.exp(k * z), np.exp(-k * (z + 2 * depth))
    share = 1 + math.exp(-2 * k * depth)
    return (up + down) / share, (up - down) / share


def airy(points: Array, heading: float, omega: float, gravity: float, depth: float) -> tuple[Array, Array]:
    """Potential (N,) and velocity (N, 3) of a wave of unit amplitude, its crest at the origin at t = 0 (H1).

    φ = -(i g / ω) cosh k(z + h) / cosh kh · e^{i k (x cos β + y sin β)}.
    """
    k = float(wave_number(omega, depth, gravity))
    c, s = profile(points[:, 2], k, depth)
    run = np.exp(1j * k * (points[:, 0] * math.cos(heading) + points[:, 1] * math.sin(heading)))
    phi = -1j * gravity / omega * c * run
    velocity = (
        gravity * k / omega * run[:, None] * np.stack([math.cos(heading) * c, math.sin(heading) * c, -1j * s], axis=1)
    )
    return phi, velocity
