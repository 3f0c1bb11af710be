"""A bundle (bundle.py) from somewhere else becomes a run: checked in a child process before anything is stored."""

from __future__ import annotations

import os
from dataclasses import replace
from datetime import timedelta
from typing import IO, Any

from solver.outcome import CaseError, FieldError
from store.clock import utc_now
from store.isolation import Stopped, stream
from store.models import ChannelRow, Run
from store.quotas import check_file, check_runs
from store.reading import damaged, limits_for
from store.repositories import CaseRepository, DataSetRepository, RunRepository
from store.repositories.cases import NewCase
from store.repositories.imports import ImportRepository
from store.scope import Scope

from ..context import Context
from ..schemas import RunInfo
from .bundle_format import Manifest
from .runs import info


def import_run(context: Context, scope: Scope, file: IO[bytes]) -> tuple[RunInfo, bool]:
    """The run here, and whether it had to be made. Raises CaseError; then nothing was stored."""
    size = file.seek(0, os.SEEK_END)
    limit = 2 * context.settings.max_bundle_bytes
    limits = replace(limits_for(2 * size), answer_bytes=3 * limit)
    try:
        found = stream("api.services.bundle_check:checked", limit, limits=limits, attached=file)
        first = next(found)
    except Stopped as stopped:
        raise CaseError([FieldError(("file",), damaged("the bundle", stopped))]) from None
    manifest = Manifest.model_validate_json(first["manifest"])
    content_hash, data = manifest.identity(), first["data"]
    with context.change() as unit:
        imports, runs = ImportRepository(unit.session, scope), RunRepository(unit.session, scope)
        known = imports.known(content_hash)
        if known is not None:
            return info(runs.view(known)), False
        check_runs(context.settings, unit.session, scope, 1, queued=False)
        version = CaseRepository(unit.session, scope).save(NewCase(*first["case"]))[0]
        data_set, made_data = DataSetRepository(unit.session, scope).save(*data) if data else (None, False)
        if data_set and made_data:
            check_file(context.settings, unit.session, scope, data_set.size)
        run = _run(manifest, first["summary"], version.id, data_set.id if data_set else None)
        origin: dict[str, Any] = {
            "run": manifest.run.model_dump(mode="json", include={"id", "created_at", "finished_at"})
        }
        origin |= {"slowdrift": manifest.slowdrift, "exported_at": manifest.exported_at.isoformat()}
        made = imports.add(run, (ChannelRow(**fields) for fields in found), content_hash, origin)
        unit.tell(run_id=made)
        return info(runs.view(made)), True


def _run(manifest: Manifest, summary: str, version_id: str, data_set_id: str | None) -> Run:
    """Its times are moved to now, so that it is not taken for an old run; its duration stays."""
    part, now = manifest.run, utc_now()
    took = part.finished_at - part.started_at if part.finished_at and part.started_at else timedelta()
    warning = f"Imported: computed elsewhere by version {part.solver_version}; the numbers were not computed here."
    same = ("case_name", "content_hash", "data_hash", "analyses", "state", "reason", "outcomes", "solver_version")
    return Run(
        **{name: getattr(part, name) for name in same},
        name=part.name,
        case_version_id=version_id,
        data_set_id=data_set_id,
        summary=summary,
        warnings=[*part.warnings, warning],
        created_at=now - took,
        started_at=now - took,
        finished_at=now,
    )
