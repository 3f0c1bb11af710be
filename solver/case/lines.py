"""Lines: types, segments, ends, attachments."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, ValidationInfo, field_validator, model_serializer, model_validator

from ..catalogue import entry
from .catalogued import CatalogueName, CatalogueValues, fill_in, unless_catalogue, without
from .quantities import (
    Angle,
    Area,
    BendingStiffness,
    Coefficient,
    Length,
    LineMass,
    LineVolume,
    LineWeight,
    Mass,
    NonNegativeLength,
    Part,
    PositiveForce,
    PositiveLength,
    Time,
    Vector3,
    Volume,
)

Name = Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[A-Za-z0-9][A-Za-z0-9 _.\-]*$")]


class NormalTangential(Part):
    """Coefficients of Morison's equation across and along a line."""

    normal: Coefficient = 1.0
    """Across the line."""
    tangential: Coefficient = 0.0
    """Along the line."""


class LineType(Part):
    """A cross-section: its mass, its displaced volume, and the diameter its drag acts on (docs/theory.md, Lines)."""

    model_config = ConfigDict(json_schema_extra=unless_catalogue)

    catalogue: CatalogueName | None = None
    """An entry of the catalogue (`slowdrift catalogue`): it gives every field of this type that is left out."""
    stiffness: Literal["e301", "orcaflex"] | None = None
    """EA of a chain of the catalogue: by DNV-OS-E301 (default, depends on the grade) or by OrcaFlex's table."""
    diameter: PositiveLength
    """Nominal diameter (bar of a chain, rope); of drag and displaced volume too, unless these are given."""
    drag_diameter: PositiveLength | None = None
    """Diameter of the drag coefficients; the nominal one when left out."""
    volume: LineVolume | None = None
    """Displaced volume per unit length: buoyancy and added mass; a solid cylinder of the nominal diameter when left out."""
    submerged_weight: LineWeight | None = None
    """Weight in water per unit length, in place of `volume`; negative for a line that floats."""
    mass: LineMass
    """Dry mass per unit length, contents included."""
    EA: PositiveForce
    """Axial stiffness."""
    EI: BendingStiffness = 0.0
    """Bending stiffness."""
    compression: Literal["none", "allowed"] = "none"
    """What an element carries in compression: `none`, at most its Euler load π²EI/l², which is nothing without bending
    stiffness; `allowed`, any compression, as a spring that pushes."""
    drag: NormalTangential = NormalTangential()
    """Drag coefficients on the drag diameter (studless chain: 2.4 and 1.15 on its nominal diameter)."""
    added_mass: NormalTangential = NormalTangential()
    """Added mass coefficients on the displaced mass, water density × displaced volume."""
    breaking_load: PositiveForce | None = None
    """Minimum breaking load, for utilisation."""
    catalogue_values: CatalogueValues | None = None
    """What `catalogue` gave; the program writes it, so that a stored case stays as it is when the catalogue changes."""

    @model_validator(mode="before")
    @classmethod
    def _from_catalogue(cls, data: Any) -> Any:
        return fill_in(data)

    @field_validator("stiffness")
    @classmethod
    def _known_stiffness(cls, value: str | None, info: ValidationInfo) -> str | None:
        name = info.data.get("catalogue")
        if value is not None and name is None and "catalogue" in info.data:
            raise ValueError("stiffness chooses the EA of a catalogue entry; give `catalogue`, or EA alone")
        if value is not None and name is not None:
            entry(name).choice(value)
        return value

    @field_validator("diameter")
    @classmethod
    def _within_catalogue(cls, value: float, info: ValidationInfo) -> float:
        if info.data.get("catalogue") is not None:
            entry(info.data["catalogue"]).check(value)
        return value

    @model_validator(mode="after")
    def _one_volume(self) -> LineType:
        if self.volume is not None and self.submerged_weight is not None:
            raise ValueError("give at most one of volume and submerged_weight")
        return self

    @model_serializer(mode="wrap")
    def _without_catalogue_values(self, write: Any) -> dict[str, Any]:
        return without(write(self), self.catalogue_values)


class Segment(Part):
    type: Name
    """Name of a line type."""
    length: PositiveLength | Literal["find"]
    """Unstretched length, or `find`: the length that gives the wanted pretension."""
    elements: Annotated[int, Field(ge=1, le=5000)] | None = None
    """Number of equal elements. Give this or `element_length`."""
    element_length: PositiveLength | None = None
    """Wanted element length; the number of elements is rounded up."""

    @model_validator(mode="after")
    def _one_spacing(self) -> Segment:
        if (self.elements is None) == (self.element_length is None):
            raise ValueError("give exactly one of elements and element_length")
        if self.length == "find" and self.elements is None:
            raise ValueError("length: find needs `elements`")
        return self


