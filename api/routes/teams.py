"""Teams, their members, projects, invitations and log."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from store.people import Invitation
from store.repositories.entry import EntryRepository
from store.repositories.teams import TeamRepository

from ..access import PrincipalDep, get_principal, needs
from ..context import ContextDep, ScopeDep
from ..people_schemas import (
    Acceptance,
    AuditInfo,
    AuditPage,
    HomeInfo,
    HomeList,
    InvitationInfo,
    InvitationList,
    InvitationRequest,
    InvitationShown,
    Me,
    MemberInfo,
    MemberList,
    NameRequest,
    NewInvitation,
    RoleRequest,
    TeamInfo,
    TeamList,
)
from ..services import teams as service
from .auth import browser_of, give_session, whole_me
from .common import Cursor, Key, Limit, problems

router = APIRouter(tags=["teams"])


async def get_links(context: ContextDep, request: Request) -> str:
    """The address before `/app/…` of links that are sent to people."""
    return (context.settings.public_url or str(request.base_url)).rstrip("/")


LinksDep = Annotated[str, Depends(get_links)]


# -- teams


@router.get("/teams")
@needs("account")
def list_teams(context: ContextDep, principal: PrincipalDep) -> TeamList:
    """One's own."""
    with context.database.read() as session:
        rows = TeamRepository(session).of(principal.user.id if principal.user else None)
    names = {home.team_id for home in principal.homes}
    shown = [row for row in rows if principal.kind != "key" or row[0].id in names]
    items = [TeamInfo(id=t.id, name=t.name, role=role, members=m, projects=p) for t, role, m, p in shown]
    return TeamList(items=items)


@router.post("/teams", status_code=201, responses=problems(409))
@needs("manage")
def add_team(context: ContextDep, principal: PrincipalDep, body: NameRequest) -> TeamInfo:
    """The caller becomes its owner; it gets a project."""
    team = service.add_team(context, principal, body.name)
    return TeamInfo(id=team.id, name=team.name, role="owner", members=int(principal.user is not None), projects=1)


@router.patch("/teams/{team_id}", status_code=204, responses=problems(409))
@needs("own")
def rename_team(context: ContextDep, scope: ScopeDep, team_id: Key, body: NameRequest) -> None:
    with context.change() as unit:
        teams = TeamRepository(unit.session)
        teams.rename(teams.get(scope.team_id), body.name)


@router.delete("/teams/{team_id}", status_code=204, responses=problems(409))
@needs("own")
def delete_team(context: ContextDep, scope: ScopeDep, team_id: Key) -> None:
    """Only when its projects hold nothing."""
    with context.change() as unit:
        TeamRepository(unit.session).delete(scope.team_id)


@router.get("/teams/{team_id}/audit")
@needs("own")
def list_audit(
    context: ContextDep, scope: ScopeDep, team_id: Key, limit: Limit = 50, cursor: Cursor = None
) -> AuditPage:
    """Who did what, newest first."""
    with context.database.read() as session:
        rows = TeamRepository(session).audit(scope.team_id, limit, cursor)
    items = [AuditInfo.model_validate(row) for row in rows]
    return AuditPage(items=items, next_cursor=items[-1].id if len(items) == limit else None)


# -- members


@router.get("/teams/{team_id}/members")
def list_members(context: ContextDep, scope: ScopeDep, team_id: Key) -> MemberList:
    with context.database.read() as session:
        rows = TeamRepository(session).members(scope.team_id)
    items = [
        MemberInfo(user_id=u.id, email=u.email, name=u.name, role=role, disabled=u.disabled_at is not None)
        for u, role in rows
    ]
    return MemberList(items=items)


@router.put("/teams/{team_id}/members/{user_id}", status_code=204, responses=problems(409))
@needs("own")
def set_role(context: ContextDep, scope: ScopeDep, team_id: Key, user_id: Key, body: RoleRequest) -> None:
    """409 where the team would be left without an owner."""
    with context.change() as unit:
        unit.tell(role=body.role)
        TeamRepository(unit.session).set_role(scope.team_id, user_id, body.role)


