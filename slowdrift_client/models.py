"""What the service answers. Made from its OpenAPI by docs/make_client.py; change nothing here."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AwareDatetime, BaseModel, ConfigDict, Field


class AxisInfo(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    name: str
    unit: str
    size: int
    first: float | None
    last: float | None


class AxisValues(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    name: str
    unit: str
    values: list[float]


class CaseCheck(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    ok: bool | None = True
    name: str
    analyses: list[str]
    warnings: list[str]


class CaseInfo(BaseModel):
    """
    A saved case: one version under its name, never changed.
    """

    model_config = ConfigDict(
        extra="allow",
    )
    id: str
    name: str
    version: int
    content_hash: Annotated[str, Field(description="SHA-256 of the canonical JSON")]
    created_at: AwareDatetime
    warnings: list[str] | None = []


class ChannelListing(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    name: str
    dims: list[str]
    shape: list[int]
    unit: str
    axes: list[AxisInfo]
    description: str
    band: str


class ChannelPage(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    items: list[ChannelListing]


class ChannelValues(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    name: str
    unit: str
    description: str
    band: str
    axes: list[AxisValues]
    values: Annotated[
        list[Any],
        Field(description="nested lists, one level per axis; a bare number when no axis is left"),
    ]
    decimation: Annotated[
        str | None,
        Field(description="m4 or stride, when `points` made the first axis shorter"),
    ]
    full_size: Annotated[int | None, Field(description="length of the first axis before decimation")]


class DataSetInfo(BaseModel):
    """
    Hydrodynamic data; cases refer to it by id, content hash or name (then the newest version).
    """

    model_config = ConfigDict(
        extra="allow",
    )
    id: str
    name: str
    version: int
    filename: str
    content_hash: Annotated[str, Field(description="SHA-256 of the file")]
    size: Annotated[int, Field(description="bytes")]
    summary: dict[str, Any]
    created_at: AwareDatetime


class QueueClass(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    queue: str
    priority: str
    queued: int
    running: int
    oldest_seconds: Annotated[float | None, Field(description="how long the oldest has waited")]


class QueueInfo(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    items: list[QueueClass]
    busy_workers: Annotated[int, Field(description="processes with a task in hand")]
    seconds_left: Annotated[
        float | None,
        Field(description="estimate of the seconds until all that waits is done"),
    ]


class RunCase(BaseModel):
    """
    The very case that a run computes.
    """

    model_config = ConfigDict(
        extra="allow",
    )
    name: str
    content_hash: str
    case: dict[str, Any]
    yaml: str


class RunInfo(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    id: str
    kind: Annotated[
        str | None,
        Field(description="case, or hydrodynamics (see GET /hydrodynamics/{id})"),
    ] = "case"
    case_id: Annotated[str | None, Field(description="null for a run without a case")]
    case_name: str
    content_hash: str
    analyses: list[str]
    state: Annotated[
        str,
        Field(description="queued, running, cancelling, succeeded, failed or cancelled"),
    ]
    outcomes: Annotated[
        dict[str, str],
        Field(description="per analysis: pending, succeeded, failed, skipped or cancelled"),
    ]
    reason: Annotated[str | None, Field(description="why it failed")]
    progress: Annotated[float, Field(ge=0.0, le=1.0)]
    message: str
    created_at: AwareDatetime
    started_at: AwareDatetime | None
    finished_at: AwareDatetime | None
    attempt: int
    solver_version: str | None
    data_set_id: str | None
    data_hash: str | None = None
    warnings: list[str]
    name: str | None = ""
    tags: list[str] | None = []
    pinned: bool | None = False
    priority: str | None = "normal"
    eta_seconds: Annotated[
        float | None,
        Field(description="estimate of the seconds left; null without ground for one"),
    ] = None
    study_id: str | None = None
    study_index: int | None = None
    overrides: Annotated[
        dict[str, Any] | None,
        Field(description="what a study's run changes in its case"),
    ] = None
    rerun_of: str | None = None
    created_by: Annotated[str | None, Field(description="name of the user who started it")] = None


class RunPage(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    items: list[RunInfo]
    next_cursor: str | None
    total: Annotated[
        int | None,
        Field(description="how many there are in all, where `total=true` asks for it"),
    ] = None


class StudyInfo(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    id: str
    name: str
    case_id: str
    analyses: list[str]
    axes: Annotated[dict[str, list[Any]] | None, Field(description="of a grid")]
    pointers: Annotated[list[str], Field(description="what the runs change in the case")]
    size: int
    state: Annotated[str, Field(description="active, succeeded, failed (one at least) or cancelled")]
    counts: Annotated[dict[str, int], Field(description="runs by state")]
    progress: Annotated[float, Field(ge=0.0, le=1.0)]
    eta_seconds: Annotated[
        float | None,
        Field(description="estimate of the seconds left; null without ground for one"),
    ]
    created_at: AwareDatetime


class StudyPage(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    items: list[StudyInfo]
    next_cursor: str | None


class StudyTable(BaseModel):
    model_config = ConfigDict(
        extra="allow",
    )
    columns: list[str]
    rows: list[list[Any]]
    next_cursor: str | None
