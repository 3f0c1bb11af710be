"""The one class of hydrodynamic data, whatever file it came from."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...outcome import DataError
from .interpolate import NEAR, check_range, heading_weights, linear, spans_circle
from .pchip import pchip
from .qtf import QTF

Array = np.ndarray


@dataclass(frozen=True)
class HydrodynamicData:
    """First- and second-order hydrodynamics of one body: SI, radians, time factor e^{+i omega t}.

    Degrees of freedom are surge … yaw about `reference_point`, in the body's axes, which are the earth's in the design
    position at zero heading. Wave elevation and headings refer to the origin of those axes; a heading is the direction
    the wave travels TO, counter-clockwise from the body's x axis.

    omega : (W,) rising, > 0 and finite; headings : (H,) rising in [0, 2π).
    added_mass, damping : (W, 6, 6); added_mass_zero, added_mass_infinite : (6, 6) or None.
    excitation : complex (W, H, 6), Froude-Krylov plus diffraction per unit amplitude [N/m, N m/m].
    excitation_zero : real limit at omega = 0, (H, 6), or None.
    mean_drift : (W, H, 6) force in a regular wave per amplitude squared [N/m2, N m/m2], or None; at frequencies and
    headings of its own, mean_drift_omega and mean_drift_headings, where they are not None.
    motions : complex (W, H, 6) per unit amplitude as the file says them [m/m, rad/m], or None; no analysis uses them.
    hydrostatic_stiffness : (6, 6) of the body in equilibrium with its weight at `centre_of_mass`, or None.
    displaced_volume [m3], centre_of_buoyancy, centre_of_mass (3,) [m] in body axes, None when the file does not say.
    reference_known : False when the file does not say where its reference point is (then (0, 0, 0) stands here).
    Matrices are as the file has them; `about_cg` makes A and B symmetric. depth [m] may be inf. content_hash : SHA-256
    of the file, or of the manifest of a set. provenance : format, files, conventions, what was assumed; plain JSON.
    """

    name: str
    content_hash: str
    omega: Array
    headings: Array
    added_mass: Array
    damping: Array
    excitation: Array
    added_mass_zero: Array | None
    added_mass_infinite: Array | None
    excitation_zero: Array | None
    mean_drift: Array | None
    hydrostatic_stiffness: Array | None
    displaced_volume: float | None
    centre_of_buoyancy: Array | None
    centre_of_mass: Array | None
    reference_point: Array
    density: float
    gravity: float
    depth: float
    qtf: QTF | None = None
    reference_known: bool = True
    warnings: tuple[str, ...] = ()
    mean_drift_omega: Array | None = None
    mean_drift_headings: Array | None = None
    motions: Array | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        w, h = self.omega.size, self.headings.size
        if w == 0 or self.omega[0] <= 0 or np.any(np.diff(self.omega) <= 0) or not np.all(np.isfinite(self.omega)):
            raise DataError(f"{self.name}: frequencies must rise from above 0 and be finite; got {w} of them")
        expected = {
            "added_mass": (w, 6, 6), "damping": (w, 6, 6), "excitation": (w, h, 6), "added_mass_zero": (6, 6),
            "added_mass_infinite": (6, 6), "excitation_zero": (h, 6), "motions": (w, h, 6),
            "mean_drift": (self.drift_omega.size, self.drift_headings.size, 6),
            "hydrostatic_stiffness": (6, 6), "centre_of_buoyancy": (3,), "centre_of_mass": (3,),
            "reference_point": (3,),
        }  # fmt: skip
        for attribute, shape in expected.items():
            value = getattr(self, attribute)
            if value is not None and value.shape != shape:
                raise DataError(f"{self.name}: {attribute} has shape {value.shape}; expected {shape}")
            if value is not None and not np.all(np.isfinite(value)):
                raise DataError(f"{self.name}: {attribute} holds values that are not finite; compute them again")

    @property
    def drift_omega(self) -> Array:
        """Frequencies of the mean drift [rad/s]."""
        return self.omega if self.mean_drift_omega is None else self.mean_drift_omega

    @property
    def drift_headings(self) -> Array:
        """Headings of the mean drift [rad]."""
        return self.headings if self.mean_drift_headings is None else self.mean_drift_headings

    @property
    def nbytes(self) -> int:
        """Bytes of all arrays."""
        tables = [value for value in vars(self).values() if isinstance(value, np.ndarray)]
        if self.qtf is not None:
            tables += [self.qtf.values, *self.qtf.cross.values()]
        return sum(table.nbytes for table in tables)

    # --- evaluation

    def excitation_at(self, omega: Array, heading: float) -> Array:
        """First-order force per unit wave amplitude at omega (W,) [rad/s] and one heading [rad]: complex (W, 6) (V4).

        Linear in the real and imaginary parts over frequency and heading; below the lowest frequency towards the
        long-wave limit, the file's own at omega = 0, or the hydrostatic one (V5). Raises DataError outside the data.
        """
        omega = np.atleast_1d(np.asarray(omega, dtype=float))
        i, j, w = heading_weights(self.headings, heading, self.name)
        values = (1.0 - w) * self.excitation[:, i] + w * self.excitation[:, j]
        nodes, zero = self.omega, self._long_waves()
        if zero is not None:
            values = np.concatenate([((1.0 - w) * zero[i] + w * zero[j])[None], values])
            nodes = np.concatenate([[0.0], nodes])
        check_range(omega, float(nodes[0]), float(nodes[-1]), self.name, "the wave excitation")
        return linear(omega, nodes, values)

    def _long_waves(self) -> Array | None:
        if self.excitation_zero is not None:
            return self.excitation_zero
        if self.hydrostatic_stiffness is None:
            return None
        return np.broadcast_to(self.hydrostatic_stiffness[:, 2], (self.headings.size, 6))

    def radiation_at(self, omega: Array) -> tuple[Array, Array]:
        """Added mass and damping at omega (W,) [rad/s]: two arrays (W, 6, 6) (V6).

        Shape-preserving cubics (PCHIP) through the data and, at omega = 0, added_mass_zero and no damping. Raises
        DataError above the data, and below them when there is no zero-frequency added mass.
        """
        omega = np.atleast_1d(np.asarray(omega, dtype=float))
        nodes, added_mass, damping = self.radiation_nodes()
        check_range(omega, float(nodes[0]), float(nodes[-1]), self.name, "added mass and damping")
        omega = np.clip(omega, nodes[0], nodes[-1])
        if nodes.size == 1:
            return np.repeat(added_mass, omega.size, axis=0), np.repeat(damping, omega.size, axis=0)
        both = np.stack([added_mass, damping], axis=1)
        found = pchip(nodes, both, omega)
        return found[:, 0], found[:, 1]

    def radiation_nodes(self) -> tuple[Array, Array, Array]:
        """Frequencies, added mass and damping of the data, with omega = 0 in front when it is known."""
        if self.added_mass_zero is None:
            return self.omega, self.added_mass, self.damping
        return (
            np.concatenate([[0.0], self.omega]),
            np.concatenate([self.added_mass_zero[None], self.added_mass]),
            np.concatenate([np.zeros((1, 6, 6)), self.damping]),
        )

    def mean_drift_at(self, omega: Array, heading: float, far: bool = False) -> Array:
        """Mean drift force per amplitude squared at omega (any shape (...)) and one heading: (..., 6) (V7).

        Linear over frequency and heading, and to zero at omega = 0 as a long wave scatters nothing. far : a heading
        outside the data is the nearest of the data, at any distance (V29). Raises DataError when the file has none, above
        its frequencies and outside its headings.
        """
        if self.mean_drift is None:
            raise DataError(
                f"{self.name}: the file has no mean_drift_force(omega, wave_direction, influenced_dof), which "
                f"Newman's approximation needs; add it to the file, or set vessel.hydrodynamics.drift to none"
            )
        omega = np.asarray(omega, dtype=float)
        i, j, w = heading_weights(self.drift_headings, heading, self.name, math.inf if far else NEAR)
        table = (1.0 - w) * self.mean_drift[:, i] + w * self.mean_drift[:, j]
        check_range(omega.ravel(), 0.0, float(self.drift_omega[-1]), self.name, "the mean drift force")
        nodes = np.concatenate([[0.0], self.drift_omega])
        result = np.zeros((*omega.shape, 6))
        for dof in np.flatnonzero(np.any(table != 0.0, axis=0)):
            result[..., dof] = np.interp(omega, nodes, np.concatenate([[0.0], table[:, dof]]))
        return result

    # --- another point of reference

    def moved_to(self, point: Array) -> HydrodynamicData:
        """The same body with its degrees of freedom about another point [m, body axes] (V1, V2).

        The phase of the excitation stays referred to the origin, and the stiffness keeps its centre of mass.
        """
        point = np.asarray(point, dtype=float)
        arm = point - self.reference_point
        if not np.any(arm):
            return self
        t = transport(arm)
        drift = self.mean_drift
        if drift is not None:
            horizontal = not np.any(drift[..., 2:5])  # a far-field force has no known height: it gives no roll, pitch
            drift = drift @ t
            if horizontal:
                drift[..., 2:5] = 0.0
        return replace(
            self,
            reference_point=point,
            reference_known=True,
            added_mass=t.T @ self.added_mass @ t,
            damping=t.T @ self.damping @ t,
            excitation=self.excitation @ t,
            added_mass_zero=_congruent(self.added_mass_zero, t),
            added_mass_infinite=_congruent(self.added_mass_infinite, t),
            excitation_zero=None if self.excitation_zero is None else self.excitation_zero @ t,
            mean_drift=drift,
            hydrostatic_stiffness=_congruent(self.hydrostatic_stiffness, t),
            qtf=None if self.qtf is None else self.qtf.moved(t),
            motions=None if self.motions is None else self.motions @ np.linalg.inv(t).T,
        )

    def symmetric(self) -> HydrodynamicData:
        """The same with added mass and damping made symmetric, as theory has them; itself when they are already."""
        edges = [edge for edge in (self.added_mass_zero, self.added_mass_infinite) if edge is not None]
        if all(np.array_equal(item, item.swapaxes(-1, -2)) for item in (self.added_mass, self.damping, *edges)):
            return self
        return replace(
            self,
            added_mass=_symmetric(self.added_mass),
            damping=_symmetric(self.damping),
            added_mass_zero=None if self.added_mass_zero is None else _symmetric(self.added_mass_zero),
            added_mass_infinite=None if self.added_mass_infinite is None else _symmetric(self.added_mass_infinite),
        )

    def describe(self) -> dict[str, Any]:
        """What the file holds, as plain JSON values: SI, angles in degrees for reading."""
        depth = float(self.depth)
        return {
            "name": self.name,
            "content_hash": self.content_hash,
            "frequencies": {"count": int(self.omega.size), "from": float(self.omega[0]), "to": float(self.omega[-1])},
            "has_zero_frequency": self.added_mass_zero is not None,
            "has_infinite_frequency": self.added_mass_infinite is not None,
            "headings_deg": [round(float(value), 6) for value in np.degrees(self.headings)],
            "headings_span_circle": spans_circle(self.headings),
            "mean_drift": self.mean_drift is not None,
            "qtf": None if self.qtf is None else self.qtf.describe(),
            "hydrostatic_stiffness": self.hydrostatic_stiffness is not None,
            "displaced_volume": self.displaced_volume,
            "reference_point": [float(value) for value in self.reference_point] if self.reference_known else None,
            "density": self.density,
            "gravity": self.gravity,
            "depth": depth if np.isfinite(depth) else None,
            "warnings": list(self.warnings),
            "provenance": self.provenance,
        }


def transport(arm: Array) -> Array:
    """T (6, 6): motions q_old = T q_new, forces F_new = Tᵀ F_old, the new point at `arm` [m] from the old (V1)."""
    x, y, z = arm
    t = np.eye(6)
    t[:3, 3:] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    return t


def _symmetric(matrix: Array) -> Array:
    result: Array = 0.5 * (matrix + np.swapaxes(matrix, -1, -2))
    return result


def _congruent(matrix: Array | None, t: Array) -> Array | None:
    return None if matrix is None else t.T @ matrix @ t
