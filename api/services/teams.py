"""Teams, their members, projects and invitations."""

from __future__ import annotations

from solver.outcome import CaseError, FieldError
from store.bundled import register_bundled
from store.errors import NotFoundError
from store.models import Project, Team
from store.passwords import hash_password
from store.people import Invitation, User
from store.repositories.accounts import AccountRepository
from store.repositories.entry import Home
from store.repositories.teams import TeamRepository
from store.scope import Scope
from store.tokens import INVITATION, digest, is_token, new_token

from ..access import Principal
from ..context import Context, Unit
from ..people_schemas import Acceptance, InvitationRequest, InvitationShown
from .accounts import Browser, in_days, note, open_session


def add_team(context: Context, principal: Principal, name: str) -> Team:
    with context.change() as unit:
        team = TeamRepository(unit.session).add(name, principal.user.id if principal.user else None)
        projects = TeamRepository(unit.session).projects(team.id)
        unit.tell(team_id=team.id)
    for project in projects:
        register_bundled(context.database, Scope(team.id, project.id))
    return team


def add_project(context: Context, team_id: str, role: str, name: str) -> Home:
    with context.change() as unit:
        teams = TeamRepository(unit.session)
        project: Project = teams.add_project(team_id, name)
        unit.tell(project_id=project.id)
        home = Home(team_id, teams.get(team_id).name, project.id, project.name, role)
    register_bundled(context.database, Scope(team_id, project.id))
    return home


# -- invitations


def invite(context: Context, made_by: str | None, team_id: str, request: InvitationRequest) -> tuple[Invitation, str]:
    token = new_token(INVITATION)
    row = Invitation(
        team_id=team_id,
        role=request.role,
        email=request.email,
        digest=digest(token, context.secret),
        made_by=made_by,
        expires_at=in_days(request.expires_in_days),
    )
    with context.change() as unit:
        unit.tell(role=request.role, email=request.email or "")
        return TeamRepository(unit.session).invite(row), token


def look(context: Context, token: str) -> InvitationShown:
    """What the invitation is for. Raises NotFoundError."""
    with context.database.read() as session:
        teams = TeamRepository(session)
        row = teams.invitation(_digest(context, token))
        return InvitationShown(
            kind="join" if row.user_id is None else "password",
            team=teams.get(row.team_id).name if row.team_id else None,
            role=row.role if row.team_id else None,  # type: ignore[arg-type]
            email=row.email,
            expires_at=row.expires_at,
        )


def accept(
    context: Context, token: str, given: Acceptance, principal: Principal | None, browser: Browser
) -> tuple[str, User]:
    """Join, or choose a password; gives a session's token. Everything is checked before anything is changed."""
    look(context, token)  # before the work of a hash is done for a stranger
    hashed = hash_password(given.password) if given.password is not None else None
    with context.change() as unit:
        row = TeamRepository(unit.session).invitation(_digest(context, token))
        user = _guest(unit, row, given, hashed, principal)
        if row.team_id is not None:
            TeamRepository(unit.session).join(row.team_id, user.id, row.role)
        TeamRepository(unit.session).use(row, user.id)
        note(user)
        return open_session(context, unit, user.id, browser), user


def _guest(unit: Unit, row: Invitation, given: Acceptance, hashed: str | None, principal: Principal | None) -> User:
    """Who accepts: the account whose password is set, whoever is signed in, or a newcomer."""
    accounts = AccountRepository(unit.session)
    if row.user_id is not None:
        user = accounts.get(row.user_id)
        if user.disabled_at is not None:
            raise NotFoundError("invitation", "")
        _require(given, ("password",))
        accounts.set_password(user, hashed or "")
        return user
    if principal is not None and principal.kind == "session" and principal.user is not None:
        if row.email is not None and row.email != principal.user.email:
            raise CaseError([FieldError(("email",), f"the invitation is for {row.email} only", principal.user.email)])
        return accounts.get(principal.user.id)
    _require(given, ("email", "name", "password"))
    if row.email is not None and row.email != given.email:
        raise CaseError([FieldError(("email",), "the invitation is for another address", repr(given.email))])
    if accounts.by_email(given.email or "") is not None:
        raise CaseError(
            [FieldError(("email",), "has an account already; sign in, then open the link", given.email or "")]
        )
    return accounts.add(given.email or "", given.name or "", hashed, row.is_admin)


def _require(given: Acceptance, names: tuple[str, ...]) -> None:
    missing = [FieldError((name,), "is needed here") for name in names if getattr(given, name) is None]
    if missing:
        raise CaseError(missing)


def _digest(context: Context, token: str) -> str:
    if not is_token(token, INVITATION):
        raise NotFoundError("invitation", "")
    return digest(token, context.secret)
