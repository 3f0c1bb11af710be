"""What there is to say of a mesh before it is computed: measures, and warnings with threshold, value and remedy."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..waves.dispersion import wave_number
from .geometry import Hull
from .panels import Panels, near_groups
from .spec import HydrodynamicJob

Array = np.ndarray
PER_WAVE = 8.0  # panels on the shortest wave
ASPECT = 10.0  # longest to shortest edge of a panel
SMALL = 1e-3  # of the mean area
SPREAD = 2e-3  # of the volume: how far its three reckonings may differ
WEIGHT = 0.05  # of the displaced mass: how far the body's mass may differ
NEAR = 2e-3  # of the mean edge: files round their coordinates
SHOWN = 6000


@dataclass(frozen=True)
class Doubt:
    """One doubt about a mesh. `message` is a sentence with the numbers and the remedy in it."""

    check: str
    threshold: float
    value: float
    remedy: str
    message: str

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


@dataclass(frozen=True)
class Edges:
    """Edges that are no seam of two panels: `open` below the water line, `turned` where neighbours disagree on outside."""

    open: int
    turned: int
    water_line: Array
    """Corners of the edges in the still water (E, 2, 3) [m]."""


def edges_of(mesh: Panels) -> Edges:
    pairs, _ = mesh.edges()
    ordered = np.sort(pairs, axis=1)
    unique, inverse, count = np.unique(ordered, axis=0, return_inverse=True, return_counts=True)
    forward = np.bincount(inverse.ravel(), weights=(pairs[:, 0] < pairs[:, 1]).astype(float))
    turned = int(np.count_nonzero((count == 2) & (forward != 1)))
    border = unique[count == 1]
    near = NEAR * float(mesh.edge_lengths.mean())
    at_surface = (np.abs(mesh.vertices[border][..., 2]) < near).all(axis=1)
    loose = mesh.vertices[border[~at_surface]]
    return Edges(_unmatched(loose, near) + int(np.count_nonzero(count > 2)), turned, mesh.vertices[border[at_surface]])


def _unmatched(edges: Array, near: float) -> int:
    """Edges (E, 2, 3) left once each is split where another's end lies on it and equal pieces are paired off.

    A panel may border on two smaller ones: no hole, though no edge is shared. Looked at where there are at most 5000.
    """
    if not 0 < edges.shape[0] <= 5000:
        return int(edges.shape[0])
    group = near_groups(edges.reshape(-1, 3), near)
    points = edges.reshape(-1, 3)[np.unique(group, return_index=True)[1]]
    pieces: dict[tuple[int, int], int] = {}
    for ends, (start, end) in zip(group.reshape(-1, 2).tolist(), edges, strict=True):
        along = end - start
        length = max(float(np.linalg.norm(along)), 1e-300)
        s = (points - start) @ along / length
        away = np.linalg.norm(points - start - s[:, None] * along / length, axis=1)
        inner = np.flatnonzero((away < near) & (s > near) & (s < length - near))
        stops = [ends[0], *inner[np.argsort(s[inner])].tolist(), ends[1]]
        for p, q in pairwise(stops):
            if p != q:
                pieces[min(p, q), max(p, q)] = pieces.get((min(p, q), max(p, q)), 0) + 1
    return sum(1 for times in pieces.values() if times % 2)


def measures(hull: Hull, job: HydrodynamicJob) -> dict[str, Any]:
    """Numbers of the wetted hull (docs/rest.md, Hydrodynamics): SI, plain JSON values."""
    mesh, edges = hull.panels, edges_of(hull.panels)
    lengths, low, high = mesh.edge_lengths, mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    aspect = lengths.max(axis=1) / np.maximum(lengths.min(axis=1), 1e-12)
    area, _, _ = mesh.water_plane()
    omega = job.highest()
    wave = None if not omega else 2 * math.pi / float(wave_number(omega, job.water.depth_m, job.water.gravity))
    box = float((high[0] - low[0]) * (high[1] - low[1]) * -low[2])
    spread = float(np.ptp(mesh.volumes) / abs(mesh.volume))
    return {
        "panels": mesh.count,
        "triangles": int(mesh.triangles.sum()),
        "volume": mesh.volume,
        "volume_spread": spread,
        "displacement": mesh.volume * job.water.density,
        "wetted_area": float(mesh.areas.sum()),
        "waterplane_area": area,
        "centre_of_buoyancy": mesh.centre_of_buoyancy.tolist(),
        "block_coefficient": mesh.volume / box,
        "bounds": [low.tolist(), high.tolist()],
        "draught": hull.draught,
        "closed": edges.open == 0 and spread < SPREAD,
        "open_edges": edges.open,
        "turned_edges": edges.turned,
        "normals_outward": not hull.turned and edges.turned == 0,
        "duplicate_panels": hull.doubles,
        "dropped_panels": hull.flat + hull.tiny,
        "symmetry": list(hull.symmetry),
        "panel_edge": {"mean": float(lengths.mean()), "max": float(lengths.max())},
        "aspect_ratio": {"mean": float(aspect.mean()), "max": float(aspect.max())},
        "smallest_area": float(mesh.areas.min()),
        "shortest_wave": wave,
        "panels_per_wavelength": None if wave is None else wave / float(lengths.max(axis=1).max()),
        "panel_size": hull.panel_size,
    }


def doubts(hull: Hull, job: HydrodynamicJob, found: dict[str, Any]) -> list[Doubt]:
    """Every measure beyond its threshold."""
    out: list[Doubt] = []

    def say(check: str, threshold: float, value: float, text: str, remedy: str) -> None:
        out.append(Doubt(check, threshold, value, remedy, f"{text}; {remedy}."))

    _shape_doubts(hull, found, say)
    _panel_doubts(hull, found, say)
    body = job.body
    if body is not None and body.mass is not None:
        gap = abs(body.mass / found["displacement"] - 1)
        if gap > WEIGHT:
            say("displacement", WEIGHT, gap, f"the mesh displaces {found['displacement']:.4g} kg and the body's mass is "
                f"{body.mass:.4g} kg, {100 * gap:.1f} % apart (threshold {100 * WEIGHT:.0f} %)",
                "check draught, scale and mass; moorings or loads must carry the difference")  # fmt: skip
    depth = job.water.depth
    if depth is not None and hull.draught >= depth:
        say("depth", depth, hull.draught, f"the hull reaches {hull.draught:g} m down, the water is {depth:g} m deep",
            "check the draught or the depth")  # fmt: skip
    return out


def _shape_doubts(hull: Hull, found: dict[str, Any], say: Any) -> None:
    if found["volume_spread"] > SPREAD:
        say("volume", SPREAD, found["volume_spread"], "the volume reckoned along x, y and z differs by "
            f"{100 * found['volume_spread']:.2g} % (threshold {100 * SPREAD:g} %)", "close the holes of the mesh")  # fmt: skip
    if found["open_edges"]:
        say("watertight", 0, found["open_edges"], f"{found['open_edges']} edges belong to one panel only, or to more than two",
            "weld the corners and close the holes")  # fmt: skip
    if found["turned_edges"]:
        say("normals", 0, found["turned_edges"], f"at {found['turned_edges']} edges two panels disagree on which side is out",
            "make the normals consistent in the program the mesh comes from")  # fmt: skip
    if hull.turned:
        say("normals", 0, hull.panels.count, "all normals pointed inward and were turned", "nothing needs to be done")
    if hull.doubles:
        say("duplicates", 0, hull.doubles, f"{hull.doubles} panels are there twice and were counted once",
            "check that parts do not overlap")  # fmt: skip
    if hull.flat:
        say("still water", 0, hull.flat, f"{hull.flat} panels lie in the still water and were left out",
            "nothing needs to be done: a lid is made when the job asks for one")  # fmt: skip
    if hull.tiny:
        say("area", 0, hull.tiny, f"{hull.tiny} panels without area were left out", "nothing needs to be done")


def _panel_doubts(hull: Hull, found: dict[str, Any], say: Any) -> None:
    per_wave, wave = found["panels_per_wavelength"], found["shortest_wave"]
    if per_wave is not None and per_wave < PER_WAVE:
        say("panels per wavelength", PER_WAVE, per_wave, f"the largest panel edge, {found['panel_edge']['max']:.3g} m, goes "
            f"{per_wave:.2g} times into the shortest wave, {wave:.3g} m (threshold {PER_WAVE:g})",
            f"use panels of at most {wave / PER_WAVE:.3g} m, or stop at lower frequencies")  # fmt: skip
    if found["aspect_ratio"]["max"] > ASPECT:
        count = int(np.count_nonzero(_aspect(hull.panels) > ASPECT))
        say("aspect ratio", ASPECT, found["aspect_ratio"]["max"], f"{count} panels are long and narrow, the worst "
            f"{found['aspect_ratio']['max']:.3g} to 1 (threshold {ASPECT:g})", "make panels more even")  # fmt: skip
    least, mean = found["smallest_area"], float(hull.panels.areas.mean())
    if least < SMALL * mean:
        say("area", SMALL, least / mean, f"the smallest panel, {least:.2g} m2, has {100 * least / mean:.2g} % of the mean area "
            f"(threshold {100 * SMALL:g} %)", "join slivers with their neighbours")  # fmt: skip


def _aspect(mesh: Panels) -> Array:
    lengths = mesh.edge_lengths
    return np.asarray(lengths.max(axis=1) / np.maximum(lengths.min(axis=1), 1e-12))


def preview(hull: Hull, most: int = SHOWN) -> dict[str, Any]:
    """Panels to draw: corners [m, to the millimetre] and faces; of a large mesh every n-th panel."""
    mesh = hull.panels
    chosen = mesh.chosen(np.linspace(0, mesh.count - 1, min(most, mesh.count)).astype(int))
    used, faces = np.unique(chosen.faces, return_inverse=True)
    return {
        "vertices": np.round(chosen.vertices[used], 3).tolist(),
        "faces": faces.reshape(-1, 4).tolist(),
        "panels": mesh.count,
        "shown": chosen.count,
    }
