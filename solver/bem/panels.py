"""A mesh of flat panels, its measures, and what is cut from it at the still water."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from ..outcome import DataError

Array = np.ndarray
CROSSING = 1e-2  # of the farther side: what a half may reach over its plane of symmetry
WELD = 1e-6  # of the mesh's extent: nearer corners are one


@dataclass(frozen=True)
class Panels:
    """Panels of three or four corners; seen from the water, corners run counter-clockwise, so normals point outward.

    vertices : (V, 3) [m]; faces : (N, 4) indices, a triangle repeats its last corner.
    """

    vertices: Array
    faces: Array

    @property
    def count(self) -> int:
        return int(self.faces.shape[0])

    @cached_property
    def corners(self) -> Array:
        """(N, 4, 3) [m]."""
        return self.vertices[self.faces]

    @cached_property
    def triangles(self) -> Array:
        """Which panels have three corners (N,)."""
        return np.asarray(self.faces[:, 2] == self.faces[:, 3])

    @cached_property
    def area_vectors(self) -> Array:
        """Area times outward normal, (N, 3) [m2]."""
        a, b, c, d = np.moveaxis(self.corners, 1, 0)
        return 0.5 * np.cross(c - a, d - b)

    @cached_property
    def areas(self) -> Array:
        return np.asarray(np.linalg.norm(self.area_vectors, axis=1))

    @cached_property
    def normals(self) -> Array:
        return self.area_vectors / np.maximum(self.areas, 1e-300)[:, None]

    @cached_property
    def centres(self) -> Array:
        """Centroids (N, 3) [m], of the two triangles weighted by their areas."""
        a, b, c, d = np.moveaxis(self.corners, 1, 0)
        first = np.linalg.norm(np.cross(b - a, c - a), axis=1)[:, None]
        second = np.linalg.norm(np.cross(c - a, d - a), axis=1)[:, None]
        both = np.maximum(first + second, 1e-300)
        return (first * (a + b + c) + second * (a + c + d)) / (3.0 * both)

    @cached_property
    def edge_lengths(self) -> Array:
        """(N, 4) [m]; the fourth of a triangle is that of its third corner to its first."""
        lengths = np.linalg.norm(np.roll(self.corners, -1, axis=1) - self.corners, axis=2)
        lengths[self.triangles, 2] = lengths[self.triangles, 3]
        return lengths

    @cached_property
    def volumes(self) -> Array:
        """Volume enclosed with the plane z = 0 [m3], reckoned along x, y and z (3,): equal when the mesh is closed."""
        a, b, c, d = np.moveaxis(self.corners, 1, 0)
        total = np.zeros(3)
        for p, q, r in ((a, b, c), (a, c, d)):
            total += (0.5 * np.cross(q - p, r - p) * (p + q + r) / 3.0).sum(axis=0)
        return total

    @property
    def volume(self) -> float:
        return float(self.volumes[2])

    @cached_property
    def centre_of_buoyancy(self) -> Array:
        """(3,) [m]: the first moments of the volume, exact for flat triangles."""
        a, b, c, d = np.moveaxis(self.corners, 1, 0)
        moment = np.zeros(3)
        for p, q, r in ((a, b, c), (a, c, d)):
            area = 0.5 * np.cross(q - p, r - p)
            squares = (p * p + q * q + r * r + p * q + q * r + r * p) / 6.0
            moment[2] += 0.5 * (area * squares)[:, 2].sum()
            # ∫ x dV = ∫ x z n_z dS, with the mean over a triangle of a product of two linear functions
            for axis in (0, 1):
                product = (p[:, axis] + q[:, axis] + r[:, axis]) * (p[:, 2] + q[:, 2] + r[:, 2])
                product += p[:, axis] * p[:, 2] + q[:, axis] * q[:, 2] + r[:, axis] * r[:, 2]
                moment[axis] += (area[:, 2] * product / 12.0).sum()
        return moment / self.volume

    def water_plane(self) -> tuple[float, Array, Array]:
        """Area, first moments (x, y) and second moments (xx, yy, xy) of the water plane [m2, m3, m4].

        The plane is what closes the mesh at z = 0, so its integrals are those of -n_z over the hull.
        """
        a, b, c, d = np.moveaxis(self.corners, 1, 0)
        area, first, second = 0.0, np.zeros(2), np.zeros(3)
        for p, q, r in ((a, b, c), (a, c, d)):
            shade = -0.5 * np.cross(q - p, r - p)[:, 2]
            total = p + q + r
            area += float(shade.sum())
            first += (shade[:, None] * total[:, :2] / 3.0).sum(axis=0)
            for slot, (i, j) in enumerate(((0, 0), (1, 1), (0, 1))):
                product = total[:, i] * total[:, j] + p[:, i] * p[:, j] + q[:, i] * q[:, j] + r[:, i] * r[:, j]
                second[slot] += (shade * product / 12.0).sum()
        return area, first, second

    def edges(self) -> tuple[Array, Array]:
        """Directed edges (E, 2) of all panels, and the panel of each (E,)."""
        following = np.roll(self.faces, -1, axis=1)
        pairs = np.stack([self.faces, following], axis=2).reshape(-1, 2)
        owner = np.repeat(np.arange(self.count), 4)
        real = pairs[:, 0] != pairs[:, 1]
        return pairs[real], owner[real]

    def flipped(self) -> Panels:
        """The same panels seen from the other side."""
        turned = self.faces[:, [0, 3, 2, 1]].copy()
        tri = self.triangles
        turned[tri] = self.faces[tri][:, [0, 2, 1, 1]]
        return Panels(self.vertices, turned)

    def mirrored(self, axis: int) -> Panels:
        """The mirror image across the plane where coordinate `axis` is zero."""
        vertices = self.vertices.copy()
        vertices[:, axis] = -vertices[:, axis]
        return Panels(vertices, self.faces).flipped()

    def chosen(self, which: Array) -> Panels:
        """Some of the panels, by mask or index."""
        return Panels(self.vertices, self.faces[which])


def sharp_edged(mesh: Panels, angle: float) -> Array:
    """Which panels of a welded mesh meet a neighbour at more than `angle` [rad] (N,)."""
    pairs, owner = mesh.edges()
    _, edge, count = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True, return_counts=True)
    edge = edge.ravel()
    order = np.argsort(edge, kind="stable")
    shared = order[count[edge[order]] == 2].reshape(-1, 2)
    one, other = owner[shared[:, 0]], owner[shared[:, 1]]
    sharp = (mesh.normals[one] * mesh.normals[other]).sum(axis=1) < np.cos(angle)
    found = np.zeros(mesh.count, bool)
    found[one[sharp]] = found[other[sharp]] = True
    return found


def component_areas(mesh: Panels) -> Array:
    """Areas of the pieces of a welded mesh that hang together [m2]."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    pairs, _ = mesh.edges()
    size = mesh.vertices.shape[0]
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    labels = connected_components(graph, directed=False)[1]
    return np.bincount(labels[mesh.faces[:, 0]], weights=mesh.areas)


