"""Tables. Every row of a user's belongs to a project, every project to a team; both have a default each."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import (
    JSON,
    DateTime,
    Float,
    ForeignKey,
    Index,
    LargeBinary,
    MetaData,
    String,
    Text,
    UniqueConstraint,
    false,
    text,
)
from sqlalchemy.engine import Dialect
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column
from sqlalchemy.types import TypeDecorator

from .clock import utc_now
from .ids import new_id

DEFAULT_TEAM = "0" * 31 + "1"
DEFAULT_PROJECT = "0" * 31 + "2"

Id = String(32)
Seconds = Float(53)

# states of runs, and of tasks (which know no `cancelling`)
QUEUED, RUNNING, CANCELLING = "queued", "running", "cancelling"
SUCCEEDED, FAILED, CANCELLED = "succeeded", "failed", "cancelled"
ACTIVE = (QUEUED, RUNNING, CANCELLING)
FINAL = (SUCCEEDED, FAILED, CANCELLED)
STATES = ACTIVE + FINAL
CASE, HYDRODYNAMICS = "case", "hydrodynamics"
"""Kinds of runs."""


class UtcDateTime(TypeDecorator[datetime]):
    """A moment in UTC; SQLite keeps no zone, so it is put back on the way out."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        return None if value is None else value.astimezone(UTC)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


class Base(DeclarativeBase):
    metadata = MetaData(
        naming_convention={  # so that later migrations can name what they change, on SQLite too
            "ix": "ix_%(table_name)s_%(column_0_N_name)s",
            "uq": "uq_%(table_name)s_%(column_0_N_name)s",
            "fk": "fk_%(table_name)s_%(column_0_name)s",
            "pk": "pk_%(table_name)s",
        }
    )
    type_annotation_map = {datetime: UtcDateTime, dict[str, Any]: JSON, list[Any]: JSON, bytes: LargeBinary}  # noqa: RUF012


class Team(Base):
    __tablename__ = "teams"
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    name: Mapped[str] = mapped_column(String(200), unique=True)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class Project(Base):
    __tablename__ = "projects"
    __table_args__ = (UniqueConstraint("team_id", "name"),)
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    team_id: Mapped[str] = mapped_column(Id, ForeignKey("teams.id"))
    name: Mapped[str] = mapped_column(String(200))
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class Case(Base):
    """A name under which versions are saved."""

    __tablename__ = "cases"
    __table_args__ = (UniqueConstraint("project_id", "name"),)
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    name: Mapped[str] = mapped_column(String(200))
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class CaseVersion(Base):
    """One saved case, never changed: what REST calls a case."""

    __tablename__ = "case_versions"
    __table_args__ = (UniqueConstraint("case_id", "number"), UniqueConstraint("project_id", "content_hash"))
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    case_id: Mapped[str] = mapped_column(Id, ForeignKey("cases.id"))
    number: Mapped[int]
    name: Mapped[str] = mapped_column(String(200))
    content_hash: Mapped[str] = mapped_column(String(64))
    canonical: Mapped[str] = mapped_column(Text, deferred=True)
    """The case as JSON in SI with sorted keys; its SHA-256 is the content hash."""
    yaml: Mapped[str] = mapped_column(Text, deferred=True)
    """The text as submitted, or made from the case when it came as JSON."""
    warnings: Mapped[list[Any]] = mapped_column(default=list)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class DataSet(Base):
    """Hydrodynamic data: a file, by content hash, versioned under its name."""

    __tablename__ = "data_sets"
    __table_args__ = (UniqueConstraint("project_id", "name", "version"), UniqueConstraint("project_id", "content_hash"))
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    name: Mapped[str] = mapped_column(String(200))
    version: Mapped[int]
    filename: Mapped[str] = mapped_column(String(200))
    content_hash: Mapped[str] = mapped_column(String(64))
    size: Mapped[int]
    summary: Mapped[dict[str, Any]] = mapped_column(default=dict)
    payload: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class Study(Base):
    """A saved case and a list of overrides: its runs."""

    __tablename__ = "studies"
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    case_version_id: Mapped[str] = mapped_column(Id, ForeignKey("case_versions.id"))
    name: Mapped[str] = mapped_column(String(200))
    analyses: Mapped[list[Any]]
    axes: Mapped[dict[str, Any] | None] = mapped_column(JSON, default=None)
    """Of a grid: JSON pointer to its values, the last varying fastest."""
    pointers: Mapped[list[Any]]
    """Every pointer that a run of the study changes."""
    size: Mapped[int]
    created_by: Mapped[str | None] = mapped_column(Id, default=None)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


