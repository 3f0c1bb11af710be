"""Line forces, one per file. Each has `force(line, x, v, u, a, out)` and `tangent(line, x, v, u, K, B)`.

line : LineArrays; x, v : node positions and velocities, shape (N+1, 3); u, a : velocity and acceleration of the water at
the nodes without the current; out : forces on the nodes, added to; K, B : banded -∂F/∂x and -∂F/∂v, added to.

`REGISTRY` serves the tests, which hold every member to the same contract; solvers call the fixed list in
`solver.model.system`.
"""

from . import axial, bending, drag, inertia, seabed, weight

REGISTRY = {
    "axial": axial,
    "bending": bending,
    "weight": weight,
    "drag": drag,
    "inertia": inertia,
    "seabed": seabed,
}