def joined(parts: list[Panels]) -> Panels:
    """Several meshes as one; corners are not welded."""
    offsets = np.cumsum([0, *(part.vertices.shape[0] for part in parts)])
    faces = [part.faces + offset for part, offset in zip(parts, offsets[:-1], strict=True)]
    return Panels(np.concatenate([part.vertices for part in parts]), np.concatenate(faces))


def unfolded(mesh: Panels, axis: int, name: str) -> Panels:
    """The mesh with its mirror image across the plane where coordinate `axis` is zero. Raises DataError when it crosses it."""
    low, high = mesh.vertices[:, axis].min(), mesh.vertices[:, axis].max()
    if min(-low, high) > CROSSING * max(-low, high):
        raise DataError(
            f"{name}: a symmetry across {'xyz'[axis]} = 0 is stated, but panels lie on both sides, from {low:.4g} to "
            f"{high:.4g}; give one side, or no symmetry"
        )
    return joined([mesh, mesh.mirrored(axis)])


def welded(mesh: Panels, tolerance: float | None = None) -> Panels:
    """The mesh with near corners made one, corners that no panel uses left out, collapsed quadrangles as triangles."""
    if mesh.count == 0:
        return Panels(np.zeros((0, 3)), np.zeros((0, 4), int))
    extent = float(np.ptp(mesh.vertices, axis=0).max())
    near = max(WELD * extent, 1e-12) if tolerance is None else tolerance
    group = near_groups(mesh.vertices, near)
    faces = group[mesh.faces]
    used, faces = np.unique(faces, return_inverse=True)
    faces = _without_repeats(faces.reshape(-1, 4))
    first = np.full(int(group.max()) + 1, -1)
    first[group[::-1]] = np.arange(group.size)[::-1]
    return Panels(mesh.vertices[first[used]], faces)


