"""Signing in and out; one's own account and keys."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from store.repositories.accounts import AccountRepository
from store.repositories.entry import EntryRepository

from ..access import Principal, PrincipalDep, get_principal, needs
from ..attempts import Attempts
from ..context import Context, ContextDep
from ..guard import COOKIE, SECURE_COOKIE, session_token
from ..known_browsers import DAYS, KNOWN, SECURE_KNOWN, known_browser, known_value
from ..people_schemas import (
    AuthInfo,
    KeyList,
    KeyRequest,
    Me,
    MeChange,
    NewKey,
    PasswordChange,
    SignInRequest,
    SignOutRequest,
)
from ..services import accounts as service
from .common import Key, problems

router = APIRouter(tags=["accounts"])


async def get_attempts(request: Request) -> Attempts:
    found: Attempts = request.app.state.attempts
    return found


def address_of(request: Request) -> str:
    return request.client.host if request.client else ""


def session_of(request: Request) -> str:
    return session_token(request.headers.get("cookie", ""))


def is_secure(context: Context, request: Request) -> bool:
    return request.url.scheme == "https" or context.settings.public_url.startswith("https:")


def browser_of(request: Request) -> service.Browser:
    headers = request.headers
    return service.Browser(address_of(request), headers.get("user-agent", ""), headers.get("cookie", ""))


def give_session(context: Context, request: Request, response: Response, token: str, user_id: str) -> None:
    """The cookies of the session, and of a browser that the account knows from now on: not for scripts, not sent from
    other sites' pages, over https only where we are reached by it."""
    secure = is_secure(context, request)
    seconds = int(context.settings.session_hours * 3600)
    name = SECURE_COOKIE if secure else COOKIE
    response.set_cookie(name, token, max_age=seconds, path="/", secure=secure, httponly=True, samesite="lax")
    if known_browser(request.headers.get("cookie", ""), user_id, context.secret) is None:
        name, value = SECURE_KNOWN if secure else KNOWN, known_value(user_id, context.secret)
        seconds = DAYS * 86_400
        response.set_cookie(name, value, max_age=seconds, path="/", secure=secure, httponly=True, samesite="lax")


def whole_me(context: Context, user_id: str, token: str) -> Me:
    """What GET /me will say to the session that has just begun."""
    with context.database.read() as session:
        user = AccountRepository(session).get(user_id)
        homes = tuple(EntryRepository(session).homes(user_id))
    return service.me(context, Principal("session", user.email, user, homes=homes), token)


AttemptsDep = Annotated[Attempts, Depends(get_attempts)]


@router.get("/auth")
@needs("open")
def get_auth(context: ContextDep, request: Request) -> AuthInfo:
    """Whether people sign in here, and whether the caller has."""
    principal = get_principal(request)
    local = principal is not None and principal.kind == "local"
    provider = context.settings.oidc_name if context.settings.oidc_issuer and not local else None
    return AuthInfo(accounts=not local, signed_in=principal is not None and not local, provider=provider)


@router.post("/auth/sign-in", responses=problems(401, 409, 429))
@needs("open")
def sign_in(
    context: ContextDep, attempts: AttemptsDep, request: Request, response: Response, body: SignInRequest
) -> Me:
    """Begins a new session, whatever cookie the browser came with."""
    token, user = service.sign_in(context, attempts, body.email, body.password, browser_of(request))
    give_session(context, request, response, token, user.id)
    return whole_me(context, user.id, token)


@router.post("/auth/sign-out", status_code=204)
@needs("open")
def sign_out(context: ContextDep, request: Request, response: Response, body: SignOutRequest | None = None) -> None:
    service.sign_out(context, session_of(request), body is not None and body.everywhere)
    response.delete_cookie(COOKIE, path="/")
    response.delete_cookie(SECURE_COOKIE, path="/", secure=True)


@router.get("/me")
@needs("account")
def get_me(context: ContextDep, principal: PrincipalDep, request: Request) -> Me:
    return service.me(context, principal, session_of(request))


@router.patch("/me", responses=problems(404, 409))
@needs("self")
def change_me(context: ContextDep, principal: PrincipalDep, request: Request, change: MeChange) -> Me:
    """One's name, and the project in which requests work that name none."""
    service.change_me(context, principal, change)
    with context.database.read() as session:
        user = AccountRepository(session).get(service.account_of(principal).id)
    home = change.project_id or principal.home
    changed = replace(principal, user=user, home=home)
    return service.me(context, changed, session_of(request))


@router.put("/me/password", status_code=204, responses=problems(409, 429))
@needs("self")
def change_password(
    context: ContextDep, principal: PrincipalDep, attempts: AttemptsDep, request: Request, change: PasswordChange
) -> None:
    """One's other sessions end; keys stay."""
    service.change_password(context, attempts, principal, change.old, change.new, address_of(request))


@router.get("/keys", responses=problems(409))
@needs("self")
def list_keys(context: ContextDep, principal: PrincipalDep) -> KeyList:
    """One's own, newest first, revoked ones included."""
    with context.database.read() as session:
        rows = AccountRepository(session).keys(service.account_of(principal).id)
    return KeyList(items=[service.key_info(key, team) for key, team in rows])


@router.post("/keys", status_code=201, responses=problems(404, 409))
@needs("self")
def add_key(context: ContextDep, principal: PrincipalDep, request: KeyRequest) -> NewKey:
    """The answer holds the key itself, this once."""
    key, token = service.add_key(context, principal, request)
    team = next((home.team_name for home in principal.homes if home.team_id == key.team_id), None)
    return NewKey(**service.key_info(key, team).model_dump(), token=token)


@router.delete("/keys/{key_id}", status_code=204, responses=problems(404, 409))
@needs("self")
def revoke_key(context: ContextDep, principal: PrincipalDep, key_id: Key) -> None:
    user = service.account_of(principal)
    with context.change() as unit:
        AccountRepository(unit.session).revoke_key(user.id, key_id)
