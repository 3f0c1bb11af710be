"""Points of a deck as ends of a case's lines: on the bed, held above it, or on the vessel."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from ...case.vessel import Vessel
from ...vessel.rigid import mass_matrix
from .report import Report
from .system import Point, System, far_apart

NEAR_BED = 1e-6  # of the depth: a fixed point nearer to the bed is an anchor on it
WIDE = 8.0  # radii of gyration: coupled points farther apart are doubtful as parts of one vessel


class Placement:
    """Points of the deck as ends of lines: vessel points from the deck's reference to the centre of gravity."""

    def __init__(self, depth: float, vessel: Any, points: Iterable[Point], report: Report):
        self.depth = depth
        self.vessel = Vessel.model_validate(vessel) if vessel is not None else None
        if self.vessel is not None:
            self._doubt_width(points, report)
            report.assumed.append(
                "vessel points are relative to (0, 0, 0) of the design position, at the mean water level"
            )
            if self.vessel.heading:
                report.assumed.append(
                    "the deck's axes are the earth's, and its points those of the vessel at its heading"
                )

    def _doubt_width(self, points: Iterable[Point], report: Report) -> None:
        """Coupled points many radii of gyration apart may be those of two vessels."""
        coupled = [point for point in points if point.kind == "coupled"]
        if self.vessel is None or not coupled:
            return
        inertia = mass_matrix(self.vessel)
        radius = math.sqrt(max(inertia[3, 3], inertia[4, 4], inertia[5, 5]) / inertia[0, 0])
        one, other, apart = far_apart(coupled)
        if apart > WIDE * radius:
            report.assumed.append(
                f"coupled points {one.id} and {other.id} are on one vessel, {apart:.4g} m apart, {apart / radius:.2g} times "
                f"its radius of gyration of {radius:.4g} m (threshold {WIDE:g}); check whether the deck holds two vessels"
            )

    def end(self, point: Point) -> dict[str, Any]:
        x, y, z = point.xyz
        if point.kind == "fixed":
            if abs(z + self.depth) <= NEAR_BED * self.depth:
                return {"anchor": {"point": [x, y]}}
            return {"pinned": [x, y, z]}
        if self.vessel is None:
            return {
                "fairlead": [
                    f"{value:g} m minus {axis} of the CG" for value, axis in zip(point.xyz, "xyz", strict=True)
                ]
            }
        c, s = math.cos(self.vessel.heading), math.sin(self.vessel.heading)
        gx, gy, gz = self.vessel.centre_of_gravity
        return {"fairlead": [tidy(c * x + s * y - gx), tidy(c * y - s * x - gy), tidy(z - gz)]}


def off_the_bed(system: System, depth: float, report: Report) -> None:
    """Says which anchors are not on the bed: a z or a WtrDpth that was mistyped."""
    ends = [chain.start for chain in system.chains if chain.start.kind == "fixed"]
    above = {point.id: depth + point.xyz[2] for point in ends}
    far = {name: height for name, height in above.items() if abs(height) > NEAR_BED * depth}
    for name, height in far.items():
        side = "above" if height > 0 else "below"
        report.assumed.append(
            f"fixed point {name} is {abs(height):.4g} m {side} the bed and taken as pinned there; check its z "
            f"({-depth + height:g} m) and the depth ({depth:g} m)"
        )
    if far and len(far) == len(above):
        report.assumed.append(f"no anchor is on the bed at {depth:g} m; check WtrDpth")


def tidy(value: float) -> float:
    """A computed number to 12 digits: -14 + 1.7 is -12.3."""
    return float(f"{value:.12g}")