def near_groups(points: Array, near: float) -> Array:
    """Number of the group of near points that each belongs to (V,)."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    pairs = cKDTree(points).query_pairs(near, output_type="ndarray")
    size = points.shape[0]
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    return np.asarray(connected_components(graph, directed=False)[1])


def _without_repeats(faces: Array) -> Array:
    """Faces in which two neighbouring corners are the same, as triangles; those with fewer than three corners go."""
    out = faces.copy()
    same = faces == np.roll(faces, -1, axis=1)  # corner i is corner i + 1
    for i in range(3):
        rows = same[:, i] & (same.sum(axis=1) == 1)
        keep = [j for j in range(4) if j != i]
        out[rows] = faces[rows][:, [*keep, keep[-1]]]
    rows = same[:, 3] & (same.sum(axis=1) == 1)
    out[rows] = faces[rows][:, [0, 1, 2, 2]]
    distinct = np.array([len(set(row)) for row in out.tolist()])
    return out[distinct >= 3]


def below_water(mesh: Panels) -> tuple[Panels, int]:
    """The part of the mesh below z = 0, crossing panels cut; and how many panels in the plane z = 0 were left out."""
    z = mesh.corners[..., 2]
    near = WELD * max(float(np.ptp(mesh.vertices, axis=0).max(initial=0.0)), 1e-6)
    whole, gone = (z <= near).all(axis=1), (z >= -near).all(axis=1)
    flat = int(np.count_nonzero(whole & gone))
    pieces = [mesh.chosen(np.flatnonzero(whole & ~gone))]
    crossing = np.flatnonzero(~whole & ~gone)
    if crossing.size:
        corners: list[Array] = []
        faces: list[list[int]] = []
        for polygon in (cut for index in crossing for cut in _cut(mesh.corners[index])):
            start = len(corners)
            corners.extend(polygon)
            faces.append([start, start + 1, start + 2, start + len(polygon) - 1])
        pieces.append(Panels(np.array(corners).reshape(-1, 3), np.array(faces, int).reshape(-1, 4)))
    return welded(joined(pieces)), flat


def _cut(corners: Array) -> list[list[Array]]:
    """What is left of one panel below z = 0, as polygons of three or four corners."""
    kept: list[Array] = []
    for here, there in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if here[2] <= 0:
            kept.append(here)
        if here[2] * there[2] < 0:
            share = here[2] / (here[2] - there[2])
            point = here + share * (there - here)
            point[2] = 0.0
            kept.append(point)
    distinct = [p for p, q in zip(kept, [*kept[1:], *kept[:1]], strict=True) if np.any(p != q)]
    if len(distinct) < 3:
        return []
    if len(distinct) <= 4:
        return [distinct]
    return [distinct[:4], [distinct[0], *distinct[3:]]]
