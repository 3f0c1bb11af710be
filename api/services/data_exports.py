"""Hydrodynamic data as a file that other programs read."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from solver.outcome import CaseError, DataError, FieldError
from solver.vessel.data.bundle import pack
from solver.vessel.data.layout import dump_netcdf
from solver.vessel.data.wamit import conventions_of, write_wamit
from store.reading import read_bytes
from store.repositories import DataSetRepository
from store.scope import Scope
from store.sources import PinnedSource

from ..context import Context

Format = Literal["netcdf", "wamit"]


@dataclass(frozen=True)
class DataFile:
    payload: bytes
    media_type: str
    filename: str


def export(context: Context, scope: Scope, data_set_id: str, kind: Format, length: float | None) -> DataFile:
    """NetCDF in Capytaine's layout, or a WAMIT set in a ZIP with its conventions. Raises CaseError.

    length : ULEN of a WAMIT set [m]; that of the files it came from, or 1, when left out.
    """
    with context.database.read() as session:
        row = DataSetRepository(session, scope).get(data_set_id)
        source, name = PinnedSource(row, read_bytes, stated=False), row.name
    stem = re.sub(r"[^A-Za-z0-9_-]", "_", re.sub(r"\.[A-Za-z0-9]{1,4}$", "", name))[:60] or "data"
    try:
        data = source.open(name)
        if kind == "netcdf":
            return DataFile(dump_netcdf(data), "application/x-netcdf", f"{stem}.nc")
        files, options = write_wamit(data, stem, length), conventions_of(data, length)
    except DataError as error:
        raise CaseError([FieldError(("format",), str(error), kind)]) from None
    return DataFile(pack(files, options), "application/zip", f"{stem}-wamit.zip")
