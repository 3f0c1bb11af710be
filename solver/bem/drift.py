"""Waves that a body sends out, and the mean drift force that follows from their momentum (docs/theory-hydrodynamics.md)."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import jv

from .airy import profile

Array = np.ndarray


def highest_order(reach: float, wave_number: float) -> int:
    """Order of the Kochin function's Fourier series beyond which it vanishes, for panels within `reach` [m] of the axis."""
    x = wave_number * reach
    return math.ceil(x + 6.0 * x ** (1 / 3) + 8)


def kochin(points: Array, strength: Array, k: float, depth: float, order: int) -> Array:
    """Fourier coefficients h_m, m = -order … order, of H(θ) = Σ h_m e^{imθ}: complex (2 · order + 1, R) (H7).

    points : centres of all panels (N, 3); strength : source strength times panel area (N, R).
    """
    radius, angle = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    weighted = strength * profile(points[:, 2], k, depth)[0][:, None] / (4 * math.pi)
    m = np.arange(-order, order + 1)
    out = np.empty((m.size, strength.shape[1]), complex)
    for row, number in enumerate(m):
        out[row] = ((-1j) ** number * jv(number, k * radius) * np.exp(-1j * number * angle)) @ weighted
    return out


def mean_drift(
    h: Array, headings: Array, omega: float, k: float, depth: float, density: float, gravity: float
) -> Array:
    """Surge, sway and yaw (about the vertical through the origin) per amplitude squared, (H, 3) [N/m2, N m/m2] (H8).

    h : Kochin coefficients of all waves sent out, a column per heading (2 · order + 1, H).
    """
    order = (h.shape[0] - 1) // 2
    m = np.arange(-order, order + 1)[:, None]
    forward, scattered = _scales(omega, k, depth, density, gravity)
    here = np.exp(1j * m * headings[None, :])
    value, slope = (h * here).sum(axis=0), (1j * m * h * here).sum(axis=0)
    ahead = 2 * math.pi * (h[:-1] * np.conj(h[1:])).sum(axis=0)  # ∫ |H|² e^{iθ} dθ
    spin = 2 * math.pi * (m * np.abs(h) ** 2).sum(axis=0)
    surge = -forward * np.cos(headings) * value.real - scattered * ahead.real
    sway = -forward * np.sin(headings) * value.real - scattered * ahead.imag
    yaw = -forward / k * slope.imag - scattered / k * spin
    return np.stack([surge, sway, yaw], axis=1)


def absorbed(
    h: Array, headings: Array, omega: float, k: float, depth: float, density: float, gravity: float
) -> tuple[Array, Array]:
    """Power taken from the waves less that scattered, and that scattered, over the phase speed: (H,) each [N/m2] (H9).

    The first is zero where nothing damps.
    """
    order = (h.shape[0] - 1) // 2
    m = np.arange(-order, order + 1)[:, None]
    forward, scattered = _scales(omega, k, depth, density, gravity)
    value = (h * np.exp(1j * m * headings[None, :])).sum(axis=0)
    sent = scattered * 2 * math.pi * (np.abs(h) ** 2).sum(axis=0)
    return -forward * value.real - sent, sent


def _scales(omega: float, k: float, depth: float, density: float, gravity: float) -> tuple[float, float]:
    """Factors of the incident wave's work on the body and of the power sent out, both over the phase speed (H8).

    2πρgk/ω and 2πρkD, D = k² / ((k² - K²) h + K), K = ω²/g; in deep water 2πρω and 2πρk².
    """
    deep = omega**2 / gravity
    sent = k if math.isinf(depth) else k**2 / ((k**2 - deep**2) * depth + deep)
    return 2 * math.pi * density * gravity * k / omega, 2 * math.pi * density * k * sent
