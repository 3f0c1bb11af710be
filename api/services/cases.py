"""From a text to a checked case, and to a saved one. Nothing is stored of a case that has a fault."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from solver.case import Case, to_yaml
from solver.case.partial import noted
from solver.case.text import MAX_BYTES, Reading
from solver.check import check
from solver.outcome import CaseError, DataError, FieldError
from store.effective import stored_case
from store.errors import NotFoundError
from store.models import CaseVersion, DataSet
from store.reading import read_bytes, read_case, read_case_data
from store.repositories import CaseRepository, DataSetRepository
from store.repositories.cases import NewCase
from store.scope import Scope
from store.sources import PinnedSource

from ..bodies import Body, read_json
from ..context import Context
from ..schemas import CaseDetail, CaseInfo

DATA = ("vessel", "hydrodynamics", "data")


@dataclass(frozen=True)
class Checked:
    """A case without fault, as it would be saved, and the data set its reference means."""

    case: Case
    yaml: str
    warnings: tuple[str, ...]
    data_set_id: str | None

    def as_new(self) -> NewCase:
        return NewCase(self.case.name, self.case.content_hash(), self.case.canonical(), self.yaml, self.warnings)


def check_body(context: Context, scope: Scope, body: Body) -> Checked:
    """Raises CaseError or DataError."""
    if body.is_json:
        return check_data(context, scope, read_json(body), len(body.content))
    return check_text(context, scope, body.content)


def check_data(context: Context, scope: Scope, data: Any, size: int = 0) -> Checked:
    if size > MAX_BYTES:
        raise CaseError([FieldError((), f"the case has {size} bytes; allowed: at most {MAX_BYTES}")])
    reading = read_case_data(data)
    warnings, data_set_id = _examined(context, scope, reading)
    case = reading.sound()
    return Checked(case, to_yaml(case), warnings, data_set_id)


def check_text(context: Context, scope: Scope, text: str | bytes) -> Checked:
    reading = read_case(text)
    warnings, data_set_id = _examined(context, scope, reading)
    case = reading.sound()
    return Checked(case, text if isinstance(text, str) else text.decode("utf-8-sig"), warnings, data_set_id)


def _examined(context: Context, scope: Scope, reading: Reading) -> tuple[tuple[str, ...], str | None]:
    """As `examine`, for a case that may have faults: those found here are added to the reading's."""
    found: tuple[tuple[str, ...], str | None] = (), None
    faults: list[FieldError] = []
    if reading.case is not None:
        with noted(faults):
            nameable(reading.case)
        with noted(faults):
            found = examine(context, scope, reading.case)
    reading.add(faults)
    return found


def nameable(case: Case) -> Case:
    """Names stand in lists and columns of their own; control characters and half surrogates cannot."""
    errors = [
        FieldError((field,), "holds characters that cannot be shown, such as control characters", ascii(text)[:80])
        for field, text in (("name", case.name), ("description", re.sub(r"\s", "", case.description)))
        if not text.isprintable()
    ]
    if errors:
        raise CaseError(errors)
    return case


def examine(context: Context, scope: Scope, case: Case) -> tuple[tuple[str, ...], str | None]:
    """Warnings, and the id of the data set the case refers to. Raises CaseError."""
    with context.database.read() as session:
        row = find_data(session, scope, case)
        source = PinnedSource(row, read_bytes, states_conventions(case))
    try:
        return tuple(check(case, source)), None if row is None else row.id
    except DataError as error:
        raise CaseError([FieldError(DATA, str(error))]) from None


def states_conventions(case: Case) -> bool:
    hydrodynamics = case.vessel.hydrodynamics if case.vessel else None
    return hydrodynamics is not None and hydrodynamics.wamit is not None


def find_data(session: Session, scope: Scope, case: Case) -> DataSet | None:
    hydrodynamics = case.vessel.hydrodynamics if case.vessel else None
    if hydrodynamics is None:
        return None
    data_sets = DataSetRepository(session, scope)
    try:
        return data_sets.find(hydrodynamics.data)
    except NotFoundError:
        known = ", ".join(data_sets.names()) or "none"
        message = f"there is no data set of this id, hash or name; known: {known}; upload it with POST /data-sets"
        raise CaseError([FieldError(DATA, message, repr(hydrodynamics.data)[:80])]) from None


def save(context: Context, scope: Scope, checked: Checked) -> tuple[CaseVersion, bool]:
    with context.change() as unit:
        return CaseRepository(unit.session, scope).save(checked.as_new())


def info(version: CaseVersion) -> CaseInfo:
    return CaseInfo(
        id=version.id,
        name=version.name,
        version=version.number,
        content_hash=version.content_hash,
        created_at=version.created_at,
        warnings=version.warnings,
    )


def detail(version: CaseVersion) -> CaseDetail:
    return CaseDetail(**info(version).model_dump(), case=json.loads(version.canonical), yaml=version.yaml)


def saved(context: Context, scope: Scope, key: str) -> tuple[CaseVersion, Case]:
    with context.database.read() as session:
        version = CaseRepository(session, scope).get_with_text(key)
    return version, stored_case(version.canonical)
