"""Idempotency-Key: the same request, sent again because its answer got lost, makes nothing more.

The key is kept in the transaction that makes the thing, so it cannot be there without it, nor the thing without it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Header, Request, Response
from sqlalchemy.orm import Session

from store.repositories import IdempotencyRepository
from store.scope import Scope

from .bodies import Body, read_body

REPLAYED = "Idempotent-Replayed"


@dataclass(frozen=True)
class Once:
    """The key of a request, and the hash of what it asks for; no key: every request makes something."""

    key: str | None
    fingerprint: str
    response: Response

    def make(self, session: Session, scope: Scope, make: Callable[[], str]) -> str:
        """The id of what `make` makes now, or of what this very request made before. Raises ConflictError."""
        if self.key is None:
            return make()
        row, fresh = IdempotencyRepository(session, scope).reserve(self.key, self.fingerprint)
        if fresh:
            row.resource_id = make()
        else:
            self.response.headers[REPLAYED] = "true"
        return row.resource_id


async def get_once(
    request: Request,
    response: Response,
    body: Annotated[Body, Depends(read_body)],
    key: Annotated[
        str | None,
        Header(
            alias="Idempotency-Key",
            min_length=1,
            max_length=200,
            pattern=r"^[ -~]+$",
            description="the same request with the same key makes nothing more",
        ),
    ] = None,
) -> Once:
    asked = f"{request.method} {request.url.path}\n".encode() + body.content
    return Once(key, hashlib.sha256(asked).hexdigest(), response)


OnceDep = Annotated[Once, Depends(get_once)]
