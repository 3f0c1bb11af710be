"""Runs: started from a saved case or a new one, and shown."""

from __future__ import annotations

from collections.abc import Iterable

from fastapi.exceptions import RequestValidationError

from solver.case import Case, to_yaml
from solver.outcome import CaseError, FieldError
from solver.plan import plan
from solver.results.part import Chunk
from store.effective import identity, stored_case
from store.errors import NotFoundError
from store.models import CASE, FINAL, CaseVersion, DataSet, Run
from store.priority import INTERACTIVE, NAMES, QUICK_WEIGHT, by_size, name_of
from store.quotas import check_runs
from store.repositories import CaseRepository, RunRepository
from store.repositories.runs import Labels, RunView
from store.scope import Scope

from ..context import Context
from ..idempotency import Once
from ..schemas import Chosen, RunCase, RunChange, RunInfo, RunRequest
from .cases import Checked, check_data, check_text, examine, saved


def start(context: Context, scope: Scope, request: RunRequest, once: Once) -> tuple[RunInfo, bool]:
    """Check everything, then insert the run with its tasks and commit, then ring. The run, and whether it is new."""
    case, of = base_of(context, scope, request)
    asked = stored_case(case.canonical(), request.analyses)
    warnings, data_set_id = examine(context, scope, asked)
    chunks, analyses = plan(asked), asked.analyses.requested()
    with context.change() as unit:
        cases, runs = CaseRepository(unit.session, scope), RunRepository(unit.session, scope)
        data_set = None if data_set_id is None else unit.session.get(DataSet, data_set_id)
        if request.reuse == "allow":
            data_hash = None if data_set is None else data_set.content_hash
            found = runs.identical(identity(case.content_hash(), data_hash, analyses))
            if found is not None:
                return info(runs.view(found.id)), False

        def make() -> str:
            check_runs(context.settings, unit.session, scope, 1)
            version = version_of(cases, of)
            run, doors = runs.create(version, analyses, chunks, data_set, warnings, labels_of(request, chunks))
            unit.rings.extend(doors)
            return run.id

        return info(runs.view(once.make(unit.session, scope, make))), True


def base_of(context: Context, scope: Scope, request: Chosen) -> tuple[Case, CaseVersion | Checked]:
    """The case that a request gives, by id or in full, without fault."""
    given = [name for name in ("case_id", "case", "yaml") if getattr(request, name) is not None]
    if len(given) != 1:
        fault = {"loc": (), "msg": f"give exactly one of case_id, case, yaml; given: {', '.join(given) or 'none'}"}
        raise RequestValidationError([fault])
    if request.case_id is not None:
        version, case = saved(context, scope, request.case_id)
        return case, version
    checked = (
        check_text(context, scope, request.yaml)
        if request.yaml is not None
        else check_data(context, scope, request.case)
    )
    return checked.case, checked


def version_of(cases: CaseRepository, of: CaseVersion | Checked) -> CaseVersion:
    """The saved case, in this unit of work."""
    return cases.save(of.as_new())[0] if isinstance(of, Checked) else cases.get(of.id)


def labels_of(request: Chosen, chunks: Iterable[Chunk]) -> Labels:
    """Raises CaseError for a priority that is more urgent than the size of the work allows."""
    priority = None if request.priority is None else NAMES[request.priority]
    weight = sum(chunk.weight for chunk in chunks)
    if priority == INTERACTIVE and by_size([weight]) != INTERACTIVE:
        message = (
            f"`interactive` is for at most {QUICK_WEIGHT:g} frequency-domain runs' work, this is {weight:.3g}; leave it "
            "out, or say normal or batch"
        )
        raise CaseError([FieldError(("priority",), message, request.priority or "")])
    return Labels(request.name, tuple(dict.fromkeys(request.tags)), priority)


def again(context: Context, scope: Scope, run_id: str, once: Once) -> RunInfo:
    """The same case version, data version and analyses once more."""
    _, case, _ = computed(context, scope, run_id)
    with context.change() as unit:
        runs = RunRepository(unit.session, scope)

        def make() -> str:
            check_runs(context.settings, unit.session, scope, 1)
            run, doors = runs.again(run_id, plan(case))
            unit.rings.extend(doors)
            return run.id

        return info(runs.view(once.make(unit.session, scope, make)))


def computed(context: Context, scope: Scope, run_id: str) -> tuple[RunView, Case, RunCase]:
    """A run, the case with the analyses asked of it, and that case as it may be saved. NotFoundError: it has none."""
    with context.database.read() as session:
        view = RunRepository(session, scope).view(run_id)
        run = view.run
        if run.kind != CASE or run.case_version_id is None:
            raise NotFoundError("case of the run", run_id)
        version = CaseRepository(session, scope).get_with_text(run.case_version_id)
    whole, text = stored_case(version.canonical, None, run.overrides), case_text(version, run)
    shown = RunCase(
        name=whole.name, content_hash=run.content_hash, case=whole.model_dump(mode="json", exclude_none=True), yaml=text
    )
    return view, stored_case(whole.canonical(), run.analyses), shown


def case_text(version: CaseVersion, run: Run) -> str:
    """The case that the run computes, as YAML: as it was submitted, unless the run changes it."""
    return to_yaml(stored_case(version.canonical, None, run.overrides)) if run.overrides else version.yaml


def show(context: Context, scope: Scope, run_id: str) -> RunInfo:
    with context.database.read() as session:
        return info(RunRepository(session, scope).view(run_id))


def cancel(context: Context, scope: Scope, run_id: str) -> RunInfo:
    with context.change() as unit:
        runs = RunRepository(unit.session, scope)
        runs.cancel(run_id)
        return info(runs.view(run_id))


def change(context: Context, scope: Scope, run_id: str, given: RunChange) -> RunInfo:
    with context.change() as unit:
        runs = RunRepository(unit.session, scope)
        tags = None if given.tags is None else list(dict.fromkeys(given.tags))
        runs.label(run_id, given.name, tags, given.pinned)
        return info(runs.view(run_id))


def info(view: RunView) -> RunInfo:
    run = view.run
    pending = {} if run.state in FINAL else dict.fromkeys(run.analyses, "pending")
    return RunInfo(
        id=run.id,
        kind=run.kind,
        case_id=run.case_version_id,
        case_name=run.case_name,
        content_hash=run.content_hash,
        analyses=run.analyses,
        state=run.state,
        outcomes=pending | run.outcomes,
        reason=run.reason,
        progress=view.progress,
        message=view.message,
        created_at=run.created_at,
        started_at=run.started_at,
        finished_at=run.finished_at,
        attempt=view.attempt,
        solver_version=run.solver_version,
        data_set_id=run.data_set_id,
        data_hash=run.data_hash,
        warnings=run.warnings,
        name=run.name,
        tags=run.tags,
        pinned=run.pinned,
        priority=name_of(view.priority),
        eta_seconds=view.seconds_left,
        study_id=run.study_id,
        study_index=run.study_index,
        overrides=run.overrides,
        rerun_of=run.rerun_of,
        created_by=view.created_by,
    )
