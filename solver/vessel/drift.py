"""Mean and slowly varying wave drift: T2, the spectrum of the force, and its collection by difference (V21)-(V28)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from ..outcome import DataError
from .data import HydrodynamicData
from .rigid import turned_force

Array = np.ndarray
#: T2(omega_m, omega_n, direction_m, direction_n): frequencies of one shape (...), earth directions -> (..., 6)
T2 = Callable[[Array, Array, float, float], Array]
#: one wave system: its spectrum S(omega) [m2 s/rad] as a function, and the direction it travels TO [rad]
System = tuple[Callable[[Array], Array], float]

STEP = 0.0025  # rad/s: widest panel of the integrals over wave frequency
ROUND_OFF = 1e-9


@dataclass(frozen=True)
class Drift:
    """T2 of a vessel in earth axes at its static yaw, from data about the CG (V21)-(V24).

    kind : `none`; `newman`, half the sum of the diagonal terms; `newman-geometric`, their geometric mean with their
    sign, zero where the signs differ; `qtf`, the full table. Waves of two directions: the table of those headings where
    the data hold it, else half the sum of the terms of each direction. Hermitian: T2(m, n) = T2(n, m)*.
    far : headings outside the data are the nearest of the data at any distance, for statics (V29).
    """

    data: HydrodynamicData | None
    kind: Literal["none", "newman", "newman-geometric", "qtf"]
    yaw: float = 0.0
    far: bool = False

    def __post_init__(self) -> None:
        if self.kind == "none":
            return
        if self.data is None:
            raise DataError("wave drift needs hydrodynamic data; give vessel.hydrodynamics.data, or drift: none")
        if self.kind == "qtf" and self.data.qtf is None:
            raise DataError(f"{self.data.name}: the file holds no full QTF; use drift: newman")
        if self.kind != "qtf" and self.data.mean_drift is None:
            self.data.mean_drift_at(np.zeros(1), 0.0)  # raises, with the remedy

    def __call__(self, omega_m: Array, omega_n: Array, direction_m: float, direction_n: float) -> Array:
        """T2 [N/m2, N m/m2], (..., 6), real unless `qtf`. Raises DataError outside the data."""
        if omega_n is not omega_m:
            omega_m, omega_n = np.broadcast_arrays(np.asarray(omega_m, float), np.asarray(omega_n, float))
        if self.kind == "none" or self.data is None:
            return np.zeros((*omega_m.shape, 6))
        if self.kind == "qtf":
            return self._of_pairs(
                lambda qtf, *headings: qtf.at(omega_m, omega_n, *headings, far=self.far), direction_m, direction_n
            )
        first = self.data.mean_drift_at(omega_m, direction_m - self.yaw, self.far)
        if omega_n is omega_m and direction_n == direction_m:
            return turned_force(first, self.yaw)
        second = self.data.mean_drift_at(omega_n, direction_n - self.yaw, self.far)
        if self.kind == "newman":
            return turned_force(0.5 * (first + second), self.yaw)
        product = first * second
        return turned_force(np.sign(first) * np.sqrt(np.maximum(product, 0.0)), self.yaw)

    def nodal(self, direction_m: float, direction_n: float) -> Array:
        """T2 of `qtf` at the nodes of its hats, earth axes, complex (N+1, N+1, 6); unknown pairs are zero (V23, V24)."""
        return self._of_pairs(lambda qtf, *headings: qtf.nodal(*headings), direction_m, direction_n)

    def _of_pairs(self, find: Callable[..., Array], direction_m: float, direction_n: float) -> Array:
        """What `find(qtf, headings…)` gives of two directions, in earth axes (V24)."""
        assert self.data is not None
        qtf = self.data.qtf
        assert qtf is not None
        heading_m, heading_n = direction_m - self.yaw, direction_n - self.yaw
        if direction_n == direction_m or qtf.knows(heading_m, heading_n):
            values = find(qtf, heading_m, heading_n)
        else:
            values = 0.5 * (find(qtf, heading_m) + find(qtf, heading_n))
        return turned_force(values, self.yaw)

    def warnings(self, directions: Sequence[float]) -> tuple[str, ...]:
        """What to say of wave systems that travel in these directions [rad] (V24)."""
        apart = np.angle(np.exp(1j * (np.array(directions) - directions[0]))) if len(directions) else np.zeros(1)
        if self.kind == "none" or np.abs(apart).max() < 1e-6:
            return ()
        qtf = self.data.qtf if self.data is not None and self.kind == "qtf" else None
        pairs = [(a - self.yaw, b - self.yaw) for a in directions for b in directions if a != b]
        if qtf is not None and all(qtf.knows(a, b) for a, b in pairs):
            return ()
        return (
            "waves of different directions: their common slow drift is taken as half the sum of each direction's T2, "
            "because the data hold none for pairs of directions",
        )


def mean_drift_force(systems: Sequence[System], t2: T2, low: float, high: float) -> Array:
    """Mean force of a random sea, 2 Σ ∫ T2(ω, ω) S dω over low..high [rad/s] and systems, (6,) [N, N m] (V25)."""
    omega, step = _panels(low, high)
    force = np.zeros(6)
    for spectrum, direction in systems:
        force += 2.0 * step * (spectrum(omega) @ t2(omega, omega, direction, direction).real)
    return force


def mean_drift_regular(waves: Sequence[tuple[float, complex, float]], t2: T2) -> Array:
    """Mean force of regular waves (frequency [rad/s], complex amplitude [m], direction [rad]), (6,): T2(ω, ω) a² each.

    Waves of one frequency interfere: Re Σ Σ A_m A_n* T2 over the pairs of equal frequency (V25).
    """
    force = np.zeros(6)
    for omega_m, amplitude_m, direction_m in waves:
        for omega_n, amplitude_n, direction_n in waves:
            if abs(omega_m - omega_n) <= ROUND_OFF * omega_m:
                value = t2(np.array(omega_m), np.array(omega_n), direction_m, direction_n)
                force += (amplitude_m * np.conj(amplitude_n) * value).real
    return force


def drift_spectrum(
    omega: Array, systems: Sequence[System], t2: T2, low: float, high: float, step: float = STEP
) -> Array:
    """One-sided cross-spectral matrix of the slow drift force at omega (K,) [rad/s]: complex (K, 6, 6) (V26).

    S_FF(ω) = 8 Σ_ab ∫ T2(ω+μ, μ) T2(ω+μ, μ)ᴴ S_a(ω+μ) S_b(μ) dμ over all pairs of systems, both frequencies within
    low..high [rad/s], the band of the wave components; S_FF = E[F F ᴴ] of the force of e^{+iωt}. The spectra and T2 are
    evaluated as functions, by the midpoint rule in panels of at most `step`, whatever the strips of the analysis.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    count = max(int(np.ceil((high - low) / step)), 1)
    span = np.maximum(high - low - omega, 0.0)
    width = span / count
    mu = low + (np.arange(count) + 0.5)[None, :] * width[:, None]
    upper = np.minimum(mu + omega[:, None], high)
    result = np.zeros((omega.size, 6, 6), dtype=complex)
    at_upper = [spectrum(upper) for spectrum, _ in systems]
    at_mu = [spectrum(mu) for spectrum, _ in systems]
    for a, (_, direction_a) in enumerate(systems):
        for b, (_, direction_b) in enumerate(systems):
            weight = 8.0 * width[:, None] * at_upper[a] * at_mu[b]
            values = t2(upper, mu, direction_a, direction_b)
            active = np.flatnonzero(np.any(values != 0.0, axis=(0, 1)))
            part = np.sqrt(weight)[..., None] * values[..., active]
            found = part.transpose(0, 2, 1) @ part.conj()
            result[np.ix_(np.arange(omega.size), active, active)] += found
    return result


