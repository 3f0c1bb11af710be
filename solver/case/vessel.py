"""The vessel: a rigid body with hydrodynamic data, hydrostatics, extra damping and constant loads."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from .quantities import (
    DOF,
    Acceleration,
    Angle,
    Density,
    Force,
    Frequency,
    Matrix6,
    Moment,
    Part,
    PositiveLength,
    PositiveMass,
    Vector3,
)


class Diagonal(Part):
    """One value per degree of freedom, zero where not given [N s/m and N m s for damping; SI throughout]."""

    surge: Annotated[float, Field(ge=0)] = 0.0
    sway: Annotated[float, Field(ge=0)] = 0.0
    heave: Annotated[float, Field(ge=0)] = 0.0
    roll: Annotated[float, Field(ge=0)] = 0.0
    pitch: Annotated[float, Field(ge=0)] = 0.0
    yaw: Annotated[float, Field(ge=0)] = 0.0

    def values(self) -> tuple[float, ...]:
        return tuple(getattr(self, dof) for dof in DOF)


class Damping(Part):
    """Damping beyond wave radiation, about the centre of gravity."""

    linear: Diagonal = Diagonal()
    """B_V: force per velocity, N s/m and N m s/rad."""
    linear_matrix: Matrix6 | None = None
    """A full 6×6 B_V, added to `linear`."""
    quadratic: Diagonal = Diagonal()
    """Force per velocity squared, N s²/m² and N m s²/rad²; linearised statistically in the frequency domain."""


class ConstantLoad(Part):
    """A steady load at the centre of gravity (wind, current on the hull), earth-fixed axes."""

    surge: Force = 0.0
    sway: Force = 0.0
    heave: Force = 0.0
    roll: Moment = 0.0
    pitch: Moment = 0.0
    yaw: Moment = 0.0

    def values(self) -> tuple[float, ...]:
        return tuple(getattr(self, dof) for dof in DOF)


class WamitFiles(Part):
    """What WAMIT's numeric files do not say of themselves. Over REST it is given with the upload instead."""

    length: PositiveLength | None = None
    """ULEN, the length that made the values dimensionless; needed unless `values` is dimensional."""
    values: Literal["nondimensional", "dimensional"] = "nondimensional"
    """Values divided by powers of ρ, g, ω and ULEN, as WAMIT writes them, or in SI."""
    density: Density | None = None
    """Water density of the computation; the case's own when left out."""
    gravity: Acceleration | None = None
    """Gravity of the computation; the case's own when left out."""
    depth: PositiveLength | None = None
    """Water depth of the computation; the case's own when left out."""
    first_column: Literal["auto", "periods", "frequencies"] = "auto"
    """Whether the first column holds periods in s or frequencies in rad/s; `auto` tells by the heave force."""
    pair_columns: Literal["auto", "periods", "frequencies"] = "auto"
    """The same for the two first columns of the QTF; `auto` tells by the other files' range."""
    pair_order: Literal["first-minus-second", "second-minus-first"] = "first-minus-second"
    """Which difference the QTF's phase goes with: e^{i(ω1-ω2)t}, WAMIT's, or e^{i(ω2-ω1)t}."""
    drift: Literal["auto", ".8", ".9"] = "auto"
    """Mean drift from momentum (.8: surge, sway, yaw) or from pressure (.9); `auto` takes .8 when it is there."""
    centre_of_mass: Vector3 | None = None
    """Centre of gravity of the computation, which the .hst contains; the reference point when gravity was left out."""


class Hydrodynamics(Part):
    data: Annotated[str, Field(min_length=1, max_length=300)]
    """Hydrodynamic data: a path relative to the case file on the command line; over REST the id or hash of a data set."""
    wamit: WamitFiles | None = None
    """Conventions of WAMIT files on the command line, where `data` is a folder, a stem or one file of the set."""
    radiation: Literal["constant", "cummins"] = "cummins"
    """`constant`: added mass and damping at `frequency`; `cummins`: the transform of the retardation functions."""
    frequency: Frequency | None = None
    """The one frequency of `radiation: constant`."""
    drift: Literal["none", "newman", "newman-geometric", "qtf"] = "newman"
    """Slow-drift force: none, Newman's approximation from the mean drift, or the full difference-frequency QTF."""
    reference_point: Vector3 = (0.0, 0.0, 0.0)
    """The point the data's degrees of freedom refer to when the file does not say, in the design position."""

    @model_validator(mode="after")
    def _one_frequency(self) -> Hydrodynamics:
        if self.radiation == "constant" and self.frequency is None:
            raise ValueError("radiation: constant needs `frequency`, the angular frequency whose A and B are taken")
        if self.radiation == "cummins" and self.frequency is not None:
            raise ValueError("`frequency` belongs to radiation: constant; leave it out with cummins")
        return self


class Hydrostatics(Part):
    """Overrides what the hydrodynamic data say, or stands in for them."""

    stiffness: Matrix6 | None = None
    """K_V about the centre of gravity, N/m … N m/rad; without the lines."""
    displaced_volume: Annotated[float, Field(gt=0)] | None = None
    """Displaced volume in the design position, m³ (needed by trim: as_given)."""


class LineCoefficients(Part):
    """Equivalent 6×6 coefficients of lines that are not modelled (an uncoupled analysis), about the CG."""

    inertia: Matrix6 | None = None
    """kg, kg m, kg m²."""
    damping: Matrix6 | None = None
    """N s/m, N s, N m s."""
    stiffness: Matrix6 | None = None
    """N/m, N, N m; with finite kinematics the `geometric` part of a summary belongs to it."""


class Vessel(Part):
    mass: PositiveMass
    """Mass of the vessel without added mass."""
    centre_of_gravity: Vector3
    """In the design position, axes along the vessel; z from the mean water level, up."""
    radii_of_gyration: tuple[PositiveLength, PositiveLength, PositiveLength] | None = None
    """Roll, pitch, yaw, about the centre of gravity. Give these or `inertia`."""
    inertia: Annotated[tuple[tuple[float, float, float], ...], Field(min_length=3, max_length=3)] | None = None
    """3×3 moments of inertia about the centre of gravity, kg m²."""
    heading: Angle = 0.0
    """Where the bow points in the design position, counter-clockwise from +x. Fairleads and results turn with it."""
    hydrodynamics: Hydrodynamics | None = None
    """Wave loads, added mass, radiation damping and slow drift. Without it no waves act on the vessel."""
    hydrostatics: Hydrostatics = Hydrostatics()
    """Hydrostatics in place of the data's."""
    damping: Damping = Damping()
    """Damping beyond wave radiation."""
    constant_load: ConstantLoad = ConstantLoad()
    """Steady loads."""
    line_coefficients: LineCoefficients = LineCoefficients()
    """Lines that are not modelled."""
    trim: Literal["balanced", "as_given"] = "balanced"
    """`balanced`: constant heave, roll and pitch loads hold the design position against weight, buoyancy and lines."""
    mean_drift: Literal["include", "exclude"] = "include"
    """Whether the mean wave drift force shifts the static position."""
    fairlead_kinematics: Literal["finite", "linear"] = "finite"
    """`finite`: fairleads turn with the vessel, so pretension gives rotational stiffness; `linear`: they do not."""

    @model_validator(mode="after")
    def _one_inertia(self) -> Vessel:
        if (self.radii_of_gyration is None) == (self.inertia is None):
            raise ValueError("give exactly one of radii_of_gyration and inertia")
        return self
