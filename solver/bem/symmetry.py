"""Planes of symmetry of a mesh, and the fundamental part that they repeat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from .panels import Panels, joined

Array = np.ndarray
AXES = {"x": 0, "y": 1}
NEAR = 1e-3  # of the mean edge: how far panels may be from their mirror images
MIRROR = {  # what the mirror does to the six components of a force or motion about a point in its plane
    "x": np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0]),
    "y": np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]),
}


def symmetry_planes(mesh: Panels) -> tuple[str, ...]:
    """`x`: x -> -x leaves the mesh as it is; `y`: y -> -y does. Every panel must have its mirror image."""
    tolerance = NEAR * float(mesh.edge_lengths.mean())
    tree = cKDTree(mesh.centres)
    found = []
    for name, axis in AXES.items():
        image = mesh.centres.copy()
        image[:, axis] = -image[:, axis]
        distance, index = tree.query(image)
        if distance.max() > tolerance or np.unique(index).size != mesh.count:
            continue
        normals = mesh.normals[index].copy()
        normals[:, axis] = -normals[:, axis]
        alike = np.abs(mesh.areas[index] - mesh.areas) <= 1e-2 * mesh.areas.mean()
        if alike.all() and ((normals * mesh.normals).sum(axis=1) > 0.99).all():
            found.append(name)
    return tuple(found)


@dataclass(frozen=True)
class Fundamental:
    """A part of a mesh and the planes that repeat it: copies in the order (), (p0), (p1), (p0, p1).

    With all copies, panel i of copy c is panel c · n + i of `whole`.
    """

    part: Panels
    planes: tuple[str, ...]

    def signs(self) -> list[Array]:
        """For each copy, what mirroring has done to x, y, z: (3,) of ±1."""
        found = [np.ones(3)]
        for plane in self.planes:
            flip = np.ones(3)
            flip[AXES[plane]] = -1.0
            found += [sign * flip for sign in found]
        return found

    def whole(self) -> Panels:
        copies = [self.part]
        for plane in self.planes:
            copies += [copy.mirrored(AXES[plane]) for copy in copies]
        return joined(copies)


def fundamental(mesh: Panels, planes: tuple[str, ...]) -> Fundamental:
    """The part on the positive side of the planes. A plane that panels straddle is not used."""
    part = mesh
    used: list[str] = []
    tolerance = 1e-6 * float(mesh.edge_lengths.mean())
    for plane in planes:
        side = part.corners[..., AXES[plane]]
        if np.any((side.max(axis=1) > tolerance) & (side.min(axis=1) < -tolerance)):
            continue
        half = part.chosen(part.centres[:, AXES[plane]] > 0)
        if 2 * half.count == part.count:
            part, used = half, [*used, plane]
    return Fundamental(part, tuple(used))
