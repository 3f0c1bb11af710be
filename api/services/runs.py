"""Runs: started from a saved case or a new one, and shown."""

from __future__ import annotations

from fastapi.exceptions import RequestValidationError

from solver.case import Case
from solver.plan import plan
from store.broker import RUNS
from store.effective import stored_case
from store.models import FINAL, CaseVersion
from store.repositories import CaseRepository, RunRepository
from store.repositories.runs import RunView
from store.scope import Scope

from ..context import Context
from ..schemas import RunInfo, RunRequest
from .cases import Checked, check_data, check_text, examine, saved


def start(context: Context, scope: Scope, request: RunRequest) -> RunInfo:
    """Check everything, then insert the run with its tasks and commit, then ring."""
    given = [name for name in ("case_id", "case", "yaml") if getattr(request, name) is not None]
    if len(given) != 1:
        fault = {"loc": (), "msg": f"give exactly one of case_id, case, yaml; given: {', '.join(given) or 'none'}"}
        raise RequestValidationError([fault])
    if request.case_id is not None:
        version, case = saved(context, scope, request.case_id)
        return _insert(context, scope, request, case, version)
    if request.yaml is not None:
        checked = check_text(context, scope, request.yaml)
    else:
        checked = check_data(context, scope, request.case)
    return _insert(context, scope, request, checked.case, checked)


def _insert(context: Context, scope: Scope, request: RunRequest, case: Case, of: CaseVersion | Checked) -> RunInfo:
    asked = stored_case(case.canonical(), request.analyses)
    warnings, data_set_id = examine(context, scope, asked)
    chunks = plan(asked)
    with context.change() as unit:
        cases, runs = CaseRepository(unit.session, scope), RunRepository(unit.session, scope)
        version = cases.save(of.as_new())[0] if isinstance(of, Checked) else cases.get(of.id)
        run, tasks = runs.create(version, asked.analyses.requested(), chunks, data_set_id, warnings)
        unit.rings.extend((task, RUNS) for task in tasks)
        return info(runs.view(run.id))


def show(context: Context, scope: Scope, run_id: str) -> RunInfo:
    with context.database.read() as session:
        return info(RunRepository(session, scope).view(run_id))


def cancel(context: Context, scope: Scope, run_id: str) -> RunInfo:
    with context.change() as unit:
        runs = RunRepository(unit.session, scope)
        runs.cancel(run_id)
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
        warnings=run.warnings,
    )
