"""Values of one line as users read them first: largest tension with its place, utilisation, length on the bed."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..case import Case
from ..forces.seabed import spring_forces
from ..model.line import LineModel

Array = np.ndarray
LIES = 0.5  # share of a node's weight that the bed carries where a line lies
END_LIES = 1.0  # diameters over the bed up to which the half element at a held end lies when its neighbour does


def along_with_ends(line: LineModel, elements: Array, end_a: float, end_b: float) -> tuple[Array, Array]:
    """Arc lengths and tensions from end a to end b, the ends' own among them: (N+2,) [m], (N+2,) [N].

    elements : (N,) axial force at the middle of each element; end_a, end_b : whole force on the supports [N].
    """
    arc = np.concatenate([[0.0], line.element_arc, [line.length]])
    return arc, np.concatenate([[end_a], elements, [end_b]])


def largest(line: LineModel, elements: Array, end_a: float, end_b: float) -> dict[str, float]:
    """The largest tension of a line and where it is: `tension` [N], `arc_length` from end a [m]."""
    arc, values = along_with_ends(line, elements, end_a, end_b)
    place = int(np.argmax(values))
    return {"tension": float(values[place]), "arc_length": float(arc[place])}


def breaking_loads(case: Case, line: LineModel) -> Array:
    """Breaking load at end a, in every element, at end b, (N+2,) [N]; NaN where the line type does not say."""
    loads = [
        np.nan if (load := case.line_types[name].breaking_load) is None else float(load) for name in element_types(line)
    ]
    return np.array([loads[0], *loads, loads[-1]])


def element_types(line: LineModel) -> list[str]:
    """The line type of every element, from end a."""
    counts = line.segment_elements
    return [segment.type for segment, count in zip(line.spec.segments, counts, strict=True) for _ in range(count)]


def utilisation(case: Case, line: LineModel, elements: Array, end_a: float, end_b: float) -> dict[str, Any]:
    """`utilisation`, the largest ratio of tension to the breaking load of the same place; {} where no load is given."""
    loads = breaking_loads(case, line)
    if np.all(np.isnan(loads)):
        return {}
    _, values = along_with_ends(line, elements, end_a, end_b)
    return {"utilisation": float(np.nanmax(values / loads))}


def contact_shares(line: LineModel, shape: Array) -> Array:
    """Share of each node's weight in water that the bed carries, 0…1, (N+1,) (L21)."""
    arrays = line.arrays
    weight = node_weights(line)
    heavy = weight > 0.0
    share = np.where(heavy, np.clip(spring_forces(arrays, shape) / np.where(heavy, weight, 1.0), 0.0, 1.0), 0.0)
    for end, neighbour, diameter in ((0, 1, arrays.D[0]), (-1, -2, arrays.D[-1])):
        lies = shape[end, 2] - arrays.depth <= END_LIES * diameter
        share[end] = share[neighbour] if lies else 0.0
    return share


def node_weights(line: LineModel) -> Array:
    """Weight in water of each node's share of the line, without attachments, (N+1,) [N]."""
    net = np.concatenate([[0.0], line.arrays.w_dry - line.arrays.b_wet, [0.0]])
    return 0.5 * (net[1:] + net[:-1])


def grounded_length(line: LineModel, shape: Array) -> float:
    """Length of line whose weight the bed carries by half or more, the share linear along each element [m] (L21)."""
    share = contact_shares(line, shape)
    low, high = np.minimum(share[1:], share[:-1]), np.maximum(share[1:], share[:-1])
    span = np.maximum(high - low, 1e-12)
    return float(line.arrays.L @ np.clip((high - LIES) / span, 0.0, 1.0))
