"""What REST answers with, as models: the OpenAPI description is made from them."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

ID = "0197c1f2a3b47c8d9e0f1a2b3c4d5e6f"
HASH = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
TIME = "2026-01-31T12:00:00Z"


class CaseInfo(BaseModel):
    """A saved case: one version under its name, never changed."""

    id: str = Field(examples=[ID])
    name: str = Field(examples=["FPSO 2000 m"])
    version: int = Field(examples=[1])
    content_hash: str = Field(examples=[HASH], description="SHA-256 of the canonical JSON")
    created_at: datetime = Field(examples=[TIME])
    warnings: list[str] = Field(default=[], examples=[[]])


class CaseDetail(CaseInfo):
    case: dict[str, Any]
    yaml: str


class CasePage(BaseModel):
    items: list[CaseInfo]
    next_cursor: str | None


class CaseCheck(BaseModel):
    ok: bool = True
    name: str
    analyses: list[str]
    warnings: list[str]


class DataSetInfo(BaseModel):
    """Hydrodynamic data; cases refer to it by id, content hash or name (then the newest version)."""

    id: str = Field(examples=[ID])
    name: str = Field(examples=["barge-240x46x10.nc"])
    version: int = Field(examples=[1])
    filename: str = Field(examples=["barge-240x46x10.nc"])
    content_hash: str = Field(examples=[HASH], description="SHA-256 of the file")
    size: int = Field(examples=[123456], description="bytes")
    summary: dict[str, Any]
    created_at: datetime = Field(examples=[TIME])


class QualityCheck(BaseModel):
    """One check of hydrodynamic data: `message` says value, threshold and remedy."""

    name: str = Field(examples=["reciprocity"])
    state: Literal["ok", "warning", "skipped"]
    message: str
    value: float | None
    threshold: float | None


class DataSetDetail(DataSetInfo):
    checks: list[QualityCheck]


class Series(BaseModel):
    """One curve of hydrodynamic data; `imaginary` beside the real `values` of a complex one."""

    i: int
    j: int | None = None
    heading_deg: float | None = None
    values: list[Any]
    imaginary: list[Any] | None = None
    zero: float | None = Field(None, description="the limit at zero frequency")
    infinite: float | None = Field(None, description="the limit at infinite frequency")


class Coefficients(BaseModel):
    """Hydrodynamic data to draw: over `omega` [rad/s], or over `time` [s]."""

    quantity: str
    unit: str = Field(description="of forces, of couplings with moments, of moments")
    omega: list[float] | None = None
    time: list[float] | None = None
    series: list[Series]


class Stiffness(BaseModel):
    """Hydrostatic stiffness about `reference_point`, with the weight of the computation at `centre_of_mass`."""

    hydrostatic_stiffness: list[list[float]] | None
    reference_point: list[float] | None
    centre_of_mass: list[float] | None


class DataSetPage(BaseModel):
    items: list[DataSetInfo]
    next_cursor: str | None


Tag = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9 ._:/-]{0,49}$")]
UNSHOWN = r"\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff"
"""Control characters; the last are those that turn the direction of what follows, so that a name reads as another."""
Label = Annotated[str, Field(max_length=200, pattern=rf"^[^{UNSHOWN}]*$")]
Priority = Literal["interactive", "normal", "batch"]


class Chosen(BaseModel):
    """A case, by id or in full, and what is asked of it: exactly one of `case_id`, `case`, `yaml`."""

    case_id: str | None = Field(None, pattern=r"^[0-9A-Za-z-]{1,64}$")
    case: dict[str, Any] | None = None
    yaml: str | None = None
    analyses: list[str] | None = Field(None, max_length=10, description="a choice of the case's; all when left out")
    name: Label = Field("", description="shown beside the case's name")
    tags: list[Tag] = Field([], max_length=20)
    priority: Priority | None = Field(None, description="which tasks go first; chosen by size when left out")


class RunRequest(Chosen):
    """Exactly one of `case_id`, `case`, `yaml`."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"examples": [{"case_id": ID, "analyses": ["statics", "frequency_domain"]}]},
    )
    reuse: Literal["never", "allow"] = Field(
        "never", description="allow: a succeeded run of the very same is answered (200) instead of a new one (202)"
    )


