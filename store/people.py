"""Tables of people and of what they may do: accounts, memberships, sessions, keys, invitations, shares, the audit log.

Of every token only its HMAC is kept (store/tokens.py): the database alone lets nobody in.
"""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from .clock import utc_now
from .ids import new_id
from .models import Base, Id

VIEWER, EDITOR, OWNER = "viewer", "editor", "owner"
ROLES = (VIEWER, EDITOR, OWNER)
"""Each may do what those before it may."""
READ, SUBMIT, ADMIN = "read", "submit", "admin"
KEY_SCOPES = (READ, SUBMIT, ADMIN)
"""What a key may do at most: read; also submit and change; also manage teams and accounts. Each includes the former."""

Digest = String(64)


class User(Base):
    """A person. Never deleted, since the audit log names them: disabled instead."""

    __tablename__ = "users"
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    email: Mapped[str] = mapped_column(String(254), unique=True)
    """In lower case; what one signs in with."""
    name: Mapped[str] = mapped_column(String(200))
    password_hash: Mapped[str | None] = mapped_column(String(300), default=None)
    """Argon2id with its parameters; none for whoever can sign in by other means only."""
    is_admin: Mapped[bool] = mapped_column(default=False)
    """Administers the installation: its accounts. Sees no team's rows by that."""
    disabled_at: Mapped[datetime | None] = mapped_column(default=None)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class Membership(Base):
    __tablename__ = "memberships"
    team_id: Mapped[str] = mapped_column(Id, ForeignKey("teams.id", ondelete="CASCADE"), primary_key=True)
    user_id: Mapped[str] = mapped_column(Id, ForeignKey("users.id"), primary_key=True, index=True)
    role: Mapped[str] = mapped_column(String(20))
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class SignIn(Base):
    """One browser's session."""

    __tablename__ = "sign_ins"
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    user_id: Mapped[str] = mapped_column(Id, ForeignKey("users.id"), index=True)
    digest: Mapped[str] = mapped_column(Digest, unique=True)
    project_id: Mapped[str | None] = mapped_column(Id, ForeignKey("projects.id", ondelete="SET NULL"), default=None)
    """The project in which requests work that name none."""
    agent: Mapped[str] = mapped_column(String(200), default="")
    by_provider: Mapped[bool] = mapped_column(default=False)
    """Begun by an OpenID Connect provider's word, not by a password."""
    created_at: Mapped[datetime] = mapped_column(default=utc_now)
    last_used_at: Mapped[datetime] = mapped_column(default=utc_now)
    expires_at: Mapped[datetime]


class Identity(Base):
    """Whom an OpenID Connect provider means by a subject: one account has one subject at a provider."""

    __tablename__ = "oidc_identities"
    __table_args__ = (UniqueConstraint("issuer", "subject"), UniqueConstraint("issuer", "user_id"))
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    issuer: Mapped[str] = mapped_column(String(500))
    subject: Mapped[str] = mapped_column(String(255))
    user_id: Mapped[str] = mapped_column(Id, ForeignKey("users.id"), index=True)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)


class ApiKey(Base):
    __tablename__ = "api_keys"
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    user_id: Mapped[str] = mapped_column(Id, ForeignKey("users.id"), index=True)
    team_id: Mapped[str | None] = mapped_column(Id, ForeignKey("teams.id", ondelete="CASCADE"), default=None)
    """The only team it opens; all of its user's where none is named."""
    name: Mapped[str] = mapped_column(String(200))
    scope: Mapped[str] = mapped_column(String(20))
    start: Mapped[str] = mapped_column(String(20))
    """Its first characters, to tell keys apart."""
    digest: Mapped[str] = mapped_column(Digest, unique=True)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)
    expires_at: Mapped[datetime | None] = mapped_column(default=None)
    revoked_at: Mapped[datetime | None] = mapped_column(default=None)
    last_used_at: Mapped[datetime | None] = mapped_column(default=None)


class Invitation(Base):
    """A link that works once: into a team with a role, for the first administrator, or to a new password."""

    __tablename__ = "invitations"
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    team_id: Mapped[str | None] = mapped_column(
        Id, ForeignKey("teams.id", ondelete="CASCADE"), default=None, index=True
    )
    role: Mapped[str] = mapped_column(String(20), default=VIEWER)
    is_admin: Mapped[bool] = mapped_column(default=False)
    user_id: Mapped[str | None] = mapped_column(Id, ForeignKey("users.id"), default=None)
    """Whose password it sets; none for a newcomer."""
    email: Mapped[str | None] = mapped_column(String(254), default=None)
    """The only address it is good for; any where none is named."""
    digest: Mapped[str] = mapped_column(Digest, unique=True)
    made_by: Mapped[str | None] = mapped_column(Id, ForeignKey("users.id"), default=None)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)
    expires_at: Mapped[datetime]
    used_at: Mapped[datetime | None] = mapped_column(default=None)
    used_by: Mapped[str | None] = mapped_column(Id, ForeignKey("users.id"), default=None)


class Share(Base):
    """A link that shows a few runs of one project to whoever has it."""

    __tablename__ = "shares"
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id", ondelete="CASCADE"), index=True)
    title: Mapped[str] = mapped_column(String(200))
    run_ids: Mapped[list[Any]]
    view: Mapped[dict[str, Any]] = mapped_column(default=dict)
    """What was on the screen, as the pages wrote it."""
    digest: Mapped[str] = mapped_column(Digest, unique=True)
    made_by: Mapped[str | None] = mapped_column(Id, ForeignKey("users.id"), default=None)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)
    expires_at: Mapped[datetime | None] = mapped_column(default=None)
    revoked_at: Mapped[datetime | None] = mapped_column(default=None)
    last_used_at: Mapped[datetime | None] = mapped_column(default=None)


class Audit(Base):
    """Who did what. Written in the transaction of the change itself."""

    __tablename__ = "audit"
    __table_args__ = (Index("ix_audit_team", "team_id", "id"),)
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    at: Mapped[datetime] = mapped_column(default=utc_now)
    team_id: Mapped[str | None] = mapped_column(Id, default=None)
    """Of no foreign key: the log outlives what it tells of."""
    project_id: Mapped[str | None] = mapped_column(Id, default=None)
    user_id: Mapped[str | None] = mapped_column(Id, default=None)
    actor: Mapped[str] = mapped_column(String(300))
    """The e-mail address, and the key's name where one was used; `cli` for the command line."""
    action: Mapped[str] = mapped_column(String(200))
    """Method and route, or the command."""
    subject: Mapped[dict[str, Any]] = mapped_column(default=dict)
    address: Mapped[str] = mapped_column(String(60), default="")


class RunImport(Base):
    """A run that came from another Slowdrift: the hash of its bundle, so that the same one comes in once."""

    __tablename__ = "run_imports"
    __table_args__ = (UniqueConstraint("project_id", "content_hash"),)
    id: Mapped[str] = mapped_column(Id, primary_key=True, default=new_id)
    project_id: Mapped[str] = mapped_column(Id, ForeignKey("projects.id"))
    run_id: Mapped[str] = mapped_column(Id, ForeignKey("runs.id", ondelete="CASCADE"), index=True)
    content_hash: Mapped[str] = mapped_column(String(64))
    origin: Mapped[dict[str, Any]] = mapped_column(default=dict)
    created_at: Mapped[datetime] = mapped_column(default=utc_now)