def psd_factor(matrix: Array, tolerance: float = 1e-8) -> Array:
    """C (K, 6, r) with C Cᴴ = matrix (K, 6, 6), Hermitian and positive semi-definite; r the largest rank (V27).

    Scaled by its diagonal first, so that newtons and newton-metres weigh alike; negative eigenvalues down to
    -tolerance of the largest are round-off and clipped. Raises ValueError below that.
    """
    size = np.sqrt(np.maximum(np.diagonal(matrix, axis1=1, axis2=2).real.max(axis=0, initial=0.0), 0.0))
    scale = np.where(size > 0, size, 1.0)
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    largest = float(values.max(initial=0.0))
    if values.size and float(values.min()) < -tolerance * max(largest, 1e-300):
        raise ValueError(f"not positive semi-definite: eigenvalues from {values.min():.3g} to {largest:.3g}")
    kept = np.any(values > tolerance * 1e-4 * largest, axis=0) if largest > 0 else np.zeros(6, bool)
    factor = vectors[..., kept] * np.sqrt(np.maximum(values[:, None, kept], 0.0))
    return np.asarray(scale[:, None] * factor)


def difference_table(omega: Array, t2: T2, direction_m: float, direction_n: float, last: int) -> Array:
    """T2(omega[n + k], omega[n]) on an even grid omega (N,), k = 0 … last: (last + 1, N, 6); zero where n + k >= N."""
    count = omega.size
    last = min(last, count - 1)
    index = np.arange(count)[None, :] + np.arange(last + 1)[:, None]
    inside = index < count
    values = t2(omega[np.minimum(index, count - 1)], np.broadcast_to(omega, index.shape), direction_m, direction_n)
    return np.asarray(values * inside[..., None])


