"""A run as one file that another Slowdrift imports: a ZIP of case, data, summary and channels with a manifest of hashes.

Channels travel as they are stored (store/arrays.py), so that the copy holds the very same numbers.
"""

from __future__ import annotations

import hashlib
import tempfile
import zipfile
from collections.abc import Iterator
from typing import IO

from store.clock import utc_now
from store.effective import solver_version, stored_case
from store.errors import ConflictError
from store.models import ChannelRow, DataSet, Run
from store.repositories import CaseRepository, DataSetRepository, RunRepository
from store.repositories.imports import ImportRepository
from store.scope import Scope

from ..context import Context
from .bundle_format import CASE, CASE_TEXT, MANIFEST, SUMMARY, Entry, Listed, Manifest, RunPart
from .data_sets import harmless
from .runs import case_text


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
