"""Hydrodynamic data: uploaded, listed, deleted."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, File, Form, Query, Response, UploadFile

from solver.outcome import CaseError, FieldError
from solver.vessel.data.bundle import MAX_FILES
from store.repositories import DataSetRepository

from ..context import ContextDep, ScopeDep
from ..schemas import Coefficients, DataSetDetail, DataSetInfo, DataSetPage, Stiffness
from ..services import data_sets as service
from ..services.coefficients import coefficients
from .common import Cursor, Key, Limit, problems

router = APIRouter(prefix="/data-sets", tags=["data sets"])
UPLOAD_BYTES = 256_000_000
"""The transport's limit; the setting max_data_bytes is the one that counts."""
Quantity = Literal["added_mass", "damping", "excitation", "motions", "mean_drift", "retardation", "qtf"]
Index = Annotated[int | None, Query(ge=0, le=5, description="degree of freedom: 0 (surge) to 5 (yaw)")]
Text = Annotated[str | None, Form(max_length=100)]


async def wamit_form(
    length: Text = None,
    values: Text = None,
    density: Text = None,
    gravity: Text = None,
    depth: Text = None,
    first_column: Text = None,
    pair_columns: Text = None,
    pair_order: Text = None,
    drift: Text = None,
    centre_of_mass: Text = None,
) -> dict[str, str | None]:
    """What WAMIT's files do not say of themselves, as `WamitFiles` of a case has it (GET /schema)."""
    return dict(locals())


WamitForm = Annotated[dict[str, str | None], Depends(wamit_form)]


@router.post(
    "",
    status_code=201,
    responses={200: {"model": DataSetInfo, "description": "These very data are here already."}, **problems(422)},
    max_body_size=UPLOAD_BYTES,
)
def upload(
    context: ContextDep,
    scope: ScopeDep,
    response: Response,
    file: Annotated[
        list[UploadFile], File(description="one NetCDF file, the files of a WAMIT set, or a ZIP of either")
    ],
    wamit: WamitForm,
    name: Annotated[str | None, Form(max_length=200)] = None,
) -> DataSetInfo:
    """Capytaine's NetCDF, or a WAMIT set with its conventions. The same name with other content makes a new version."""
    left, files = context.settings.max_data_bytes + 1, {}
    if len(file) > MAX_FILES:
        raise CaseError([FieldError(("file",), f"{len(file)} files; allowed: at most {MAX_FILES}")])
    for item in file:
        filename = service.harmless(item.filename or "") or "data"
        if filename in files:
            raise CaseError([FieldError(("file",), "the same name twice; give each file once", filename)])
        files[filename] = item.file.read(left)
        left -= len(files[filename])
        if left <= 0:
            break  # the service refuses what is over the limit
    row, made = service.add(context, scope, files, name, wamit)
    response.status_code = 201 if made else 200
    return service.info(row)


@router.get("")
def list_data_sets(context: ContextDep, scope: ScopeDep, limit: Limit = 50, cursor: Cursor = None) -> DataSetPage:
    with context.database.read() as session:
        rows = DataSetRepository(session, scope).page(limit, cursor)
    items = [service.info(row) for row in rows]
    return DataSetPage(items=items, next_cursor=rows[-1].id if len(rows) == limit else None)


@router.get("/{data_set_id}", responses=problems(404))
def get_data_set(context: ContextDep, scope: ScopeDep, data_set_id: Key) -> DataSetDetail:
    """What it holds, and the quality checks."""
    return service.detail(context, scope, data_set_id)


@router.get("/{data_set_id}/coefficients", responses=problems(404, 422))
def get_coefficients(
    context: ContextDep,
    scope: ScopeDep,
    data_set_id: Key,
    quantity: Quantity,
    i: Index = None,
    j: Index = None,
    heading: Annotated[float | None, Query(ge=-720, le=720, description="degrees; all when left out")] = None,
) -> Coefficients:
    """Arrays to draw: SI, frequencies rising, complex values in the time factor e^{iωt}."""
    _, data = service.opened(context, scope, data_set_id)
    return coefficients(data, quantity, i, j, heading)


@router.get("/{data_set_id}/stiffness", responses=problems(404))
def get_stiffness(context: ContextDep, scope: ScopeDep, data_set_id: Key) -> Stiffness:
    _, data = service.opened(context, scope, data_set_id)
    return Stiffness(
        hydrostatic_stiffness=_plain(data.hydrostatic_stiffness),
        reference_point=_plain(data.reference_point) if data.reference_known else None,
        centre_of_mass=_plain(data.centre_of_mass),
    )


def _plain(values: Any) -> Any:
    return None if values is None else values.tolist()


@router.delete("/{data_set_id}", status_code=204, responses=problems(404, 409))
def delete_data_set(context: ContextDep, scope: ScopeDep, data_set_id: Key) -> None:
    with context.change() as unit:
        DataSetRepository(unit.session, scope).delete(data_set_id)
