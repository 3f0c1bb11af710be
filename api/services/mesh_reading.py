"""Meshes read and measured: called in a child process (store/isolation), since a mesh is whatever was uploaded."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.bem import Hull, HydrodynamicJob, parse_job
from solver.bem.geometry import wetted
from solver.bem.job import Estimate, check, estimate, wet
from solver.bem.quality import doubts, measures, preview
from solver.bem.read import read_mesh
from store.reading import hull

Content = tuple[bytes, str]
"""Bytes and name of a mesh."""


def examine(payload: bytes, filename: str, label: str) -> dict[str, Any]:
    """Format, quality, warnings and preview of a mesh where it stands. Raises DataError."""
    mesh, kind = read_mesh(payload, filename)
    found = wetted(mesh, kind, 1.0, np.zeros(3), filename)
    return {"format": kind, **_shown(found, parse_job({"geometry": {"mesh": label}}, compute=False))}


def look(job: HydrodynamicJob, mesh: Content | None) -> dict[str, Any]:
    """Quality, warnings, preview and estimate of a job's geometry. Raises CaseError or DataError."""
    made = hull(job, mesh)
    return {**_shown(made, job), "estimate": estimate(job, wet(job, made)).as_dict()}


def needed(job: HydrodynamicJob, mesh: Content | None, memory_mb: float) -> dict[str, Any]:
    """Estimate and warnings of a job that is to be computed. Raises CaseError or DataError."""
    made = hull(job, mesh)
    shape = wet(job, made)
    check(job, made, shape, memory_mb)
    found: Estimate = estimate(job, shape)
    warnings = [item.message for item in doubts(made, job, measures(made, job))]
    return {"estimate": found.as_dict(), "seconds": float(found.seconds), "warnings": warnings}


def _shown(made: Hull, job: HydrodynamicJob) -> dict[str, Any]:
    found = measures(made, job)
    warnings = [item.as_dict() for item in doubts(made, job, found)]
    return {"quality": found, "warnings": warnings, "preview": preview(made)}
