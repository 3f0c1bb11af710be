"""Natural frequencies of the vessel on lines that follow it quasi-statically, and those that slow drift does not reach."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..case.quantities import DOF
from ..model.build import Model
from ..model.linear import line_geometry
from ..statics.newton import vessel_coupling
from ..statics.solve import StaticState
from ..vessel.data.interpolate import linear
from ..waves.spectra import hs_in_band, significant_height
from .equivalent import equivalent_coefficients

Array = np.ndarray
START, POINTS = 0.02, 30  # rad/s, and frequencies from there to the end of the wave band at which added mass is taken
ROUNDS = 30
SETTLED = 1e-6
CALM = (
    0.05  # of the waves' energy: a mode with less of it below its frequency answers to slow drift rather than to waves
)


def unreached_modes(model: Model, static: StaticState) -> tuple[str, ...]:
    """Warnings of natural modes that lie above the difference frequencies of the slow drift, where waves are small."""
    seas, vessel = model.case.environment.random, model.vessel
    if vessel is None or not vessel.has_drift or not seas:
        return ()
    energy = sum(significant_height(sea) ** 2 for sea in seas)
    found = []
    for omega, label in vessel_modes(model, static):
        share = sum(hs_in_band(sea, 0.0, omega) ** 2 for sea in seas) / energy
        if omega > vessel.difference_to * (1 + 1e-9) and (omega < vessel.band[0] or share < CALM):
            found.append(_sentence(label, omega, vessel.difference_to, share, vessel.drift))
    return tuple(found)


def _sentence(label: str, omega: float, to: float, share: float, drift: str) -> str:
    mode = (
        f"slow drift: the natural mode of {label}, {2 * np.pi / omega:.3g} s or {omega:.3g} rad/s, lies above the highest "
        f"difference frequency"
    )
    calm = (
        f"the waves have {100 * share:.2g} % of their energy below that frequency (threshold {100 * CALM:g} %), so that "
        f"second-order response there may matter and is left out"
    )
    if drift == "qtf":
        remedy = "raise analyses.frequency_domain.difference.to, or compute more pairs of the QTF"
        return f"{mode}, {to:.3g} rad/s; {calm}; {remedy}"
    remedy = (
        "use a full QTF, drift: qtf (Newman's approximation is good near equal frequencies only; a higher "
        "analyses.frequency_domain.low.to takes it further, at the cost of accuracy)"
    )
    return f"{mode} of drift: {drift}, low.to = {to:.3g} rad/s; {calm}; {remedy}"


def vessel_modes(model: Model, static: StaticState) -> list[tuple[float, str]]:
    """Undamped natural frequencies of the vessel [rad/s] and their motions, rising (M3, M7).

    Added mass is linear between POINTS frequencies and held beyond them.
    """
    body, vessel = static.body, model.vessel
    if body is None or vessel is None:
        return []
    geometries = [line_geometry(line, x) for line, x in zip(static.lines, static.state.shapes, strict=True)]
    couplings = [vessel_coupling(line, body, static.position) for line in static.lines]
    still = [np.zeros((g.x.shape[0], 3, 3)) for g in geometries]
    lines = equivalent_coefficients(geometries, still, couplings, np.zeros((6, 6)))
    stiffness = body.stiffness(static.position) + lines.stiffness
    for line, force in zip(static.lines, static.state.end_forces, strict=True):
        for row, end in enumerate(line.ends):
            if end.kind == "fairlead" and end.arm is not None:
                at_end = force[3 * row : 3 * row + 3]
                stiffness = stiffness + line.multiplicity * body.geometric(static.position, end.arm, at_end)
    omega = np.geomspace(START, max(vessel.band[1], 2 * START), POINTS)
    own = vessel.dynamic(omega, float(static.position[5]), np.zeros(6)).real
    masses = lines.inertia - own / omega[:, None, None] ** 2

    def mass(at: float) -> Array:
        return linear(np.array([at]), omega, masses)[0]

    return sorted(_frequencies(0.5 * (stiffness + stiffness.T), mass))


def _frequencies(stiffness: Array, mass) -> Iterator[tuple[float, str]]:  # type: ignore[no-untyped-def]
    """Each stable mode at the added mass of its own frequency, followed by its shape; modes that do not settle are left out."""
    try:
        values, vectors = _eigen(stiffness, mass(START))
        for value, vector in zip(values, vectors.T, strict=True):
            omega, shape = float(np.sqrt(max(value, 0.0))), vector
            for _ in range(ROUNDS if omega > 0.0 else 0):
                M = mass(omega)
                found, shapes = _eigen(stiffness, M)
                best = int(np.argmax(np.abs(shapes.T @ M @ shape)))
                before, omega, shape = omega, float(np.sqrt(max(found[best], 1e-12))), shapes[:, best]
                if abs(omega - before) < SETTLED * omega:
                    yield omega, DOF[int(np.argmax(shape * (M @ shape)))]
                    break
    except np.linalg.LinAlgError:
        return  # a mass that is not positive: the checks of the data say so


def _eigen(stiffness: Array, mass: Array) -> tuple[Array, Array]:
    """Eigenvalues, rising, and mass-normal vectors (6, 6) of K x = λ M x."""
    root = np.linalg.inv(np.linalg.cholesky(0.5 * (mass + mass.T)))
    values, vectors = np.linalg.eigh(root @ stiffness @ root.T)
    return values, root.T @ vectors
