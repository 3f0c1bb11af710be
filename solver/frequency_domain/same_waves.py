"""The linearised system under the very waves of time-domain seeds: both domains without sampling noise (F18)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.band import LANES
from ..model.build import Model
from .band import Strips
from .drivers import water_of
from .response import Loads, respond
from .solve import FrequencyResult
from .water import water_motion

Array = np.ndarray


@dataclass(frozen=True)
class SeedWaves:
    """Components of seeds on one grid: amplitudes (seeds, systems, N) at omega (N,), and G_k (seeds, K, 6), k = 1 … K.

    border : of lf and wf [rad/s].
    """

    omega: Array
    step: float
    amplitudes: Array
    differences: Array
    border: float


def same_waves(model: Model, result: FrequencyResult, waves: SeedWaves) -> dict[str, Array]:
    """Vessel σ pooled over the seeds, keys wf and lf, each (6,) [m, rad]: parted by frequency, as in the time domain (F18)."""
    transfer = _transfer(model, result, waves.omega, _unit(model, result, waves.omega), True)
    motions = np.einsum("rin,srn->sin", transfer, waves.amplitudes)
    inside = waves.omega < waves.border * (1 - 1e-9)
    variance = {"wf": _pooled(motions[..., ~inside]), "lf": _pooled(motions[..., inside])}
    if result.driver.low is not None and waves.differences.shape[1]:
        omega = waves.step * np.arange(1, waves.differences.shape[1] + 1)
        forces = np.repeat(np.eye(6, dtype=complex)[:, :, None], omega.size, axis=2)
        H = _transfer(model, result, omega, forces, False)  # (6 unit loads, 6 motions, K)
        slow = np.einsum("jik,skj->sik", H, 2.0 * waves.differences)
        inside = omega <= waves.border * (1 + 1e-9)
        variance["lf"] = variance["lf"] + _pooled(slow[..., inside])
        variance["wf"] = variance["wf"] + _pooled(slow[..., ~inside])
    return {band: np.sqrt(value) for band, value in variance.items()}


def _pooled(motions: Array) -> Array:
    """Variance (6,) of complex amplitudes (seeds, 6, N), in the mean of the seeds."""
    return np.asarray(0.5 * (np.abs(motions) ** 2).sum(axis=2).mean(axis=0))


def _unit(model: Model, result: FrequencyResult, omega: Array) -> Array:
    """First-order load per unit elevation of each wave system, complex (R, 6, N)."""
    assert model.vessel is not None
    yaw = float(result.static.position[5])
    return np.stack([model.vessel.excitation(omega, heading, yaw).T for _, heading in model.wave_systems])


def _transfer(model: Model, result: FrequencyResult, omega: Array, vessel: Array, waves: bool) -> Array:
    """Motion of the vessel per unit of each load (R, 6, N); `waves`: the loads are wave systems, which act on lines too."""
    gap = -omega.size % LANES
    padded = np.concatenate([omega, np.full(gap, omega[-1])])
    strips = Strips(padded, np.ones(omega.size), omega.size, 0)
    loads = np.ascontiguousarray(np.concatenate([vessel, np.repeat(vessel[..., -1:], gap, axis=-1)], axis=-1))
    water = [
        water_of(model, g, padded, True) if waves else water_motion([], g.x, padded.size) for g in result.geometries
    ]
    drive = Loads(loads, water, [None] * len(water), strips.pad(np.ones((vessel.shape[0], omega.size))))
    own = result.driver.own(model, result.static, padded, result.linear.vessel)
    response = respond(result.geometries, result.linear.damping, result.couplings, own, strips, drive)
    assert response.vessel is not None
    return response.vessel[..., : omega.size]
