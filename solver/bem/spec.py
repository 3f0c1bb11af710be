"""What a hydrodynamic job is asked to compute: hull, water, body, frequencies and headings (docs/hydrodynamics-bem.md)."""

from __future__ import annotations

import hashlib
import json
import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError, model_validator

from ..case.case import field_errors
from ..case.quantities import (
    Acceleration,
    Angle,
    Density,
    Frequency,
    NonNegativeFrequency,
    Part,
    PositiveLength,
    PositiveMass,
    Vector3,
)
from ..case.text import read_text, with_line
from ..case.vessel import Diagonal
from ..outcome import CaseError, FieldError
from .hulls import KINDS, AnyHull

Array = np.ndarray
MAX_FREQUENCIES, MAX_HEADINGS, MAX_PANELS = 500, 361, 20_000
TURN = 2 * math.pi


class Geometry(Part):
    """The wetted hull: from dimensions, or from a mesh. Give exactly one of `hull` and `mesh`."""

    hull: AnyHull | None = None
    """Dimensions of a hull."""
    panel_size: PositiveLength | None = None
    """Largest edge of a panel of `hull`; by default such that the hull has about 1000 panels."""
    mesh: Annotated[str, Field(min_length=1, max_length=300)] | None = None
    """A mesh: a path relative to the file on the command line; over REST the id, content hash or name of an upload."""
    scale: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    """Factor that brings the mesh's coordinates to metres."""
    move: Vector3 = (0.0, 0.0, 0.0)
    """Added to the mesh's coordinates after scaling, so that z = 0 is the still water. What lies above is cut off."""

    @model_validator(mode="after")
    def _one(self) -> Geometry:
        if (self.hull is None) == (self.mesh is None):
            raise ValueError("give exactly one of hull and mesh")
        if self.mesh is not None and self.panel_size is not None:
            raise ValueError("panel_size belongs to hull; a mesh has the panels it has")
        if self.hull is not None and (self.scale != 1.0 or any(self.move)):
            raise ValueError("scale and move belong to mesh; a hull of given dimensions lies where it should")
        return self


class JobWater(Part):
    density: Density = 1025.0
    """Density of the sea water."""
    gravity: Acceleration = 9.80665
    """Acceleration of gravity."""
    depth: PositiveLength | None = None
    """Depth; infinite when left out."""

    @property
    def depth_m(self) -> float:
        return math.inf if self.depth is None else self.depth


class Body(Part):
    """The rigid body: what its hydrostatic stiffness, motions and mean drift need."""

    centre_of_gravity: Vector3
    """In the hull's axes; z from the still water, up. The degrees of freedom of the data are about it."""
    mass: PositiveMass | None = None
    """Mass; that of the displaced water when left out."""
    radii_of_gyration: tuple[PositiveLength, PositiveLength, PositiveLength] | None = None
    """Roll, pitch, yaw about the centre of gravity; needed by mean_drift: free."""
    damping: Diagonal = Diagonal()
    """Linear damping beyond radiation for the motions behind the mean drift, N s/m and N m s/rad."""


class Frequencies(Part):
    """Angular frequencies from `from` to `to` at `step`."""

    from_: Frequency = Field(alias="from")
    to: Frequency
    step: Frequency

    @model_validator(mode="after")
    def _rising(self) -> Frequencies:
        if self.to < self.from_:
            raise ValueError(f"`to` {self.to:g} rad/s must not be below `from` {self.from_:g} rad/s")
        if (self.to - self.from_) / self.step > MAX_FREQUENCIES - 1 + 1e-9:
            raise ValueError(f"more than {MAX_FREQUENCIES} frequencies; use a wider step than {self.step:g} rad/s")
        return self

    def values(self) -> Array:
        return self.from_ + self.step * np.arange(math.floor((self.to - self.from_) / self.step + 1e-6) + 1)


class Headings(Part):
    """Directions the waves travel TO, counter-clockwise from +x, from `from` to `to` at `step`."""

    from_: Angle = Field(0.0, alias="from")
    to: Angle
    step: Angle

    @model_validator(mode="after")
    def _rising(self) -> Headings:
        if self.to < self.from_ or self.step <= 0 or self.to - self.from_ > TURN + 1e-9:
            raise ValueError("headings must rise from `from` to `to` by a positive step, over at most 360 deg")
        if (self.to - self.from_) / self.step > MAX_HEADINGS - 1 + 1e-9:
            raise ValueError(f"more than {MAX_HEADINGS} headings; use a wider step")
        return self

    def values(self) -> Array:
        return self.from_ + self.step * np.arange(math.floor((self.to - self.from_) / self.step + 1e-6) + 1)


