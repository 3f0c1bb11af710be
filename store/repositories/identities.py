"""Which account a subject of an OpenID Connect provider is."""

from __future__ import annotations

from sqlalchemy import select
from sqlalchemy.orm import Session

from ..people import Identity, User
from .unique import add_unique


class IdentityRepository:
    def __init__(self, session: Session):
        self.session = session

    def user_of(self, issuer: str, subject: str) -> User | None:
        query = select(User).join(Identity, Identity.user_id == User.id)
        return self.session.scalars(query.where(Identity.issuer == issuer, Identity.subject == subject)).one_or_none()

    def has(self, issuer: str, user_id: str) -> bool:
        """Whether the account has a subject at this provider already."""
        query = select(Identity.id).where(Identity.issuer == issuer, Identity.user_id == user_id)
        return self.session.scalar(query) is not None

    def add(self, identity: Identity) -> Identity:
        return add_unique(self.session, identity, "This account was linked a moment ago; sign in again.")
