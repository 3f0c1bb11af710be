"""Signing in and out, one's own account and keys; accounts as an administrator sees them."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from datetime import datetime, timedelta

from solver.outcome import CaseError, FieldError
from store.clock import utc_now
from store.errors import ConflictError, NotFoundError, SignInError
from store.passwords import check_password, hash_password
from store.people import ApiKey, Invitation, User
from store.repositories.accounts import AccountRepository
from store.repositories.entry import EntryRepository, Home
from store.repositories.teams import TeamRepository
from store.tokens import INVITATION, KEY, SESSION, START, csrf_token, digest, new_token

from ..access import Principal
from ..attempts import Attempts
from ..context import Context, Unit, acting
from ..guard import session_token
from ..known_browsers import known_browser
from ..people_schemas import HomeInfo, KeyInfo, KeyRequest, Me, MeChange, UserChange, UserInfo, UserRequest

RESET_DAYS = 3
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Browser:
    """What a request tells of the browser that signs in."""

    address: str
    agent: str
    cookies: str

    @property
    def session(self) -> str:
        """The token of the session with which it came; empty where there is none."""
        return session_token(self.cookies)


WRONG = "The e-mail address or the password is wrong, or the account is disabled."


def sign_in(context: Context, attempts: Attempts, email: str, password: str, browser: Browser) -> tuple[str, User]:
    """A new session's token: never one that the browser came with.

    Raises SignInError, TooManyError.
    """
    account, address = email.strip().lower(), browser.address
    with context.database.read() as session:
        user = AccountRepository(session).by_email(account)
    known = known_browser(browser.cookies, user.id, context.secret) if user else None
    attempts.begin(account, address, known)
    good, fresh = check_password(password, user.password_hash if user else None)
    if user is None or not good or user.disabled_at is not None:
        log.warning("A sign-in as %r from %s was refused", account[:100], address)
        raise SignInError(WRONG)
    attempts.forgive(account, address, known)
    note(user)
    with context.change() as unit:
        if fresh is not None:
            AccountRepository(unit.session).get(user.id).password_hash = fresh
        return open_session(context, unit, user.id, browser), user


def note(user: User) -> None:
    """The stranger of this request turns out to be somebody: the audit log names them."""
    act = acting.get()
    if act is not None:
        act.actor, act.user_id = user.email, user.id


def open_session(context: Context, unit: Unit, user_id: str, browser: Browser, by_provider: bool = False) -> str:
    """A new session's token; the session that the browser came with ends."""
    token = new_token(SESSION)
    accounts = AccountRepository(unit.session)
    if browser.session:
        accounts.sign_out(digest(browser.session, context.secret))
    expires_at = utc_now() + timedelta(hours=context.settings.session_hours)
    accounts.sign_in(user_id, digest(token, context.secret), browser.agent, expires_at, by_provider)
    return token


def sign_out(context: Context, token: str, everywhere: bool) -> None:
    if not token:
        return
    hashed = digest(token, context.secret)
    with context.change() as unit:
        accounts = AccountRepository(unit.session)
        found = EntryRepository(unit.session).signed_in(hashed)
        if everywhere and found is not None:
            accounts.end_sessions(found[1].id)
        accounts.sign_out(hashed)


def account_of(principal: Principal) -> User:
    """Raises ConflictError where nobody signs in."""
    if principal.user is None:
        raise ConflictError("Nobody signs in here; make the first account with `slowdrift user add --admin`.")
    return principal.user


def me(context: Context, principal: Principal, session: str) -> Me:
    homes: tuple[Home, ...] = principal.homes
    if principal.kind == "local":
        with context.database.read() as opened:
            homes = tuple(EntryRepository(opened).all_homes())
    home = next((each for each in homes if each.project_id == principal.home), None) or next(iter(homes), None)
    return Me(
        mode="one-person" if principal.kind == "local" else "accounts",
        by=principal.kind,
        user=user_info(principal.user) if principal.user else None,
        home=HomeInfo.model_validate(home) if home else None,
        homes=[HomeInfo.model_validate(each) for each in homes],
        key_scope=principal.key_scope,  # type: ignore[arg-type]
        by_provider=principal.by_provider,
        csrf_token=csrf_token(session) if principal.kind == "session" else None,
    )


