"""Hydrodynamic data: uploaded, listed, deleted."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Form, Response, UploadFile

from store.repositories import DataSetRepository

from ..context import ContextDep, ScopeDep
from ..schemas import DataSetInfo, DataSetPage
from ..services import data_sets as service
from .common import Cursor, Key, Limit, problems

router = APIRouter(prefix="/data-sets", tags=["data sets"])
UPLOAD_BYTES = 256_000_000
"""The transport's limit; the setting max_data_bytes is the one that counts."""


@router.post(
    "",
    status_code=201,
    responses={200: {"model": DataSetInfo, "description": "This very file is here already."}, **problems(422)},
    max_body_size=UPLOAD_BYTES,
)
def upload(
    context: ContextDep,
    scope: ScopeDep,
    response: Response,
    file: UploadFile,
    name: Annotated[str | None, Form(max_length=200)] = None,
) -> DataSetInfo:
    """A NetCDF file in Capytaine's layout. The same name with other content makes a new version."""
    payload = file.file.read(context.settings.max_data_bytes + 1)
    row, made = service.add(context, scope, payload, file.filename or "", name)
    response.status_code = 201 if made else 200
    return service.info(row)


@router.get("")
def list_data_sets(context: ContextDep, scope: ScopeDep, limit: Limit = 50, cursor: Cursor = None) -> DataSetPage:
    with context.database.read() as session:
        rows = DataSetRepository(session, scope).page(limit, cursor)
    items = [service.info(row) for row in rows]
    return DataSetPage(items=items, next_cursor=rows[-1].id if len(rows) == limit else None)


@router.get("/{data_set_id}", responses=problems(404))
def get_data_set(context: ContextDep, scope: ScopeDep, data_set_id: Key) -> DataSetInfo:
    with context.database.read() as session:
        return service.info(DataSetRepository(session, scope).get(data_set_id))


@router.delete("/{data_set_id}", status_code=204, responses=problems(404, 409))
def delete_data_set(context: ContextDep, scope: ScopeDep, data_set_id: Key) -> None:
    with context.change() as unit:
        DataSetRepository(unit.session, scope).delete(data_set_id)
