"""A run as one ZIP: run.json, summary.json, case.yaml, channels.npz."""

from __future__ import annotations

import io
import tempfile
import zipfile
from typing import IO

import numpy as np

from store.repositories import CaseRepository, ChannelRepository, RunRepository
from store.scope import Scope

from ..context import Context
from .runs import case_text, info


def archive(context: Context, scope: Scope, run_id: str) -> IO[bytes]:
    """An open file at its start; it is gone once closed."""
    with context.database.read() as session:
        runs, channels = RunRepository(session, scope), ChannelRepository(session)
        view, summary = runs.view(run_id), runs.summary(run_id)
        version = view.run.case_version_id
        case = None if version is None else CaseRepository(session, scope).get_with_text(version)
        spool = tempfile.SpooledTemporaryFile(max_size=8_000_000)  # noqa: SIM115 (the response closes it)
        with zipfile.ZipFile(spool, "w", zipfile.ZIP_DEFLATED) as target:
            target.writestr("run.json", info(view).model_dump_json(indent=1))
            target.writestr("summary.json", summary)
            if case is not None:
                target.writestr("case.yaml", case_text(case, view.run))
            with target.open("channels.npz", "w", force_zip64=True) as inner:
                _channels(inner, channels, run_id)
    spool.seek(0)
    return spool


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
