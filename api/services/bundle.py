"""A run as one file that another Slowdrift imports: a ZIP of case, data, summary and channels with a manifest of hashes.

Channels travel as they are stored (store/arrays.py), so that the copy holds the very same numbers.
"""

from __future__ import annotations

import hashlib
import json
import tempfile
import zipfile
from collections.abc import Iterator
from datetime import datetime
from typing import IO, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from store.clock import utc_now
from store.effective import solver_version, stored_case
from store.errors import ConflictError
from store.models import ChannelRow, DataSet, Run
from store.repositories import CaseRepository, DataSetRepository, RunRepository
from store.repositories.imports import ImportRepository
from store.scope import Scope

from ..context import Context
from .data_sets import harmless
from .runs import case_text

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


class _Writer:
    def __init__(self, target: zipfile.ZipFile):
        self.target = target
        self.files: dict[str, Entry] = {}

    def add(self, name: str, content: bytes, method: int = zipfile.ZIP_DEFLATED) -> str:
        self.target.writestr(zipfile.ZipInfo(name), content, compress_type=method)
        self.files[name] = Entry(sha256=hashlib.sha256(content).hexdigest(), size=len(content))
        return name


def bundle(context: Context, scope: Scope, run_id: str) -> IO[bytes]:
    """An open file at its start; it is gone once closed. ConflictError for a run without case or results."""
    with context.database.snapshot() as session:
        runs = RunRepository(session, scope)
        run, summary = runs.get(run_id), runs.summary(run_id)
        if run.case_version_id is None:
            raise ConflictError("The run has no case; its data set is what it made.")
        case = CaseRepository(session, scope).get_with_text(run.case_version_id)
        data = DataSetRepository(session, scope).get(run.data_set_id) if run.data_set_id else None
        spool = tempfile.SpooledTemporaryFile(max_size=8_000_000)  # noqa: SIM115 (the response closes it)
        with zipfile.ZipFile(spool, "w") as target:
            writer = _Writer(target)
            writer.add(CASE, stored_case(case.canonical, None, run.overrides).canonical().encode())
            writer.add(CASE_TEXT, case_text(case, run).encode())
            writer.add(SUMMARY, summary.encode())
            part = _run(run, data, writer)
            rows = ImportRepository(session, scope).channel_rows(run.id)
            channels = [_channel(row, number, writer) for number, row in enumerate(rows)]
            manifest = Manifest(
                format="slowdrift-run",
                version=1,
                exported_at=utc_now(),
                slowdrift=solver_version(),
                run=part,
                channels=channels,
                files=writer.files,
            )
            target.writestr(MANIFEST, manifest.model_dump_json(indent=1), compress_type=zipfile.ZIP_DEFLATED)
    spool.seek(0)
    return spool


def _run(run: Run, data: DataSet | None, writer: _Writer) -> RunPart:
    file = None
    if data is not None:
        file = writer.add(f"data/{harmless(data.filename) or 'data'}", data.payload)
    same = ("id", "name", "case_name", "content_hash", "analyses", "state", "reason", "outcomes", "warnings")
    times = ("solver_version", "created_at", "started_at", "finished_at")
    known = {name: getattr(run, name) for name in same + times}
    data_hash, data_name = (None, None) if data is None else (data.content_hash, data.name)
    return RunPart(**known, data_hash=data_hash, data_name=data_name, data_file=file)


def _channel(row: ChannelRow, number: int, writer: _Writer) -> Listed:
    same = ("name", "unit", "description", "band", "axes", "shape", "codec")
    values = writer.add(f"channels/{number:05d}.values", row.payload, zipfile.ZIP_STORED)
    coordinates = writer.add(f"channels/{number:05d}.axes", row.axes_payload, zipfile.ZIP_STORED)
    return Listed(**{name: getattr(row, name) for name in same}, values=values, coordinates=coordinates)


def pieces(file: IO[bytes]) -> Iterator[bytes]:
    with file:
        while piece := file.read(256 * 1024):
            yield piece
