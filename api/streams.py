"""How many event streams may be open: of one caller, of one team, of one API process.

An open stream keeps a connection for hours, so streams may take half of the process's connections at most.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from typing import Annotated

from fastapi import Depends, Request

from store.errors import QuotaError, UnavailableError
from store.quotas import CHANGE, STREAMS
from store.settings import Settings

from .access import Principal, get_principal
from .context import ScopeDep

HALF = 2
"""The share of the connections: one of so many."""


class Streams:
    """The open streams of this process."""

    def __init__(self, settings: Settings):
        self.most = min(settings.max_streams, settings.max_connections // HALF)
        self.per_caller, self.per_team = settings.max_streams_per_caller, settings.quota_streams
        self.open = 0
        self.refused = 0
        self._of_caller: Counter[str] = Counter()
        self._of_team: Counter[str] = Counter()

    def of_team(self, team_id: str) -> int:
        return self._of_team[team_id]

    @contextmanager
    def place(self, caller: str | None, team_id: str | None) -> Iterator[None]:
        """One stream for as long as it lasts; None: not counted. Raises QuotaError or UnavailableError."""
        try:
            self._check(caller, team_id)
        except (QuotaError, UnavailableError):
            self.refused += 1
            raise
        held = [(self._of_caller, caller), (self._of_team, team_id)]
        self.open += 1
        for counter, key in held:
            if key is not None:
                counter[key] += 1
        try:
            yield
        finally:
            self.open -= 1
            for counter, key in held:
                if key is not None:
                    counter[key] -= 1
                    if counter[key] <= 0:
                        del counter[key]

    def _check(self, caller: str | None, team_id: str | None) -> None:
        if self.open >= self.most:
            raise UnavailableError(
                f"{self.open} event streams are open, the most of one API process; ask GET /runs/{{id}} now and then "
                f"instead, or try again later. {CHANGE.format(setting='MAX_STREAMS')}"
            )
        if caller is not None and self.per_caller and self._of_caller[caller] >= self.per_caller:
            raise QuotaError(
                f"You have {self._of_caller[caller]} event streams open of at most {self.per_caller}; close some. "
                f"{CHANGE.format(setting='MAX_STREAMS_PER_CALLER')}"
            )
        if team_id is not None and self.per_team and self._of_team[team_id] >= self.per_team:
            raise QuotaError(
                f"The team has {self._of_team[team_id]} {STREAMS} of at most {self.per_team}; close some. "
                f"{CHANGE.format(setting='QUOTA_STREAMS')}"
            )


def caller_of(principal: Principal | None, address: str) -> str | None:
    """Whose streams are counted together: a user's, behind a share link an address's. None: the one person's of a
    service without accounts, which have no limit but the process's."""
    if principal is None:
        return f"address {address}"
    return None if principal.user is None else f"user {principal.user.id}"


async def take_place(request: Request, scope: ScopeDep) -> AsyncIterator[None]:
    """A dependency of every route that streams: refuses before the stream begins, and counts until it has ended."""
    streams: Streams = request.app.state.streams
    caller = caller_of(get_principal(request), request.client.host if request.client else "")
    with streams.place(caller, None if caller is None else scope.team_id):
        yield


PlaceDep = Annotated[None, Depends(take_place)]
