"""Whether the vessel of a case is the one of its data: mass and centre of gravity against the displaced water (V11)."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..case import Case
from ..case.environment import Environment
from ..case.vessel import Vessel
from ..outcome import CaseError
from .data import HydrodynamicData
from .rigid import displaced_volume, hydrostatic_stiffness, turning

Array = np.ndarray
UNLIKE = 0.05
"""Of the displaced mass, and of the radius of gyration of the waterplane: a difference beyond it is warned of."""
CLOSED = 0.02
"""The same, of what is left when the pull of the lines is counted: a difference that closes so far is no fault."""


def balance_warnings(
    vessel: Vessel, data: HydrodynamicData | None, environment: Environment, pull: Array | None
) -> list[str]:
    """What does not balance in the design position: weight and centre of gravity against the buoyancy of the data (V11).

    pull : force and moment of the lines and of constant_load on the vessel about its CG, body axes (6,) [N, N m]; None
    while it is not known: then only a mass too large is said, which no pull downward explains.
    """
    try:
        volume = displaced_volume(vessel, data)
    except CaseError:
        return []
    held = volume * float(environment.water.density)
    gap = vessel.mass - held
    if pull is None:
        unexplained = gap > 0
    else:
        unexplained = abs(gap - float(pull[2]) / float(environment.water.gravity)) > CLOSED * held
    found = []
    if abs(gap) > UNLIKE * held and unexplained:
        found.append(
            f"vessel.mass is {vessel.mass:.5g} kg, its hull displaces {held:.5g} kg of water ({volume:.5g} m3): "
            f"{100 * gap / held:+.3g} % (threshold {100 * UNLIKE:g} %), and the pull of the lines does not close it within "
            f"{100 * CLOSED:g} %; check the mass and the draught of the data{_held(vessel, 'force')}"
        )
    if data is not None and data.centre_of_buoyancy is not None and pull is not None:
        found += _centres(vessel, data, held * float(environment.water.gravity), pull)
    return found


def _held(vessel: Vessel, what: str) -> str:
    return "" if vessel.trim == "as_given" else f" (trim: balanced makes up for it by a constant {what})"


def constant_pull(case: Case) -> Array | None:
    """The pull of `balance_warnings` where it needs no statics: constant_load of a vessel without lines; else None."""
    if case.vessel is None or case.lines:
        return None
    return np.asarray(turning(-float(case.vessel.heading)) @ np.array(case.vessel.constant_load.values()))


def _centres(vessel: Vessel, data: HydrodynamicData, lift: float, pull: Array) -> Iterator[str]:
    """Centre of gravity against centre of buoyancy along x and y; the lines' moment over the lift stands for a distance."""
    assert data.centre_of_buoyancy is not None
    away = data.centre_of_buoyancy - np.array(vessel.centre_of_gravity)
    moved = (float(pull[4]) / lift, -float(pull[3]) / lift)
    for axis, name in enumerate("xy"):
        radius = _waterplane_radius(vessel, data, float(away[2]), 4 - axis)
        gap = float(away[axis])
        if abs(gap) > UNLIKE * radius and abs(gap - moved[axis]) > CLOSED * radius:
            yield (
                f"vessel.centre_of_gravity: {name} is {vessel.centre_of_gravity[axis]:.4g} m, {-gap:+.4g} m from the centre of "
                f"buoyancy of {data.name} (threshold: {100 * UNLIKE:g} % of {radius:.4g} m, the waterplane's radius of "
                f"gyration), and the pull of the lines does not close it within {100 * CLOSED:g} %; check both"
                f"{_held(vessel, 'moment')}"
            )


def _waterplane_radius(vessel: Vessel, data: HydrodynamicData, height: float, dof: int) -> float:
    """√(I/A) of the waterplane about the axis of roll (dof 3) or pitch (4) through the CG, from K33 and K44 or K55 (V9) [m].

    height : z_B - z_G [m]. Without a waterplane that resists, the cube root of the displaced volume.
    """
    stiffness, volume = hydrostatic_stiffness(vessel, data), displaced_volume(vessel, data)
    heave = float(stiffness[2, 2])
    moment = float(stiffness[dof, dof]) - data.density * data.gravity * volume * height
    return math.sqrt(moment / heave) if heave > 0 and moment > 0 else volume ** (1 / 3)


def current_warnings(case: Case) -> list[str]:
    """A current that acts on the lines of a case with a vessel, but not on its hull."""
    vessel, current = case.vessel, case.environment.current
    if vessel is None or current is None or not any(current.speeds):
        return []
    load = vessel.constant_load
    if load.surge or load.sway or load.yaw:
        return []
    return ["environment.current acts on the lines only, not on the hull; give its load there as vessel.constant_load"]
