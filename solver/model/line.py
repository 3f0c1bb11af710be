"""Case → one discretised line: arrays for the kernels, ends, and what is still to be found."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..case import Case, harmonic_frequencies
from ..case.lines import End, Line, Segment
from ..case.section import section
from ..kernels.compression import SHARE
from ..kernels.line import LineArrays
from ..outcome import CaseError, FieldError

Array = np.ndarray
DEFAULT_SOIL = 100e3  # N/m3


@dataclass(frozen=True)
class EndModel:
    """One end of a line. `point` in the solver's frame [m], None while it is to be found.

    arm : fairlead relative to the CG, vessel axes, for kind "fairlead".
    phasor : complex amplitude (3,) of prescribed motion e^{iωt}, for kind "prescribed".
    """

    kind: str  # "fixed" | "fairlead" | "prescribed"
    point: Array | None
    arm: Array | None = None
    phasor: Array | None = None


@dataclass(frozen=True)
class LineModel:
    """A line ready to be solved. `wanted` is the pretension still to be met by a radius or a length."""

    name: str
    spec: Line
    arrays: LineArrays
    end_a: EndModel
    end_b: EndModel
    azimuth: float | None = None
    wanted: float | None = None
    anchor_at_b: bool = False

    @property
    def multiplicity(self) -> int:
        return self.spec.multiplicity

    @property
    def ends(self) -> tuple[EndModel, EndModel]:
        """End b, then end a: the order of the columns of every condensed matrix."""
        return self.end_b, self.end_a

    @property
    def nodes(self) -> int:
        return int(self.arrays.L.size) + 1

    @property
    def anchor_end(self) -> str:
        """Which end counts as the anchor: `end_b` where end b alone is anchored, or end a alone is on the vessel."""
        on_vessel = self.end_a.kind == "fairlead" and self.end_b.kind != "fairlead"
        return "end_b" if self.anchor_at_b or on_vessel else "end_a"

    @property
    def segment_elements(self) -> tuple[int, ...]:
        """Number of elements of each segment, from end a."""
        known = [None if one.length == "find" else element_count(one, float(one.length)) for one in self.spec.segments]
        rest = int(self.arrays.L.size) - sum(count or 0 for count in known)
        return tuple(rest if count is None else count for count in known)

    @property
    def node_arc(self) -> Array:
        """Unstretched arc length of the nodes from end a, shape (N+1,) [m]."""
        return np.concatenate([[0.0], np.cumsum(self.arrays.L)])

    @property
    def element_arc(self) -> Array:
        """Unstretched arc length of the element midpoints, shape (N,) [m]."""
        arc = self.node_arc
        return 0.5 * (arc[1:] + arc[:-1])

    @property
    def length(self) -> float:
        return float(self.arrays.L.sum())

    def with_end(self, point: Array) -> LineModel:
        """The same line with its anchor put at a point."""
        if self.anchor_at_b:
            return replace(self, end_b=replace(self.end_b, point=point))
        return replace(self, end_a=replace(self.end_a, point=point))


def turned(vector: Array, angle: float) -> Array:
    """Vectors turned about the vertical. vector (..., 3)."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = np.moveaxis(np.asarray(vector, dtype=float), -1, 0)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)


def build_line(case: Case, name: str, frame: float, found_length: float = 1000.0) -> LineModel:
    """Discretise a line in the solver's frame, which is turned by `frame` [rad] from the earth's axes."""
    spec = case.lines[name]
    end_a, end_b = _end(case, spec.end_a, frame), _end(case, spec.end_b, frame)
    anchor_at_b = spec.end_a.anchor is None and spec.end_b.anchor is not None
    anchor = spec.end_b.anchor if anchor_at_b else spec.end_a.anchor
    arrays = discretise(case, name, frame, found_length)
    azimuth = anchor.azimuth - frame if anchor is not None and anchor.azimuth is not None else None
    line = LineModel(name, spec, arrays, end_a, end_b, azimuth, anchor.pretension if anchor else None, anchor_at_b)
    if anchor is not None and azimuth is not None and anchor.radius is not None:
        line = line.with_end(anchor_point(case, line, anchor.radius))
    return line


def anchor_point(case: Case, line: LineModel, radius: float) -> Array:
    """Where the anchor lies at a horizontal distance from the other end [m]."""
    other = line.end_a.point if line.anchor_at_b else line.end_b.point
    if other is None or line.azimuth is None:
        raise CaseError([FieldError(("lines", line.name), "the other end of an anchored line must be a known point")])
    away = radius * np.array([math.cos(line.azimuth), math.sin(line.azimuth), 0.0])
    point = other + away
    point[2] = -case.environment.depth
    return point