class HydrodynamicJob(Part):
    """A computation of hydrodynamic data."""

    name: Annotated[str, Field(min_length=1, max_length=100, pattern=r"^[A-Za-z0-9._ ()+-]+$")] = "hull"
    """Name of the data set that comes of it."""
    geometry: Geometry
    """The wetted hull."""
    water: JobWater = JobWater()
    """The water."""
    body: Body | None = None
    """The rigid body; needed to compute, not to look at a mesh."""
    frequencies: (
        Frequencies | Annotated[tuple[Frequency, ...], Field(min_length=1, max_length=MAX_FREQUENCIES)] | None
    ) = None
    """Angular frequencies: a range, or a list that rises. Needed to compute."""
    limits: bool = True
    """Also zero and infinite frequency (added mass), which time-domain analyses want."""
    headings: Headings | Annotated[tuple[Angle, ...], Field(min_length=1, max_length=MAX_HEADINGS)] = Headings(
        to="345 deg",  # type: ignore[arg-type]
        step="15 deg",  # type: ignore[arg-type]
    )
    """Directions the waves travel to: a range, or a list. By default every 15 deg."""
    mean_drift: Literal["free", "fixed", "none"] = "free"
    """Mean drift force of the freely floating body, of a fixed one, or none."""
    lid: bool = True
    """Panels on the inner water plane against irregular frequencies."""
    lid_size: PositiveLength | None = None
    """Largest edge of a panel of the lid; by default 1.5 times the mean edge of the hull's panels."""
    coarsest: NonNegativeFrequency | None = None
    """Look at the mesh for waves up to this frequency, when `frequencies` is not given."""

    def omega(self) -> Array:
        """Finite angular frequencies, rising (W,) [rad/s]; empty when not given."""
        if self.frequencies is None:
            return np.zeros(0)
        if isinstance(self.frequencies, Frequencies):
            return np.round(self.frequencies.values(), 12)
        return np.asarray(self.frequencies)

    def beta(self) -> Array:
        """Headings in [0, 2π), rising, each once (H,) [rad]."""
        given = self.headings.values() if isinstance(self.headings, Headings) else np.asarray(self.headings)
        angle = np.round(given % TURN, 12) % round(TURN, 12)
        return np.unique(np.where(angle > TURN - 1e-9, 0.0, angle))

    def highest(self) -> float | None:
        """The frequency the panels must resolve [rad/s]."""
        return float(self.omega()[-1]) if self.frequencies is not None else self.coarsest

    def canonical(self) -> str:
        """JSON with sorted keys, SI and angles as `… rad`; reads back to an equal job."""
        return json.dumps(self.model_dump(mode="json", exclude_none=True), sort_keys=True, separators=(",", ":"))

    def content_hash(self, mesh_hash: str = "") -> str:
        """SHA-256 of the job and of the mesh it uses."""
        return hashlib.sha256((self.canonical() + mesh_hash).encode()).hexdigest()


def parse_job(data: Any, compute: bool = True) -> HydrodynamicJob:
    """A checked job from plain dicts and lists; `compute` False asks for the geometry only.

    Raises CaseError with the dotted field, the value and the allowed range of every fault.
    """
    try:
        job = HydrodynamicJob.model_validate(data)
    except ValidationError as error:
        raise CaseError([_without_tags(item) for item in field_errors(error)]) from None
    errors = _cross_checks(job, compute)
    if errors:
        raise CaseError(errors)
    return job


def load_job(text: str | bytes) -> HydrodynamicJob:
    """A checked job from YAML or JSON text. Raises CaseError, each error with its line."""
    data, lines = read_text(text)
    try:
        return parse_job(data)
    except CaseError as error:
        raise CaseError([with_line(item, lines) for item in error.errors]) from None


def _without_tags(error: FieldError) -> FieldError:
    tags = (*KINDS, "Frequencies", "Headings")
    return FieldError(tuple(part for part in error.loc if part not in tags), error.message, error.value)


def _cross_checks(job: HydrodynamicJob, compute: bool) -> list[FieldError]:
    errors = []
    omega = job.omega()
    if np.any(np.diff(omega) <= 0):
        errors.append(FieldError(("frequencies",), "must rise strictly from one to the next"))
    if compute and job.frequencies is None:
        errors.append(FieldError(("frequencies",), "this field is required"))
    if compute and job.body is None:
        errors.append(FieldError(("body",), "this field is required: at least centre_of_gravity"))
    if job.mean_drift == "free" and job.body is not None and job.body.radii_of_gyration is None:
        errors.append(
            FieldError(
                ("body", "radii_of_gyration"),
                "mean_drift: free needs them for the motions; or ask for mean_drift: fixed",
            )
        )
    depth, hull = job.water.depth, job.geometry.hull
    draft = 0.0 if hull is None else draft_of(hull)
    if depth is not None and draft >= depth:
        errors.append(
            FieldError(
                ("water", "depth"), f"{depth:g} m; allowed: more than the hull's draft of {draft:g} m", f"{depth:g}"
            )
        )
    return errors


def draft_of(hull: AnyHull) -> float:
    """Deepest point of a hull of given dimensions [m]."""
    if hull.kind in ("barge", "ship"):
        return float(hull.draft)  # type: ignore[union-attr]
    if hull.kind == "spar":
        return float(hull.profile[-1].depth)  # type: ignore[union-attr]
    return max(column.draft for column in hull.columns)  # type: ignore[union-attr]
