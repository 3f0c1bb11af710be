"""The longest natural period of a moored vessel, with its lines reduced to its six coordinates (docs/theory.md, M7, M9)."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from ..case.quantities import DOF
from ..model.build import Model
from ..model.linear import line_geometry
from ..statics.newton import vessel_coupling
from ..statics.solve import StaticState
from .equivalent import equivalent_coefficients

Array = np.ndarray
ROUNDS = 20
START = 0.05  # rad/s: where added mass is taken at first


class Longest(TypedDict):
    """period [s] and the motion with the largest share of the kinetic energy."""

    period: float
    motion: str


def longest_period(model: Model, static: StaticState) -> Longest | None:
    """Of the coupled system about its static position (M9); None without a vessel or a mode of positive stiffness."""
    from scipy.linalg import eigh

    if model.vessel is None or static.body is None:
        return None
    inertia, stiffness = _reduced(static)
    yaw, omega = float(static.position[5]), START
    for _ in range(ROUNDS):
        own = -model.vessel.dynamic(np.array([omega]), yaw, np.zeros(6))[0].real / omega**2
        mass = 0.5 * (own + own.T) + inertia
        values, shapes = eigh(stiffness, mass)
        rising = np.flatnonzero(values > 0)
        if rising.size == 0:
            return None
        last, omega = omega, float(np.sqrt(values[rising[0]]))
        if abs(omega - last) < 1e-6 * omega:
            break
    shape = shapes[:, rising[0]]
    return {"period": 2 * np.pi / omega, "motion": DOF[int(np.argmax(shape * (mass @ shape)))]}


def _reduced(static: StaticState) -> tuple[Array, Array]:
    """Inertia of the lines, and stiffness of lines and vessel, in the vessel's coordinates (6, 6), symmetric."""
    body, position = static.body, static.position
    assert body is not None
    geometries = [line_geometry(line, x) for line, x in zip(static.lines, static.state.shapes, strict=True)]
    couplings = [vessel_coupling(line, body, position) for line in static.lines]
    still = [np.zeros((g.x.shape[0], 3, 3)) for g in geometries]
    stiffness = body.stiffness(position)
    for line, force in zip(static.lines, static.state.end_forces, strict=True):
        for row, end in enumerate(line.ends):
            if end.kind == "fairlead" and end.arm is not None:
                at_end = force[3 * row : 3 * row + 3]
                stiffness = stiffness + line.multiplicity * body.geometric(position, end.arm, at_end)
    equivalent = equivalent_coefficients(geometries, still, couplings, np.zeros((6, 6)))
    stiffness = stiffness + equivalent.stiffness
    return 0.5 * (equivalent.inertia + equivalent.inertia.T), 0.5 * (stiffness + stiffness.T)