def _end(case: Case, end: End, frame: float) -> EndModel:
    if end.fairlead is not None and case.vessel is not None:
        arm: Array = np.array(end.fairlead)
        cg = centre_of_gravity(case)
        return EndModel("fairlead", cg + arm, arm=arm)
    if end.pinned is not None:
        point = turned(np.array(end.pinned), -frame)
        if end.motion is None:
            return EndModel("fixed", point)
        phasor = np.zeros(3, dtype=complex)
        for axis, harmonic in end.motion.harmonics().items():
            phasor[axis] = harmonic.amplitude * np.exp(1j * harmonic.phase)
        return EndModel("prescribed", point, phasor=turned(phasor.real, -frame) + 1j * turned(phasor.imag, -frame))
    anchor = end.anchor
    if anchor is None or anchor.point is None:
        return EndModel("fixed", None)
    x, y = anchor.point[:2]
    z = anchor.point[2] if len(anchor.point) == 3 else -case.environment.depth
    return EndModel("fixed", turned(np.array([x, y, z]), -frame))


def centre_of_gravity(case: Case) -> Array:
    """Position of the CG in the solver's frame, in the design position [m]."""
    if case.vessel is None:
        return np.zeros(3)
    return np.array(case.vessel.centre_of_gravity)


def discretise(case: Case, name: str, frame: float, found_length: float) -> LineArrays:
    """The constants of every element and node (docs/theory.md, Lines).

    found_length : length of the segment marked `find` [m].
    """
    water, spec = case.environment.water, case.lines[name]
    keys = ("L", "EA", "EI", "D", "D_drag", "D_wet", "volume", "m", "cn", "ct", "can", "cat", "pushes")
    columns: dict[str, list[float]] = {key: [] for key in keys}
    for segment in spec.segments:
        kind = case.line_types[segment.type]
        shape = section(kind, water)
        length = found_length if segment.length == "find" else float(segment.length)
        count = element_count(segment, length)
        values = (length / count, kind.EA, kind.EI, kind.diameter, shape.drag_diameter, shape.wet_diameter, shape.volume,
                  kind.mass, kind.drag.normal, kind.drag.tangential, kind.added_mass.normal,
                  kind.added_mass.tangential, kind.compression == "allowed")  # fmt: skip
        for key, value in zip(columns, values, strict=True):
            columns[key].extend([value] * count)
    c = {key: np.array(values, dtype=float) for key, values in columns.items()}
    L, D, volume = c["L"], c["D_drag"], c["volume"]
    rho, g = water.density, water.gravity
    node = _nodes(case, name, L, c["m"], frame)
    kb = np.zeros(L.size + 1)
    flexible = (c["EI"][:-1] > 0) & (c["EI"][1:] > 0)
    with np.errstate(divide="ignore"):
        kb[1:-1] = np.where(flexible, 2.0 / (L[:-1] / c["EI"][:-1] + L[1:] / c["EI"][1:]), 0.0)
    w_dry, b_wet = c["m"] * g * L, rho * g * volume * L
    bed = _bed_springs(case, _halves(L), _halves(w_dry - b_wet), _halves(L * c["D"]))
    z, current = current_profile(case, frame)
    return LineArrays(
        L=L, EA=c["EA"], limit=np.where(c["pushes"] > 0, np.inf, euler_load(c["EI"], L) / c["EA"]),
        knee=_knee(w_dry / L, b_wet / L, min(case.environment.depth, float(L.sum())), c["EA"]),
        kb=kb, EI=c["EI"], D=c["D_wet"], w_dry=w_dry, b_wet=b_wet,
        cdn=0.25 * rho * L * D * c["cn"], cdt=0.25 * rho * L * D * c["ct"], mw=0.5 * rho * volume * L,
        can=c["can"], cat=c["cat"], **node, **bed, depth=-float(case.environment.depth),
        current_z=z, current_v=current,
    )  # fmt: skip


def element_count(segment: Segment, length: float) -> int:
    """Number of elements of a segment of a length [m]."""
    return segment.elements or math.ceil(length / float(segment.element_length or length) - 1e-9)


