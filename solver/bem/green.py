"""Influence matrices of panels on panels: Capytaine's Green function, evaluated in pieces.

The only module that loads Capytaine (the extra `bem`). Its compiled core holds Python's lock while it works, so pieces are
kept short: a worker can renew its lease, report and stop between them.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..outcome import DataError
from .panels import Panels, sharp_edged, welded
from .symmetry import Fundamental

Array = np.ndarray
PIECE_SECONDS = 0.4
FIRST_PIECE = 100_000  # entries; later ones are sized by the time it took
SINGULARITIES = "low_freq"  # taken out of the Green function so that panels in the still water can be
SHARP = math.radians(40.0)  # between panels: more is an edge of the hull, less is its curvature
SHALLOWEST = 0.15  # k·h below which Capytaine has no Green function of finite depth


class _Points(NamedTuple):
    """What the Green function asks of the panels where it is evaluated."""

    faces_centers: Array
    faces_normals: Array
    nb_faces: int


def load_capytaine() -> Any:
    """Capytaine. Raises DataError where it is not installed."""
    try:
        import capytaine
    except ImportError:
        raise DataError(
            "boundary elements need Capytaine, which is not installed here; install slowdrift[bem]"
        ) from None
    logging.getLogger("capytaine").setLevel(logging.WARNING)
    return capytaine


def make_tables() -> None:
    """Make the tables that Capytaine interpolates in, or load those of a former start; the first time takes a while.

    Python's lock is held meanwhile, so a worker does it before it has a task to keep alive.
    """
    load_capytaine().Delhommeau(gf_singularities=SINGULARITIES)


def capytaine_version() -> str:
    return str(load_capytaine().__version__)


class Green:
    """Green function of panels and their copies by symmetry.

    surface : whether some panels lie in the still water (a lid), which asks for another way of taking out singularities.
    closure : what panels lack in flux (`flux_closure`), added to their own influence.
    """

    def __init__(self, shape: Fundamental, depth: float, surface: bool, closure: Array | None = None):
        capytaine = load_capytaine()
        self.depth = depth
        self._function = capytaine.Delhommeau(gf_singularities=SINGULARITIES)
        self._sources = capytaine.Mesh(shape.part.vertices, _as_capytaine(shape.part))
        whole = shape.whole()
        self._centres, self._normals = whole.centres, whole.normals
        self.size, self.copies = shape.part.count, whole.count // shape.part.count
        self._jump = np.where(np.abs(shape.part.centres[:, 2]) < 1e-6, 1.0, 0.5)
        if closure is not None:
            self._jump[: closure.size] += closure

    def matrices(self, wave_number: float, on_piece: Callable[[float], None]) -> tuple[Array, Array]:
        """Potential S and normal velocity K at all copies of unit sources on the part (H2): (copies, n, n) complex each.

        K has the jump at a panel itself: 1/2 of its strength, 1 in the still water. wave_number [1/m] may be 0 or infinite.
        `on_piece` gets the share done, and may raise.
        """
        total, n = self._centres.shape[0], self.size
        s, k = np.empty((total, n), complex), np.empty((total, n), complex)
        row, rows = 0, max(1, FIRST_PIECE // n)
        while row < total:
            piece = slice(row, min(row + rows, total))
            began = time.perf_counter()
            points = _Points(self._centres[piece], self._normals[piece], piece.stop - piece.start)
            s[piece], k[piece] = self._evaluate(points, wave_number)
            took = max(time.perf_counter() - began, 1e-6)
            row = piece.stop
            rows = max(1, int(points.nb_faces * min(4.0, PIECE_SECONDS / took)))
            on_piece(row / total)
        k[np.arange(n), np.arange(n)] += self._jump
        if not (np.all(np.isfinite(s)) and np.all(np.isfinite(k))):
            raise DataError(
                f"the Green function is not finite at a wave number of {wave_number:.4g} 1/m; panels overlap or touch "
                "the still water: look at the mesh's quality report"
            )
        return s.reshape(self.copies, n, n), k.reshape(self.copies, n, n)

    def _evaluate(self, points: _Points, wave_number: float) -> tuple[Array, Array]:
        from capytaine.green_functions.abstract_green_function import GreenFunctionEvaluationError

        try:
            found: tuple[Array, Array] = self._function.evaluate(
                points,
                self._sources,
                wavenumber=wave_number,
                water_depth=self.depth,
                diagonal_term_in_double_layer=False,
            )
            return found
        except (GreenFunctionEvaluationError, NotImplementedError) as error:
            raise DataError(f"Capytaine gave up at a wave number of {wave_number:.4g} 1/m: {error}") from None


def flux_closure(shape: Fundamental, on_piece: Callable[[float], None]) -> Array:
    """What the flux of each panel's source through the hull lacks of its strength (n,) (H3).

    A flat panel sends nothing through itself sideways, the curved one it stands for does. Through a hull closed by its
    mirror image in a rigid still water the flux of a source on it is its strength; what the panels miss of that, put on
    the diagonal, makes curved hulls converge with the square of the panel size. Panels at sharp edges are left alone:
    there the midpoint rule is what misses, not the curvature.
    """
    _, k = Green(shape, math.inf, False).matrices(0.0, on_piece)
    areas = shape.part.areas
    through = np.tensordot(areas, k.real.sum(axis=0), 1)
    sharp = sharp_edged(welded(shape.whole()), SHARP)[: shape.part.count]
    return np.where(sharp, 0.0, 1.0 - through / areas)


def _as_capytaine(mesh: Panels) -> Array:
    """Capytaine writes a triangle with its first corner repeated at the end."""
    faces = mesh.faces.copy()
    faces[mesh.triangles, 3] = faces[mesh.triangles, 0]
    return faces


def solve_symmetric(s: Array, k: Array, velocity: Array, on_block: Callable[[float], None]) -> tuple[Array, Array]:
    """Source strengths and potentials for normal velocities (copies · n, R): two complex arrays of that shape (H4).

    Mirror images make the matrix a block matrix M[i, j] = block[i xor j]; the sums of blocks with the signs of the group's
    characters take it apart into as many systems of size n as there are copies.
    """
    copies, n, _ = k.shape
    signs = np.array([[(-1.0) ** bin(a & i).count("1") for i in range(copies)] for a in range(copies)])
    right = velocity.reshape(copies, n, -1)
    strength, potential = np.zeros(right.shape, complex), np.zeros(right.shape, complex)
    for a in range(copies):
        part = np.tensordot(signs[a], right, 1) / copies
        wanted = np.flatnonzero(np.abs(part).max(axis=0) > 1e-13 * np.abs(right).max(initial=1e-300))
        if wanted.size:
            matrix = np.tensordot(signs[a], k, 1)
            found = np.linalg.solve(matrix, part[:, wanted].astype(complex))
            waves = np.tensordot(signs[a], s, 1) @ found
            strength[:, :, wanted] += signs[a][:, None, None] * found
            potential[:, :, wanted] += signs[a][:, None, None] * waves
        on_block((a + 1) / copies)
    return strength.reshape(velocity.shape), potential.reshape(velocity.shape)
