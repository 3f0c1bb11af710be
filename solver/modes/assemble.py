"""Sparse matrices of the coupled system about its static position, fairleads tied to the vessel (docs/theory.md, M1-M2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..kernels.line import HALF
from ..model.linear import LineGeometry

if TYPE_CHECKING:
    from scipy.sparse import coo_array, csc_array

Array = np.ndarray


@dataclass(frozen=True)
class System:
    """Matrices over the interior nodes of all lines and, last, the vessel's six.

    stiffness : symmetrised; mass, damping : of the lines alone; offsets : first row of each line; vessel : whether the
    last six rows exist; asymmetry : largest entry dropped by symmetrising, as a share of the vessel's largest stiffness (M2).
    """

    stiffness: csc_array
    mass: csc_array
    damping: csc_array
    offsets: list[int]
    vessel: bool
    asymmetry: float

    @property
    def size(self) -> int:
        return int(self.stiffness.shape[0])


def assemble(
    geometries: list[LineGeometry], damping: list[Array], couplings: list[Array], body_stiffness: Array | None
) -> System:
    """Put lines and vessel together. damping : (N+1, 3, 3) per line; body_stiffness : (6, 6) with K_g, None without vessel."""
    offsets, total = [], 0
    for g in geometries:
        offsets.append(total)
        total += g.x.size - 6
    size = total + (6 if body_stiffness is not None else 0)
    parts: dict[str, list[tuple[Array, Array, Array]]] = {"K": [], "M": [], "B": []}
    for g, B, G, first in zip(geometries, damping, couplings, offsets, strict=True):
        n = g.line.multiplicity
        T = _expansion(g, G, first, total, size)
        for key, band in (("K", _band(g.K)), ("M", _blocks(g.M)), ("B", _blocks(B))):
            tied = (T.T @ band @ T).tocoo() * n
            parts[key].append((tied.data, tied.row, tied.col))
    K, M, C = (_sum(parts[key], size) for key in ("K", "M", "B"))
    if body_stiffness is not None:
        rows, cols = np.meshgrid(np.arange(total, size), np.arange(total, size), indexing="ij")
        K = K + sparse(body_stiffness, rows, cols, (size, size)).tocsc()
    skew = abs(K - K.T)
    tail = K[total:, total:].toarray() if size > total else K.diagonal()
    scale = float(np.abs(tail).max(initial=0.0)) or 1.0
    dropped = float(skew.max()) / 2 / scale if skew.nnz else 0.0
    return System((0.5 * (K + K.T)).tocsc(), M, C, offsets, body_stiffness is not None, dropped)


def sparse(data: Array, rows: Array, cols: Array, shape: tuple[int, int]) -> coo_array:
    """Entries, with places given twice added up. SciPy is loaded here, so that other analyses start without it."""
    from scipy.sparse import coo_array

    return coo_array((data.ravel(), (rows.ravel(), cols.ravel())), shape=shape)


def _band(K: Array) -> coo_array:
    size = K.shape[0]
    rows = np.repeat(np.arange(size), K.shape[1])
    cols = rows + np.tile(np.arange(K.shape[1]) - HALF, size)
    keep = (cols >= 0) & (cols < size)
    return sparse(K.ravel()[keep], rows[keep], cols[keep], (size, size))


def _blocks(M: Array) -> coo_array:
    nodes = M.shape[0]
    base = 3 * np.arange(nodes)[:, None, None]
    rows = np.broadcast_to(base + np.arange(3)[:, None], M.shape)
    cols = np.broadcast_to(base + np.arange(3)[None, :], M.shape)
    return sparse(M, rows, cols, (3 * nodes, 3 * nodes))


def _expansion(g: LineGeometry, G: Array, first: int, total: int, size: int) -> csc_array:
    """All node coordinates of a line from the system's coordinates: interior as they are, ends through the vessel (M1)."""
    count = g.x.size
    rows, cols = [np.arange(3, count - 3)], [first + np.arange(count - 6)]
    data = [np.ones(count - 6)]
    if size > total:
        for block, start in ((G[:3], count - 3), (G[3:], 0)):
            r, c = np.nonzero(block)
            rows.append(start + r)
            cols.append(total + c)
            data.append(block[r, c])
    return sparse(np.concatenate(data), np.concatenate(rows), np.concatenate(cols), (count, size)).tocsc()


def _sum(parts: list[tuple[Array, Array, Array]], size: int) -> csc_array:
    none: tuple[Array, Array, Array] = (np.zeros(0), np.zeros(0, int), np.zeros(0, int))
    data, rows, cols = (np.concatenate(column) for column in zip(none, *parts, strict=True))
    return sparse(data, rows, cols, (size, size)).tocsc()