def collect(table: Array, upper: Array, lower: Array | None = None) -> Array:
    """G_k = Σ_n T2(n+k, n) A_{n+k} B_n* from `difference_table`: complex (K, 6) [N, N m] (V28).

    upper, lower : complex amplitudes (N,) of the components m = n + k and n [m]; one array for a single system. The
    force is F2(t) = Re G_0 + 2 Re Σ_{k>=1} G_k e^{i k dω t}.
    """
    lower = upper if lower is None else lower
    result = np.empty((table.shape[0], 6), dtype=complex)
    for k in range(table.shape[0]):
        result[k] = (upper[k:] * np.conj(lower[: lower.size - k])) @ table[k, : lower.size - k]
    return result


def collect_pairs(hats: Array, nodal: Array, upper: Array, lower: Array, last: int) -> Array:
    """G_k, k = 0 … last, of a T2 that is bilinear between nodes, by products in time: complex (last + 1, 6) (V28).

    hats : (N, M) weights of the nodes at the components; nodal : T2 at the nodes (M, M, 6); upper, lower : amplitudes
    (N,) of the components m and n. With z(t) = Σ_n h(ω_n) A_n e^{iω_n t} of each node the force is zᵀ T z*, and G_k its
    Fourier coefficient: memory and work grow with N, where a table of all differences grows with N².
    """
    count = upper.size
    size = 1 << max(2 * count - 1, 1).bit_length()
    z_upper, z_lower = (np.fft.ifft(hats * part[:, None], size, axis=0) * size for part in (upper, lower))
    force = np.zeros((size, 6), dtype=complex)
    for dof in np.flatnonzero(np.any(nodal != 0.0, axis=(0, 1))):
        force[:, dof] = np.einsum("tm,tm->t", z_upper @ nodal[..., dof], np.conj(z_lower))
    return np.asarray(np.fft.fft(force, axis=0)[: min(last, count - 1) + 1] / size)


def difference_sum(
    force: Drift, omega: Array, direction_m: float, direction_n: float, last: int
) -> Callable[[Array, Array], Array]:
    """G_k, k = 0 … last, of components omega (N,) of two wave systems, as a function of their amplitudes (N,) (V28).

    Raises DataError where a QTF does not know pairs of these differences.
    """
    if force.kind != "qtf":
        return partial(collect, difference_table(omega, force, direction_m, direction_n, last))
    assert force.data is not None
    qtf = force.data.qtf
    assert qtf is not None
    step = float(omega[1] - omega[0]) if omega.size > 1 else 0.0
    last = min(last, omega.size - 1)
    qtf.check_difference(last * step, float(omega[0]), float(omega[-1]))
    return partial(collect_pairs, qtf.hats(omega), force.nodal(direction_m, direction_n), last=last)


def slow_drift(omega: Array, amplitudes: Array, directions: Sequence[float], t2: T2, last: int) -> Array:
    """G_k, k = 0 … last, of several wave systems on one even grid: amplitudes complex (L, N) -> (last + 1, 6) (V28)."""
    total = np.zeros((min(last, omega.size - 1) + 1, 6), dtype=complex)
    for upper, direction_m in zip(amplitudes, directions, strict=True):
        for lower, direction_n in zip(amplitudes, directions, strict=True):
            table = difference_table(omega, t2, direction_m, direction_n, last)
            total += collect(table, upper, lower)
    return total


def _panels(low: float, high: float) -> tuple[Array, float]:
    count = max(int(np.ceil((high - low) / STEP)), 1)
    step = (high - low) / count
    return low + (np.arange(count) + 0.5) * step, step
