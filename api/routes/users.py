"""Accounts, as administrators of the installation see them."""

from __future__ import annotations

from fastapi import APIRouter

from store.people import Invitation, User
from store.repositories.accounts import AccountRepository

from ..access import PrincipalDep, needs
from ..context import ContextDep
from ..people_schemas import UserChange, UserInfo, UserLink, UserPage, UserRequest
from ..services import accounts as service
from .common import Cursor, Key, Limit, problems
from .teams import LinksDep

router = APIRouter(prefix="/users", tags=["accounts"])


@router.get("")
@needs("admin")
def list_users(context: ContextDep, limit: Limit = 50, cursor: Cursor = None) -> UserPage:
    """Newest first."""
    with context.database.read() as session:
        rows = AccountRepository(session).page(limit, cursor)
    items = [service.user_info(row) for row in rows]
    return UserPage(items=items, next_cursor=items[-1].id if len(items) == limit else None)


@router.post("", status_code=201, responses=problems(409))
@needs("admin")
def add_user(context: ContextDep, principal: PrincipalDep, links: LinksDep, body: UserRequest) -> UserLink:
    """An account without a password; the answer holds the link at which to choose one, this once."""
    made_by = service.account_of(principal).id
    return _link(links, *service.add_user(context, made_by, body))


@router.patch("/{user_id}", responses=problems(409))
@needs("admin")
def change_user(context: ContextDep, user_id: Key, body: UserChange) -> UserInfo:
    """A disabled account's sessions end and its keys open nothing. 409 for the last administrator."""
    return service.user_info(service.change_user(context, user_id, body))


@router.post("/{user_id}/reset", status_code=201)
@needs("admin")
def reset_password(context: ContextDep, principal: PrincipalDep, links: LinksDep, user_id: Key) -> UserLink:
    """A link at which to choose a new password; the old one is good until it is used."""
    return _link(links, *service.reset(context, principal.user.id if principal.user else None, user_id))


def _link(links: str, user: User, row: Invitation, token: str) -> UserLink:
    url = f"{links}/app/invitations/{token}"
    return UserLink(user=service.user_info(user), url=url, token=token, expires_at=row.expires_at)