_IS_ACTIVE = text("state IN ('queued', 'running', 'cancelling')")
ACTIVE_RUNS = Index("ix_runs_active", "project_id", "id", postgresql_where=_IS_ACTIVE, sqlite_where=_IS_ACTIVE)
_IS_JOB = text("kind = 'hydrodynamics'")
JOBS = Index("ix_runs_jobs", "project_id", "id", postgresql_where=_IS_JOB, sqlite_where=_IS_JOB)
_IS_TIMED = text("state = 'succeeded' AND seconds IS NOT NULL")
TIMED_TASKS = Index("ix_tasks_timed", "queue", "id", postgresql_where=_IS_TIMED, sqlite_where=_IS_TIMED)


class Run(Base):
    """One job: a case version and the analyses asked of it, or hydrodynamics. `state` is the truth about it."""

    __tablename__ = "runs"
    __table_args__ = (
        Index("ix_runs_project_state", "project_id", "state"),
        Index("ix_runs_case", "case_version_id"),
        Index("ix_runs_project_id", "project_id", "id"),
        Index("ix_runs_study", "study_id", "study_index"),
        Index("ix_runs_identity", "project_id", "identity"),
        Index("ix_runs_finished", "finished_at"),
        Index("ix_runs_data_set", "data_set_id"),
        Index("ix_runs_state", "state"),
        Index("ix_runs_starter", "project_id", "created_by", "id"),
        ACTIVE_RUNS,
        JOBS,
    )
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    kind: Mapped[str] = mapped_column(String(20), default=CASE, server_default=CASE)
    """`case`, or `hydrodynamics`: a data set is to be computed (store/hydrodynamics.py)."""
    case_version_id: Mapped[str | None] = mapped_column(Id, ForeignKey("case_versions.id"), default=None)
    """None for a run that has no case."""
    data_set_id: Mapped[str | None] = mapped_column(Id, ForeignKey("data_sets.id"))
    """The very version of the data that the case's reference meant when the run was made."""
    case_name: Mapped[str] = mapped_column(String(200))
    content_hash: Mapped[str] = mapped_column(String(64))
    """Of the case that is computed: the saved one with the overrides."""
    overrides: Mapped[dict[str, Any] | None] = mapped_column(JSON, default=None)
    """What a run of a study changes in its saved case: JSON pointer to value."""
    data_hash: Mapped[str | None] = mapped_column(String(64), default=None)
    identity: Mapped[str | None] = mapped_column(String(64), default=None)
    """Hash of all that decides the numbers: case, data, analyses, solver version; None where that is not known."""
    name: Mapped[str] = mapped_column(String(200), default="", server_default="")
    tags: Mapped[list[Any]] = mapped_column(default=list, server_default="[]")
    pinned: Mapped[bool] = mapped_column(default=False, server_default=false())
    """Kept by retention however old."""
    study_id: Mapped[str | None] = mapped_column(Id, ForeignKey("studies.id"), default=None)
    study_index: Mapped[int | None] = mapped_column(default=None)
    rerun_of: Mapped[str | None] = mapped_column(Id, default=None)
    created_by: Mapped[str | None] = mapped_column(Id, default=None)
    """The user who started it, where people sign in."""
    analyses: Mapped[list[Any]]
    state: Mapped[str] = mapped_column(String(20), default=QUEUED)
    reason: Mapped[str | None] = mapped_column(Text, default=None)
    outcomes: Mapped[dict[str, Any]] = mapped_column(default=dict)
    warnings: Mapped[list[Any]] = mapped_column(default=list)
    solver_version: Mapped[str | None] = mapped_column(String(50), default=None)
    summary: Mapped[str | None] = mapped_column(Text, default=None, deferred=True)
    figures: Mapped[str | None] = mapped_column(Text, default=None, deferred=True)
    """Values of the summary that tables of studies show, as JSON (store/figures.py)."""
    created_at: Mapped[datetime] = mapped_column(default=utc_now)
    started_at: Mapped[datetime | None] = mapped_column(default=None)
    finished_at: Mapped[datetime | None] = mapped_column(default=None)