@router.delete("/teams/{team_id}/members/{user_id}", status_code=204, responses=problems(409))
@needs("own")
def remove_member(context: ContextDep, scope: ScopeDep, team_id: Key, user_id: Key) -> None:
    with context.change() as unit:
        TeamRepository(unit.session).remove(scope.team_id, user_id)


# -- projects


@router.get("/projects")
@needs("account")
def list_projects(context: ContextDep, principal: PrincipalDep) -> HomeList:
    """Those one may enter, and as what."""
    homes = principal.homes
    if principal.kind == "local":
        with context.database.read() as session:
            homes = tuple(EntryRepository(session).all_homes())
    return HomeList(items=[HomeInfo.model_validate(home) for home in homes])


@router.post("/teams/{team_id}/projects", status_code=201, responses=problems(409))
@needs("own")
def add_project(context: ContextDep, scope: ScopeDep, team_id: Key, body: NameRequest) -> HomeInfo:
    return HomeInfo.model_validate(service.add_project(context, scope.team_id, "owner", body.name))


@router.patch("/projects/{project_id}", status_code=204, responses=problems(409))
@needs("own")
def rename_project(context: ContextDep, scope: ScopeDep, project_id: Key, body: NameRequest) -> None:
    with context.change() as unit:
        teams = TeamRepository(unit.session)
        teams.rename(teams.project(scope.project_id), body.name)


@router.delete("/projects/{project_id}", status_code=204, responses=problems(409))
@needs("own")
def delete_project(context: ContextDep, scope: ScopeDep, project_id: Key) -> None:
    """Only when it holds nothing but the bundled data sets, and is not the team's last."""
    with context.change() as unit:
        TeamRepository(unit.session).delete_project(scope.project_id)


# -- invitations


def _shown(row: Invitation) -> InvitationInfo:
    return InvitationInfo(
        id=row.id,
        role=row.role,  # type: ignore[arg-type]
        email=row.email,
        created_at=row.created_at,
        expires_at=row.expires_at,
    )


@router.get("/teams/{team_id}/invitations")
@needs("own")
def list_invitations(context: ContextDep, scope: ScopeDep, team_id: Key) -> InvitationList:
    """Those that can still be accepted."""
    with context.database.read() as session:
        rows = TeamRepository(session).invitations(scope.team_id)
    return InvitationList(items=[_shown(row) for row in rows])


@router.post("/teams/{team_id}/invitations", status_code=201)
@needs("own")
def invite(
    context: ContextDep, scope: ScopeDep, links: LinksDep, team_id: Key, body: InvitationRequest
) -> NewInvitation:
    """The answer holds the link, this once."""
    row, token = service.invite(context, scope.user_id, scope.team_id, body)
    return NewInvitation(**_shown(row).model_dump(), token=token, url=f"{links}/app/invitations/{token}")


@router.delete("/teams/{team_id}/invitations/{invitation_id}", status_code=204)
@needs("own")
def withdraw(context: ContextDep, scope: ScopeDep, team_id: Key, invitation_id: Key) -> None:
    with context.change() as unit:
        TeamRepository(unit.session).withdraw(scope.team_id, invitation_id)


@router.get("/invitations/{token}")
@needs("open")
def show_invitation(context: ContextDep, token: Key) -> InvitationShown:
    return service.look(context, token)


@router.post("/invitations/{token}/accept", responses=problems(409))
@needs("open")
def accept_invitation(
    context: ContextDep, request: Request, response: Response, token: Key, body: Acceptance | None = None
) -> Me:
    """Signs in whoever accepts."""
    given = body or Acceptance()
    session, user = service.accept(context, token, given, get_principal(request), browser_of(request))
    give_session(context, request, response, session, user.id)
    return whole_me(context, user.id, session)
