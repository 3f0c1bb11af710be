"""What REST takes and answers about studies and the queue."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from .schemas import ID, TIME, Chosen

MOST_RUNS = 20_000


class StudyRequest(Chosen):
    """A base case (exactly one of `case_id`, `case`, `yaml`) and exactly one of `overrides`, `grid`."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "examples": [{"name": "drag", "case_id": ID, "grid": {"/line_types/wire/drag/normal": [0.8, 1.0, 1.2]}}]
        },
    )
    overrides: list[dict[str, Any]] | None = Field(
        None, min_length=1, max_length=MOST_RUNS, description="of each run: JSON pointer into the case to value"
    )
    grid: dict[str, list[Any]] | None = Field(
        None, min_length=1, max_length=20, description="JSON pointer to its values; the last varies fastest"
    )


class StudyInfo(BaseModel):
    id: str = Field(examples=[ID])
    name: str = Field(examples=["drag"])
    case_id: str = Field(examples=[ID])
    analyses: list[str]
    axes: dict[str, list[Any]] | None = Field(description="of a grid")
    pointers: list[str] = Field(description="what the runs change in the case")
    size: int = Field(examples=[3])
    state: str = Field(examples=["active"], description="active, succeeded, failed (one at least) or cancelled")
    counts: dict[str, int] = Field(examples=[{"queued": 2, "running": 1}], description="runs by state")
    progress: float = Field(ge=0, le=1)
    eta_seconds: float | None = Field(description="estimate of the seconds left; null without ground for one")
    created_at: datetime = Field(examples=[TIME])


class StudyPage(BaseModel):
    items: list[StudyInfo]
    next_cursor: str | None


class StudyTable(BaseModel):
    columns: list[str]
    rows: list[list[Any]]
    next_cursor: str | None


class QueueClass(BaseModel):
    queue: str = Field(examples=["runs"])
    priority: str = Field(examples=["interactive"])
    queued: int
    running: int
    oldest_seconds: float | None = Field(description="how long the oldest has waited")


class QueueInfo(BaseModel):
    items: list[QueueClass]
    busy_workers: int = Field(description="processes with a task in hand")
    seconds_left: float | None = Field(description="estimate of the seconds until all that waits is done")


class QuotaItem(BaseModel):
    name: str = Field(examples=["queued runs"])
    used: int = Field(examples=[120])
    limit: int | None = Field(examples=[20000], description="None: there is none")
    left: int | None = Field(examples=[19880])
    setting: str = Field(examples=["SLOWDRIFT_QUOTA_QUEUED_RUNS"], description="with which it is changed")


class Refusal(BaseModel):
    at: datetime = Field(examples=[TIME])
    detail: str = Field(description="which limit, and who can change it")


class QuotaInfo(BaseModel):
    """Limits of the caller's team."""

    items: list[QuotaItem]
    refused: list[Refusal] = Field(
        default=[], description="the last requests that a limit refused, newest first, as this process knows"
    )
    who: str = Field("", description="who can change the limits")