def _bed_springs(case: Case, length: Array, weight: Array, area: Array) -> dict[str, Array]:
    """The springs of the bed under the nodes (L13, L19, L20).

    length, weight, area : of a node's share of the line: unstretched length [m], weight in water [N], length times
    diameter [m2]. The ends of a line are held by their supports: they have no spring.
    """
    seabed, level = case.environment.seabed, -case.environment.depth
    if seabed.node_stiffness is not None:
        a1 = np.full(length.size, float(seabed.node_stiffness))
    else:
        a1 = (DEFAULT_SOIL if seabed.soil is None else float(seabed.soil)) * area
    resting = np.maximum(weight, 0.0) / a1
    if seabed.transition is not None:
        transition = np.full(length.size, float(seabed.transition))
    else:
        transition = np.maximum(resting, 0.5 * area / length)
    a1[[0, -1]] = 0.0
    return {
        "a1": a1, "a2": 1.0 / transition, "bed": level - _lowered(resting, transition),
        "contact": np.array([seabed.damping, seabed.friction, seabed.friction_speed]),
    }  # fmt: skip


def _lowered(resting: Array, transition: Array) -> Array:
    """How far a node's spring is lowered so that the node rests where a linear spring would hold it [m] (L19)."""
    with np.errstate(divide="ignore"):
        lowered = -0.5 * transition * np.log(-np.expm1(-2.0 * resting / transition))
    return np.where(resting > 1e-9 * transition, lowered, 0.0)


def euler_load(EI: Array, L: Array) -> Array:
    """Compression at which an element buckles between its two nodes, π²EI/L² [N] (L17)."""
    load: Array = np.pi**2 * EI / L**2
    return load


def _knee(dry: Array, buoyancy: Array, height: float, EA: Array) -> Array:
    """Width of the regularisation of compression, as a strain (N,) (L18). dry, buoyancy : per length [N/m]."""
    weight = np.maximum(np.abs(dry - buoyancy), 0.05 * dry)
    return np.minimum(0.5 * SHARE * weight * height / EA, 0.01)


def _halves(values: Array) -> Array:
    """Element values shared in halves onto the nodes."""
    padded = np.concatenate([[0.0], values, [0.0]])
    return 0.5 * (padded[1:] + padded[:-1])


def _nodes(case: Case, name: str, L: Array, mass: Array, frame: float) -> dict[str, Array]:
    water = case.environment.water
    arc = np.concatenate([[0.0], np.cumsum(L)])
    out = {key: np.zeros(L.size + 1) for key in ("point_weight", "point_lift", "point_drag", "point_mw", "point_ca")}
    node_mass = _halves(mass * L)
    for index, item in enumerate(case.attachments):
        if item.line != name:
            continue
        i = int(np.argmin(np.abs(arc - item.arc_length)))
        if not 0 < i < L.size:
            raise CaseError([FieldError(
                ("attachments", index, "arc_length"),
                f"{item.arc_length:g} m is nearest to an end of the line; use shorter elements or another place",
            )])  # fmt: skip
        added, displaced = out["point_mw"][i] * out["point_ca"][i], water.density * item.volume
        out["point_weight"][i] += item.mass * water.gravity
        out["point_lift"][i] += displaced * water.gravity
        out["point_drag"][i] += 0.5 * water.density * item.drag_area
        out["point_mw"][i] += displaced
        if displaced > 0:
            out["point_ca"][i] = (added + displaced * item.added_mass) / out["point_mw"][i]
        node_mass[i] += item.mass
    radius = np.maximum(np.cbrt(0.75 * out["point_mw"] / (math.pi * water.density)), 1e-3)
    return {"node_mass": node_mass, "point_radius": radius, **out}


def current_profile(case: Case, frame: float) -> tuple[Array, Array]:
    """Heights, rising, and current velocity there in the solver's frame: (C,) [m], (C, 3) [m/s]."""
    current = case.environment.current
    if current is None:
        return np.zeros(1), np.zeros((1, 3))
    angle = current.direction - frame
    z = -np.array(current.depths)[::-1]
    along = np.array([math.cos(angle), math.sin(angle), 0.0])
    return np.ascontiguousarray(z), np.ascontiguousarray(np.array(current.speeds)[::-1, None] * along)


def has_current(arrays: LineArrays) -> bool:
    return bool(np.any(arrays.current_v))


def harmonic_omega(case: Case) -> float | None:
    """The one frequency of regular waves and prescribed motions [rad/s]; None when nothing is harmonic."""
    found = harmonic_frequencies(case)
    return found[0][1] if found else None
