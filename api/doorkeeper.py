"""Asks every request under /api/v1 who it comes from, before a byte of its body is read.

As long as there is no account (and the setting `accounts` is auto), it is the one person who has this machine: requests
that come from elsewhere, or through a proxy, are refused then (api/nearness.py).
"""

from __future__ import annotations

import logging
import time

from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from store.people import ApiKey, SignIn
from store.repositories.entry import EntryRepository, stale
from store.tokens import KEY, SESSION, digest, is_token

from .access import Principal
from .context import Acting, Context, acting
from .guard import problem, session_token
from .nearness import may_go_unnamed

OPEN = ("/auth", "/invitations/", "/shared/", "/openapi.json")
"""Under the base: what strangers may ask. Every other address answers 401 before anything is looked up."""
ASK_AGAIN = 2.0
LOCAL = Principal("local", "this machine")
SIGN_IN = "Sign in, or send a key as `Authorization: Bearer …`."
NO_ACCOUNT = (
    "There are no accounts yet, and this request comes from another machine or through a proxy. Make an account with "
    "`slowdrift user add`, or start the service with --setup; with --allow-no-login it obeys everybody who reaches it."
)
log = logging.getLogger(__name__)


class Doorkeeper:
    def __init__(self, app: ASGIApp, context: Context, base: str):
        self.app, self.context, self.base = app, context, base
        self._accounts = context.settings.accounts == "on"
        self._asked_at = -ASK_AGAIN

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or not scope["path"].startswith(f"{self.base}/"):
            return await self.app(scope, receive, send)
        connection = HTTPConnection(scope)
        try:
            unnamed = not self._accounts and (self._alone() or not await run_in_threadpool(self.accounts_on))
            if unnamed:
                principal = LOCAL if may_go_unnamed(self.context.settings, scope) else None
            else:
                principal = await run_in_threadpool(self._recognise, connection)
        except SQLAlchemyError:
            log.exception("Nobody can be recognised: the database does not answer")
            return await problem(503, "unavailable", "The database cannot be reached.")(scope, receive, send)
        if principal is None and not scope["path"].removeprefix(self.base).startswith(OPEN):
            answer = problem(401, "sign-in-required", NO_ACCOUNT if unnamed else SIGN_IN)
            answer.headers["www-authenticate"] = "Bearer"
            return await answer(scope, receive, send)
        scope.setdefault("state", {})["principal"] = principal
        if principal is None or principal.kind != "local":
            address = connection.client.host if connection.client else ""
            user = principal.user if principal else None
            acting.set(Acting(principal.actor if principal else "", user.id if user else None, address))
        return await self.app(scope, receive, send)

    def _alone(self) -> bool:
        """Whether there was no account a moment ago."""
        return not self._accounts and time.monotonic() - self._asked_at < ASK_AGAIN

    def accounts_on(self) -> bool:
        """Once there is an account it stays so; until then the database is asked again now and then."""
        if not self._accounts and not self._alone():
            with self.context.database.read() as session:
                self._accounts = EntryRepository(session).any_account()
            self._asked_at = time.monotonic()
        return self._accounts

    def _recognise(self, connection: HTTPConnection) -> Principal | None:
        """The key in the Authorization header if there is one, else the session in the cookie."""
        kind, _, value = connection.headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer":
            return self._key(value.strip())
        return self._session(session_token(connection.headers.get("cookie", "")))

    def _key(self, token: str) -> Principal | None:
        if not is_token(token, KEY):
            return None
        with self.context.database.read() as session:
            found = EntryRepository(session).key(digest(token, self.context.secret))
        if found is None:
            return None
        key, user, homes = found
        self._touch(key)
        actor = f"{user.email} (key {key.name})"
        return Principal("key", actor, user, key.id, key.scope, None, homes)

    def _session(self, token: str) -> Principal | None:
        if not is_token(token, SESSION):
            return None
        with self.context.database.read() as session:
            found = EntryRepository(session).signed_in(digest(token, self.context.secret))
        if found is None:
            return None
        row, user, homes = found
        self._touch(row)
        return Principal("session", user.email, user, row.id, None, row.project_id, homes, row.by_provider)

    def _touch(self, row: SignIn | ApiKey) -> None:
        if stale(row):
            with self.context.database.write() as session:
                EntryRepository(session).touch(row)
