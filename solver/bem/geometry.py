"""From the geometry of a job to the panels of its wetted hull, ready to be looked at and computed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..outcome import CaseError, DataError, FieldError
from .panels import Panels, below_water, welded
from .read import read_mesh
from .shapes import count_about, hull_panels
from .spec import MAX_PANELS, HydrodynamicJob
from .symmetry import symmetry_planes

Array = np.ndarray
LEAST_VOLUME = 1e-6  # of the box around the hull
TINY = 1e-9  # of the mean area: smaller panels are no panels


@dataclass(frozen=True)
class Hull:
    """Wetted panels, and what was done to get them.

    format : of the file, or `hull`; panel_size : of a hull of given dimensions [m]; flat, doubles, tiny, cut : panels
    left out because they lie in the still water, are there twice or have no area, and whether some were cut by it.
    turned : the file had its normals inward.
    """

    panels: Panels
    format: str
    panel_size: float | None = None
    flat: int = 0
    doubles: int = 0
    tiny: int = 0
    turned: bool = False

    @cached_property
    def symmetry(self) -> tuple[str, ...]:
        """Mirror images found: `x` fore and aft, `y` port and starboard."""
        return symmetry_planes(self.panels)

    @cached_property
    def draught(self) -> float:
        return float(-self.panels.corners[..., 2].min())


Fetch = Callable[[str], tuple[bytes, str]]
"""Gives content and file name of a mesh by its reference; raises DataError."""


def prepare(job: HydrodynamicJob, fetch: Fetch) -> Hull:
    """The wetted hull. Raises CaseError or DataError, naming what is wrong and how to put it right."""
    geometry = job.geometry
    if geometry.hull is not None:
        size = geometry.panel_size
        about = 0.0 if size is None else count_about(geometry.hull, size)
        if about > 4 * MAX_PANELS:
            raise _too_many(about, f"{size:g} m")
        panels, size = hull_panels(geometry.hull, size)
        if panels.count > MAX_PANELS:
            raise _too_many(panels.count, f"{size:g} m")
        return Hull(panels, "hull", size)
    payload, filename = fetch(geometry.mesh or "")
    mesh, kind = read_mesh(payload, filename)
    return wetted(mesh, kind, geometry.scale, np.array(geometry.move), filename)


def _too_many(count: float, size: str) -> CaseError:
    message = f"{size} gives about {count:.0f} panels; allowed: at most {MAX_PANELS}; use a larger panel_size"
    return CaseError([FieldError(("geometry", "panel_size"), message, size)])


def wetted(mesh: Panels, kind: str, scale: float, move: Array, name: str) -> Hull:
    """What of a mesh lies below z = 0, without doubles, normals outward. Raises DataError."""
    mesh = Panels(mesh.vertices * scale + move, mesh.faces)
    z = mesh.corners[..., 2]
    if z.min() >= 0:
        raise DataError(
            f"{name}: the whole mesh lies above the water, from z = {z.min():g} to {z.max():g} m; move it down with "
            "geometry.move"
        )
    below, flat = below_water(mesh)
    single = below.chosen(np.sort(np.unique(np.sort(below.faces, axis=1), axis=0, return_index=True)[1]))
    solid = single.chosen(single.areas * max(single.count, 1) > TINY * single.areas.sum())
    panels = welded(solid)
    if not 0 < panels.count <= MAX_PANELS:
        raise DataError(f"{name}: {panels.count} panels with an area below the water; allowed: 1 to {MAX_PANELS}")
    box = float(np.prod(np.ptp(panels.vertices, axis=0)))
    if not abs(panels.volume) > LEAST_VOLUME * box or box == 0:
        raise DataError(
            f"{name}: the mesh encloses {panels.volume:.3g} m3 below the water, in a box of {box:.3g} m3; give a hull that is "
            "closed but for the still water"
        )
    turned = panels.volume < 0
    doubles, tiny = below.count - single.count, single.count - solid.count
    return Hull(panels.flipped() if turned else panels, kind, None, flat, doubles, tiny, turned)
