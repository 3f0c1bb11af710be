"""The state of the drag linearisation: covariances of relative velocity, and what follows from them (F1, F14)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..forces import drag
from ..model.linear import LineGeometry
from .coefficients import drag_blocks, harmonic, local_axes, random

Array = np.ndarray
TINY = 1e-16  # m²/s²


@dataclass(frozen=True)
class Linearised:
    """Linear damping of every line (N+1, 3, 3), its mean drag beyond the static one (N+1, 3), and of the vessel (6,)."""

    damping: list[Array]
    mean: list[Array]
    vessel: Array


@dataclass(frozen=True)
class DragState:
    """Covariance of relative velocity per line (N+1, 6) and variance of vessel velocity (6,).

    For harmonic motion half the square of the amplitude stands for the variance.
    """

    lines: list[Array]
    vessel: Array

    def pack(self) -> Array:
        """All covariances and variances in one array: what is mixed between iterations."""
        return np.concatenate([*(part.ravel() for part in self.lines), self.vessel])

    def weight(self) -> Array:
        """One over the variance of each entry's node, so that slow nodes count as fast ones do."""
        nodes = [np.repeat(part[:, :3].sum(axis=1), 6) for part in self.lines]
        sizes = np.concatenate([*nodes, self.vessel])
        return 1.0 / np.maximum(sizes, 1e-6 * max(float(sizes.max(initial=0.0)), TINY))

    def mixed(self, packed: Array) -> DragState:
        """The state of `packed`, save where mixing left a variance far from this one's: there this one stays."""
        parts, start = [], 0
        for part in self.lines:
            new = packed[start : start + part.size].reshape(part.shape)
            start += part.size
            own = part[:, :3]
            far: Array = (new[:, :3] < 0.1 * own - TINY) | (new[:, :3] > 10.0 * own + TINY)
            stay: Array = np.any(far, axis=1, keepdims=True)
            parts.append(np.where(stay, part, new))
        vessel = packed[start:]
        return DragState(parts, np.where(vessel < 0.1 * self.vessel, self.vessel, vessel))


def linearise(
    geometries: list[LineGeometry], state: DragState, quadratic: Array, is_random: bool, as_vector: bool
) -> Linearised:
    """Equivalent damping for a state. quadratic : (6,) force per velocity squared of the vessel."""
    damping, mean = [], []
    for g, covariance in zip(geometries, state.lines, strict=True):
        B, load = drag_blocks(g.line.arrays, g.x, g.wet, covariance, g.plane, is_random, as_vector)
        B[:, 2, 2] += g.bed
        static = np.zeros_like(g.x)
        still = np.zeros_like(g.x)
        drag.force(g.line.arrays, g.x, still, still, still, static)
        damping.append(B)
        mean.append(load - static)
    vessel = np.zeros(6)
    for dof in np.flatnonzero(quadratic):
        sigma = float(np.sqrt(state.vessel[dof]))
        beta, _ = random(0.0, sigma) if is_random else harmonic(0.0, np.sqrt(2.0) * sigma)
        vessel[dof] = quadratic[dof] * beta
    return Linearised(damping, mean, vessel)


def sigmas(geometries: list[LineGeometry], state: DragState) -> Array:
    """Standard deviation of relative velocity in every drag direction, one flat array [m/s]: what must settle (F17)."""
    out = []
    for g, c in zip(geometries, state.lines, strict=True):
        S = np.empty((g.x.shape[0], 3, 3))
        for p, q, k in ((0, 0, 0), (1, 1, 1), (2, 2, 2), (0, 1, 3), (0, 2, 4), (1, 2, 5)):
            S[:, p, q] = S[:, q, p] = c[:, k]
        axes = element_axes(g)
        arrays = g.line.arrays
        used = np.asarray(np.stack([arrays.cdt, arrays.cdn, arrays.cdn], axis=1) > 0)
        for shift in (0, 1):  # the half elements at the start and at the end of each element
            variance: Array = np.einsum("jdp,jpq,jdq->jd", axes, S[shift : S.shape[0] - 1 + shift], axes)
            out.append(np.sqrt(np.maximum(variance, 0.0))[used])
    return np.concatenate([*out, np.sqrt(state.vessel)]) if out else np.sqrt(state.vessel)


def element_axes(g: LineGeometry) -> Array:
    """Rows t, n, Π of every element, (N, 3, 3)."""
    axes = np.empty((g.x.shape[0] - 1, 3, 3))
    for j in range(axes.shape[0]):
        local_axes(g.x, j, g.plane, axes[j])
    return axes


def moment_response(g: LineGeometry, Yr: Array, Yi: Array) -> Array:
    """Bending moment per unit response, in the line's plane and out of it: complex (R, 2, N+1, W) [N m] (F13).

    Linearised from kb θ: in plane kb b·δ(t_j × t_k)/cos θ with the binormal b, out of plane kb (θ/sin θ) n·δ(t_j × t_k).
    """
    Y = Yr + 1j * Yi
    R, nodes, _, W = Y.shape
    out = np.zeros((R, 2, nodes, W), dtype=complex)
    d = np.diff(g.x, axis=0)
    length = np.linalg.norm(d, axis=1)
    t = d / length[:, None]
    dY = np.diff(Y, axis=1)
    along = np.einsum("jp,rjpw->rjw", t, dY)
    dt = (dY - t[None, :, :, None] * along[:, :, None, :]) / length[None, :, None, None]
    axes = element_axes(g)
    tj, tk = t[:-1], t[1:]
    change = np.cross(dt[:, :-1], tk[None, :, :, None], axis=2) + np.cross(tj[None, :, :, None], dt[:, 1:], axis=2)
    cosine = np.clip(np.einsum("ip,ip->i", tj, tk), -1.0, 1.0)
    theta = np.arccos(cosine)
    p = np.where(theta > 1e-6, theta / np.maximum(np.sin(theta), 1e-12), 1.0)
    kb = g.line.arrays.kb[1:-1]
    same: Array = np.where(np.einsum("ip,ip->i", axes[:-1, 2], axes[1:, 2]) < 0.0, -1.0, 1.0)[:, None]
    binormal, normal = 0.5 * (axes[:-1, 2] + same * axes[1:, 2]), 0.5 * (axes[:-1, 1] + same * axes[1:, 1])
    safe = np.where(np.abs(cosine) > 1e-3, cosine, 1e-3)
    out[:, 0, 1:-1] = np.einsum("ip,ripw->riw", binormal, change) * (kb / safe)[None, :, None]
    out[:, 1, 1:-1] = np.einsum("ip,ripw->riw", normal, change) * (kb * p)[None, :, None]
    return out
