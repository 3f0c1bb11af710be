"""Results as files."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse

from ..context import ContextDep, ScopeDep
from ..services import data_exports
from ..services import export as service
from .common import Key, problems

router = APIRouter()
Format = Literal["zip", "netcdf", "csv", "parquet"]
_FILES: dict[str, dict[str, str]] = {media.partition(";")[0]: {} for media in service.MEDIA.values()}


@router.get(
    "/runs/{run_id}/export",
    tags=["runs"],
    responses={200: {"content": _FILES}, **problems(404, 409, 422)},
    response_class=StreamingResponse,
)
def export_run(
    context: ContextDep,
    scope: ScopeDep,
    run_id: Key,
    format: Format = "zip",
    channels: Annotated[
        str | None, Query(max_length=4000, description="names or patterns with *, comma-separated")
    ] = None,
    layout: Annotated[Literal["long", "wide"], Query(description="of a CSV table")] = "long",
    seed: Annotated[int | None, Query(ge=0, le=2**63 - 1, description="one realisation")] = None,
) -> StreamingResponse:
    """Everything in a ZIP, or channels as NetCDF, CSV or Parquet (docs/export.md)."""
    made = service.export(context, scope, run_id, service.Wanted(format, channels, layout, seed))
    headers = {"Content-Disposition": f'attachment; filename="{made.filename}"'}
    return StreamingResponse(made.pieces(), media_type=made.media_type, headers=headers)


@router.get(
    "/data-sets/{data_set_id}/export",
    tags=["data sets"],
    responses={200: {"content": {"application/x-netcdf": {}, "application/zip": {}}}, **problems(404, 422)},
    response_class=Response,
)
def export_data_set(
    context: ContextDep,
    scope: ScopeDep,
    data_set_id: Key,
    format: data_exports.Format = "netcdf",
    length: Annotated[float | None, Query(gt=0, le=1e6, description="ULEN of a WAMIT set [m]")] = None,
) -> Response:
    """Hydrodynamic data as NetCDF in Capytaine's layout, or as a WAMIT set in a ZIP with its conventions."""
    made = data_exports.export(context, scope, data_set_id, format, length)
    headers = {"Content-Disposition": f'attachment; filename="{made.filename}"'}
    return Response(made.payload, media_type=made.media_type, headers=headers)
