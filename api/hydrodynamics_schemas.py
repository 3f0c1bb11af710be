"""What the routes of hydrodynamic jobs answer with."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from pydantic import BaseModel, Field

from .schemas import HASH, ID, TIME


class MeshDoubt(BaseModel):
    check: str = Field(examples=["panels per wavelength"])
    threshold: float
    value: float
    remedy: str
    message: str


class Preview(BaseModel):
    """Panels to draw; a triangle repeats its last corner."""

    vertices: list[list[float]]
    faces: list[list[int]]
    panels: int = Field(description="of the whole mesh")
    shown: int


class MeshInfo(BaseModel):
    """An uploaded mesh and what its wetted part measures."""

    id: str = Field(examples=[ID])
    name: str = Field(examples=["hull.gdf"])
    content_hash: str = Field(examples=[HASH], description="SHA-256 of the file")
    size: int = Field(description="bytes")
    created_at: datetime = Field(examples=[TIME])
    format: str = Field(examples=["GDF"])
    quality: dict[str, Any]
    warnings: list[MeshDoubt]


class MeshDetail(MeshInfo):
    preview: Preview


class MeshPage(BaseModel):
    items: list[MeshInfo]
    next_cursor: str | None


class MeshLook(BaseModel):
    """A hull before it is computed."""

    quality: dict[str, Any]
    warnings: list[MeshDoubt]
    preview: Preview
    estimate: dict[str, Any]


class HydrodynamicInfo(BaseModel):
    """A boundary-element job; its state is that of the run with the same id."""

    id: str = Field(examples=[ID])
    name: str = Field(examples=["barge"])
    state: str = Field(examples=["running"], description="queued, running, cancelling, succeeded, failed or cancelled")
    progress: float = Field(examples=[0.4], ge=0, le=1)
    message: str = Field(examples=["12 of 40, 0.6 rad/s: Green function"])
    reason: str | None = Field(description="why it failed")
    created_at: datetime = Field(examples=[TIME])
    started_at: datetime | None
    finished_at: datetime | None
    attempt: int
    warnings: list[str]
    created_by: str | None
    spec: dict[str, Any]
    estimate: dict[str, Any]
    mesh_id: str | None
    data_set_id: str | None = Field(description="the data set it made, once it has succeeded")


class HydrodynamicPage(BaseModel):
    items: list[HydrodynamicInfo]
    next_cursor: str | None
    total: int
