"""Studies: a base case and overrides, checked one by one, stored and queued in one piece or not at all."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Mapping
from typing import Any

from fastapi.exceptions import RequestValidationError

from solver.case import ANALYSES, Case, parse_case
from solver.check import check
from solver.outcome import CaseError, DataError, FieldError
from solver.plan import plan
from store.effective import chosen
from store.models import ACTIVE, CANCELLED, FAILED, SUCCEEDED, DataSet, Study
from store.pointers import replaced, value_at
from store.quotas import check_runs
from store.reading import read_bytes
from store.repositories import CaseRepository, RunRepository, StudyRepository
from store.repositories.studies import StudyView, Variant
from store.scope import Scope
from store.sources import PinnedSource

from ..context import Context
from ..idempotency import Once
from ..schemas import RunPage
from ..study_schemas import MOST_RUNS, StudyInfo, StudyRequest
from .cases import DATA, find_data, nameable
from .runs import base_of, info, labels_of, version_of

MOST_FAULTS = 100
LINES = ("/line_types/", "/lines/", "/attachments/")


def start(context: Context, scope: Scope, request: StudyRequest, once: Once) -> StudyInfo:
    """Check every run, then insert all of them and commit, then ring. Raises CaseError; then nothing is stored."""
    case, of = base_of(context, scope, request)
    changes = _changes(request)
    variants = _Checker(context, scope, case, request.analyses).all(changes)
    labels = labels_of(request, [chunk for variant in variants for chunk in variant.chunks])
    pointers = list(dict.fromkeys(pointer for each in changes for pointer in each))
    with context.change() as unit:
        studies = StudyRepository(unit.session, scope)

        def make() -> str:
            check_runs(context.settings, unit.session, scope, len(variants))
            study = Study(
                name=request.name or case.name,
                analyses=list(request.analyses or case.analyses.requested()),
                axes=request.grid,
                pointers=pointers,
            )
            version = version_of(CaseRepository(unit.session, scope), of)
            doors = studies.create(study, version, variants, labels)
            unit.rings.extend(("", door) for door in doors)
            return study.id

        return show(studies.view(once.make(unit.session, scope, make)))


def _changes(request: StudyRequest) -> list[dict[str, Any]]:
    """What each run changes."""
    if (request.overrides is None) == (request.grid is None):
        raise _fault((), "give exactly one of overrides, grid")
    if request.overrides is not None:
        return request.overrides
    grid = request.grid or {}
    empty = next((pointer for pointer, values in grid.items() if not values), None)
    if empty is not None:
        raise _fault(("grid", empty), "a list of at least one value is wanted")
    size = math.prod(len(values) for values in grid.values())
    if size > MOST_RUNS:
        raise _fault(("grid",), f"{size} runs; allowed: at most {MOST_RUNS}")
    return [dict(zip(grid, values, strict=True)) for values in itertools.product(*grid.values())]


def _fault(loc: tuple[str, ...], message: str) -> RequestValidationError:
    return RequestValidationError([{"loc": loc, "msg": message}])


class _Checker:
    """Makes the runs of a study out of its base case, and tells every fault by the number of the run."""

    def __init__(self, context: Context, scope: Scope, case: Case, analyses: list[str] | None):
        self._context, self._scope, self._analyses = context, scope, analyses
        self._base = json.loads(case.canonical())
        if analyses is not None:
            chosen(self._base, analyses)  # says which of them the case does not hold
        self._checked: dict[tuple[tuple[str, str], ...], tuple[str, ...]] = {}
        self._data: dict[str | None, tuple[DataSet | None, PinnedSource]] = {}

    def all(self, changes: list[dict[str, Any]]) -> list[Variant]:
        variants: list[Variant] = []
        faults: list[FieldError] = []
        for index, overrides in enumerate(changes):
            try:
                variants.append(self._one(overrides))
            except CaseError as error:
                prefix = ("overrides", index)
                faults += [FieldError((*prefix, *fault.loc), fault.message, fault.value) for fault in error.errors]
                if len(faults) >= MOST_FAULTS:
                    break
        if faults:
            raise CaseError(faults[:MOST_FAULTS])
        return variants

    def _one(self, overrides: Mapping[str, Any]) -> Variant:
        whole = nameable(parse_case(replaced(self._base, overrides)))
        asked = whole if self._analyses is None else self._asked(whole, self._analyses)
        row, source = self._source(asked)
        canonical = whole.canonical()
        plain = json.loads(canonical)
        kept = {pointer: value_at(plain, pointer) for pointer in overrides}
        kept = {pointer: overrides[pointer] if value is None else value for pointer, value in kept.items()}
        return Variant(
            kept,
            hashlib.sha256(canonical.encode()).hexdigest(),
            whole.name,
            tuple(asked.analyses.requested()),
            tuple(plan(asked)),
            row,
            self._warnings(asked, source, overrides),
        )

    @staticmethod
    def _asked(whole: Case, analyses: list[str]) -> Case:
        """The valid case with a choice of its analyses, which is valid too."""
        others = {name: None for name in ANALYSES if name not in analyses}
        return whole.model_copy(update={"analyses": whole.analyses.model_copy(update=others)})

    def _warnings(self, case: Case, source: PinnedSource, overrides: Mapping[str, Any]) -> tuple[str, ...]:
        """What `check` says, asked once for all runs that differ in their lines only: it looks at the vessel in its sea."""
        key = tuple((pointer, repr(value)) for pointer, value in overrides.items() if not pointer.startswith(LINES))
        if key not in self._checked:
            try:
                self._checked[key] = tuple(check(case, source))
            except DataError as error:
                raise CaseError([FieldError(DATA, str(error))]) from None
        return self._checked[key]

    def _source(self, case: Case) -> tuple[DataSet | None, PinnedSource]:
        hydrodynamics = case.vessel.hydrodynamics if case.vessel else None
        reference = None if hydrodynamics is None else hydrodynamics.data
        if reference not in self._data:
            with self._context.database.read() as session:
                row = find_data(session, self._scope, case)
                self._data[reference] = row, PinnedSource(row, read_bytes)
        return self._data[reference]


def show(view: StudyView) -> StudyInfo:
    study, counts = view.study, view.counts
    if any(counts.get(state) for state in ACTIVE):
        state = "active"
    else:
        state = next((state for state in (FAILED, CANCELLED) if counts.get(state)), SUCCEEDED)
    return StudyInfo(
        id=study.id,
        name=study.name,
        case_id=study.case_version_id,
        analyses=study.analyses,
        axes=study.axes,
        pointers=study.pointers,
        size=study.size,
        state=state,
        counts=counts,
        progress=min(1.0, view.progress),
        eta_seconds=view.seconds_left,
        created_at=study.created_at,
    )


def runs_of(
    context: Context, scope: Scope, study_id: str, limit: int, cursor: str | None, states: tuple[str, ...]
) -> RunPage:
    """Its runs in their order; the cursor is the number of the last one seen."""
    with context.database.read() as session:
        study = StudyRepository(session, scope).view(study_id)
        numbered = StudyRepository(session, scope).run_ids(study_id, limit, place(cursor), states)
        views = RunRepository(session, scope).views([run_id for run_id, _ in numbered])
        items = sorted((info(view) for view in views), key=lambda run: run.study_index or 0)
    following = str(numbered[-1][1]) if len(numbered) == limit else None
    total = sum(count for state, count in study.counts.items() if not states or state in states)
    return RunPage(items=items, next_cursor=following, total=total)


def place(cursor: str | None) -> int:
    """The number in a cursor. Raises RequestValidationError."""
    if cursor is None:
        return -1
    if not (cursor.isascii() and cursor.isdigit() and len(cursor) < 10):
        raise _fault(("cursor",), "no cursor of this list")
    return int(cursor)


def cancel(context: Context, scope: Scope, study_id: str) -> StudyInfo:
    with context.change() as unit:
        studies = StudyRepository(unit.session, scope)
        studies.cancel(study_id)
        return show(studies.view(study_id))


def page(context: Context, scope: Scope, limit: int, cursor: str | None) -> list[StudyInfo]:
    with context.database.read() as session:
        return [show(view) for view in StudyRepository(session, scope).page(limit, cursor)]
