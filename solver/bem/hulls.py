"""Hulls given by a few dimensions (docs/hydrodynamics-bem.md has drawings in words). z = 0 is the still water."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from ..case.quantities import Length, NonNegativeLength, Part, PositiveLength


class Barge(Part):
    """A box, its origin midway in the water plane."""

    kind: Literal["barge"]
    length: PositiveLength
    """Along x."""
    breadth: PositiveLength
    """Along y."""
    draft: PositiveLength


class Ship(Part):
    """A wall-sided hull: parallel middle body, bow and stern whose waterlines follow 1 - s^fullness, a round bilge."""

    kind: Literal["ship"]
    length: PositiveLength
    """Along x, from stern to bow; the origin is midway."""
    breadth: PositiveLength
    draft: PositiveLength
    bow: PositiveLength
    """Length over which the waterline narrows forward."""
    stern: PositiveLength
    """Length over which it narrows aft."""
    fullness: Annotated[float, Field(ge=1, le=10)] = 2.0
    """Exponent of the waterlines at both ends: 1 wedge, 2 parabola, more is fuller."""
    bilge_radius: NonNegativeLength = 0.0
    """Radius of the bilge amidships; it shrinks with the breadth towards the ends."""

    @model_validator(mode="after")
    def _fits(self) -> Ship:
        if self.bow + self.stern > self.length * (1 + 1e-12):
            raise ValueError(
                f"bow {self.bow:g} m and stern {self.stern:g} m together are longer than the ship, {self.length:g} m"
            )
        limit = min(self.draft, self.breadth / 2)
        if self.bilge_radius > limit:
            raise ValueError(
                f"bilge_radius {self.bilge_radius:g} m; allowed: at most {limit:g} m (draft, half breadth)"
            )
        return self


class Station(Part):
    """Diameter of a round column at a depth."""

    depth: NonNegativeLength
    """Below the still water."""
    diameter: PositiveLength


Profile = Annotated[tuple[Station, ...], Field(min_length=2, max_length=20)]


def _check_profile(profile: tuple[Station, ...]) -> None:
    if profile[0].depth != 0:
        raise ValueError(f"the profile starts at a depth of {profile[0].depth:g} m; let it start at 0 m")
    if any(b.depth < a.depth for a, b in pairwise(profile)):
        raise ValueError("depths must not fall from one station to the next; equal ones make a step")
    if any(b.depth == a.depth and b.diameter == a.diameter for a, b in pairwise(profile)):
        raise ValueError("two stations that follow one another are the same; leave one out")
    if profile[-1].depth == profile[-2].depth:
        raise ValueError("the profile ends in a step; its last part needs a height")


class Spar(Part):
    """A stack of cylinders and cones about the z axis."""

    kind: Literal["spar"]
    profile: Profile
    """From the still water down to the keel; linear between stations."""

    @model_validator(mode="after")
    def _falls(self) -> Spar:
        _check_profile(self.profile)
        return self


class Column(Part):
    """A vertical round column."""

    position: tuple[Length, Length]
    """x and y of its axis."""
    profile: Profile
    """From the still water down; the part that pontoons meet must be a cylinder."""

    @model_validator(mode="after")
    def _falls(self) -> Column:
        _check_profile(self.profile)
        return self

    @property
    def draft(self) -> float:
        return self.profile[-1].depth


class Pontoon(Part):
    """A box between two columns, its axis through both of theirs."""

    between: tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]]
    """Numbers of the two columns, from 0."""
    width: PositiveLength
    top: PositiveLength
    """Depth of its upper side."""
    bottom: PositiveLength
    """Depth of its lower side."""


class SemiSubmersible(Part):
    """Round columns, joined by pontoons of rectangular section."""

    kind: Literal["semisubmersible"]
    columns: Annotated[tuple[Column, ...], Field(min_length=1, max_length=20)]
    pontoons: Annotated[tuple[Pontoon, ...], Field(max_length=40)] = ()

    @model_validator(mode="after")
    def _fits(self) -> SemiSubmersible:
        for number, pontoon in enumerate(self.pontoons):
            self._check(number, pontoon)
        for i, a in enumerate(self.columns):
            for j, b in enumerate(self.columns[:i]):
                gap = math.dist(a.position, b.position)
                reach = max(s.diameter for s in a.profile) / 2 + max(s.diameter for s in b.profile) / 2
                if gap < reach * (1 + 1e-9):
                    raise ValueError(
                        f"columns {j} and {i} are {gap:g} m apart and would touch; allowed: more than {reach:g} m"
                    )
        return self

    def _check(self, number: int, pontoon: Pontoon) -> None:
        name = f"pontoon {number}"
        if pontoon.bottom <= pontoon.top:
            raise ValueError(f"{name}: bottom {pontoon.bottom:g} m must be deeper than top {pontoon.top:g} m")
        if pontoon.between[0] == pontoon.between[1]:
            raise ValueError(f"{name} joins column {pontoon.between[0]} with itself; name two columns")
        for index in pontoon.between:
            if index >= len(self.columns):
                raise ValueError(f"{name}: there is no column {index}; allowed: 0 to {len(self.columns) - 1}")
            column = self.columns[index]
            if pontoon.bottom > column.draft * (1 + 1e-12):
                raise ValueError(
                    f"{name}: bottom {pontoon.bottom:g} m lies below column {index}, whose draft is {column.draft:g} m"
                )
            diameter = diameter_between(column, pontoon.top, pontoon.bottom)
            if diameter is None:
                raise ValueError(
                    f"{name}: column {index} has no constant diameter from {pontoon.top:g} to {pontoon.bottom:g} m depth"
                )
            if pontoon.width > 0.95 * diameter:
                raise ValueError(
                    f"{name}: width {pontoon.width:g} m; allowed: at most {0.95 * diameter:g} m, 0.95 of the diameter of "
                    f"column {index}"
                )


def diameter_between(column: Column, top: float, bottom: float) -> float | None:
    """The constant diameter of a column from one depth to another [m]; None when it varies."""
    for a, b in pairwise(column.profile):
        if a.depth <= top and bottom <= b.depth * (1 + 1e-12) and a.depth < b.depth:
            return a.diameter if a.diameter == b.diameter else None
    return None


AnyHull = Annotated[Barge | Ship | Spar | SemiSubmersible, Field(discriminator="kind")]
KINDS = ("barge", "ship", "spar", "semisubmersible")
