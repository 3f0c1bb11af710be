"""Statics at once, for an editor that waits: a letter in the database, answered within its time or not at all."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Protocol

from solver.case import Case
from solver.outcome import Cancelled, SlowdriftError
from solver.results.part import OnProgress, Progress, Result
from solver.vessel.data import DataSource
from store.database import Database
from store.effective import stored_case
from store.models import FAILED, SUCCEEDED, DataSet
from store.repositories import PreviewRepository
from store.settings import Settings
from store.sources import PinnedSource

from .execute import to_json

POSITION = "/position"


class PreviewSolver(Protocol):
    """The door of solver.run that a preview uses."""

    def run(self, case: Case, data: DataSource, on_progress: OnProgress | None = None) -> Result: ...


def answer_preview(database: Database, solver: PreviewSolver, settings: Settings, preview_id: str) -> str:
    with database.write() as session:
        row = PreviewRepository(session).claim(preview_id, settings.preview_seconds)
        if row is None:
            return "nobody waits"
        canonical = row.canonical
        data = PinnedSource(session.get(DataSet, row.data_set_id) if row.data_set_id else None)
    state, answer = _statics(solver, canonical, data, _until(time.monotonic() + settings.preview_seconds))
    with database.write() as session:
        PreviewRepository(session).answer(preview_id, state, answer)
    return state


def _until(deadline: float) -> Callable[[Progress], None]:
    def check(_: Progress) -> None:
        if time.monotonic() > deadline:
            raise Cancelled

    return check


def _statics(solver: PreviewSolver, canonical: str, data: PinnedSource, check: OnProgress) -> tuple[str, str]:
    try:
        result = solver.run(stored_case(canonical, ["statics"]), data, check)
        if result.failures:
            return FAILED, " ".join(result.failures.values())
        return SUCCEEDED, to_json(shapes(result))
    except Cancelled:
        return FAILED, "Statics took too long for a preview; start a run instead."
    except SlowdriftError as error:
        return FAILED, str(error)


def shapes(result: Result) -> dict[str, Any]:
    """The statics summary, the line types, and where each line lies: arc length and [x, y, z] per node."""
    lines = {}
    for channel in result.channels:
        if channel.name.startswith("static/line/") and channel.name.endswith(POSITION):
            name = channel.name.removeprefix("static/line/").removesuffix(POSITION)
            lines[name] = {"arc_length": channel.axes[0].values, "position": channel.values}
    return {
        "statics": result.summary.get("statics"),
        "line_types": result.summary.get("line_types"),
        "lines": lines,
        "warnings": list(result.summary.get("warnings", ())),
    }
