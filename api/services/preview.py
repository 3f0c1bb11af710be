"""Statics for an editor that waits: asked through the interactive queue, answered in about a second or not at all."""

from __future__ import annotations

import time

from solver.case import Case, parse_case
from solver.outcome import NotConverged
from store.errors import TooSlowError, UnavailableError
from store.models import SUCCEEDED
from store.repositories import PreviewRepository
from store.scope import Scope

from ..bodies import Body
from ..context import Context
from .cases import check_body

POLL_SECONDS = 0.01


def preview(context: Context, scope: Scope, body: Body) -> str:
    """The answer as JSON text."""
    checked = check_body(context, scope, body)
    canonical = _only_statics(checked.case)
    with context.change() as unit:
        key = PreviewRepository(unit.session, scope).ask(canonical, checked.data_set_id)
    context.doorbell.ring_preview(key)
    state, answer = _wait(context, key)
    if state != SUCCEEDED:
        raise NotConverged("statics", answer, "")
    return answer


def _only_statics(case: Case) -> str:
    data = case.model_dump(mode="json", exclude_none=True)
    data["analyses"] = {"statics": data["analyses"].get("statics", {})}
    return parse_case(data).canonical()


def _wait(context: Context, key: str) -> tuple[str, str]:
    deadline = time.monotonic() + context.settings.preview_seconds
    try:
        while time.monotonic() < deadline:
            with context.database.read() as session:
                found = PreviewRepository(session).collect(key)
            if found is not None:
                return found
            time.sleep(POLL_SECONDS)
        if context.doorbell.last_error is not None:
            raise UnavailableError("The queue for previews cannot be reached.")
        raise TooSlowError(
            f"No preview within {context.settings.preview_seconds:g} s: the case is large, or the worker is busy or "
            "starting. Try again, or start a run."
        )
    finally:
        with context.change() as unit:
            PreviewRepository(unit.session).remove(key)