class RunChange(BaseModel):
    """What is given is changed."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"tags": ["basis"], "pinned": True}]})
    name: Label | None = None
    tags: list[Tag] | None = Field(None, max_length=20)
    pinned: bool | None = Field(None, description="a pinned run is kept however old")


class RunCase(BaseModel):
    """The very case that a run computes."""

    name: str
    content_hash: str
    case: dict[str, Any]
    yaml: str


class RunInfo(BaseModel):
    id: str = Field(examples=[ID])
    kind: str = Field("case", examples=["case"], description="case, or hydrodynamics (see GET /hydrodynamics/{id})")
    case_id: str | None = Field(examples=[ID], description="null for a run without a case")
    case_name: str = Field(examples=["FPSO 2000 m"])
    content_hash: str = Field(examples=[HASH])
    analyses: list[str] = Field(examples=[["statics", "frequency_domain", "modes"]])
    state: str = Field(examples=["running"], description="queued, running, cancelling, succeeded, failed or cancelled")
    outcomes: dict[str, str] = Field(
        examples=[{"statics": "succeeded"}],
        description="per analysis: pending, succeeded, failed, skipped or cancelled",
    )
    reason: str | None = Field(description="why it failed")
    progress: float = Field(examples=[0.4], ge=0, le=1)
    message: str = Field(examples=["frequency domain, iteration 3"])
    created_at: datetime = Field(examples=[TIME])
    started_at: datetime | None
    finished_at: datetime | None
    attempt: int = Field(examples=[1])
    solver_version: str | None
    data_set_id: str | None
    data_hash: str | None = None
    warnings: list[str]
    name: str = ""
    tags: list[str] = []
    pinned: bool = False
    priority: str = Field("normal", examples=["interactive"])
    eta_seconds: float | None = Field(None, description="estimate of the seconds left; null without ground for one")
    study_id: str | None = None
    study_index: int | None = None
    overrides: dict[str, Any] | None = Field(None, description="what a study's run changes in its case")
    rerun_of: str | None = None
    created_by: str | None = Field(None, description="name of the user who started it")


class RunPage(BaseModel):
    items: list[RunInfo]
    next_cursor: str | None
    total: int | None = Field(None, description="how many there are in all, where `total=true` asks for it")


class AxisInfo(BaseModel):
    name: str = Field(examples=["omega"])
    unit: str = Field(examples=["rad/s"])
    size: int
    first: float | None
    last: float | None


class ChannelListing(BaseModel):
    name: str = Field(examples=["frequency/vessel/surge"])
    dims: list[str] = Field(examples=[["omega"]])
    shape: list[int] = Field(examples=[[360]])
    unit: str = Field(examples=["m2 s/rad"])
    axes: list[AxisInfo]
    description: str
    band: str = Field(examples=["total"])


class ChannelPage(BaseModel):
    items: list[ChannelListing]


class AxisValues(BaseModel):
    name: str
    unit: str
    values: list[float]


class ChannelValues(BaseModel):
    name: str
    unit: str
    description: str
    band: str
    axes: list[AxisValues]
    values: list[Any] = Field(description="nested lists, one level per axis; a bare number when no axis is left")
    decimation: str | None = Field(description="m4 or stride, when `points` made the first axis shorter")
    full_size: int | None = Field(description="length of the first axis before decimation")


class Example(BaseModel):
    name: str = Field(examples=["fpso-2000m"])
    title: str
    description: str
    yaml: str


class FieldFault(BaseModel):
    loc: list[str | int]
    field: str = Field(examples=["lines.bow-port.segments.0.length"])
    message: str
    value: str
    line: int | None


class ImportReport(BaseModel):
    """Sentences for people: what came over, what the source leaves open, what a case cannot say, what is still to be given."""

    read: list[str]
    assumed: list[str]
    dropped: list[str]
    missing: list[str]


class ImportInfo(BaseModel):
    """What a foreign model became. Where it is not `complete`, `errors` says which fields of `yaml` are to be filled in."""

    complete: bool
    name: str = Field(examples=["FPSO 2000 m"])
    yaml: str = Field(description="the case's text, the report at its head as comments")
    case: dict[str, Any] | None = Field(description="the case as an object in SI, when it is complete")
    report: ImportReport
    errors: list[FieldFault]


class ProblemInfo(BaseModel):
    """RFC 9457, as application/problem+json."""

    type: str
    title: str
    status: int
    detail: str | None = None
    errors: list[FieldFault] | None = None


class CatalogueEntry(BaseModel):
    """A kind of chain or rope; `unverified` names the values that were not read at their source."""

    name: str = Field(examples=["chain-R4-studless"])
    title: str = Field(examples=["Studless chain, grade R4"])
    diameter_range: tuple[float, float] = Field(examples=[(0.02, 0.22)], description="m")
    stiffnesses: list[str] = Field(examples=[["e301", "orcaflex"]], description="choices of EA, the default first")
    unverified: list[str] = Field(examples=[[]])


class CatalogueValue(BaseModel):
    value: float = Field(examples=[286.56])
    unit: str = Field(examples=["kg/m"])
    formula: str = Field(examples=["19900 d² kg/m, d in m"])
    source: str
    status: Literal["verified", "unverified"]


class CatalogueType(CatalogueEntry):
    """The values are there when a diameter was given."""

    diameter: float | None = Field(default=None, examples=[0.12], description="m")
    stiffness: str | None = Field(default=None, examples=["e301"])
    water_density: float | None = Field(default=None, examples=[1025.0], description="kg/m3")
    weight_in_water: float | None = Field(default=None, examples=[2443.26], description="N/m")
    values: dict[str, CatalogueValue] = {}
