"""Uploads of hydrodynamic data: bounded, read before they are stored, named harmlessly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from solver.case.vessel import WamitFiles
from solver.outcome import CaseError, DataError, FieldError
from solver.vessel.data import HydrodynamicData
from store.isolation import Stopped, call
from store.models import DataSet
from store.quotas import check_file
from store.reading import damaged, limits_for, quality_of, read_bytes
from store.repositories import DataSetRepository
from store.scope import Scope
from store.sources import PinnedSource

from ..context import Context
from ..schemas import DataSetDetail, DataSetInfo
from .data_reading import harmless


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
    named = {harmless(key) or "data": payload for key, payload in files.items()}
    try:
        read = call("api.services.data_reading:read_upload", named, options, limits=limits_for(size))
    except DataError as error:
        raise _fault("file", str(error)) from None
    except Stopped as stopped:
        raise _fault("file", damaged(", ".join(sorted(named)[:3]), stopped)) from None
    filename, content_hash, payload, summary = read
    label = harmless(name or "") or filename
    with context.change() as unit:
        row, made = DataSetRepository(unit.session, scope).save(label, filename, content_hash, payload, summary)
        if made:
            check_file(context.settings, unit.session, scope, row.size)
        return row, made


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


def detail(context: Context, scope: Scope, key: str) -> DataSetDetail:
    """With the quality checks, which are made in a child process: of large data they take seconds."""
    with context.database.read() as session:
        row = DataSetRepository(session, scope).get(key)
        payload = row.payload
    return DataSetDetail.model_validate(info(row).model_dump() | {"checks": quality_of(payload, row.filename)})


def opened(context: Context, scope: Scope, key: str) -> tuple[DataSet, HydrodynamicData]:
    """A data set and what it holds."""
    with context.database.read() as session:
        row = DataSetRepository(session, scope).get(key)
        source = PinnedSource(row, read_bytes, stated=False)
    return row, source.open(row.name)


def _fault(field: str, message: str) -> CaseError:
    return CaseError([FieldError((field,), message)])
