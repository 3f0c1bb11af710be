"""Tables of hydrodynamic jobs: uploaded meshes, and what a run of kind `hydrodynamics` was asked to compute.

Such a run has state, tasks, lease, progress and cancel like any other; it has no case, and its result is a data set.
"""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, LargeBinary, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from .clock import utc_now
from .ids import new_id
from .models import Base, Id


class Mesh(Base):
    """The mesh of a hull as it was uploaded, by content hash. `summary` has its size and measurements."""

    __tablename__ = "meshes"
    __table_args__ = (UniqueConstraint("project_id", "content_hash"),)
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    name: Mapped[str] = mapped_column(String(200))
    content_hash: Mapped[str] = mapped_column(String(64))
    size: Mapped[int]
    summary: Mapped[dict[str, Any]] = mapped_column(default=dict)
    payload: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class HydrodynamicJob(Base):
    """What a run of kind `hydrodynamics` computes, and the data set it made once it has succeeded."""

    __tablename__ = "hydrodynamic_jobs"
    run_id: Mapped[str] = mapped_column(Id, ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    spec: Mapped[dict[str, Any]]
    """docs/hydrodynamics-bem.md; in SI."""
    estimate: Mapped[dict[str, Any]] = mapped_column(default=dict)
    """Panels, memory and number of solutions, as reckoned before the start."""
    mesh_id: Mapped[str | None] = mapped_column(Id, ForeignKey("meshes.id"), default=None)
    data_set_id: Mapped[str | None] = mapped_column(Id, ForeignKey("data_sets.id", ondelete="SET NULL"), default=None)
