"""Dynamic forces of a line on its supports (docs/theory.md, F19)."""

from __future__ import annotations

import numpy as np

from ..kernels.line import HALF
from ..model.linear import LineGeometry
from .water import WaterMotion

Array = np.ndarray
REACH = 3  # nodes that the stiffness of an end node couples, the end itself included


def end_forces(
    g: LineGeometry, damping: Array, omega: Array, motion: Array, water: WaterMotion, static: Array
) -> Array:
    """Changes of size and vertical part of the forces on the supports per unit of each load, complex (R, 4, W) [N].

    damping : (N+1, 3, 3) [N s/m]; omega : (W,) [rad/s]; motion : displacements of the nodes, complex (R, N+1, 3, W) [m];
    water : velocities of the water at the same frequencies; static : forces at rest, end b then end a, (6,) [N].

    Rows: size at end b, size at end a, vertical part at end b, vertical part at end a.
    """
    out = np.empty((motion.shape[0], 4, omega.size), dtype=complex)
    for row, node in enumerate((g.x.shape[0] - 1, 0)):
        force = -_stiffness_times(g, node, motion)
        inertia = -(omega**2) * np.einsum("ps,rsw->rpw", g.M[node], motion[:, node])
        force -= inertia + 1j * omega * np.einsum("ps,rsw->rpw", damping[node], motion[:, node])
        if water.real.shape[0]:
            u = water.real[:, node] + 1j * water.imag[:, node]
            force += np.einsum("ps,rsw->rpw", damping[node], u) + 1j * omega * np.einsum("ps,rsw->rpw", g.C[node], u)
        at_rest = static[3 * row : 3 * row + 3]
        size = float(np.linalg.norm(at_rest))
        out[:, row] = np.einsum("p,rpw->rw", at_rest / size if size > 0 else np.zeros(3), force)
        out[:, 2 + row] = force[:, 2]
    return out


def _stiffness_times(g: LineGeometry, node: int, motion: Array) -> Array:
    """Rows of K at a node times the motion, complex (R, 3, W)."""
    nodes = g.x.shape[0]
    out = np.zeros((motion.shape[0], 3, motion.shape[-1]), dtype=complex)
    for other in range(max(node - REACH + 1, 0), min(node + REACH, nodes)):
        block = np.zeros((3, 3))
        for p in range(3):
            for s in range(3):
                column = HALF + 3 * (other - node) + s - p
                block[p, s] = g.K[3 * node + p, column] if 0 <= column < g.K.shape[1] else 0.0
        out += np.einsum("ps,rsw->rpw", block, motion[:, other])
    return out