class Anchor(Part):
    """An anchor on the seabed: at a point, or at a radius along an azimuth, or where a pretension puts it."""

    point: Vector3 | tuple[Length, Length] | None = None
    """Earth-fixed x, y (and z; default the seabed)."""
    azimuth: Angle | None = None
    """Direction in which the line leads out from its other end, counter-clockwise from +x."""
    radius: PositiveLength | None = None
    """Horizontal distance from the other end to the anchor."""
    pretension: PositiveForce | None = None
    """Wanted tension at the other end in the design position; finds the radius, or the length marked `find`."""

    @model_validator(mode="after")
    def _placed(self) -> Anchor:
        if self.point is not None and (self.azimuth is not None or self.radius is not None):
            raise ValueError("give a point, or an azimuth with a radius or a pretension, not both")
        if self.point is None and self.azimuth is None:
            raise ValueError("give a point, or an azimuth with a radius or a pretension")
        if self.azimuth is not None and self.radius is None and self.pretension is None:
            raise ValueError("an azimuth needs a radius or a pretension")
        return self


class Harmonic(Part):
    amplitude: NonNegativeLength
    """Half the travel."""
    period: Time
    """The same for all motions and regular waves of a case in the frequency domain."""
    phase: Angle = 0.0
    """Lead on cos(2πt/period)."""


class Motion(Part):
    """Prescribed harmonic motion of an end about its pinned point: amplitude·cos(2πt/period + phase)."""

    surge: Harmonic | None = None
    """Along x."""
    sway: Harmonic | None = None
    """Along y."""
    heave: Harmonic | None = None
    """Along z."""

    @model_validator(mode="after")
    def _some_motion(self) -> Motion:
        if not self.harmonics():
            raise ValueError("give at least one of surge, sway, heave")
        return self

    def harmonics(self) -> dict[int, Harmonic]:
        """The harmonics by axis, 0 for x."""
        named = enumerate((self.surge, self.sway, self.heave))
        return {axis: harmonic for axis, harmonic in named if harmonic is not None}


class End(Part):
    """One end of a line: a fairlead on the vessel, an anchor, or a pinned point (with prescribed motion, if wanted)."""

    fairlead: Vector3 | None = None
    """Position on the vessel relative to its centre of gravity, vessel axes."""
    anchor: Anchor | None = None
    """On the seabed."""
    pinned: Vector3 | None = None
    """A point fixed in space, earth axes."""
    motion: Motion | None = None
    """Prescribed motion of the pinned point."""

    @model_validator(mode="after")
    def _one_kind(self) -> End:
        given = [name for name in ("fairlead", "anchor", "pinned") if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"give exactly one of fairlead, anchor, pinned (given: {', '.join(given) or 'none'})")
        if self.motion is not None and self.pinned is None:
            raise ValueError("motion belongs to a pinned end: give the point it moves about as `pinned`")
        return self


class Line(Part):
    """One line (or `multiplicity` equal ones) from end a (anchor, bottom) to end b (top)."""

    segments: Annotated[tuple[Segment, ...], Field(min_length=1, max_length=50)]
    """From end a to end b."""
    end_a: End
    """The bottom end, arc length 0."""
    end_b: End
    """The top end."""
    allow_stretch: bool = False
    """Whether the ends may lie farther apart than the unstretched length (a taut mooring)."""
    multiplicity: Annotated[int, Field(ge=1, le=1000)] = 1
    """Number of real lines this one stands for; reported tensions are per single line."""

    @property
    def length(self) -> float | None:
        """Unstretched length [m]; None while a segment's length is to be found."""
        lengths = [segment.length for segment in self.segments]
        return None if "find" in lengths else float(sum(lengths))  # type: ignore[arg-type]

    @model_validator(mode="after")
    def _ends(self) -> Line:
        anchors = [end.anchor for end in (self.end_a, self.end_b) if end.anchor is not None]
        if len(anchors) == 2 and any(anchor.point is None for anchor in anchors):
            raise ValueError("a line between two anchors needs both as points")
        wanted = [anchor for anchor in anchors if anchor.pretension is not None]
        finds = sum(segment.length == "find" for segment in self.segments)
        placed = any(anchor.point is not None or anchor.radius is not None for anchor in wanted)
        if finds > 1:
            raise ValueError("only one segment may have length: find")
        if finds and not (wanted and placed):
            raise ValueError("length: find needs an anchor with a pretension and a point or a radius")
        if wanted and placed and not finds:
            raise ValueError("the anchor is placed and has a pretension: mark the segment to adjust with length: find")
        return self


class Attachment(Part):
    """A clump weight or a buoy at a node of a line."""

    line: Name
    """Name of the line it hangs on."""
    arc_length: NonNegativeLength
    """Distance from end a along the unstretched line; moved to the nearest node, which must be inside the line."""
    mass: Mass = 0.0
    """Dry mass."""
    volume: Volume = 0.0
    """Displaced volume."""
    drag_area: Area = 0.0
    """Drag coefficient × frontal area, the same in all directions."""
    added_mass: Coefficient = 0.5
    """Added mass coefficient on the displaced mass, the same in all directions."""
