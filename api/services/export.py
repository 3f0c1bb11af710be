"""A run's results as a file: a ZIP of everything, or channels as NetCDF, CSV or Parquet.

Files are written to disk, one channel in memory at a time, and streamed from there.
"""

from __future__ import annotations

import io
import json
import re
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from typing import IO

import numpy as np

from solver.io.export import FORMATS, describe, write_results
from solver.io.selection import select_channels
from solver.outcome import CaseError, FieldError
from store.errors import ConflictError
from store.repositories import CaseRepository, ChannelRepository, RunRepository
from store.scope import Scope

from ..context import Context
from .runs import case_text, info

ZIP = "application/zip"
MEDIA = {
    "zip": ZIP,
    "netcdf": "application/x-netcdf",
    "csv": "text/csv; charset=utf-8",
    "parquet": "application/vnd.apache.parquet",
}
IN_MEMORY = 8_000_000  # bytes of a file before it goes to disk
PIECE = 256 * 1024


@dataclass(frozen=True)
class Wanted:
    """What of a run is asked for. `channels`: names or patterns with `*`, comma-separated; None for all."""

    format: str = "zip"
    channels: str | None = None
    layout: str = "long"
    seed: int | None = None


@dataclass(frozen=True)
class Exported:
    """An open file at its start, which is gone once it is read."""

    file: IO[bytes]
    media_type: str
    filename: str

    def pieces(self) -> Iterator[bytes]:
        with self.file:
            while piece := self.file.read(PIECE):
                yield piece


def export(context: Context, scope: Scope, run_id: str, wanted: Wanted) -> Exported:
    """Raises CaseError for what cannot be chosen so, ConflictError while there are no results."""
    spool: IO[bytes] = tempfile.SpooledTemporaryFile(max_size=IN_MEMORY)  # noqa: SIM115 (closed by `pieces`)
    try:
        if wanted.format == "zip":
            _no_choice(wanted)
            _archive(spool, context, scope, run_id)
        else:
            spool.close()
            spool = tempfile.TemporaryFile()  # noqa: SIM115 (HDF5 wants a file of the system)
            _results(spool, context, scope, run_id, wanted)
    except BaseException:
        spool.close()
        raise
    spool.seek(0)
    ending = FORMATS.get(wanted.format, ".zip")
    plain = re.sub(r"[^A-Za-z0-9-]", "", run_id)[:32]
    return Exported(spool, MEDIA[wanted.format], f"slowdrift-{plain}{ending}")


def _no_choice(wanted: Wanted) -> None:
    for field in ("channels", "seed"):
        if getattr(wanted, field) is not None:
            raise CaseError(
                [FieldError((field,), "a zip holds all of a run; choose with format netcdf, csv or parquet")]
            )


def _results(target: IO[bytes], context: Context, scope: Scope, run_id: str, wanted: Wanted) -> None:
    with context.database.read() as session:
        runs, channels = RunRepository(session, scope), ChannelRepository(session)
        run, summary = runs.get(run_id), json.loads(runs.summary(run_id))
        dims = {listed.name: listed.dims for listed in channels.names(run.id)}
        if run.case_version_id is None or not dims:
            raise ConflictError("This run has no channels to export.")
        case = CaseRepository(session, scope).get_with_text(run.case_version_id)
        patterns = [text.strip() for text in (wanted.channels or "").split(",") if text.strip()]
        selection = select_channels(dims, lambda name: channels.get(run.id, name), patterns, wanted.seed)
        about = describe(summary, case_text(case, run), run.case_name) | {"run": run.id}
        write_results(target, wanted.format, selection, about, wanted.layout == "wide")


def _archive(target: IO[bytes], context: Context, scope: Scope, run_id: str) -> None:
    """run.json, summary.json, case.yaml and channels.npz in one ZIP."""
    with context.database.read() as session:
        runs, channels = RunRepository(session, scope), ChannelRepository(session)
        view, summary = runs.view(run_id), runs.summary(run_id)
        version = view.run.case_version_id
        case = None if version is None else CaseRepository(session, scope).get_with_text(version)
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("run.json", info(view).model_dump_json(indent=1))
            archive.writestr("summary.json", summary)
            if case is not None:
                archive.writestr("case.yaml", case_text(case, view.run))
            with archive.open("channels.npz", "w", force_zip64=True) as inner:
                _channels(inner, channels, run_id)


def _channels(target: IO[bytes], channels: ChannelRepository, run_id: str) -> None:
    """NumPy's own format: `NAME` for values, `NAME@AXIS` for each axis; one channel in memory at a time."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as npz:
        for listed in channels.names(run_id):
            channel = channels.get(run_id, listed.name)
            _array(npz, channel.name, channel.values)
            for axis in channel.axes:
                _array(npz, f"{channel.name}@{axis.name}", axis.values)


def _array(npz: zipfile.ZipFile, name: str, values: np.ndarray) -> None:
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, np.ascontiguousarray(values), allow_pickle=False)
    npz.writestr(f"{name}.npy", buffer.getvalue())
