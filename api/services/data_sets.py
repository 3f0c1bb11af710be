"""Uploads of hydrodynamic data: bounded, read before they are stored, named harmlessly."""

from __future__ import annotations

import hashlib
import re

from solver.outcome import CaseError, DataError, FieldError
from solver.vessel import data as hydrodynamics
from store.models import DataSet
from store.repositories import DataSetRepository
from store.scope import Scope

from ..context import Context
from ..schemas import DataSetInfo


def harmless(name: str) -> str:
    """The last part of a path, of plain characters only."""
    last = re.split(r"[/\\]", name)[-1]
    return re.sub(r"[^A-Za-z0-9._ ()+-]", "_", last).strip(" .")[:100]


def add(context: Context, scope: Scope, payload: bytes, filename: str, name: str | None) -> tuple[DataSet, bool]:
    if len(payload) > context.settings.max_data_bytes:
        raise _fault("file", f"{len(payload)} bytes; allowed: at most {context.settings.max_data_bytes}")
    filename = harmless(filename) or "data"
    label = harmless(name or "") or filename
    try:
        summary = hydrodynamics.read_bytes(payload, filename).describe()
    except DataError as error:
        raise _fault("file", str(error)) from None
    content_hash = hashlib.sha256(payload).hexdigest()
    with context.change() as unit:
        return DataSetRepository(unit.session, scope).save(label, filename, content_hash, payload, summary)


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


def _fault(field: str, message: str) -> CaseError:
    return CaseError([FieldError((field,), message)])
