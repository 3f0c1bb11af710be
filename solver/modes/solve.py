"""Undamped modes of the coupled system, with damping and mass shares (docs/theory.md, M3-M6)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..case.quantities import DOF
from ..outcome import NotConverged
from .assemble import System, sparse

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = np.ndarray
START = 0.05  # rad/s: where added mass is taken for a first guess of the slow modes
ROUNDS = 20
BESIDE = 0.9999  # where an eigenvalue is sought again: on it the matrix to factor is singular

#: ω -> (mass with added mass, damping) of the vessel, each (6, 6)
VesselMatrices = Callable[[float], tuple[Array, Array]]


@dataclass(frozen=True)
class Mode:
    """One mode, ΦᵀMΦ = 1. shape : over the system's coordinates; damping ratios and the lines' share of the mass."""

    period: float
    label: str
    damping_vessel: float
    damping_lines: float
    mass_lines: float
    shape: Array

    @property
    def omega(self) -> float:
        return 2.0 * np.pi / self.period


def solve_modes(system: System, vessel: VesselMatrices | None, count: int) -> list[Mode]:
    """The `count` longest modes. Each uses the vessel's matrices at its own frequency, found by substitution (M3).

    Raises NotConverged when the eigenvalue iteration fails or a mode has no positive stiffness.
    """
    count = min(count, system.size)
    mass, _ = _with_vessel(system, vessel, START)
    values, vectors = _eigen(system.stiffness, mass, count, 0.0)
    if values.size and values[0] <= 0:
        raise NotConverged(
            "modes", f"the static position is not stable: the lowest eigenvalue is {values[0]:.3g} rad²/s².",
            "Check moorings and hydrostatics; a negative yaw stiffness needs fairleads further out.",
        )  # fmt: skip
    modes = []
    for k in range(count):
        omega, shape = float(np.sqrt(values[k])), vectors[:, k]
        if vessel is not None:
            omega, shape = _at_own_frequency(system, vessel, omega, shape)
        modes.append(_describe(system, vessel, omega, shape))
    return sorted(modes, key=lambda mode: -mode.period)


def _with_vessel(system: System, vessel: VesselMatrices | None, omega: float) -> tuple[csc_array, Array]:
    """Mass of everything, and the vessel's damping, at a frequency."""
    if vessel is None:
        return system.mass, np.zeros((6, 6))
    own, damping = vessel(omega)
    at = np.arange(system.size - 6, system.size)
    rows, cols = np.meshgrid(at, at, indexing="ij")
    symmetric = 0.5 * (own + own.T)
    block = sparse(symmetric, rows, cols, (system.size, system.size))
    return (system.mass + block.tocsc()).tocsc(), damping


def _eigen(K: csc_array, M: csc_array, count: int, shift: float) -> tuple[Array, Array]:
    """Eigenvalues nearest to a shift, rising, and M-normal vectors."""
    size = K.shape[0]
    if size <= max(count + 2, 60):
        from scipy.linalg import eigh

        values, vectors = eigh(K.toarray(), M.toarray())
        nearest = np.sort(np.argsort(np.abs(values - shift))[:count])
        return values[nearest], vectors[:, nearest]
    from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, eigsh

    start = np.random.default_rng(1).standard_normal(size)
    try:
        values, vectors = eigsh(K, k=count, M=M, sigma=shift, which="LM", v0=start, tol=1e-10)
    except (ArpackNoConvergence, ArpackError, RuntimeError) as error:
        raise NotConverged(
            "modes", f"the eigenvalue iteration failed near {np.sqrt(abs(shift)):.3g} rad/s ({error}).",
            "Ask for fewer modes, or check for nodes without stiffness.",
        ) from None  # fmt: skip
    order = np.argsort(values)
    return values[order], vectors[:, order]


def _at_own_frequency(system: System, vessel: VesselMatrices, omega: float, shape: Array) -> tuple[float, Array]:
    """Repeat with the vessel's mass at the mode's own frequency until the frequency settles, following the shape (M4)."""
    for _ in range(ROUNDS):
        mass, _ = _with_vessel(system, vessel, omega)
        values, vectors = _eigen(system.stiffness, mass, min(4, system.size), BESIDE * omega**2)
        alike = np.abs(vectors.T @ (mass @ shape))
        best = int(np.argmax(alike))
        new = float(np.sqrt(max(values[best], 1e-12)))
        settled = abs(new - omega) < 1e-8 * new
        omega, shape = new, vectors[:, best]
        if settled:
            return omega, shape
    raise NotConverged(
        "modes", f"a mode near {2 * np.pi / omega:.4g} s does not settle at its own added mass.",
        "Use radiation: constant, or data in finer frequency steps.",
    )  # fmt: skip


def _describe(system: System, vessel: VesselMatrices | None, omega: float, shape: Array) -> Mode:
    """Damping ratios (M5), the lines' share of the mass and the label (M6)."""
    mass, own_damping = _with_vessel(system, vessel, omega)
    shape = shape / np.sqrt(shape @ (mass @ shape))
    lines = float(shape @ (system.mass @ shape))
    damping_lines = float(shape @ (system.damping @ shape)) / (2 * omega)
    if vessel is None:
        return Mode(2 * np.pi / omega, "line", 0.0, damping_lines, lines, shape)
    s = shape[-6:]
    own, _ = vessel(omega)
    shares = s * (0.5 * (own + own.T) @ s)
    label = "line" if lines > 0.5 else DOF[int(np.argmax(shares))]
    shape = shape * (np.sign(s[int(np.argmax(np.abs(shares)))]) or 1.0)
    return Mode(2 * np.pi / omega, label, float(s @ own_damping @ s) / (2 * omega), damping_lines, lines, shape)


def line_shapes(system: System, mode: Mode, couplings: list[Array], nodes: list[int]) -> list[Array]:
    """Displacement of the nodes of each line in a mode, (N+1, 3) each."""
    s = mode.shape[-6:] if system.vessel else np.zeros(6)
    shapes = []
    for first, G, count in zip(system.offsets, couplings, nodes, strict=True):
        ends = G @ s
        inner = mode.shape[first : first + 3 * (count - 2)].reshape(-1, 3)
        shapes.append(np.concatenate([ends[None, 3:], inner, ends[None, :3]]))
    return shapes
