"""The sea: depth, water, seabed, current and wave systems."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from .quantities import (
    Acceleration,
    Angle,
    Density,
    Frequency,
    LineDamping,
    NonNegativeLength,
    Part,
    PositiveLength,
    SoilStiffness,
    Spectral,
    Speed,
    Stiffness,
    Time,
)


class Water(Part):
    density: Density = 1025.0
    """Density of the sea water."""
    gravity: Acceleration = 9.80665
    """Acceleration of gravity."""


class Seabed(Part):
    """Vertical contact springs under the nodes of the lines (docs/theory.md, Seabed)."""

    node_stiffness: Stiffness | None = None
    """Stiffness of the spring under one node, whatever its spacing. Give this or `soil`."""
    soil: SoilStiffness | None = None
    """Soil stiffness per unit area; a node's spring is soil × diameter × tributary length. Default 100 kN/m3."""
    transition: PositiveLength | None = None
    """Height over which the contact force grows from nothing to its linear law (1/a2). Default: the depth to which a node
    sinks under its own weight, and at least half a diameter."""
    damping: LineDamping = 0.0
    """Damping of vertical motion of one node in full contact."""
    friction: Annotated[float, Field(ge=0, le=2)] = 0.0
    """Coulomb friction along the bed, as a share of the contact force. It acts in the time domain only."""
    friction_speed: Annotated[Speed, Field(ge=1e-4, le=1)] = 0.01
    """Horizontal speed of a node at which friction has 0.7 of its full size; a slower node creeps."""

    @model_validator(mode="after")
    def _one_law(self) -> Seabed:
        if self.node_stiffness is not None and self.soil is not None:
            raise ValueError("give either node_stiffness or soil, not both")
        return self


class Current(Part):
    """Horizontal current, one direction, speed over depth (linear between the points, held beyond the ends)."""

    depths: Annotated[tuple[NonNegativeLength, ...], Field(min_length=1, max_length=200)]
    """Depths below the mean water level, rising."""
    speeds: Annotated[tuple[Speed, ...], Field(min_length=1, max_length=200)]
    """Speed at each depth."""
    direction: Angle
    """Direction the current flows TO, counter-clockwise from +x."""

    @model_validator(mode="after")
    def _same_length(self) -> Current:
        if len(self.depths) != len(self.speeds):
            raise ValueError(f"{len(self.depths)} depths but {len(self.speeds)} speeds; one speed per depth")
        if any(b <= a for a, b in pairwise(self.depths)):
            raise ValueError("depths must rise strictly from one point to the next")
        return self


class _WaveSystem(Part):
    direction: Angle
    """Direction the waves travel TO, counter-clockwise from +x (head seas on a vessel at zero yaw: 180 deg)."""


class _Parametric(_WaveSystem):
    hs: PositiveLength
    """Significant wave height."""
    tz: Time | None = None
    """Mean zero-crossing period. Give this or `tp`; related by Tz = Tp √((5+γ)/(11+γ))."""
    tp: Time | None = None
    """Peak period. Give this or `tz`."""

    @model_validator(mode="after")
    def _one_period(self) -> Any:
        if (self.tz is None) == (self.tp is None):
            raise ValueError("give exactly one of tz and tp")
        if self.hs > 0.142 * 1.56 * self.peak_period**2:
            limit = 0.142 * 1.56 * self.peak_period**2
            raise ValueError(
                f"hs {self.hs:g} m breaks with a peak period of {self.peak_period:.3g} s; "
                f"allowed: hs below {limit:.3g} m, or a longer period"
            )
        return self

    @property
    def peak_period(self) -> float:
        """Tp [s], from Tz by Tz = Tp √((5+γ)/(11+γ)) when Tz is given."""
        gamma = getattr(self, "gamma", 1.0)
        if self.tp is not None:
            return float(self.tp)
        return float(self.tz) * math.sqrt((11 + gamma) / (5 + gamma))  # type: ignore[arg-type]


class Jonswap(_Parametric):
    spectrum: Literal["jonswap"]
    """The kind of wave system."""
    gamma: Annotated[float, Field(ge=1, le=10)] = 3.3
    """Peak enhancement factor."""


class PiersonMoskowitz(_Parametric):
    spectrum: Literal["pierson-moskowitz"]
    """The kind of wave system."""


class Tabulated(_WaveSystem):
    spectrum: Literal["tabulated"]
    """The kind of wave system."""
    frequencies: Annotated[tuple[Frequency, ...], Field(min_length=2, max_length=10_000)]
    """Angular frequencies, rising."""
    densities: Annotated[tuple[Spectral, ...], Field(min_length=2, max_length=10_000)]
    """One-sided spectral density of the surface elevation; linear between the points, zero outside."""

    @model_validator(mode="after")
    def _table(self) -> Tabulated:
        if len(self.frequencies) != len(self.densities):
            raise ValueError(f"{len(self.frequencies)} frequencies but {len(self.densities)} densities")
        if any(b <= a for a, b in pairwise(self.frequencies)):
            raise ValueError("frequencies must rise strictly")
        if not any(self.densities):
            raise ValueError("every density is zero; leave the wave system out instead")
        return self


class RegularWave(_WaveSystem):
    wave: Literal["regular"]
    """The kind of wave system."""
    height: PositiveLength
    """Crest to trough."""
    period: Time
    """Wave period."""
    phase: Angle = 0.0
    """Phase of the elevation at (0, 0) and t = 0."""


def _kind(value: Any) -> str:
    get = value.get if isinstance(value, dict) else lambda key, default=None: getattr(value, key, default)
    if get("wave") is not None:
        return "regular"
    return str(get("spectrum"))


SeaState = Annotated[
    Annotated[Jonswap, Tag("jonswap")]
    | Annotated[PiersonMoskowitz, Tag("pierson-moskowitz")]
    | Annotated[Tabulated, Tag("tabulated")]
    | Annotated[RegularWave, Tag("regular")],
    Discriminator(
        _kind,
        custom_error_type="wave_system",
        custom_error_message="a wave system needs `spectrum: jonswap | pierson-moskowitz | tabulated` or `wave: regular`",
    ),
]


class Environment(Part):
    depth: PositiveLength
    """Water depth."""
    water: Water = Water()
    """Density and gravity."""
    seabed: Seabed = Seabed()
    """Contact of lines with the bed."""
    current: Current | None = None
    """Drag on the lines only; on the hull give vessel.constant_load."""
    seastates: Annotated[tuple[SeaState, ...], Field(max_length=16)] = ()
    """Wave systems that act together, each with its own direction."""

    @property
    def regular(self) -> tuple[RegularWave, ...]:
        return tuple(sea for sea in self.seastates if isinstance(sea, RegularWave))

    @property
    def random(self) -> tuple[Jonswap | PiersonMoskowitz | Tabulated, ...]:
        return tuple(sea for sea in self.seastates if not isinstance(sea, RegularWave))
