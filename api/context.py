"""What every request shares, and the unit of work of one that changes something."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated

from fastapi import Depends, Request
from sqlalchemy.orm import Session

from store.database import Database
from store.doorbell import Doorbell
from store.people import Audit
from store.scope import Scope
from store.settings import Settings
from store.tokens import read_secret


@dataclass
class Acting:
    """Who does what in this request, for the audit log."""

    actor: str
    user_id: str | None
    address: str
    action: str = ""
    subject: dict[str, str] = field(default_factory=dict)
    team_id: str | None = None
    project_id: str | None = None
    silent: bool = True
    """Until a request is let in that changes something, and again once it is written down."""


acting: ContextVar[Acting | None] = ContextVar("acting", default=None)


@dataclass
class Unit:
    """A session and the messages to send once it is committed."""

    session: Session
    rings: list[tuple[str, str]] = field(default_factory=list)

    def tell(self, **subject: str) -> None:
        """For the audit log: what the change is about, beside what the address says."""
        act = acting.get()
        if act is not None:
            act.subject |= subject


@dataclass(frozen=True)
class Context:
    settings: Settings
    database: Database
    doorbell: Doorbell

    @contextmanager
    def change(self) -> Iterator[Unit]:
        """One unit of work: committed at its end, then the messages go out, all at once.

        With accounts, the first of a request that changes something writes into the audit log who did it.
        """
        with self.database.write() as session:
            unit = Unit(session)
            yield unit
            act = acting.get()
            if act is not None and not act.silent:
                session.add(_entry(act))
        if act is not None:
            act.silent = True
        self.doorbell.ring(unit.rings)

    @cached_property
    def secret(self) -> bytes:
        """Key of the HMACs of tokens."""
        return read_secret(self.settings)


def _entry(act: Acting) -> Audit:
    return Audit(
        team_id=act.team_id,
        project_id=act.project_id,
        user_id=act.user_id,
        actor=act.actor[:300],
        action=act.action[:200],
        subject=act.subject,
        address=act.address[:60],
    )


def context_of(request: Request) -> Context:
    context: Context = request.app.state.context
    return context


# Dependencies that wait for nothing are coroutines all the same: FastAPI sends every other function to a thread.


async def get_context(request: Request) -> Context:
    return context_of(request)


async def get_scope(request: Request) -> Scope:
    """Whose rows the caller may touch: decided for every route under /api/v1 by `api/access.py` before it is called."""
    admitted: Scope = request.scope["state"]["admitted"]
    return admitted


ContextDep = Annotated[Context, Depends(get_context)]
ScopeDep = Annotated[Scope, Depends(get_scope)]
