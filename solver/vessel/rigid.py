"""The rigid body about its centre of gravity: mass, linear damping, hydrostatics, and the turn into earth axes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..case.environment import Environment
from ..case.vessel import Vessel
from ..outcome import CaseError, DataError, FieldError
from .data import HydrodynamicData

Array = np.ndarray
WATER_TOLERANCE = 0.005  # of density and gravity, between the case and the data
DEPTH_TOLERANCE = 0.05


def about_cg(data: HydrodynamicData, vessel: Vessel) -> HydrodynamicData:
    """The data about the vessel's centre of gravity, in its own axes, A and B symmetric (V1, V2).

    When the file does not say its reference point, vessel.hydrodynamics.reference_point stands in.
    """
    if not data.reference_known and vessel.hydrodynamics is not None:
        data = replace(data, reference_point=np.array(vessel.hydrodynamics.reference_point), reference_known=True)
    return data.symmetric().moved_to(np.array(vessel.centre_of_gravity))


def mass_matrix(vessel: Vessel) -> Array:
    """Mass and moments of inertia about the CG in body axes, (6, 6) [kg, kg m2], without added mass (V8)."""
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = vessel.mass * np.eye(3)
    if vessel.inertia is not None:
        matrix[3:, 3:] = vessel.inertia
    elif vessel.radii_of_gyration is not None:
        matrix[3:, 3:] = vessel.mass * np.diag(np.square(np.array(vessel.radii_of_gyration)))
    moments = np.linalg.eigvalsh(0.5 * (matrix[3:, 3:] + matrix[3:, 3:].T))
    gap = np.abs(matrix - matrix.T).max()
    asymmetric = gap > 1e-6 * np.abs(matrix[3:, 3:]).max()
    if asymmetric or moments[0] <= 0 or moments[2] > (moments[0] + moments[1]) * (1 + 1e-9):
        field = "inertia" if vessel.inertia is not None else "radii_of_gyration"
        raise CaseError([FieldError(
            ("vessel", field), "no body has these moments of inertia: they must be symmetric, positive, and none "
            "larger than the sum of the other two",
        )])  # fmt: skip
    return matrix


def linear_damping(vessel: Vessel) -> Array:
    """B_V about the CG in body axes, (6, 6) [N s/m, N m s]: the diagonal plus the full matrix of the case."""
    matrix = np.diag(np.array(vessel.damping.linear.values(), dtype=float))
    if vessel.damping.linear_matrix is not None:
        matrix = matrix + np.array(vessel.damping.linear_matrix)
    return matrix


def hydrostatic_stiffness(vessel: Vessel, data: HydrodynamicData | None) -> Array:
    """K_V about the CG in body axes, (6, 6) [N/m … N m], without lines: the case's own, or the file's (V9).

    The weight acts at the CG and gives no moment about it, so that K44 = ρg (I_xx + V (z_B - z_G)) whatever the mass. A
    file whose weight stood at another height is corrected by ρg V times the difference (V10).
    Raises CaseError when neither the case nor the file has one.
    """
    if vessel.hydrostatics.stiffness is not None:
        return np.array(vessel.hydrostatics.stiffness)
    if data is None or data.hydrostatic_stiffness is None:
        raise CaseError([FieldError(
            ("vessel", "hydrostatics", "stiffness"),
            "the hydrodynamic data hold no hydrostatic_stiffness; give it here",
        )])  # fmt: skip
    stiffness: Array = about_cg(data, vessel).hydrostatic_stiffness.copy()  # type: ignore[union-attr]
    if data.centre_of_mass is None:
        return stiffness
    height = float(data.centre_of_mass[2] - vessel.centre_of_gravity[2])
    if abs(height) > 1e-9:
        moment = data.density * data.gravity * displaced_volume(vessel, data) * height
        stiffness[3, 3] += moment
        stiffness[4, 4] += moment
    return stiffness


def displaced_volume(vessel: Vessel, data: HydrodynamicData | None) -> float:
    """Displaced volume in the design position [m3]: the case's own, or the file's. Raises CaseError without one."""
    if vessel.hydrostatics.displaced_volume is not None:
        return vessel.hydrostatics.displaced_volume
    if data is not None and data.displaced_volume is not None:
        return data.displaced_volume
    raise CaseError([FieldError(
        ("vessel", "hydrostatics", "displaced_volume"),
        "the hydrodynamic data do not say the displaced volume; give it here",
    )])  # fmt: skip


def buoyancy_minus_weight(vessel: Vessel, data: HydrodynamicData | None, environment: Environment) -> Array:
    """Buoyancy and weight in the design position about the CG, body axes, (6,) [N, N m] (V11).

    For trim: as_given. The centre of buoyancy is the file's; without one it stands straight below the CG.
    """
    density, gravity = environment.water.density, environment.water.gravity
    lift = density * gravity * displaced_volume(vessel, data)
    force = np.zeros(6)
    force[2] = lift - vessel.mass * gravity
    if data is not None and data.centre_of_buoyancy is not None:
        x, y, _ = data.centre_of_buoyancy - np.array(vessel.centre_of_gravity)
        force[3], force[4] = lift * y, -lift * x
    return force


def water_warnings(data: HydrodynamicData, environment: Environment, lowest: float) -> tuple[str, ...]:
    """Sentences where density, gravity or depth of the data differ from the case's; the data are used as they are.

    lowest : lowest wave frequency of the analysis [rad/s]; where its wave does not feel the bottom, depth is no matter.
    """
    water, found = environment.water, []
    for what, ours, theirs, unit in (
        ("density", water.density, data.density, "kg/m3"),
        ("gravity", water.gravity, data.gravity, "m/s2"),
    ):
        if abs(ours - theirs) > WATER_TOLERANCE * ours:
            found.append(
                f"{data.name}: the data are for a {what} of {theirs:g} {unit}, the case has {ours:g} (threshold "
                f"{100 * WATER_TOLERANCE:g} %); compute them for the case's water"
            )
    deep = water.gravity * math.pi / lowest**2  # half the longest wave
    ours, theirs = environment.depth, data.depth
    if min(ours, theirs) < deep and abs(1 / ours - 1 / theirs) > DEPTH_TOLERANCE / min(ours, theirs):
        found.append(
            f"{data.name}: the data are for a depth of {theirs:g} m, the case has {ours:g} m, and waves of "
            f"{lowest:g} rad/s feel the bottom (depth below {deep:.0f} m); compute them for the case's depth"
        )
    return tuple(found)


def turning(yaw: float) -> Array:
    """R (6, 6): components in earth axes from components in axes turned by yaw [rad] about the vertical (V12)."""
    c, s = math.cos(yaw), math.sin(yaw)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    result = np.zeros((6, 6))
    result[:3, :3] = result[3:, 3:] = rotation
    return result


def turned(values: Array, yaw: float) -> Array:
    """A matrix (..., 6, 6), R M Rᵀ, from axes turned by yaw [rad] into earth axes (V12)."""
    if yaw == 0.0:
        return values
    r = turning(yaw)
    return np.asarray(r @ values @ r.T)


def turned_force(values: Array, yaw: float) -> Array:
    """Vectors (..., 6), forces or motions, from axes turned by yaw [rad] into earth axes (V12)."""
    if yaw == 0.0:
        return values
    return np.asarray(values @ turning(yaw).T)


def need_data(data: HydrodynamicData | None, what: str) -> HydrodynamicData:
    """The data, or a DataError that says what they are needed for."""
    if data is None:
        raise DataError(f"{what} needs hydrodynamic data; give vessel.hydrodynamics.data")
    return data
