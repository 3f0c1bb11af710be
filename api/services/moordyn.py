"""MoorDyn decks over REST: a deck to a case's text, a saved case to a deck. Nothing is stored."""

from __future__ import annotations

import json

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from solver.case.case import field_errors
from solver.io.moordyn import Placed, Written, write_deck
from solver.outcome import CaseError, FieldError
from store.errors import ConflictError
from store.reading import read_deck
from store.repositories import RunRepository
from store.scope import Scope

from ..bodies import Body, read_json
from ..context import Context
from ..schemas import FieldFault, ImportInfo, ImportReport
from .cases import saved


class ImportRequest(BaseModel):
    """A deck, and where it hangs on a vessel the text of a case that has it."""

    model_config = ConfigDict(extra="forbid")
    deck: str = Field(max_length=1_000_000)
    case: str | None = Field(None, max_length=1_000_000)
    name: str | None = Field(None, min_length=1, max_length=200)


def read(body: Body) -> ImportInfo:
    """Raises CaseError with lines of the deck."""
    if not body.is_json:
        return _read(body.content)
    try:
        request = ImportRequest.model_validate(read_json(body))
    except ValidationError as error:
        raise CaseError(field_errors(error)) from None
    return _read(request.deck, request.case, request.name)


def _read(deck: str | bytes, case: str | None = None, name: str | None = None) -> ImportInfo:
    found = read_deck(deck, case, name)
    errors = [FieldFault(**error.as_dict()) for error in found["errors"]]
    report = ImportReport(**found["report"])
    return ImportInfo(**{key: found[key] for key in ("complete", "name", "yaml", "case")}, report=report, errors=errors)


def write(context: Context, scope: Scope, case_id: str, run_id: str | None) -> Written:
    """The deck of a saved case; `run_id` is a run whose statics placed its anchors. Raises CaseError."""
    _, case = saved(context, scope, case_id)
    return write_deck(case, None if run_id is None else _placed(context, scope, run_id, case.content_hash()))


def _placed(context: Context, scope: Scope, run_id: str, content_hash: str) -> dict[str, Placed]:
    with context.database.read() as session:
        runs = RunRepository(session, scope)
        run, summary = runs.get(run_id), json.loads(runs.summary(run_id))
    if run.content_hash != content_hash:
        raise CaseError([FieldError(("run",), "this run is of another case", run_id[:64])])
    if "statics" not in summary:
        raise ConflictError("The run has no statics, which would place the anchors.")
    return Placed.of(summary)
