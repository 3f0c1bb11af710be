"""What every request shares, and the unit of work of one that changes something."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends, Request
from sqlalchemy.orm import Session

from store.database import Database
from store.doorbell import Doorbell
from store.scope import Scope
from store.settings import Settings


@dataclass
class Unit:
    """A session and the messages to send once it is committed."""

    session: Session
    rings: list[tuple[str, str]] = field(default_factory=list)


@dataclass(frozen=True)
class Context:
    settings: Settings
    database: Database
    doorbell: Doorbell

    @contextmanager
    def change(self) -> Iterator[Unit]:
        """One unit of work: committed at its end, then the messages go out, all at once."""
        with self.database.write() as session:
            unit = Unit(session)
            yield unit
        self.doorbell.ring(unit.rings)


def get_context(request: Request) -> Context:
    context: Context = request.app.state.context
    return context


def get_scope() -> Scope:
    """Whose rows the caller may see; accounts will answer this from the request."""
    return Scope()


ContextDep = Annotated[Context, Depends(get_context)]
ScopeDep = Annotated[Scope, Depends(get_scope)]
