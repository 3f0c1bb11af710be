"""A line about its static shape: what the linear equations of motion need of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..forces.inertia import blocks
from ..forces.seabed import damping_blocks
from ..forces.weight import wet_half
from ..kernels.line import HALF
from .line import LineModel
from .system import stiffness

Array = np.ndarray


@dataclass(frozen=True)
class LineGeometry:
    """Linear properties of one line about its static shape.

    x : (N+1, 3) [m]; K : banded stiffness; M, C : (N+1, 3, 3) mass with added mass, factor of the water's acceleration.
    wet : (N+1, 2) wet share of the half elements before and after each node; bed : (N+1,) seabed damping [N s/m].
    plane : horizontal normal of the line's vertical plane; ends : columns of end motion kept; half : bandwidth in use.
    """

    line: LineModel
    x: Array
    K: Array
    M: Array
    C: Array
    wet: Array
    bed: Array
    plane: Array
    ends: int
    half: int


def line_geometry(line: LineModel, x: Array) -> LineGeometry:
    """The linearised line about nodes x (N+1, 3) [m]."""
    arrays = line.arrays
    M, C = blocks(arrays, x)
    nodes = line.nodes
    wet = np.zeros((nodes, 2))
    for i in range(nodes):
        if i > 0:
            wet[i, 0] = wet_half(x[i, 2], x[i - 1, 2], arrays.D[i - 1])[0]
        if i < nodes - 1:
            wet[i, 1] = wet_half(x[i, 2], x[i + 1, 2], arrays.D[i])[0]
    bed = damping_blocks(arrays, x)
    chord = x[-1] - x[0]
    flat = float(np.hypot(chord[0], chord[1]))
    plane = np.array([-chord[1], chord[0], 0.0]) / flat if flat > 1e-9 else np.array([0.0, 1.0, 0.0])
    moving = [end.kind != "fixed" for end in line.ends]
    ends = 6 if moving[1] else (3 if moving[0] else 0)
    half = HALF if np.any(arrays.kb > 0) else 5
    return LineGeometry(line, x, stiffness(arrays, x, True), M, C, wet, bed, plane, ends, half)
