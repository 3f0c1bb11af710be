"""Accounts, their sessions and keys."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from sqlalchemy import delete, func, select, update
from sqlalchemy.orm import Session

from ..clock import utc_now
from ..errors import ConflictError, NotFoundError
from ..models import Team
from ..people import ApiKey, Membership, SignIn, User
from .unique import add_unique

KEYS_EACH = 100


class AccountRepository:
    def __init__(self, session: Session):
        self.session = session

    # -- people

    def add(self, email: str, name: str, password_hash: str | None, is_admin: bool) -> User:
        user = User(email=email, name=name, password_hash=password_hash, is_admin=is_admin)
        return add_unique(self.session, user, f"There is an account {email!r} already.")

    def get(self, key: str) -> User:
        user = self.session.get(User, key)
        if user is None:
            raise NotFoundError("user", key)
        return user

    def by_email(self, email: str) -> User | None:
        return self.session.scalars(select(User).where(User.email == email)).one_or_none()

    def page(self, limit: int, cursor: str | None) -> Sequence[User]:
        """Newest first."""
        query = select(User).order_by(User.id.desc()).limit(limit)
        return self.session.scalars(query.where(User.id < cursor) if cursor else query).all()

    def set_admin(self, user: User, is_admin: bool) -> None:
        user.is_admin = is_admin
        self._keep_an_administrator()

    def set_disabled(self, user: User, disabled: bool) -> None:
        """A disabled account has no session; its keys open nothing while it is so."""
        user.disabled_at = (user.disabled_at or utc_now()) if disabled else None
        self._keep_an_administrator()
        if disabled:
            self.end_sessions(user.id)

    def set_password(self, user: User, password_hash: str, but_session: str | None = None) -> None:
        """Sessions other than `but_session` end."""
        user.password_hash = password_hash
        self.end_sessions(user.id, but_session)

    def _keep_an_administrator(self) -> None:
        self.session.flush()
        left = select(func.count()).select_from(User).where(User.is_admin, User.disabled_at.is_(None))
        if not self.session.scalar(left):
            raise ConflictError("This is the last administrator; make another one first.")

    # -- sessions

    def sign_in(self, user_id: str, digest: str, agent: str, expires_at: datetime, by_provider: bool = False) -> SignIn:
        self.session.execute(delete(SignIn).where(SignIn.expires_at < utc_now()))
        row = SignIn(user_id=user_id, digest=digest, agent=agent[:200], expires_at=expires_at, by_provider=by_provider)
        self.session.add(row)
        self.session.flush()
        return row

    def sign_out(self, digest: str) -> None:
        self.session.execute(delete(SignIn).where(SignIn.digest == digest))

    def end_sessions(self, user_id: str, but: str | None = None) -> None:
        query = delete(SignIn).where(SignIn.user_id == user_id)
        self.session.execute(query.where(SignIn.id != but) if but else query)

    def work_in(self, session_id: str, project_id: str) -> None:
        self.session.execute(update(SignIn).where(SignIn.id == session_id).values(project_id=project_id))

    # -- keys

    def add_key(self, key: ApiKey) -> ApiKey:
        held = select(func.count()).select_from(ApiKey).where(ApiKey.user_id == key.user_id)
        if (self.session.scalar(held.where(ApiKey.revoked_at.is_(None))) or 0) >= KEYS_EACH:
            raise ConflictError(f"There are {KEYS_EACH} keys already; revoke one first.")
        if key.team_id is not None and self.session.get(Membership, (key.team_id, key.user_id)) is None:
            raise NotFoundError("team", key.team_id)
        self.session.add(key)
        self.session.flush()
        return key

    def keys(self, user_id: str) -> Sequence[tuple[ApiKey, str | None]]:
        """With the name of the only team each opens; newest first, revoked ones included."""
        query = select(ApiKey, Team.name).outerjoin(Team, Team.id == ApiKey.team_id).where(ApiKey.user_id == user_id)
        rows = self.session.execute(query.order_by(ApiKey.id.desc()).limit(500)).all()
        return [(row[0], row[1]) for row in rows]

    def revoke_key(self, user_id: str, key_id: str) -> None:
        query = update(ApiKey).where(ApiKey.id == key_id, ApiKey.user_id == user_id, ApiKey.revoked_at.is_(None))
        found = self.session.scalar(query.values(revoked_at=utc_now()).returning(ApiKey.id))
        if found is None:
            raise NotFoundError("key", key_id)
