"""Runs as files that travel from one Slowdrift to another."""

from __future__ import annotations

import tempfile
from collections.abc import AsyncIterator
from typing import IO, Annotated

from fastapi import APIRouter, Depends, Request, Response
from fastapi.responses import StreamingResponse

from solver.outcome import CaseError, FieldError

from ..context import ContextDep, ScopeDep
from ..schemas import RunInfo
from ..services.bundle import bundle, pieces
from ..services.bundle_import import import_run
from .common import Key, problems

router = APIRouter(tags=["sharing"])
UPLOAD_BYTES = 2_000_000_000
"""The transport's limit; the setting max_bundle_bytes is the one that counts."""
_BODY = {
    "requestBody": {
        "required": True,
        "content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}},
    }
}


async def read_upload(request: Request, context: ContextDep) -> AsyncIterator[IO[bytes]]:
    """The body as a file, on disk when it is large; refused as soon as it is too large."""
    limit, size = context.settings.max_bundle_bytes, 0
    with tempfile.SpooledTemporaryFile(max_size=8_000_000) as spool:
        async for piece in request.stream():
            size += len(piece)
            if size > limit:
                raise CaseError([FieldError(("file",), f"has more than {limit} bytes, the most allowed")])
            spool.write(piece)
        spool.seek(0)
        spool.rollover()  # a file of the system, which a child process can read
        yield spool  # type: ignore[misc]  # SpooledTemporaryFile is an IO[bytes] in all but name


@router.get(
    "/runs/{run_id}/bundle",
    responses={200: {"content": {"application/zip": {}}}, **problems(404, 409)},
    response_class=StreamingResponse,
)
def export_bundle(context: ContextDep, scope: ScopeDep, run_id: Key) -> StreamingResponse:
    """The run as one file that another Slowdrift imports: case, data, summary, channels, and their hashes."""
    file = bundle(context, scope, run_id)
    headers = {"Content-Disposition": f'attachment; filename="slowdrift-run-{run_id[:32]}.zip"'}
    return StreamingResponse(pieces(file), media_type="application/zip", headers=headers)


@router.post(
    "/imports/run",
    status_code=201,
    responses={200: {"model": RunInfo, "description": "This very run is here already."}, **problems(409, 422)},
    openapi_extra=_BODY,
    max_body_size=UPLOAD_BYTES,
)
def import_bundle(
    context: ContextDep, scope: ScopeDep, file: Annotated[IO[bytes], Depends(read_upload)], response: Response
) -> RunInfo:
    """A file of GET /runs/{id}/bundle, from here or elsewhere. Everything in it is checked before it is stored."""
    run, made = import_run(context, scope, file)
    response.status_code = 201 if made else 200
    return run