def change_me(context: Context, principal: Principal, change: MeChange) -> None:
    user = account_of(principal)
    if change.project_id is not None and all(home.project_id != change.project_id for home in principal.homes):
        raise NotFoundError("project", change.project_id)
    with context.change() as unit:
        accounts = AccountRepository(unit.session)
        if change.name is not None:
            accounts.get(user.id).name = change.name
        if change.project_id is not None and principal.credential_id is not None:
            accounts.work_in(principal.credential_id, change.project_id)


def change_password(
    context: Context, attempts: Attempts, principal: Principal, old: str, new: str, address: str
) -> None:
    user = account_of(principal)
    attempts.begin(user.email, address, principal.credential_id)  # strangers' attempts do not count here
    if not check_password(old, user.password_hash)[0]:
        raise CaseError([FieldError(("old",), "is not the present password")])
    attempts.forgive(user.email, address, principal.credential_id)
    hashed = hash_password(new)
    with context.change() as unit:
        accounts = AccountRepository(unit.session)
        accounts.set_password(accounts.get(user.id), hashed, principal.credential_id)


# -- keys


def add_key(context: Context, principal: Principal, request: KeyRequest) -> tuple[ApiKey, str]:
    user = account_of(principal)
    token = new_token(KEY)
    key = ApiKey(
        user_id=user.id,
        team_id=request.team_id,
        name=request.name,
        scope=request.scope,
        start=token[:START],
        digest=digest(token, context.secret),
        expires_at=in_days(request.expires_in_days) if request.expires_in_days else None,
    )
    with context.change() as unit:
        made = AccountRepository(unit.session).add_key(key)
        unit.tell(key_id=made.id, scope=made.scope)
        return made, token


def in_days(days: int) -> datetime:
    return utc_now() + timedelta(days=days)


def key_info(key: ApiKey, team_name: str | None) -> KeyInfo:
    shown = {name: getattr(key, name) for name in KeyInfo.model_fields if name != "team_name"}
    return KeyInfo(**shown, team_name=team_name)


# -- accounts, for administrators


def user_info(user: User) -> UserInfo:
    return UserInfo(
        id=user.id,
        email=user.email,
        name=user.name,
        is_admin=user.is_admin,
        disabled=user.disabled_at is not None,
        created_at=user.created_at,
    )


def add_user(context: Context, made_by: str | None, request: UserRequest) -> tuple[User, Invitation, str]:
    """An account without a password, and the link at which to choose one."""
    with context.change() as unit:
        user = AccountRepository(unit.session).add(request.email, request.name, None, request.is_admin)
        unit.tell(user_id=user.id)
        return user, *_reset(context, unit, user, made_by)


def reset(context: Context, made_by: str | None, user_id: str) -> tuple[User, Invitation, str]:
    with context.change() as unit:
        user = AccountRepository(unit.session).get(user_id)
        return user, *_reset(context, unit, user, made_by)


def _reset(context: Context, unit: Unit, user: User, made_by: str | None) -> tuple[Invitation, str]:
    token = new_token(INVITATION)
    row = Invitation(
        user_id=user.id,
        email=user.email,
        digest=digest(token, context.secret),
        made_by=made_by,
        expires_at=in_days(RESET_DAYS),
    )
    return TeamRepository(unit.session).invite(row), token


def change_user(context: Context, user_id: str, change: UserChange) -> User:
    with context.change() as unit:
        accounts = AccountRepository(unit.session)
        user = accounts.get(user_id)
        unit.tell(**{name: str(value) for name, value in change.model_dump(exclude_none=True).items()})
        if change.name is not None:
            user.name = change.name
        if change.is_admin is not None:
            accounts.set_admin(user, change.is_admin)
        if change.disabled is not None:
            accounts.set_disabled(user, change.disabled)
        unit.session.flush()
        return user
