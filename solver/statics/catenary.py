"""Elastic catenary in a vertical plane, with or without contact with a flat, frictionless seabed (docs/theory.md, S1-S4).

The first shape of Newton's iteration, and a closed form that tests hold the discretised line to.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Catenary:
    """Forces and shape of a hanging line.

    horizontal, vertical : components of the tension at the upper end [N]; grounded : length on the bed [m].
    """

    horizontal: float
    vertical: float
    length: float
    weight: float
    EA: float
    grounded: float

    @property
    def tension(self) -> float:
        return math.hypot(self.horizontal, self.vertical)

    def shape(self, arc: Array) -> tuple[Array, Array]:
        """Horizontal distance and height over the lower end at unstretched arc lengths from it [m]."""
        return _shape(np.asarray(arc, dtype=float), self.horizontal, self.vertical, self)


def _shape(arc: Array, H: float, V: float, line: Catenary) -> tuple[Array, Array]:
    """Distance and height over the lower end (S1, S2)."""
    w, EA, lift = line.weight, line.EA, np.maximum(arc - line.grounded, 0.0)
    start = V - w * (line.length - line.grounded)
    rise = start + w * lift
    x = np.minimum(arc, line.grounded) + (H / w) * (np.arcsinh(rise / H) - math.asinh(start / H)) + H * arc / EA
    z = (H / w) * (np.hypot(1.0, rise / H) - math.hypot(1.0, start / H)) + (start * lift + 0.5 * w * lift**2) / EA
    return x, z


def solve_catenary(span: float, drop: float, length: float, weight: float, EA: float, seabed: bool) -> Catenary | None:
    """The catenary between ends `span` apart horizontally and `drop` vertically (upper over lower, ≥ 0) [m].

    weight : submerged weight per unit length, > 0 [N/m]; seabed : the lower end lies on the bed.
    Returns None when Newton's iteration does not settle (a nearly vertical or nearly straight stiff line).
    """
    H, V = _first_guess(span, drop, length, weight, EA)
    previous = math.inf
    log_h = math.log(H)
    for _ in range(200):
        H = math.exp(log_h)
        line = _make(H, V, length, weight, EA, seabed)
        x, z = _end(line)
        error = math.hypot(x - span, z - drop)
        if error < 1e-9 * length:
            return line
        step = _newton(line, span - x, drop - z, seabed)
        if step is None:
            return None
        limit = min(1.0, 1.0 / max(abs(step[0]), 1e-12), 2.0 * (abs(V) + weight * length) / max(abs(step[1]), 1e-12))
        if error > previous:
            limit *= 0.5
        previous = error
        log_h += limit * step[0]
        V += limit * step[1]
    return None


def _make(H: float, V: float, length: float, weight: float, EA: float, seabed: bool) -> Catenary:
    """The catenary of given end forces, with its grounded length (S3)."""
    grounded = min(max(length - V / weight, 0.0), length) if seabed else 0.0
    return Catenary(H, V, length, weight, EA, grounded)


def _end(line: Catenary) -> tuple[float, float]:
    x, z = line.shape(np.array([line.length]))
    return float(x[0]), float(z[0])


def _first_guess(span: float, drop: float, length: float, weight: float, EA: float) -> tuple[float, float]:
    chord = math.hypot(span, drop)
    if length > chord:
        k = math.sqrt(max(3.0 * ((length**2 - drop**2) / max(span, 1e-6 * length) ** 2 - 1.0), 1e-6))
        H = max(weight * span / (2.0 * min(k, 20.0)), 1e-4 * weight * length)
        return H, 0.5 * weight * (drop / math.tanh(min(k, 20.0)) + length)
    stretch = EA * (chord / length - 1.0) + weight * length
    return stretch * max(span, 1e-3 * chord) / chord, stretch * drop / chord + 0.5 * weight * length


def _newton(line: Catenary, dx: float, dz: float, seabed: bool) -> tuple[float, float] | None:
    """Step in (log H, V) by differences of the closed form (S4)."""
    x0, z0 = _end(line)
    eh, ev = 1e-6, 1e-6 * (abs(line.vertical) + line.weight * line.length)
    args = (line.length, line.weight, line.EA, seabed)
    xh, zh = _end(_make(line.horizontal * math.exp(eh), line.vertical, *args))
    xv, zv = _end(_make(line.horizontal, line.vertical + ev, *args))
    a, b, c, d = (xh - x0) / eh, (xv - x0) / ev, (zh - z0) / eh, (zv - z0) / ev
    det = a * d - b * c
    if det == 0.0 or not math.isfinite(det):
        return None
    return (d * dx - b * dz) / det, (a * dz - c * dx) / det
