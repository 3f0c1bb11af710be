"""Who stands at the door: credentials looked up by the digest of their token, and what they open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import BindParameter, Select, bindparam, select, update
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
_PLACE = (Team.id, Team.name, Project.id, Project.name, Membership.role)
_SIGN_IN = (
    select(SignIn, User, *_PLACE)
    .join(User, User.id == SignIn.user_id)
    .outerjoin(Membership, Membership.user_id == User.id)
    .outerjoin(Team, Team.id == Membership.team_id)
    .outerjoin(Project, Project.team_id == Team.id)
    .where(SignIn.digest == _DIGEST, SignIn.expires_at > _NOW, User.disabled_at.is_(None))
    .order_by(Team.id, Project.id)
)
_KEY = (
    select(ApiKey, User, *_PLACE)
    .join(User, User.id == ApiKey.user_id)
    .outerjoin(
        Membership,
        (Membership.user_id == User.id) & (ApiKey.team_id.is_(None) | (ApiKey.team_id == Membership.team_id)),
    )
    .outerjoin(Team, Team.id == Membership.team_id)
    .outerjoin(Project, Project.team_id == Team.id)
    .where(ApiKey.digest == _DIGEST, ApiKey.revoked_at.is_(None), User.disabled_at.is_(None))
    .where(ApiKey.expires_at.is_(None) | (ApiKey.expires_at > _NOW))
    .order_by(Team.id, Project.id)
)
_SHARE = (
    select(Share)
    .where(Share.digest == _DIGEST, Share.revoked_at.is_(None))
    .where(Share.expires_at.is_(None) | (Share.expires_at > _NOW))
)


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

    def signed_in(self, digest: str) -> tuple[SignIn, User, tuple[Home, ...]] | None:
        """The session, whose it is, and the projects of their teams, oldest first."""
        return self._with_homes(_SIGN_IN, digest)

    def key(self, digest: str) -> tuple[ApiKey, User, tuple[Home, ...]] | None:
        """The key, whose it is, and the projects it opens, oldest first."""
        return self._with_homes(_KEY, digest)

    def _with_homes(self, query: Select[*tuple[Any, ...]], digest: str) -> tuple[Any, User, tuple[Home, ...]] | None:
        rows = self.session.execute(query, {"digest": digest, "now": utc_now()}).all()
        if not rows:
            return None
        return rows[0][0], rows[0][1], tuple(Home(*row[2:]) for row in rows if row[4] is not None)

    def share(self, digest: str) -> Share | None:
        return self.session.scalars(_SHARE, {"digest": digest, "now": utc_now()}).one_or_none()

    def touch(self, row: SignIn | ApiKey | Share) -> None:
        model = type(row)
        self.session.execute(update(model).where(model.id == row.id).values(last_used_at=utc_now()))

    def homes(self, user_id: str) -> list[Home]:
        """The projects of one's teams, oldest first."""
        query = (
            select(*_PLACE)
            .join(Project, Project.team_id == Team.id)
            .join(Membership, Membership.team_id == Team.id)
            .where(Membership.user_id == user_id)
            .order_by(Team.id, Project.id)
        )
        return [Home(*row) for row in self.session.execute(query)]

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
