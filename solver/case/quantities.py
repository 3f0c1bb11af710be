"""Annotated types of the case: a float in SI that accepts a unit suffix, and the base model every part shares."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer, WithJsonSchema

from ..outcome import Unread
from .units import UNITS, parse


class Part(BaseModel):
    """Base of every part of a case: frozen, no unknown keys, no NaN or infinity."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        allow_inf_nan=False,
        use_attribute_docstrings=True,
        serialize_by_alias=True,
        validate_by_name=True,
        validate_by_alias=True,
    )

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Called for what an instance lacks: a field is lacking only where a part was read in part (partial.py)."""
            if name in type(self).model_fields:
                raise Unread(name)
            return super().__getattr__(name)


def _schema(dimension: str) -> dict[str, Any]:
    si, table = UNITS[dimension]
    text = {"type": "string", "description": f"a number with a unit: {', '.join(table)}"}
    if dimension == "angle":
        return {**text, "x-unit": si, "examples": ["202.5 deg"]}
    return {"anyOf": [{"type": "number", "description": f"in {si}"}, text], "x-unit": si}


def _quantity(dimension: str, **limits: Any) -> Any:
    parts: list[Any] = [
        float,
        BeforeValidator(partial(parse, dimension=dimension)),
        WithJsonSchema({**_schema(dimension), **{f"x-{key}": value for key, value in limits.items()}}),
    ]
    if dimension == "angle":  # a bare angle would be refused on the way back in
        parts.append(PlainSerializer(lambda value: f"{value!r} rad", return_type=str))
    if limits:
        parts.append(Field(**limits))
    return Annotated[tuple(parts)]


if TYPE_CHECKING:  # to a type checker every quantity is the float it becomes
    Length = float
    PositiveLength = float
    NonNegativeLength = float
    Force = float
    PositiveForce = float
    Moment = float
    Stiffness = float
    SoilStiffness = float
    BendingStiffness = float
    Mass = float
    PositiveMass = float
    LineMass = float
    Density = float
    Acceleration = float
    Time = float
    NonNegativeTime = float
    Speed = float
    Angle = float
    Frequency = float
    NonNegativeFrequency = float
    LineDamping = float
    Area = float
    Volume = float
    LineVolume = float
    LineWeight = float
    Spectral = float
else:
    Length = _quantity("length")
    PositiveLength = _quantity("length", gt=0)
    NonNegativeLength = _quantity("length", ge=0)
    Force = _quantity("force")
    PositiveForce = _quantity("force", gt=0)
    Moment = _quantity("moment")
    Stiffness = _quantity("stiffness", gt=0)
    SoilStiffness = _quantity("soil", gt=0)
    BendingStiffness = _quantity("bending", ge=0)
    Mass = _quantity("mass", ge=0)
    PositiveMass = _quantity("mass", gt=0)
    LineMass = _quantity("line_mass", gt=0)
    Density = _quantity("density", gt=0)
    Acceleration = _quantity("acceleration", gt=0)
    Time = _quantity("time", gt=0)
    NonNegativeTime = _quantity("time", ge=0)
    Speed = _quantity("speed")
    Angle = _quantity("angle")
    Frequency = _quantity("angular_frequency", gt=0)
    NonNegativeFrequency = _quantity("angular_frequency", ge=0)
    LineDamping = _quantity("line_damping", ge=0)
    Area = _quantity("area", ge=0)
    Volume = _quantity("volume", ge=0)
    LineVolume = _quantity("line_volume", ge=0)
    LineWeight = _quantity("line_weight")
    Spectral = _quantity("spectral", ge=0)

Coefficient = Annotated[float, Field(ge=0, le=100)]
Vector3 = tuple[Length, Length, Length]
Row6 = tuple[float, float, float, float, float, float]
Matrix6 = tuple[Row6, Row6, Row6, Row6, Row6, Row6]

DOF = ("surge", "sway", "heave", "roll", "pitch", "yaw")
