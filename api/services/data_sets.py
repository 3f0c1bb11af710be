"""Uploads of hydrodynamic data: bounded, read before they are stored, named harmlessly."""

from __future__ import annotations

import re
import threading
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from solver.case.vessel import WamitFiles
from solver.outcome import CaseError, DataError, FieldError
from solver.vessel import data as hydrodynamics
from solver.vessel.data import HydrodynamicData, bundle
from solver.vessel.data.wamit import kind_of, lacking
from solver.vessel.quality import quality
from store.models import DataSet
from store.repositories import DataSetRepository
from store.scope import Scope
from store.sources import PinnedSource

from ..context import Context
from ..schemas import DataSetDetail, DataSetInfo

_reading = threading.BoundedSemaphore(2)  # uploads that are read at a time, each in some times its size of memory


def harmless(name: str) -> str:
    """The last part of a path, of plain characters only."""
    last = re.split(r"[/\\]", name)[-1]
    return re.sub(r"[^A-Za-z0-9._ ()+-]", "_", last).strip(" .")[:100]


def add(
    context: Context,
    scope: Scope,
    files: Mapping[str, bytes],
    name: str | None = None,
    form: Mapping[str, str | None] | None = None,
) -> tuple[DataSet, bool]:
    """Store one file, or the files of a set, by name; form: fields of WamitFiles as text. Raises CaseError."""
    size = sum(len(payload) for payload in files.values())
    if size > context.settings.max_data_bytes:
        raise _fault("file", f"{size} bytes; allowed: at most {context.settings.max_data_bytes}")
    options = conventions(form or {})
    try:
        with _reading:
            return _read_and_save(context, scope, files, name, options)
    except DataError as error:
        raise _fault("file", str(error)) from None


def _read_and_save(
    context: Context, scope: Scope, files: Mapping[str, bytes], name: str | None, options: WamitFiles | None
) -> tuple[DataSet, bool]:
    found = hydrodynamics.unpacked({harmless(key) or "data": payload for key, payload in files.items()})
    data, filename, payload = _stored({harmless(key) or "data": part for key, part in found.items()}, options)
    label = harmless(name or "") or filename
    with context.change() as unit:
        return DataSetRepository(unit.session, scope).save(label, filename, data.content_hash, payload, data.describe())


def conventions(form: Mapping[str, str | None]) -> WamitFiles | None:
    """What a form says of WAMIT files; a point is three numbers between commas. Raises CaseError naming the field."""
    given: dict[str, Any] = {key: text.strip() for key, text in form.items() if text is not None and text.strip()}
    if "centre_of_mass" in given:
        given["centre_of_mass"] = [part.strip() for part in given["centre_of_mass"].strip("[]()").split(",")]
    for key, value in given.items():
        if key in ("length", "density", "gravity", "depth"):
            given[key] = _number(value)
        elif key == "centre_of_mass":
            given[key] = [_number(part) for part in value]
    if not given:
        return None
    try:
        return WamitFiles.model_validate(given)
    except ValidationError as error:
        raise CaseError([
            FieldError(tuple(item["loc"])[:1], item["msg"].removeprefix("Value error, "), repr(item.get("input"))[:80])
            for item in error.errors()
        ]) from None  # fmt: skip


def _number(text: str) -> float | str:
    """A bare number as one, in SI; anything else stays text, a number with a unit."""
    try:
        return float(text)
    except ValueError:
        return text


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


def info(row: DataSet) -> DataSetInfo:
    return DataSetInfo(
        id=row.id,
        name=row.name,
        version=row.version,
        filename=row.filename,
        content_hash=row.content_hash,
        size=row.size,
        summary=row.summary,
        created_at=row.created_at,
    )


def detail(row: DataSet, data: HydrodynamicData) -> DataSetDetail:
    return DataSetDetail(**info(row).model_dump(), checks=[check.as_dict() for check in quality(data)])


def opened(context: Context, scope: Scope, key: str) -> tuple[DataSet, HydrodynamicData]:
    """A data set and what it holds."""
    with context.database.read() as session:
        row = DataSetRepository(session, scope).get(key)
        source = PinnedSource(row)
    return row, source.open(row.name)


def _fault(field: str, message: str) -> CaseError:
    return CaseError([FieldError((field,), message)])
