"""Strains beyond what wire and chain can bear (docs/theory.md, L2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..model.line import LineModel

Array = np.ndarray
STRAIN = 0.1  # of wire and chain: steel breaks at a few per cent
HEAVY = 3.0  # times the displaced water: a line of this weight is wire or chain, not a rope, a pipe or a hose


def allowed_tension(line: LineModel) -> Array:
    """Tension at the largest strain of wire and chain, of each element (N,) [N]; 0 where the line is lighter than these."""
    a = line.arrays
    return np.where(a.w_dry >= HEAVY * a.b_wet, STRAIN * a.EA, 0.0)


def strain_warnings(
    name: str, arc: Array | Sequence[float], tension: Array, allowed: Array | Sequence[float], where: str
) -> Iterator[str]:
    """What to say of the most strained element. arc [m], tension and allowed tension [N] of the elements, (N,) each."""
    limit = np.asarray(allowed, dtype=float)
    share = np.where(limit > 0, tension / np.where(limit > 0, limit, 1.0), 0.0)
    most = int(np.argmax(share))
    if share[most] > 1.0:
        yield (
            f"line {name!r}, {arc[most]:.4g} m from end a: the strain is {100 * STRAIN * share[most]:.3g} % {where} "
            f"({tension[most] / 1e6:.3g} MN; limit {100 * STRAIN:g} % for wire and chain); steel breaks at a few per cent: "
            "check EA, lengths and pretension"
        )
