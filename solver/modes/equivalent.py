"""The 6×6 inertia, damping and stiffness that the lines lend the vessel (docs/theory.md, M7-M8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.band import solve_real
from ..kernels.line import HALF
from ..model.linear import LineGeometry
from ..model.system import end_block, end_columns, end_rows

Array = np.ndarray


@dataclass(frozen=True)
class Equivalent:
    """Coefficients about the CG, each (6, 6), SI: lines following the vessel in their quasi-static shape.

    geometric : K_g of the pretension under rotation (finite kinematics), not in `stiffness` (M8).
    """

    inertia: Array
    damping: Array
    stiffness: Array
    geometric: Array


def equivalent_coefficients(
    geometries: list[LineGeometry], damping: list[Array], couplings: list[Array], geometric: Array
) -> Equivalent:
    """Condense every line onto the vessel with the shape it takes under slow motion of its ends (M7)."""
    M, B, K = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros((6, 6))
    for g, b, G in zip(geometries, damping, couplings, strict=True):
        if not np.any(G):
            continue
        shape, stiffness = quasi_static(g)
        n = g.line.multiplicity
        M += n * G.T @ np.einsum("iae,iab,ibf->ef", shape, g.M, shape) @ G
        B += n * G.T @ np.einsum("iae,iab,ibf->ef", shape, b, shape) @ G
        K += n * G.T @ stiffness @ G
    return Equivalent(M, B, K, geometric)


def quasi_static(g: LineGeometry) -> tuple[Array, Array]:
    """Displacement of all nodes per unit motion of end b and end a, (N+1, 3, 6), and the condensed stiffness (6, 6) (M7)."""
    rows = g.x.size - 6
    band = g.K[3 : 3 + rows].copy()
    for i in range(min(HALF, rows)):
        band[i, : HALF - i] = 0.0
        band[rows - 1 - i, HALF + i + 1 :] = 0.0
    rhs = np.zeros((rows, 6))
    end_columns(g.K, rhs, 0)
    if rows:
        solve_real(band, rhs)
    coupled = np.zeros((6, 6))
    end_rows(g.K, rhs, coupled)
    shape = np.zeros((g.x.shape[0], 3, 6))
    shape[1:-1] = -rhs.reshape(-1, 3, 6)
    shape[-1, :, :3] = np.eye(3)
    shape[0, :, 3:] = np.eye(3)
    return shape, end_block(g.K) - coupled
