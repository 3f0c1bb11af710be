"""Runs: started, listed, cancelled, deleted, and their results."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Response

from store.filters import RunFilter
from store.repositories import ChannelRepository, RunRepository

from ..bodies import RunRequestDep
from ..context import ContextDep, ScopeDep
from ..idempotency import OnceDep
from ..schemas import ChannelPage, ChannelValues, RunCase, RunChange, RunInfo, RunPage, RunRequest
from ..services import channels
from ..services import runs as service
from .common import CASE_BYTES, Cursor, Key, Limit, StatesQuery, as_json, problems, states_of

router = APIRouter(prefix="/runs", tags=["runs"])
_REQUEST = {
    "requestBody": {
        "required": True,
        "content": {"application/json": {"schema": RunRequest.model_json_schema()}},
    }
}


async def run_filter(
    state: StatesQuery = None,
    q: Annotated[str | None, Query(max_length=200, description="part of the run's or the case's name")] = None,
    tag: Annotated[str | None, Query(max_length=50)] = None,
    study: Annotated[str | None, Query(max_length=64)] = None,
    case: Annotated[str | None, Query(max_length=64)] = None,
    pinned: bool | None = None,
    who: Annotated[str | None, Query(max_length=200, description="id, or part of the name, of the starter")] = None,
    since: Annotated[datetime | None, Query(alias="from", description="created at or after")] = None,
    until: Annotated[datetime | None, Query(alias="to", description="created at or before")] = None,
    sort: Literal["-created", "created"] = "-created",
) -> RunFilter:
    """The filters of a list of runs."""
    return RunFilter(
        states_of(state), q, tag, study, case, pinned, who, _aware(since), _aware(until), oldest_first=sort == "created"
    )


def _aware(moment: datetime | None) -> datetime | None:
    """A time without a zone is UTC."""
    return moment.replace(tzinfo=UTC) if moment is not None and moment.tzinfo is None else moment


@router.post(
    "",
    status_code=202,
    responses={
        200: {"model": RunInfo, "description": "With `reuse: allow`: this very run is here already."},
        **problems(404, 409, 422),
    },
    openapi_extra=_REQUEST,
    max_body_size=CASE_BYTES,
)
def start_run(
    context: ContextDep, scope: ScopeDep, request: RunRequestDep, once: OnceDep, response: Response
) -> RunInfo:
    """Queue a run of a saved case, or of one given here (which is saved first)."""
    run, made = service.start(context, scope, request, once)
    response.status_code = 202 if made else 200
    return run


@router.get("")
def list_runs(
    context: ContextDep,
    scope: ScopeDep,
    which: Annotated[RunFilter, Depends(run_filter)],
    limit: Limit = 50,
    cursor: Cursor = None,
    total: Annotated[bool, Query(description="whether to count all that the filters let through")] = False,
) -> RunPage:
    """Newest first, unless `sort` says otherwise."""
    with context.database.read() as session:
        runs = RunRepository(session, scope)
        views, count = runs.page(limit, cursor, which), runs.count(which) if total else None
    items = [service.info(view) for view in views]
    return as_json(RunPage(items=items, next_cursor=items[-1].id if len(items) == limit else None, total=count))


@router.get("/{run_id}", responses=problems(404))
def get_run(context: ContextDep, scope: ScopeDep, run_id: Key) -> RunInfo:
    return as_json(service.show(context, scope, run_id))


@router.post("/{run_id}/cancel", status_code=202, responses=problems(404, 409))
def cancel_run(context: ContextDep, scope: ScopeDep, run_id: Key) -> RunInfo:
    """A queued run ends at once; a running one within about two seconds."""
    return service.cancel(context, scope, run_id)


@router.patch("/{run_id}", responses=problems(404))
def change_run(context: ContextDep, scope: ScopeDep, run_id: Key, change: RunChange) -> RunInfo:
    """Name, tags, whether it is kept however old."""
    return service.change(context, scope, run_id, change)


@router.get("/{run_id}/case", responses=problems(404))
def get_run_case(context: ContextDep, scope: ScopeDep, run_id: Key) -> RunCase:
    """The very case that it computes; of a study's run, with what the study changes."""
    return service.computed(context, scope, run_id)[2]


@router.post("/{run_id}/rerun", status_code=202, responses=problems(404, 409))
def rerun(context: ContextDep, scope: ScopeDep, run_id: Key, once: OnceDep) -> RunInfo:
    """The same case version, data version and analyses again: the same numbers."""
    return service.again(context, scope, run_id, once)


@router.delete("/{run_id}", status_code=204, responses=problems(404, 409))
def delete_run(context: ContextDep, scope: ScopeDep, run_id: Key) -> None:
    with context.change() as unit:
        RunRepository(unit.session, scope).delete(run_id)


@router.get("/{run_id}/summary", responses=problems(404, 409))
def get_summary(context: ContextDep, scope: ScopeDep, run_id: Key) -> dict[str, Any]:
    """docs/summary.md describes it. A failed run has one too when some of its analyses gave results."""
    with context.database.read() as session:
        text = RunRepository(session, scope).summary(run_id)
    return Response(text, media_type="application/json")  # type: ignore[return-value]  # it is JSON already


@router.get("/{run_id}/channels", responses=problems(404))
def list_channels(context: ContextDep, scope: ScopeDep, run_id: Key) -> ChannelPage:
    with context.database.read() as session:
        run = RunRepository(session, scope).get(run_id)
        found = ChannelRepository(session).names(run.id)
    return ChannelPage.model_validate({"items": [channels.listing(info) for info in found]})


@router.get("/{run_id}/channels/{name:path}", responses={200: {"model": ChannelValues}, **problems(404, 422)})
def get_channel(
    context: ContextDep,
    scope: ScopeDep,
    run_id: Key,
    name: str,
    start: Annotated[float | None, Query(alias="from", description="on the first axis", allow_inf_nan=False)] = None,
    stop: Annotated[float | None, Query(alias="to", description="on the first axis", allow_inf_nan=False)] = None,
    points: Annotated[int | None, Query(ge=4, le=1_000_000, description="at most so many on the first axis")] = None,
    seed: int | None = None,
    arc_length: Annotated[float | None, Query(description="the nearest node [m]", allow_inf_nan=False)] = None,
) -> Response:
    """Values, sliced and decimated here (M4: no peak is lost)."""
    with context.database.read() as session:
        run = RunRepository(session, scope).get(run_id)
        channel = ChannelRepository(session).get(run.id, name)
    shown = channels.look(channel, channels.View(start, stop, points, seed, arc_length))
    return Response(json.dumps(shown, allow_nan=False, separators=(",", ":")), media_type="application/json")
