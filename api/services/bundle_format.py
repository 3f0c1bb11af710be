"""What a bundle holds: names of its files, and its manifest."""

from __future__ import annotations

import hashlib
import json
from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

FORMAT, VERSION = "slowdrift-run", 1
CASE, CASE_TEXT, SUMMARY, MANIFEST = "case.json", "case.yaml", "summary.json", "manifest.json"
MAX_CHANNELS = 20_000


class Strict(BaseModel):
    model_config = ConfigDict(extra="forbid")

    @field_validator("*")
    @classmethod
    def _no_null_byte(cls, value: Any) -> Any:
        """PostgreSQL takes none in a text."""
        if isinstance(value, str) and "\0" in value:
            raise ValueError("holds a null byte")
        return value


class Entry(Strict):
    """What a file of the archive holds."""

    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    size: int = Field(ge=0)


class Listed(Strict):
    """A channel: what is known of it, and its two files."""

    name: str = Field(min_length=1, max_length=300)
    unit: str = Field(max_length=50)
    description: str = Field(max_length=2000)
    band: str = Field(max_length=20)
    axes: list[dict[str, Any]] = Field(max_length=8)
    shape: list[int] = Field(max_length=8)
    codec: Literal["f4-shuffle-zstd", "f8-shuffle-zstd"]
    values: str = Field(pattern=r"^channels/[0-9]{5}\.values$")
    coordinates: str = Field(pattern=r"^channels/[0-9]{5}\.axes$")


class RunPart(Strict):
    id: str = Field(pattern=r"^[0-9a-f]{32}$")
    name: str = Field(max_length=200)
    case_name: str = Field(max_length=200)
    content_hash: str = Field(pattern=r"^[0-9a-f]{64}$")
    data_hash: str | None = Field(pattern=r"^[0-9a-f]{64}$")
    data_name: str | None = Field(max_length=200)
    data_file: str | None = Field(pattern=r"^data/[A-Za-z0-9._ ()+-]{1,100}$")
    analyses: list[str] = Field(min_length=1, max_length=10)
    state: Literal["succeeded", "failed", "cancelled"]
    reason: str | None = Field(max_length=20_000)
    outcomes: dict[str, str] = Field(max_length=10)
    warnings: list[str] = Field(max_length=1000)
    solver_version: str | None = Field(max_length=50)
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None


class Manifest(Strict):
    format: Literal["slowdrift-run"]
    version: Literal[1]
    exported_at: datetime
    slowdrift: str | None = Field(max_length=50)
    run: RunPart
    channels: list[Listed] = Field(max_length=MAX_CHANNELS)
    files: dict[str, Entry] = Field(max_length=2 * MAX_CHANNELS + 10)

    def identity(self) -> str:
        """Hash of all it says but for when and by what it was exported."""
        known = self.model_dump(mode="json", exclude={"exported_at", "slowdrift"})
        return hashlib.sha256(json.dumps(known, sort_keys=True).encode()).hexdigest()
