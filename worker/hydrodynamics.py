"""A hydrodynamic job from claim to data set."""

from __future__ import annotations

import logging
import os
from pathlib import Path
from typing import Any

from solver.outcome import DataError
from solver.results.part import OnProgress
from solver.vessel import data as hydrodynamics
from store.repositories.hydrodynamics import ANALYSIS, Assignment, Made

__all__ = ["ANALYSIS", "compute", "warm_up"]
log = logging.getLogger(__name__)
WARM_FOLDER = "capytaine"
"""Inside the data folder: tables of the Green function, made once."""


def warm_up(data_dir: Path) -> None:
    """Have the tables of the Green function ready, in the data folder, before the first task."""
    _settle(data_dir)
    from solver.bem.green import make_tables

    try:
        make_tables()
    except DataError as error:
        log.warning("Hydrodynamic jobs will fail on this worker: %s", error)


def _settle(data_dir: Path) -> None:
    os.environ.setdefault("CAPYTAINE_CACHE_DIR", str(data_dir.absolute() / WARM_FOLDER))
    os.environ.setdefault("CAPYTAINE_PROGRESS_BAR", "False")


def compute(
    assignment: Assignment, data_dir: Path, on_progress: OnProgress
) -> tuple[str, Made, dict[str, Any], tuple[str, ...]]:
    """Name of the data set, its file, the run's summary and warnings. Raises what the solver raises."""
    _settle(data_dir)
    from solver.bem import parse_job, prepare
    from solver.bem.job import compute as solve

    job = parse_job(assignment.spec)
    made = solve(job, prepare(job, lambda _: _mesh(assignment)), assignment.checkpoint, on_progress)
    filename = job.name if job.name.lower().endswith(".nc") else f"{job.name}.nc"
    data = hydrodynamics.read_bytes(made.payload, filename)
    kept = Made(filename, data.content_hash, made.payload, data.describe())
    return job.name, kept, made.summary, made.warnings


def _mesh(assignment: Assignment) -> tuple[bytes, str]:
    if assignment.mesh is None:
        raise DataError("the mesh of this job is gone; upload it and start the job again")
    return assignment.mesh
