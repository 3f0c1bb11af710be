"""The rigid body on its water plane: hydrostatics, motions in waves, and headings that mirror one another."""

from __future__ import annotations

import math

import numpy as np

from ..outcome import CaseError, FieldError
from .panels import Panels
from .spec import Body, HydrodynamicJob
from .symmetry import MIRROR

Array = np.ndarray
TURN = 2 * math.pi


def hydrostatic_stiffness(mesh: Panels, centre: Array, density: float, gravity: float) -> Array:
    """(6, 6) about `centre`, the weight of the displaced water acting there [N/m … N m] (H10)."""
    area, first, second = mesh.water_plane()
    x, y = centre[:2]
    sx, sy = first[0] - x * area, first[1] - y * area
    sxx = second[0] - 2 * x * first[0] + x * x * area
    syy = second[1] - 2 * y * first[1] + y * y * area
    sxy = second[2] - x * first[1] - y * first[0] + x * y * area
    arm = mesh.volume * (mesh.centre_of_buoyancy - centre)
    k = np.zeros((6, 6))
    k[2, 2], k[2, 3], k[2, 4] = area, sy, -sx
    k[3, 3], k[3, 4], k[4, 4] = syy + arm[2], -sxy, sxx + arm[2]
    k[3, 2], k[4, 2], k[4, 3] = k[2, 3], k[2, 4], k[3, 4]
    k[3, 5], k[4, 5] = -arm[0], -arm[1]
    k[np.abs(k) < 1e-9 * np.sqrt(np.outer(*(np.maximum(np.abs(np.diag(k)), np.abs(k).max() * 1e-12),) * 2))] = 0.0
    return density * gravity * k


def mass_matrix(body: Body, displaced: float) -> Array:
    """(6, 6) about the centre of gravity; radii of gyration must be there."""
    mass = displaced if body.mass is None else body.mass
    return np.asarray(
        mass * np.diag([1.0, 1.0, 1.0, *(radius**2 for radius in body.radii_of_gyration or (0.0, 0.0, 0.0))])
    )


def motions(
    omega: float, added_mass: Array, damping: Array, force: Array, inertia: Array, stiffness: Array, extra: Array
) -> Array:
    """Motion per unit amplitude (H, 6) for forces (H, 6): (-ω²(M + A) - iω(B + B_lin) + K) X = F (H11)."""
    left = -(omega**2) * (inertia + added_mass) - 1j * omega * (damping + np.diag(extra)) + stiffness
    return np.asarray(np.linalg.solve(left, force.T).T)


def extra_damping(body: Body) -> Array:
    return np.array(body.damping.values())


def folded(headings: Array, planes: tuple[str, ...]) -> tuple[Array, list[tuple[int, Array]]]:
    """Headings that must be solved, and for each given one the solved one with the signs its six components take."""
    solved: list[float] = []
    found = []
    for beta in headings:
        angle, signs = float(beta) % TURN, np.ones(6)
        if "y" in planes and angle > math.pi + 1e-9:
            angle, signs = TURN - angle, signs * MIRROR["y"]
        if "x" in planes and math.cos(angle) < -1e-12:
            angle, signs = (math.pi - angle) % TURN, signs * MIRROR["x"]
        near = [i for i, have in enumerate(solved) if abs(math.remainder(have - angle, TURN)) < 1e-9]
        if not near:
            solved.append(angle)
        found.append((near[0] if near else len(solved) - 1, signs))
    return np.array(solved), found


def mirror_planes(symmetry: tuple[str, ...], centre: Array) -> tuple[str, ...]:
    """Of the hull's planes of symmetry those that hold the reference point, across which headings mirror one another."""
    return tuple(plane for plane in symmetry if centre[0 if plane == "x" else 1] == 0.0)


def need_body(job: HydrodynamicJob) -> Body:
    if job.body is None:
        raise CaseError([FieldError(("body",), "this field is required: at least centre_of_gravity")])
    return job.body
