"""What a team has queued and stored, in all of its projects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import Select, func, select

from ..hydrodynamics import Mesh
from ..models import CANCELLING, QUEUED, RUNNING, DataSet, Project, Run
from .scoped import Scoped


@dataclass(frozen=True)
class Usage:
    """Numbers of runs at work, of runs that wait, of all runs, of data sets and meshes, and the bytes of these."""

    running: int
    queued: int
    runs: int
    files: int
    bytes: int


class UsageRepository(Scoped):
    """Sums over the team that the caller has been let into; nobody learns a row by them."""

    def of_team(self) -> Usage:
        files = size = 0
        for model in (DataSet, Mesh):
            files += self._count(select(func.count()).select_from(model), model)
            size += self._count(select(func.coalesce(func.sum(model.size), 0)).select_from(model), model)
        return Usage(self.running(), self.queued(), self.runs(), files, size)

    def running(self) -> int:
        at_work = select(func.count()).select_from(Run).where(Run.state.in_((RUNNING, CANCELLING)))
        return self._count(at_work, Run)

    def queued(self) -> int:
        return self._count(select(func.count()).select_from(Run).where(Run.state == QUEUED), Run)

    def runs(self) -> int:
        return self._count(select(func.count()).select_from(Run), Run)

    def _count(self, query: Select[Any], model: Any) -> int:
        projects = select(Project.id).where(Project.team_id == self.scope.team_id)
        return int(self.session.scalar(query.where(model.project_id.in_(projects))) or 0)
