"""Case and data → the vessel of the model: matrices about the CG, loads, and what waves do to it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from ..case import Case
from ..case.analysis import FrequencyDomain
from ..case.environment import RegularWave
from ..vessel.data import HydrodynamicData
from ..vessel.drift import Drift, drift_spectrum, mean_drift_force, mean_drift_regular, psd_factor
from ..vessel.excitation import excitation
from ..vessel.fit import difference_to, lowest_wave
from ..vessel.headings import off_the_headings
from ..vessel.quality import quality_warnings
from ..vessel.radiation import Radiation, make_radiation
from ..vessel.rigid import (
    about_cg,
    buoyancy_minus_weight,
    hydrostatic_stiffness,
    linear_damping,
    mass_matrix,
    turned,
    turning,
    water_warnings,
)
from ..waves.spectra import spectrum
from .body import VesselBody

Array = np.ndarray
TURNED = np.radians(2.0)  # static yaw above which quadratic damping unlike along and across is said not to turn with it
TURNED_ALIKE = 0.05


@dataclass(frozen=True)
class VesselModel:
    """The vessel about its CG, body axes, which are the frame's in the design position.

    mass, damping : (6, 6); quadratic : (6,) force per velocity squared; extra_inertia, extra_damping : of lines that
    are not modelled (6, 6); steady_load, buoyancy_minus_weight : (6,) in the frame.
    band : of the wave components; difference_to : highest difference frequency of slow drift [rad/s].
    """

    body: VesselBody
    mass: Array
    damping: Array
    quadratic: Array
    extra_inertia: Array
    extra_damping: Array
    steady_load: Array
    buoyancy_minus_weight: Array
    balanced: bool
    radiation: Radiation
    data: HydrodynamicData | None
    drift: Literal["none", "newman", "newman-geometric", "qtf"]
    band: tuple[float, float]
    difference_to: float

    @property
    def has_drift(self) -> bool:
        return self.drift != "none" and self.data is not None

    def dynamic(self, omega: Array, yaw: float, quadratic: Array) -> Array:
        """-ω²(M + A) + iωB of the vessel without its lines, turned by its static yaw (W, 6, 6) (F12).

        quadratic : (6,) linearised quadratic damping.
        """
        added, damping = self.radiation.at(omega)
        w = omega[:, None, None]
        inertia = self.mass + self.extra_inertia + added
        damping = damping + self.damping + self.extra_damping + np.diag(quadratic)
        return turned(-(w**2) * inertia + 1j * w * damping, yaw)

    def excitation(self, omega: Array, heading: float, yaw: float) -> Array:
        """First-order force per unit elevation, complex (W, 6), frame axes; nothing without data (V13)."""
        if self.data is None:
            return np.zeros((omega.size, 6), dtype=complex)
        return excitation(self.data, omega, heading, yaw)

    def drift_factor(self, omega: Array, systems: list[tuple[Any, float]], yaw: float) -> Array:
        """C (W, 6, r) with C Cᴴ the spectrum of the slow drift force at low omega (W,), frame axes (V26, V27)."""
        force = Drift(self.data, self.drift, yaw)
        return psd_factor(drift_spectrum(omega, _random(systems), force, *self.band))

    def damping_warnings(self, yaw: float) -> tuple[str, ...]:
        """What to say of the time domain's quadratic damping, which a static yaw does not turn (T5)."""
        unlike = [i for i in (0, 3) if not np.isclose(self.quadratic[i], self.quadratic[i + 1], rtol=TURNED_ALIKE)]
        if abs(yaw) <= TURNED or not unlike:
            return ()
        return (
            f"time domain: vessel.damping.quadratic acts along the axes of the design position, the vessel lies turned by "
            f"{math.degrees(yaw):.3g} deg (threshold {math.degrees(TURNED):.3g} deg); the frequency domain turns it; give "
            "vessel.heading so that the static yaw is small",
        )

    def drift_warnings(self, systems: list[tuple[Any, float]], yaw: float) -> tuple[str, ...]:
        """What to say of the drift of wave systems of several directions, or outside the data, at a static yaw (V24, V29)."""
        directions = [heading for _, heading in systems]
        beside = (
            off_the_headings(self.data, self.drift, directions, yaw)
            if self.data is not None and abs(yaw) > 1e-4
            else ()
        )
        return (*Drift(self.data, self.drift, yaw).warnings(directions), *beside)

    def mean_drift(self, systems: list[tuple[Any, float]], yaw: float) -> Array:
        """Mean drift force of all wave systems at a static yaw, frame axes (6,) [N, N m] (V25)."""
        if not self.has_drift:
            return np.zeros(6)
        force = Drift(self.data, self.drift, yaw, far=True)
        waves = [
            (2 * math.pi / sea.period, 0.5 * sea.height * np.exp(1j * sea.phase), heading)
            for sea, heading in systems
            if isinstance(sea, RegularWave)
        ]
        return mean_drift_force(_random(systems), force, *self.band) + mean_drift_regular(waves, force)


def _random(systems: list[tuple[Any, float]]) -> list[tuple[Any, float]]:
    """Spectrum as a function of frequency, and direction, of the random wave systems."""
    return [(partial(spectrum, sea=sea), heading) for sea, heading in systems if not isinstance(sea, RegularWave)]


def build_vessel(case: Case, data: HydrodynamicData | None) -> tuple[VesselModel, tuple[str, ...]]:
    """The vessel of a case and the warnings its data give rise to. Raises CaseError and DataError."""
    vessel = case.vessel
    assert vessel is not None
    about = about_cg(data, vessel) if data is not None else None
    frequency = case.analyses.frequency_domain or FrequencyDomain()
    radiation = make_radiation(vessel.hydrodynamics, about, 0.0, 0.0, float(frequency.wave.to))
    extra = vessel.line_coefficients
    body = VesselBody(
        np.array(vessel.centre_of_gravity), hydrostatic_stiffness(vessel, data), _six(extra.stiffness),
        vessel.fairlead_kinematics == "finite",
    )  # fmt: skip
    balanced = vessel.trim == "balanced"
    afloat = np.zeros(6) if balanced else buoyancy_minus_weight(vessel, data, case.environment)
    drift = vessel.hydrodynamics.drift if vessel.hydrodynamics is not None else "none"
    Drift(about, drift)  # raises when the data do not hold what it needs
    steady = turning(-float(vessel.heading)) @ np.array(vessel.constant_load.values())
    model = VesselModel(
        body, mass_matrix(vessel), linear_damping(vessel), np.array(vessel.damping.quadratic.values()),
        _six(extra.inertia), _six(extra.damping), steady, afloat, balanced, radiation, about, drift,
        (float(frequency.wave.from_), float(frequency.wave.to)), difference_to(case, data),
    )  # fmt: skip
    warnings = radiation.warnings
    if data is not None:
        seen = quality_warnings(data, float(frequency.wave.from_), float(frequency.wave.to))
        water = water_warnings(data, case.environment, lowest_wave(case))
        warnings = (*data.warnings, *seen, *water, *warnings)
    return model, warnings


def _six(matrix: Any) -> Array:
    return np.zeros((6, 6)) if matrix is None else np.array(matrix, dtype=float)
