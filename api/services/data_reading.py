"""Uploads of hydrodynamic data read: called in a child process (store/isolation), since they are whatever was sent."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from solver.case.vessel import WamitFiles
from solver.outcome import CaseError, FieldError
from solver.vessel import data as hydrodynamics
from solver.vessel.data import HydrodynamicData, bundle
from solver.vessel.data.wamit import kind_of, lacking


def harmless(name: str) -> str:
    """The last part of a path, of plain characters only."""
    last = re.split(r"[/\\]", name)[-1]
    return re.sub(r"[^A-Za-z0-9._ ()+-]", "_", last).strip(" .")[:100]


def read_upload(files: Mapping[str, bytes], options: WamitFiles | None) -> tuple[str, str, bytes, dict[str, Any]]:
    """Name and content hash, the bytes to keep, and the summary. Raises CaseError or DataError."""
    found = hydrodynamics.unpacked(files)
    data, filename, payload = _stored({harmless(key) or "data": part for key, part in found.items()}, options)
    return filename, data.content_hash, payload, data.describe()


def _stored(files: Mapping[str, bytes], options: WamitFiles | None) -> tuple[HydrodynamicData, str, bytes]:
    """The data, and the name and bytes they are kept under: one file as it came, a set packed with its conventions."""
    kinds = {kind for name, payload in files.items() if payload.strip() and (kind := kind_of(name)) is not None}
    if not kinds:
        data = hydrodynamics.read_files(files)
        one = next(name for name in files if name == data.name)
        return data, one, files[one]
    known = bundle.conventions(files, "archive") or options or WamitFiles()
    missing = lacking(kinds, known)
    if missing:
        raise CaseError([FieldError((field,), message) for field, message in missing])
    data = hydrodynamics.read_files(files, options)
    kept = {name: payload for name, payload in files.items() if kind_of(name)}
    return data, f"{data.name}.zip", bundle.pack(kept, known)
