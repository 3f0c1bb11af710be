"""One frequency at a time: added mass, damping, excitation and the waves sent out (docs/theory-hydrodynamics.md)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..waves.dispersion import wave_number
from .airy import airy
from .drift import highest_order, kochin
from .green import SHALLOWEST, Green, flux_closure, solve_symmetric
from .panels import Panels, joined
from .symmetry import Fundamental

Array = np.ndarray
OnShare = Callable[[float, str], None]


@dataclass(frozen=True)
class Wet:
    """What is solved: the hull's part and the lid's, and the planes that repeat them."""

    hull: Panels
    lid: Panels | None
    planes: tuple[str, ...]
    centre: Array
    """Reference point of moments and rotations (3,) [m]."""
    depth: float
    density: float
    gravity: float
    lid_from: float = 0.0
    """The lid is used from this frequency up [rad/s]: well below the first irregular one it only costs accuracy."""

    def shape(self, with_lid: bool) -> Fundamental:
        parts = [self.hull, self.lid] if with_lid and self.lid is not None else [self.hull]
        return Fundamental(joined(parts), self.planes)

    @cached_property
    def unknowns(self) -> int:
        return self.hull.count + (0 if self.lid is None else self.lid.count)


@dataclass(frozen=True)
class Solved:
    """One frequency: added mass, damping (6, 6); per heading the complex Froude-Krylov and diffraction force (H, 6).

    waves : Kochin coefficients (2 · order + 1, 6 + H), of unit motions and of the fixed body. Time factor e^{-i omega t}.
    Force and waves are None at zero and infinite frequency.
    """

    omega: float
    added_mass: Array
    damping: Array
    froude_krylov: Array | None = None
    diffraction: Array | None = None
    waves: Array | None = None


class FrequencySolver:
    """Solves frequency after frequency; matrices are given back before the next."""

    def __init__(self, wet: Wet, headings: Array):
        self.wet, self.headings = wet, headings
        self._greens: dict[bool, tuple[Green, Panels, int]] = {}
        self._closure: Array | None = None

    def solve(self, omega: float, on_share: OnShare) -> Solved:
        """Everything at one frequency (H5, H6). `on_share` gets the share done, with a few words, and may raise."""
        finite = 0 < omega < math.inf
        with_lid = finite and self.wet.lid is not None and omega >= self.wet.lid_from
        if self._closure is None:
            self._closure = flux_closure(self.wet.shape(False), lambda share: on_share(0.0, "hull"))
        green, whole, hull = self._prepare(with_lid)
        k = self._wave_number(omega)
        s, kk = green.matrices(k, lambda share: on_share(0.8 * share, "Green function"))
        mask = np.tile(np.arange(green.size) < hull, green.copies)
        modes = np.where(mask[:, None], generalized_normals(whole, self.wet.centre), 0.0)
        velocity = modes.astype(complex)
        if finite:
            waves = [airy(whole.centres, b, omega, self.wet.gravity, self.wet.depth) for b in self.headings]
            against = [-np.einsum("nj,nj->n", v, whole.normals.astype(complex)) for _, v in waves]
            velocity = np.column_stack([velocity, *(np.where(mask, a, 0.0) for a in against)])
        strength, potential = solve_symmetric(s, kk, velocity, lambda share: on_share(0.8 + 0.2 * share, "equations"))
        pressure_side = modes * whole.areas[:, None]
        z = self.wet.density * pressure_side.T @ potential  # ρ ∫ φ n dS
        added_mass = -z[:, :6].real
        if not finite:
            return Solved(omega, added_mass, np.zeros((6, 6)))
        damping = -omega * z[:, :6].imag
        phi = np.column_stack([p for p, _ in waves])
        incoming = -1j * omega * self.wet.density * (pressure_side.T @ phi).T
        strength[:, :6] *= -1j * omega  # of unit motion, not of unit velocity
        order = highest_order(float(np.hypot(whole.centres[:, 0], whole.centres[:, 1]).max()), k)
        sent = kochin(whole.centres, strength * whole.areas[:, None], k, self.wet.depth, order)
        return Solved(omega, added_mass, damping, incoming, -1j * omega * z[:, 6:].T, sent)

    def _prepare(self, with_lid: bool) -> tuple[Green, Panels, int]:
        if with_lid not in self._greens:
            self._greens.clear()
            shape = self.wet.shape(with_lid)
            self._greens[with_lid] = (
                Green(shape, self.wet.depth, with_lid, self._closure),
                shape.whole(),
                self.wet.hull.count,
            )
        return self._greens[with_lid]

    def _wave_number(self, omega: float) -> float:
        if omega == 0 and math.isfinite(self.wet.depth):
            return SHALLOWEST / self.wet.depth  # the nearest there is to zero in finite depth
        return omega if omega in (0.0, math.inf) else float(wave_number(omega, self.wet.depth, self.wet.gravity))


def lowest_frequency(depth: float, gravity: float) -> float:
    """The lowest frequency that can be solved in this depth [rad/s]; 0 in infinite depth."""
    if math.isinf(depth):
        return 0.0
    return math.sqrt(gravity / depth * SHALLOWEST * math.tanh(SHALLOWEST))


def generalized_normals(mesh: Panels, centre: Array) -> Array:
    """Normal velocity of unit surge … yaw about a point, at the centres (N, 6)."""
    return np.concatenate([mesh.normals, np.cross(mesh.centres - centre, mesh.normals)], axis=1)
