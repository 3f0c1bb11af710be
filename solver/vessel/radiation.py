"""Added mass and radiation damping: constant matrices, or the transform of the retardation functions (V14)-(V20)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..case.quantities import DOF
from ..case.vessel import Hydrodynamics
from .data import HydrodynamicData
from .data.pchip import pchip
from .rigid import turned
from .scale import arm, floors

Array = np.ndarray

LONGEST, SHORTEST = 150.0, 30.0  # s: limits of the memory
PHASE_STEP = 0.12  # rad per time step at the highest frequency of the data, at most
TAIL_END = 4.0  # the damping is continued to this multiple of the highest frequency
FORGOTTEN = 5e-4  # of its peak: the memory ends where K stays below this
TAPER = 0.2  # share of the memory over which it fades out
MISFIT = 0.02  # of the peak: above it the transform of K(t) warns
NEGLIGIBLE = 1e-3  # of √(ii·jj): a coupling below this is not judged
_FINE, _MOST = 0.004, 20_000  # rad/s, and steps at most: the damping under the cosine integral


@dataclass(frozen=True)
class Retardation:
    """Retardation functions, linear between `times` and zero beyond: the one K(t) of both domains.

    times : (T,) even, from 0 [s]; kernel : (T, 6, 6) [N/m …], zero at its end; added_mass_infinite : (6, 6).
    The force on the vessel is -A∞ ẍ(t) - ∫ K(τ) ẋ(t - τ) dτ (V15).
    """

    times: Array
    kernel: Array
    added_mass_infinite: Array

    @property
    def step(self) -> float:
        return float(self.times[1] - self.times[0])

    def at(self, times: Array) -> Array:
        """K at any times >= 0 [s]: (T', 6, 6), linear between the points."""
        position = np.clip(np.asarray(times, dtype=float) / self.step, 0.0, self.times.size - 1.0)
        lower = np.minimum(position.astype(int), self.times.size - 2)
        weight = (position - lower)[:, None, None]
        return np.asarray((1.0 - weight) * self.kernel[lower] + weight * self.kernel[lower + 1])

    def transform(self, omega: Array) -> tuple[Array, Array]:
        """A'(omega), B'(omega), each (W, 6, 6): the exact transform of this piecewise-linear K (V17, V18)."""
        omega = np.maximum(np.atleast_1d(np.asarray(omega, dtype=float)), 1e-9)
        dt, flat = self.step, self.kernel.reshape(self.times.size, 36)
        active = np.flatnonzero(np.any(flat != 0.0, axis=0))
        kernel = dt * flat[:, active]
        phase = omega[:, None] * self.times
        hat = np.sinc(omega * dt / (2 * np.pi))[:, None] ** 2
        damping, added_mass = np.zeros((omega.size, 36)), np.zeros((omega.size, 36))
        damping[:, active] = hat * (np.cos(phase) @ kernel - 0.5 * kernel[0])
        sine = hat / omega[:, None] * (np.sin(phase) @ kernel) + dt * _half_hat(omega * dt)[:, None] * kernel[0]
        added_mass[:, active] = -sine
        return self.added_mass_infinite + added_mass.reshape(-1, 6, 6), damping.reshape(-1, 6, 6)

    def turned(self, yaw: float) -> Retardation:
        """In earth axes, for axes turned by yaw [rad]."""
        return Retardation(self.times, turned(self.kernel, yaw), turned(self.added_mass_infinite, yaw))


def _half_hat(x: Array) -> Array:
    """(x - sin x)/x³: the sine integral of the half hat at t = 0, over w dt² (V18); series for small x."""
    small = x < 0.1
    safe = np.where(small, 1.0, x)
    return np.where(small, (1 - x**2 / 20 * (1 - x**2 / 42)) / 6, (safe - np.sin(safe)) / safe**3)


def retardation(data: HydrodynamicData) -> tuple[Retardation, tuple[str, ...]]:
    """K(t) = (2/π) ∫ B(ω) cos ωt dω of the data, about their reference point (V15, V16), and warnings.

    B is zero at ω = 0, goes through the data by PCHIP, and beyond the highest frequency ω_N falls as (ω_N/ω)³, faded
    out over the second half of ω_N to 4 ω_N. K is kept until it stays below 5e-4 of its peak, at least 30 s and at most
    π/Δω of the data or 150 s, its last fifth faded out; its step is at most 0.12/ω_N. A missing A∞ follows from
    Ogilvie's relation, averaged over the upper half of the data (V19).
    """
    times, kernel = _kernel(data)
    size = np.abs(kernel).max(axis=0)
    size = np.sqrt(np.outer(np.diag(size), np.diag(size)))
    alive = np.flatnonzero(np.any(np.abs(kernel) > FORGOTTEN * size, axis=(1, 2)))
    end = max(SHORTEST, float(times[alive[-1]]) / (1 - TAPER)) if alive.size else SHORTEST
    times = times[: int(np.searchsorted(times, end)) + 1]
    fade = np.clip((times - (1 - TAPER) * times[-1]) / (TAPER * times[-1]), 0.0, 1.0)
    kernel = kernel[: times.size] * (0.5 * (1 + np.cos(np.pi * fade)))[:, None, None]
    kernel[-1] = 0.0
    if data.added_mass_infinite is not None:
        return Retardation(times, kernel, data.added_mass_infinite), ()
    lagging, _ = Retardation(times, kernel, np.zeros((6, 6))).transform(data.omega)
    upper = data.omega >= 0.5 * data.omega[-1]
    infinite = (data.added_mass - lagging)[upper].mean(axis=0)
    return Retardation(times, kernel, infinite), (
        f"{data.name}: no added mass at infinite frequency; it is taken from Ogilvie's relation; "
        f"compute the data at omega = inf",
    )


def _kernel(data: HydrodynamicData) -> tuple[Array, Array]:
    """K on even times up to π/Δω of the data, (T,), (T, 6, 6), by one FFT of the damping (V15)."""
    omega, damping = _continued(data)
    spacing = float(np.median(np.diff(np.concatenate([[0.0], data.omega]))))
    memory = float(np.clip(np.pi / spacing, SHORTEST, LONGEST))
    step = float(omega[1] - omega[0])
    count = 1000 * int(np.ceil(2 * np.pi * float(data.omega[-1]) / (PHASE_STEP * step) / 1000))
    times = 2 * np.pi / (count * step) * np.arange(count // 2)
    times = times[: int(np.searchsorted(times, memory)) + 1]
    flat = damping.reshape(-1, 36)
    active = np.flatnonzero(np.any(flat != 0.0, axis=0))
    kernel = np.zeros((times.size, 36))
    cosine = 0.5 * np.fft.irfft(flat[:, active], n=count, axis=0, norm="forward")[: times.size]  # Σ' B cos
    hat = np.sinc(step * times / (2 * np.pi)) ** 2  # exact for a piecewise-linear B that ends at zero
    kernel[:, active] = (2 / np.pi) * step * hat[:, None] * cosine
    return times, kernel.reshape(-1, 6, 6)


def _continued(data: HydrodynamicData) -> tuple[Array, Array]:
    """Even frequencies from 0 to 4 ω_N, and the damping on them, (F,), (F, 6, 6) (V16)."""
    last = float(data.omega[-1])
    nodes = np.concatenate([[0.0], data.omega])
    table = np.concatenate([np.zeros((1, 36)), data.damping.reshape(-1, 36)])
    omega = np.linspace(0.0, TAIL_END * last, min(int(np.ceil(TAIL_END * last / _FINE)), _MOST) + 1)
    inside = omega <= last
    damping = np.empty((omega.size, 36))
    damping[inside] = pchip(nodes, table, omega[inside])
    tail = omega[~inside]
    middle = 0.5 * (1 + TAIL_END) * last
    fade = np.clip((tail - middle) / (TAIL_END * last - middle), 0.0, 1.0)
    damping[~inside] = ((last / tail) ** 3 * 0.5 * (1 + np.cos(np.pi * fade)))[:, None] * table[-1]
    return omega, damping.reshape(-1, 6, 6)


def misfit(kernel: Retardation, data: HydrodynamicData, low: float, high: float) -> dict[tuple[str, int, int], float]:
    """Largest |A' - A| and |B' - B| at the data's frequencies in low..high [rad/s], over the peak of the pair (V20).

    Keys ("added mass" | "damping", i, j), i <= j; couplings below a thousandth of √(ii·jj) are left out, and a diagonal
    that is rounding (Q0).
    """
    nodes, added_mass, damping = data.radiation_nodes()
    inside = (nodes >= low) & (nodes <= high)
    if not inside.any():
        return {}
    found = {}
    for what, ours, theirs in zip(
        ("added mass", "damping"), kernel.transform(nodes[inside]), (added_mass, damping), strict=True
    ):
        peak = np.abs(theirs).max(axis=0)
        zero = floors(np.diag(peak), arm(data) ** 2)
        size = np.sqrt(np.maximum(np.diag(peak), zero))
        least = NEGLIGIBLE * np.outer(size, size)
        np.fill_diagonal(least, zero)
        gap = np.abs(ours - theirs[inside]).max(axis=0)
        for i, j in zip(*np.triu_indices(6), strict=True):
            if peak[i, j] > least[i, j]:
                found[what, int(i), int(j)] = float(gap[i, j] / peak[i, j])
    return found


@dataclass(frozen=True)
class Radiation:
    """A(ω), B(ω) of a case, in earth axes: the same constants at every ω, or the transform of K(t).

    added_mass, damping : (6, 6), the constants; retardation : K(t) for `cummins`, None for `constant`.
    misfit : largest misfit over all pairs, 0 for constant; warnings : sentences for the summary.
    """

    added_mass: Array
    damping: Array
    retardation: Retardation | None = None
    misfit: float = 0.0
    warnings: tuple[str, ...] = ()

    def at(self, omega: Array) -> tuple[Array, Array]:
        """Added mass and damping at omega (W,) [rad/s]: two arrays (W, 6, 6) [kg …, N s/m …]."""
        omega = np.atleast_1d(np.asarray(omega, dtype=float))
        if self.retardation is not None:
            return self.retardation.transform(omega)
        shape = (omega.size, 6, 6)
        return np.broadcast_to(self.added_mass, shape), np.broadcast_to(self.damping, shape)


def make_radiation(
    choice: Hydrodynamics | None,
    data: HydrodynamicData | None,
    yaw: float = 0.0,
    low: float = 0.0,
    high: float = np.inf,
) -> Radiation:
    """Radiation of a case in earth axes at a yaw [rad], from data about the CG (rigid.about_cg) (V14).

    low, high : the band in use [rad/s], over which the misfit of K(t) is judged. Without data: none at all.
    For `cummins` the constants are those at infinite frequency: A∞ and no damping.
    Raises DataError when `frequency` lies outside the data.
    """
    if choice is None or data is None:
        return Radiation(np.zeros((6, 6)), np.zeros((6, 6)))
    if choice.radiation == "constant":
        added_mass, damping = data.radiation_at(np.array([choice.frequency], dtype=float))
        return Radiation(turned(added_mass[0], yaw), turned(damping[0], yaw))
    kernel, warnings = retardation(data)
    found = misfit(kernel, data, low, high)
    worst = max(found.values(), default=0.0)
    texts = [*warnings, *_misfit_warnings(found, data)]
    kernel = kernel.turned(yaw)
    return Radiation(kernel.added_mass_infinite, np.zeros((6, 6)), kernel, worst, tuple(texts))


def _misfit_warnings(found: dict[tuple[str, int, int], float], data: HydrodynamicData) -> list[str]:
    bad = sorted((item for item in found.items() if item[1] > MISFIT), key=lambda item: -item[1])
    if not bad:
        return []
    pairs = ", ".join(
        f"{what} of {DOF[i] if i == j else f'{DOF[i]}-{DOF[j]}'} {100 * value:.1f} %" for (what, i, j), value in bad[:6]
    )
    missing = [
        text for text, value in (("0", data.added_mass_zero), ("inf", data.added_mass_infinite)) if value is None
    ]
    also = f" and at omega = {' and '.join(missing)}" if missing else ""
    return [
        f"{data.name}: the retardation functions give back the data with a misfit of {pairs} of the peak "
        f"(threshold {100 * MISFIT:.0f} %); the data end at {data.omega[-1]:.4g} rad/s: compute them to higher "
        f"frequencies, in finer steps{also}, or choose radiation: constant"
    ]
