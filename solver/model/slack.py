"""Which elements of a line are slack or pushed beyond their Euler load, and the sentences that say so (L17)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.line import LineArrays
from .line import LineModel, euler_load

Array = np.ndarray
NOTHING = 1e-6  # of the largest tension: less compression is round-off


def slack_elements(arrays: LineArrays, tension: Array) -> Array:
    """Elements that are slack: axial force at most 0 where compression is not allowed. tension (N,) -> bool (N,)."""
    return np.asarray((tension <= 0.0) & np.isfinite(arrays.limit))


def push_limits(arrays: LineArrays) -> list[float | None]:
    """Euler load of every element of which compression is allowed, None for the others [N]."""
    loads = euler_load(arrays.EI, arrays.L)
    return [float(load) if np.isinf(limit) else None for load, limit in zip(loads, arrays.limit, strict=True)]


@dataclass(frozen=True)
class Pushed:
    """The element whose compression exceeds its Euler load most. Forces [N], arc_length from end a [m]."""

    compression: float
    limit: float
    arc_length: float

    def sentence(self, name: str, when: str) -> str:
        return (
            f"line {name!r}, {self.arc_length:.4g} m from end a: {when} the compression is {self.compression / 1e3:.3g} kN, "
            f"above the Euler load of the element, {self.limit / 1e3:.3g} kN; a line buckles there, this one pushes because "
            "its line type says compression: allowed; compare with compression: none"
        )


def pushed(limits: list[float | None], least: Array, largest: float, arc: list[float]) -> Pushed | None:
    """The worst of the elements that push, None where none exceeds its Euler load.

    limits : as `push_limits`; least : (N,) least axial force; largest : tension on the line; arc : of the elements.
    """
    loads = np.array([np.inf if load is None else load for load in limits])
    excess = -np.asarray(least) - loads - NOTHING * abs(largest)
    worst = int(np.argmax(excess))
    if not excess[worst] > 0.0:
        return None
    return Pushed(-float(least[worst]), float(loads[worst]), float(arc[worst]))


def static_warnings(line: LineModel, tension: Array) -> list[str]:
    """What to say of the axial forces (N,) of a line in equilibrium."""
    slack = int(np.count_nonzero(slack_elements(line.arrays, tension)))
    out = []
    if slack:
        out.append(
            f"line {line.name!r}: {slack} of {tension.size} elements are slack in static equilibrium (lowest tension "
            f"{tension.min() / 1e3:.3g} kN); a folded shape need not be the only one: check length and ends"
        )
    found = pushed(push_limits(line.arrays), tension, float(tension.max()), line.element_arc.tolist())
    if found is not None:
        out.append(found.sentence(line.name, "in static equilibrium"))
    return out