CLAIMS = Index("ix_tasks_claim", "queue", "state", "priority", "turn", "id")


class Task(Base):
    """One chunk of a run. Lease, attempt, heartbeat and checkpoint belong here; times are seconds of `clock`."""

    __tablename__ = "tasks"
    __table_args__ = (
        UniqueConstraint("run_id", "number"),
        Index("ix_tasks_state", "state", "rung_at"),
        CLAIMS,
        TIMED_TASKS,
    )
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    run_id: Mapped[str] = mapped_column(Id, ForeignKey("runs.id", ondelete="CASCADE"))
    number: Mapped[int]
    chunk: Mapped[dict[str, Any]]
    weight: Mapped[float] = mapped_column(Seconds, default=1.0)
    queue: Mapped[str] = mapped_column(String(50), default="runs")
    priority: Mapped[int] = mapped_column(default=20, server_default="20")
    """Smaller is sooner (store/priority.py)."""
    turn: Mapped[float] = mapped_column(Seconds, default=0.0, server_default="0")
    """Within a priority, smaller is sooner (store/repositories/turns.py)."""
    state: Mapped[str] = mapped_column(String(20), default=QUEUED)
    attempt: Mapped[int] = mapped_column(default=0)
    """Raised by every claim; a write with another attempt than the row's is refused."""
    releases: Mapped[int] = mapped_column(default=0)
    """Attempts given back on an orderly shutdown; they do not count against the limit."""
    worker: Mapped[str | None] = mapped_column(String(200), default=None)
    lease_until: Mapped[float | None] = mapped_column(Seconds, default=None)
    heartbeat_at: Mapped[float | None] = mapped_column(Seconds, default=None)
    claimed_at: Mapped[float | None] = mapped_column(Seconds, default=None)
    seconds: Mapped[float | None] = mapped_column(Seconds, default=None)
    """What the attempt that succeeded took."""
    rung_at: Mapped[float] = mapped_column(Seconds, default=0.0)
    """When its message was last sent."""
    progress: Mapped[float] = mapped_column(Seconds, default=0.0)
    message: Mapped[str] = mapped_column(String(500), default="")
    reason: Mapped[str | None] = mapped_column(Text, default=None)
    checkpoint: Mapped[bytes | None] = mapped_column(LargeBinary, default=None, deferred=True)
    part: Mapped[bytes | None] = mapped_column(LargeBinary, default=None, deferred=True)


class ChannelRow(Base):
    """One labelled array of a run; `axes` names them and holds evenly spaced ones, the payload holds the rest."""

    __tablename__ = "channels"
    __table_args__ = (UniqueConstraint("run_id", "name"),)
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    run_id: Mapped[str] = mapped_column(Id, ForeignKey("runs.id", ondelete="CASCADE"))
    number: Mapped[int]
    name: Mapped[str] = mapped_column(String(300))
    unit: Mapped[str] = mapped_column(String(50))
    description: Mapped[str] = mapped_column(Text)
    band: Mapped[str] = mapped_column(String(20))
    axes: Mapped[list[Any]]
    shape: Mapped[list[Any]]
    codec: Mapped[str] = mapped_column(String(30))
    payload: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)
    axes_payload: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)


class IdempotencyKey(Base):
    """What a POST with this key has made, so that the same request, sent again, makes nothing more."""

    __tablename__ = "idempotency_keys"
    __table_args__ = (UniqueConstraint("project_id", "key"),)
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    key: Mapped[str] = mapped_column(String(200))
    fingerprint: Mapped[str] = mapped_column(String(64))
    """Hash of method, path and body."""
    resource_id: Mapped[str] = mapped_column(Id)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class Preview(Base):
    """A letter box between POST /preview and the interactive worker; rows live for a minute."""

    __tablename__ = "previews"
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    canonical: Mapped[str] = mapped_column(Text)
    data_set_id: Mapped[str | None] = mapped_column(Id, default=None)
    state: Mapped[str] = mapped_column(String(20), default=QUEUED)
    answer: Mapped[str | None] = mapped_column(Text, default=None)
    asked_at: Mapped[float] = mapped_column(Seconds)


class Probe(Base):
    """What a health check wrote last (store/health.py)."""

    __tablename__ = "probes"
    name: Mapped[str] = mapped_column(String(100), primary_key=True)
    written_at: Mapped[float] = mapped_column(Seconds)
