"""Links that show a few runs to whoever has them, and what they show."""

from __future__ import annotations

import json
from datetime import timedelta

from fastapi import APIRouter

from solver.outcome import CaseError, FieldError
from store.clock import utc_now
from store.people import Share
from store.repositories import RunRepository
from store.repositories.entry import EntryRepository
from store.repositories.shares import ShareRepository
from store.tokens import SHARE, digest, new_token

from ..access import SHARE_TOKEN
from ..context import ContextDep, ScopeDep
from ..people_schemas import NewShare, SharedInfo, ShareInfo, SharePage, ShareRequest
from ..schemas import ChannelValues
from ..services import runs as service
from . import cases, events, runs
from .common import Cursor, Key, Limit, problems
from .teams import LinksDep

router = APIRouter(tags=["sharing"])
opened = APIRouter(prefix=f"/shared/{{{SHARE_TOKEN}}}", tags=["sharing"], responses=problems(404))
"""Behind a link: the very routes of runs, with a scope that holds the shared ones only (api/access.py)."""
VIEW_BYTES = 20_000


@router.get("/shares")
def list_shares(context: ContextDep, scope: ScopeDep, limit: Limit = 50, cursor: Cursor = None) -> SharePage:
    """Those of the project, newest first, revoked and expired ones included."""
    with context.database.read() as session:
        rows = ShareRepository(session, scope).page(limit, cursor)
    items = [_info(row) for row in rows]
    return SharePage(items=items, next_cursor=items[-1].id if len(items) == limit else None)


@router.post("/shares", status_code=201, responses=problems(404))
def add_share(context: ContextDep, scope: ScopeDep, links: LinksDep, body: ShareRequest) -> NewShare:
    """The answer holds the link, this once."""
    size = len(json.dumps(body.view))
    if size > VIEW_BYTES:
        raise CaseError([FieldError(("view",), f"{size} bytes; allowed: at most {VIEW_BYTES}")])
    token = new_token(SHARE)
    expires_at = utc_now() + timedelta(days=body.expires_in_days) if body.expires_in_days else None
    with context.change() as unit:
        views = RunRepository(unit.session, scope).views(body.run_ids)
        title = body.title or ", ".join(dict.fromkeys(view.run.case_name for view in views))[:100]
        shares = ShareRepository(unit.session, scope)
        row = shares.add(title, body.run_ids, body.view, digest(token, context.secret), expires_at)
        unit.tell(share_id=row.id, runs=" ".join(body.run_ids))
    return NewShare(**_info(row).model_dump(), token=token, url=f"{links}/app/shared/{token}")


@router.delete("/shares/{share_id}", status_code=204, responses=problems(404))
def revoke_share(context: ContextDep, scope: ScopeDep, share_id: Key) -> None:
    with context.change() as unit:
        ShareRepository(unit.session, scope).revoke(share_id)


@opened.get("")
def show_shared(context: ContextDep, scope: ScopeDep, share_token: Key) -> SharedInfo:
    """What the link opens: a run, or several to be compared, in the order they were shared."""
    with context.database.read() as session:
        share = EntryRepository(session).share(digest(share_token, context.secret))
        views = {view.run.id: view for view in RunRepository(session, scope).views(scope.run_ids or ())}
        shown = [service.info(views[key]) for key in scope.run_ids or () if key in views]
    assert share is not None  # `link` has let the request in
    return SharedInfo(
        title=share.title, runs=shown, view=share.view, created_at=share.created_at, expires_at=share.expires_at
    )


opened.get("/runs/{run_id}")(runs.get_run)
opened.get("/runs/{run_id}/events", response_class=events.EventStream)(events.follow_run)
opened.get("/runs/{run_id}/case")(runs.get_run_case)
opened.get("/runs/{run_id}/summary", responses=problems(409))(runs.get_summary)
opened.get("/runs/{run_id}/channels")(runs.list_channels)
opened.get("/runs/{run_id}/channels/{name:path}", responses={200: {"model": ChannelValues}})(runs.get_channel)
opened.get("/cases/{case_id}")(cases.get_case)


def _info(row: Share) -> ShareInfo:
    return ShareInfo(**{name: getattr(row, name) for name in ShareInfo.model_fields})
