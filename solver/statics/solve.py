"""Statics of a whole case: placed lines, trim, then equilibrium under steady loads (docs/theory.md, S10-S12)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..case.section import floating_lines
from ..forces import axial
from ..model.body import VesselBody
from ..model.build import Model
from ..model.line import LineModel, has_current
from ..model.slack import static_warnings
from ..vessel.balance import balance_warnings
from ..vessel.rigid import turned_force
from .drift import DriftingBody
from .newton import State, equilibrium
from .pretension import place

Array = np.ndarray


@dataclass(frozen=True)
class StaticState:
    """An equilibrium and what holds it.

    lines : with anchors and lengths found; state : shapes [m], vessel position (6,) and end forces (6,) on the supports.
    body : the vessel with its constant loads, None without one; drift : mean wave drift force (6,) [N, N m].
    """

    lines: tuple[LineModel, ...]
    state: State
    body: VesselBody | None
    drift: Array
    warnings: tuple[str, ...] = ()

    @property
    def position(self) -> Array:
        return self.state.position


def design_state(model: Model) -> StaticState:
    """Lines placed and solved with the vessel held in the design position, still water, and the trim load found (S10).

    Raises CaseError when a wanted pretension cannot be had, NotConverged when an iteration fails.
    """
    spec = model.statics
    placed = [place(model.case, line, model.frame, spec.tolerance, spec.max_iterations) for line in model.lines]
    lines = tuple(line for line, _ in placed)
    shapes, forces = [state.shapes[0] for _, state in placed], [state.end_forces[0] for _, state in placed]
    tensions = [state.tensions[0] for _, state in placed]
    iterations = max((state.iterations for _, state in placed), default=0)
    state = State(shapes, np.zeros(6), forces, iterations, 0.0, True, tensions)
    body = model.vessel.body if model.vessel is not None else None
    if body is not None and model.vessel is not None:
        body = body.with_constant(model.vessel.steady_load + _trim(model, lines, forces, body))
    return StaticState(lines, state, body, np.zeros(6))


def _trim(model: Model, lines: Sequence[LineModel], forces: Sequence[Array], body: VesselBody) -> Array:
    """`balanced`: the heave, roll and pitch load that holds the design position; `as_given`: buoyancy minus weight (S10)."""
    assert model.vessel is not None
    if not model.vessel.balanced:
        return model.vessel.buoyancy_minus_weight
    load = -_pull(lines, forces, body, np.zeros(6))
    return np.array([0.0, 0.0, load[2], load[3], load[4], 0.0])


def _pull(lines: Sequence[LineModel], forces: Sequence[Array], body: VesselBody, position: Array) -> Array:
    """Force and moment of all lines on the vessel about its CG, frame axes (6,) [N, N m]."""
    pull = np.zeros(6)
    for line, force in zip(lines, forces, strict=True):
        for row, end in enumerate(line.ends):
            if end.kind == "fairlead" and end.arm is not None:
                at_end = force[3 * row : 3 * row + 3]
                pull += line.multiplicity * body.arm_matrix(position, end.arm).T @ at_end
    return pull


def _balance(model: Model, lines: Sequence[LineModel], state: State) -> list[str]:
    """What weight, buoyancy and the lines of an equilibrium say of the vessel's mass and centre."""
    if model.vessel is None or model.case.vessel is None:
        return []
    pull = _pull(lines, state.end_forces, model.vessel.body, state.position) + model.vessel.steady_load
    own = turned_force(pull, -float(state.position[5]))
    return balance_warnings(model.case.vessel, model.data, model.case.environment, own)


def settle(model: Model, start: StaticState, extra: Sequence[Array] | None = None) -> StaticState:
    """Equilibrium under current, constant loads, mean drift and `extra` nodal loads, from a starting state (S11).

    extra : loads on the nodes of each line beyond its static forces (N+1, 3) [N]: mean drag less the current's own.

    The mean drift depends on the yaw it causes; both are found together.
    """
    spec = model.statics
    loads = list(extra) if extra is not None else [np.zeros((line.nodes, 3)) for line in start.lines]
    state, drift = start.state, np.zeros(6)
    if start.body is None:
        state = _lines_alone(start.lines, state, loads, spec.tolerance, spec.max_iterations)
    elif not np.any(model.mean_drift(float(state.position[5]))):
        state = equilibrium(start.lines, state, loads, start.body, spec.tolerance, spec.max_iterations)
    else:
        body = DriftingBody(start.body, model.mean_drift)
        state = equilibrium(start.lines, state, loads, body, spec.tolerance, spec.max_iterations)
        drift = body.drift(float(state.position[5]))
    return replace(start, state=state, drift=drift, warnings=_warnings(model, start.lines, state))


def _lines_alone(
    lines: Sequence[LineModel], state: State, loads: Sequence[Array], tolerance: float, most: int
) -> State:
    solved = [
        equilibrium([line], State([shape], np.zeros(6), tensions=[tension]), [load], None, tolerance, most)
        for line, shape, load, tension in zip(lines, state.shapes, loads, state.tensions, strict=True)
    ]
    return State(
        [one.shapes[0] for one in solved], state.position, [one.end_forces[0] for one in solved],
        max((one.iterations for one in solved), default=0), max((one.residual for one in solved), default=0.0), True,
        [one.tensions[0] for one in solved],
    )  # fmt: skip


def _warnings(model: Model, lines: Sequence[LineModel], state: State) -> tuple[str, ...]:
    found: list[str] = []
    if state.unstable:
        found.append(
            f"the vessel's static equilibrium is unstable in {state.unstable}: its stiffness with all lines and the slope of "
            "the mean drift has a negative eigenvalue; check the centre of gravity and hydrostatics (roll, pitch, heave) or "
            "give a stiffer mooring, another heading, or mean_drift: exclude (surge, sway, yaw)"
        )
    if model.vessel is not None:
        found += model.vessel.drift_warnings(model.wave_systems, float(state.position[5]))
    found += _balance(model, lines, state)
    found += floating_lines(model.case, {line.name: line.length for line in lines})
    for line, shape in zip(lines, state.shapes, strict=True):
        tension = axial.tension(line.arrays, shape)
        found += static_warnings(line, tension)
        if np.any(shape[:, 2] > 0) and np.any(shape[:, 2] < 0) and has_current(line.arrays):
            found.append(f"line {line.name!r} pierces the surface in a current; the dry part carries no drag")
    return tuple(found)


def solve_statics(model: Model) -> StaticState:
    """Design position, then equilibrium. Raises as `design_state` and `settle`."""
    return settle(model, design_state(model))
