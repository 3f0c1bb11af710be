"""Who stands at the door: credentials looked up by the digest of their token, and what they open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import BindParameter, bindparam, select, update
from sqlalchemy.orm import Session

from ..clock import utc_now
from ..hydrodynamics import Mesh
from ..models import CaseVersion, DataSet, Project, Run, Study, Team
from ..people import OWNER, ApiKey, Membership, Share, SignIn, User

TOUCH = timedelta(minutes=1)
"""`last_used_at` is kept this exactly."""
PLACES: dict[str, Any] = {
    "run_id": Run, "job_id": Run, "case_id": CaseVersion, "data_set_id": DataSet, "mesh_id": Mesh, "share_id": Share,
    "study_id": Study,
}  # fmt: skip
"""Parameters of addresses that name a row, and so the project to look in."""


# Every request asks these: made once, since to put them together takes longer than to execute them.
_DIGEST: BindParameter[str] = bindparam("digest")
_NOW: BindParameter[datetime] = bindparam("now")
_SIGN_IN = (
    select(SignIn, User)
    .join(User, User.id == SignIn.user_id)
    .where(SignIn.digest == _DIGEST, SignIn.expires_at > _NOW, User.disabled_at.is_(None))
)
_KEY = (
    select(ApiKey, User)
    .join(User, User.id == ApiKey.user_id)
    .where(ApiKey.digest == _DIGEST, ApiKey.revoked_at.is_(None), User.disabled_at.is_(None))
    .where(ApiKey.expires_at.is_(None) | (ApiKey.expires_at > _NOW))
)
_SHARE = (
    select(Share)
    .where(Share.digest == _DIGEST, Share.revoked_at.is_(None))
    .where(Share.expires_at.is_(None) | (Share.expires_at > _NOW))
)
_HOMES = (
    select(Team.id, Team.name, Project.id, Project.name, Membership.role)
    .join(Project, Project.team_id == Team.id)
    .join(Membership, Membership.team_id == Team.id)
    .where(Membership.user_id == bindparam("user"))
    .order_by(Team.id, Project.id)
)
_HOMES_IN_TEAM = _HOMES.where(Team.id == bindparam("team"))


@dataclass(frozen=True)
class Home:
    """A project that somebody may enter, and as what."""

    team_id: str
    team_name: str
    project_id: str
    project_name: str
    role: str


class EntryRepository:
    """Asked before there is a scope: whom a credential belongs to decides the scope."""

    def __init__(self, session: Session):
        self.session = session

    def any_account(self) -> bool:
        return self.session.scalar(select(User.id).limit(1)) is not None

    def signed_in(self, digest: str) -> tuple[SignIn, User] | None:
        row = self.session.execute(_SIGN_IN, {"digest": digest, "now": utc_now()}).one_or_none()
        return None if row is None else (row[0], row[1])

    def key(self, digest: str) -> tuple[ApiKey, User] | None:
        row = self.session.execute(_KEY, {"digest": digest, "now": utc_now()}).one_or_none()
        return None if row is None else (row[0], row[1])

    def share(self, digest: str) -> Share | None:
        return self.session.scalars(_SHARE, {"digest": digest, "now": utc_now()}).one_or_none()

    def touch(self, row: SignIn | ApiKey | Share) -> None:
        model = type(row)
        self.session.execute(update(model).where(model.id == row.id).values(last_used_at=utc_now()))

    def homes(self, user_id: str, team_id: str | None = None) -> list[Home]:
        """The projects of one's teams, oldest first; of one team only where it is named."""
        if team_id is None:
            return [Home(*row) for row in self.session.execute(_HOMES, {"user": user_id})]
        return [Home(*row) for row in self.session.execute(_HOMES_IN_TEAM, {"user": user_id, "team": team_id})]

    def all_homes(self) -> list[Home]:
        """What the one person of a service without accounts may enter: everything."""
        query = select(Team.id, Team.name, Project.id, Project.name).join(Project, Project.team_id == Team.id)
        return [Home(*row, OWNER) for row in self.session.execute(query.order_by(Team.id, Project.id))]

    def project_of(self, parameter: str, key: str, among: Sequence[str]) -> str | None:
        """The project, of those given, that holds the row which a parameter of the address names."""
        model = PLACES[parameter]
        return self.session.scalar(select(model.project_id).where(model.id == key, model.project_id.in_(among)))


def stale(row: SignIn | ApiKey | Share) -> bool:
    return row.last_used_at is None or utc_now() - row.last_used_at > TOUCH
