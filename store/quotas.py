"""How much one team may have queued and stored, so that one script does not take the service from the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from sqlalchemy.orm import Session

from .errors import QuotaError
from .recent import Recent
from .repositories.usage import Usage, UsageRepository
from .scope import Scope
from .settings import Settings

WHO = "whoever runs the service, by the setting named beside each limit"
CHANGE = "Whoever runs the service can change it (SLOWDRIFT_{setting})."
STREAMS = "event streams"
REMEDIES = {
    "queued runs": "wait until some have ended, or cancel some",
    "stored runs": "delete some",
    "data sets and meshes": "delete some",
    "bytes of data sets and meshes": "delete some",
}


NEAR = 0.9
"""Of a limit: beyond it every request counts."""
_recent = Recent()


@dataclass(frozen=True)
class Quota:
    """One limit of a team. limit 0: none."""

    name: str
    used: int
    limit: int
    setting: str

    @property
    def left(self) -> int | None:
        return max(0, self.limit - self.used) if self.limit else None

    def check(self, more: int) -> None:
        """Raises QuotaError where `more` does not fit."""
        if self.limit and self.used + more > self.limit:
            raise QuotaError(
                f"The team has {self.used} {self.name} of at most {self.limit}, and this would add {more}; "
                f"{REMEDIES[self.name]}. {CHANGE.format(setting=self.setting)}"
            )


def quotas(settings: Settings, session: Session, scope: Scope) -> list[Quota]:
    """What the team of the scope has and may have."""
    used: Usage = UsageRepository(session, scope).of_team()
    return [
        Quota("running runs", used.running, settings.quota_running_runs, "QUOTA_RUNNING_RUNS"),
        Quota("queued runs", used.queued, settings.quota_queued_runs, "QUOTA_QUEUED_RUNS"),
        Quota("stored runs", used.runs, settings.quota_stored_runs, "QUOTA_STORED_RUNS"),
        Quota("data sets and meshes", used.files, settings.quota_data_sets, "QUOTA_DATA_SETS"),
        Quota("bytes of data sets and meshes", used.bytes, settings.quota_data_bytes, "QUOTA_DATA_BYTES"),
    ]


def check_runs(settings: Settings, session: Session, scope: Scope, more: int, queued: bool = True) -> None:
    """Whether the team may have so many runs more. Raises QuotaError."""
    usage = UsageRepository(session, scope)
    if queued:
        used = _counted(usage.queued, more, settings.quota_queued_runs)
        Quota("queued runs", used, settings.quota_queued_runs, "QUOTA_QUEUED_RUNS").check(more)
    used = _counted(usage.runs, more, settings.quota_stored_runs)
    Quota("stored runs", used, settings.quota_stored_runs, "QUOTA_STORED_RUNS").check(more)


def _counted(count: Callable[[], int], more: int, limit: int) -> int:
    """The number, as it was counted a few seconds ago where that is far from the limit."""
    usage: Any = count.__self__  # type: ignore[attr-defined]
    key = (str(usage.session.get_bind().engine.url), usage.scope.team_id, count.__name__)
    known = _recent.get(key)
    if known is not None and known + more <= NEAR * limit:
        _recent.change(key, known + more)
        return int(known)
    if not limit:
        return 0
    found = count()
    _recent.put(key, found + more)
    return found


def check_file(settings: Settings, session: Session, scope: Scope, size: int) -> None:
    """Whether the team may store a file of so many bytes that is in this session already. Raises QuotaError."""
    *_, files, content = quotas(settings, session, scope)
    replace(files, used=files.used - 1).check(1)
    replace(content, used=content.used - size).check(size)
