"""The formats of exported results, and what is written beside the numbers."""

from __future__ import annotations

import datetime
import json
from collections.abc import Mapping
from typing import IO, Any

from ..outcome import CaseError, FieldError
from .netcdf import write_netcdf
from .selection import Selection
from .table import write_csv, write_parquet

ENDINGS = {".nc": "netcdf", ".h5": "netcdf", ".csv": "csv", ".parquet": "parquet", ".xlsx": "xlsx"}
FORMATS = {"netcdf": ".nc", "csv": ".csv", "parquet": ".parquet"}


def format_of(name: str) -> str:
    """The format that a file's name asks for: one of FORMATS, or xlsx (workbook.py). Raises CaseError."""
    for ending, kind in ENDINGS.items():
        if name.lower().endswith(ending):
            return kind
    message = f"{name[-60:]}: the format is told by the ending; allowed: {', '.join(ENDINGS)}"
    raise CaseError([FieldError(("--out",), message, name[-60:])])


def write_results(
    target: IO[bytes], kind: str, selection: Selection, about: Mapping[str, Any], wide: bool = False
) -> None:
    """Write the chosen channels into an open binary file; `about` is that of `describe`. Raises CaseError.

    kind : a key of FORMATS. wide : a column per channel (CSV only).
    """
    if wide and kind != "csv":
        raise CaseError([FieldError(("layout",), f"a wide table is CSV; {kind} has a layout of its own", "wide")])
    if not selection.names:
        raise CaseError([FieldError(("channels",), "there are no channels to write")])
    if kind == "netcdf":
        write_netcdf(target, selection, about)
    elif kind == "parquet":
        write_parquet(target, selection, about)
    else:
        write_csv(target, selection, wide)


def describe(summary: Mapping[str, Any], case_yaml: str, title: str) -> dict[str, Any]:
    """What goes into a file beside its numbers: who made it, from what, and the case and summary themselves."""
    known = {key: value for key, value in (summary.get("provenance") or {}).items() if value is not None}
    flat = {key: value if isinstance(value, str | int | float) else json.dumps(value) for key, value in known.items()}
    now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    return {
        "title": title,
        "Conventions": "CF-1.8",
        "source": f"Slowdrift {known.get('solver_version', '')}".strip(),
        "history": f"{now}: exported by Slowdrift",
        **flat,
        "warnings": "\n".join(summary.get("warnings", [])),
        "case": case_yaml,
        "summary": json.dumps(summary),
    }
