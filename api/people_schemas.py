"""What REST takes and answers about people, teams, keys and links."""

from __future__ import annotations

import unicodedata
from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

from store.passwords import MAX_LENGTH, MIN_LENGTH

from .schemas import ID, TIME, RunInfo

Role = Literal["viewer", "editor", "owner"]
KeyScope = Literal["read", "submit", "admin"]


def _shown(text: str) -> str:
    """Names stand in lists: no control characters, no half surrogates, nothing but spaces."""
    if not text.isprintable() or not text.strip():
        raise ValueError("must hold something to read, and no control characters")
    return unicodedata.normalize("NFC", text.strip())


Name = Annotated[str, StringConstraints(min_length=1, max_length=100), AfterValidator(_shown)]
Email = Annotated[
    str,
    StringConstraints(
        strip_whitespace=True, to_lower=True, max_length=254, pattern=r"^[!-?A-~]+@[0-9A-Za-z-]+(\.[0-9A-Za-z-]+)*$"
    ),
    Field(examples=["ada@example.org"]),
]
Password = Annotated[
    str,
    StringConstraints(min_length=MIN_LENGTH, max_length=MAX_LENGTH),
    Field(examples=["seven wet swans sail"], description=f"{MIN_LENGTH} to {MAX_LENGTH} characters, any"),
]
Key = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{32}$"), Field(examples=[ID])]


class Request(BaseModel):
    model_config = ConfigDict(extra="forbid")


class AuthInfo(BaseModel):
    accounts: bool = Field(description="false: nobody signs in here")
    signed_in: bool
    provider: str | None = Field(
        None, description="name of the OpenID Connect provider by which people may sign in, see /auth/oidc/start"
    )


class SignInRequest(Request):
    email: str = Field(max_length=254, examples=["ada@example.org"])
    password: str = Field(max_length=MAX_LENGTH)


class SignOutRequest(Request):
    everywhere: bool = Field(False, description="end all of one's sessions")


class UserInfo(BaseModel):
    id: str = Field(examples=[ID])
    email: str
    name: str
    is_admin: bool
    disabled: bool = False
    created_at: datetime = Field(examples=[TIME])


class UserPage(BaseModel):
    items: list[UserInfo]
    next_cursor: str | None


class HomeInfo(BaseModel):
    """A project one may enter, and as what."""

    model_config = ConfigDict(from_attributes=True)
    team_id: str = Field(examples=[ID])
    team_name: str
    project_id: str = Field(examples=[ID])
    project_name: str
    role: Role


class HomeList(BaseModel):
    items: list[HomeInfo]


class Me(BaseModel):
    mode: Literal["one-person", "accounts"]
    by: Literal["local", "session", "key"]
    user: UserInfo | None
    home: HomeInfo | None = Field(description="where requests work that name no project")
    homes: list[HomeInfo]
    key_scope: KeyScope | None = None
    by_provider: bool = Field(False, description="signed in by the OpenID Connect provider")
    csrf_token: str | None = Field(None, description="for X-CSRF-Token, where a client sends no Origin")


class MeChange(Request):
    name: Name | None = None
    project_id: Key | None = None


class PasswordChange(Request):
    old: str = Field(max_length=MAX_LENGTH)
    new: Password


class KeyRequest(Request):
    name: Name
    scope: KeyScope = "read"
    team_id: Key | None = Field(None, description="the only team it opens; all of one's teams when left out")
    expires_in_days: int | None = Field(90, ge=1, le=3650, description="null: never")


class KeyInfo(BaseModel):
    id: str = Field(examples=[ID])
    name: str
    scope: KeyScope
    start: str = Field(description="its first characters")
    team_id: str | None
    team_name: str | None
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    last_used_at: datetime | None


class NewKey(KeyInfo):
    token: str = Field(description="the key itself: it is shown this once")


class KeyList(BaseModel):
    items: list[KeyInfo]


class NameRequest(Request):
    name: Name


class TeamInfo(BaseModel):
    id: str = Field(examples=[ID])
    name: str
    role: Role
    members: int
    projects: int


class TeamList(BaseModel):
    items: list[TeamInfo]


class MemberInfo(BaseModel):
    user_id: str = Field(examples=[ID])
    email: str
    name: str
    role: Role
    disabled: bool


class MemberList(BaseModel):
    items: list[MemberInfo]


class RoleRequest(Request):
    role: Role


class InvitationRequest(Request):
    role: Role = "viewer"
    email: Email | None = Field(None, description="the only address it is good for")
    expires_in_days: int = Field(7, ge=1, le=60)


class InvitationInfo(BaseModel):
    id: str = Field(examples=[ID])
    role: Role
    email: str | None
    created_at: datetime
    expires_at: datetime


class NewInvitation(InvitationInfo):
    token: str
    url: str = Field(description="shown this once; works once")


class InvitationList(BaseModel):
    items: list[InvitationInfo]


class InvitationShown(BaseModel):
    kind: Literal["join", "password"] = Field(description="into a team (or the installation), or to a new password")
    team: str | None
    role: Role | None
    email: str | None
    expires_at: datetime


class Acceptance(Request):
    """Nothing is needed of somebody signed in who joins a team; only `password` of one who chooses a new one."""

    email: Email | None = None
    name: Name | None = None
    password: Password | None = None


class UserRequest(Request):
    email: Email
    name: Name
    is_admin: bool = False


class UserChange(Request):
    name: Name | None = None
    is_admin: bool | None = None
    disabled: bool | None = None


class UserLink(BaseModel):
    user: UserInfo
    url: str = Field(description="where to choose a password; shown this once, works once")
    token: str
    expires_at: datetime


class AuditInfo(BaseModel):
    model_config = ConfigDict(from_attributes=True)
    id: str
    at: datetime
    actor: str
    action: str = Field(examples=["POST /api/v1/runs"])
    subject: dict[str, Any]
    address: str


class AuditPage(BaseModel):
    items: list[AuditInfo]
    next_cursor: str | None


class ShareRequest(Request):
    run_ids: list[Key] = Field(min_length=1, max_length=20)
    title: Name | None = None
    view: dict[str, Any] = Field(default={}, description="what the pages want to restore; at most 20 kB as JSON")
    expires_in_days: int | None = Field(30, ge=1, le=3650, description="null: never")


class ShareInfo(BaseModel):
    id: str = Field(examples=[ID])
    title: str
    run_ids: list[str]
    view: dict[str, Any]
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    last_used_at: datetime | None


class NewShare(ShareInfo):
    token: str
    url: str = Field(description="shown this once")


class SharePage(BaseModel):
    items: list[ShareInfo]
    next_cursor: str | None


class SharedInfo(BaseModel):
    """What a link shows: a run, or several to be compared."""

    title: str
    runs: list[RunInfo]
    view: dict[str, Any]
    created_at: datetime
    expires_at: datetime | None
