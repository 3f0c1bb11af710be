"""Teams with their members, projects, invitations and log. Callers have been let into the team by `api/access.py`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sqlalchemy import delete, func, select, update
from sqlalchemy.orm import Session

from ..clock import utc_now
from ..errors import ConflictError, NotFoundError
from ..examples import bundled_hashes
from ..models import DEFAULT_TEAM, Base, DataSet, IdempotencyKey, Preview, Project, Team
from ..people import OWNER, Audit, Invitation, Membership, SignIn, User
from .unique import add_unique

FIRST_PROJECT = "default"
GOES_ALONG = ("shares", "previews", "sign_ins", "audit", "idempotency_keys")
"""Tables whose rows do not keep a project from being deleted; nor do the bundled data sets."""


class TeamRepository:
    def __init__(self, session: Session):
        self.session = session

    def add(self, name: str, owner_id: str | None) -> Team:
        """A team with its first project, and its owner as member."""
        team = add_unique(self.session, Team(name=name), f"There is a team {name!r} already.")
        self.session.add(Project(team_id=team.id, name=FIRST_PROJECT))
        if owner_id is not None:
            self.session.add(Membership(team_id=team.id, user_id=owner_id, role=OWNER))
        self.session.flush()
        return team

    def get(self, key: str) -> Team:
        team = self.session.get(Team, key)
        if team is None:
            raise NotFoundError("team", key)
        return team

    def by_name(self, name: str) -> Team | None:
        return self.session.scalars(select(Team).where(Team.name == name)).one_or_none()

    def of(self, user_id: str | None) -> Sequence[Any]:
        """(Team, role, members, projects) of one's teams; of all, with the role of an owner, where nobody signs in."""
        members = (
            select(func.count(Membership.user_id))
            .where(Membership.team_id == Team.id)
            .correlate(Team)
            .scalar_subquery()
        )
        projects = select(func.count(Project.id)).where(Project.team_id == Team.id).correlate(Team).scalar_subquery()
        if user_id is None:
            return [(*row[:1], OWNER, *row[1:]) for row in self.session.execute(select(Team, members, projects))]
        query = select(Team, Membership.role, members, projects).join(Membership, Membership.team_id == Team.id)
        return self.session.execute(query.where(Membership.user_id == user_id).order_by(Team.id)).all()

    def rename(self, row: Team | Project, name: str) -> None:
        row.name = name
        add_unique(self.session, row, f"There is one of the name {name!r} already.")

    def delete(self, team_id: str) -> None:
        if team_id == DEFAULT_TEAM:
            raise ConflictError("The first team stays; rename it if you like.")
        for project in self.session.scalars(select(Project).where(Project.team_id == team_id)).all():
            self._delete_project(project)
        self.session.delete(self.get(team_id))
        self.session.flush()

    # -- members

    def members(self, team_id: str) -> Sequence[Any]:
        """(User, role), by name."""
        query = select(User, Membership.role).join(Membership, Membership.user_id == User.id)
        return self.session.execute(query.where(Membership.team_id == team_id).order_by(User.name, User.id)).all()

    def join(self, team_id: str, user_id: str, role: str) -> None:
        """Become a member. ConflictError for whoever is one already."""
        if self.session.get(Membership, (team_id, user_id)) is not None:
            raise ConflictError("You belong to this team already.")
        row = Membership(team_id=team_id, user_id=user_id, role=role)
        add_unique(self.session, row, "You belong to this team already.")

    def set_role(self, team_id: str, user_id: str, role: str) -> None:
        self._member(team_id, user_id).role = role
        self._keep_an_owner(team_id)

    def remove(self, team_id: str, user_id: str) -> None:
        self.session.delete(self._member(team_id, user_id))
        self._keep_an_owner(team_id)

    def _member(self, team_id: str, user_id: str) -> Membership:
        self.session.get(Team, team_id, with_for_update=True)  # two owners who leave at once do so one after the other
        row = self.session.get(Membership, (team_id, user_id))
        if row is None:
            raise NotFoundError("member", user_id)
        return row

    def _keep_an_owner(self, team_id: str) -> None:
        self.session.flush()
        query = select(func.count()).select_from(Membership).join(User, User.id == Membership.user_id)
        owners = query.where(Membership.team_id == team_id, Membership.role == OWNER, User.disabled_at.is_(None))
        if not self.session.scalar(owners):
            raise ConflictError("This is the team's last owner; make another member owner first.")

    # -- projects

    def add_project(self, team_id: str, name: str) -> Project:
        return add_unique(
            self.session, Project(team_id=team_id, name=name), f"The team has a project {name!r} already."
        )

    def projects(self, team_id: str) -> Sequence[Project]:
        return self.session.scalars(select(Project).where(Project.team_id == team_id).order_by(Project.id)).all()

    def project(self, key: str) -> Project:
        project = self.session.get(Project, key)
        if project is None:
            raise NotFoundError("project", key)
        return project

    def delete_project(self, key: str) -> None:
        project = self.project(key)
        if self.session.scalar(select(func.count()).where(Project.team_id == project.team_id)) == 1:
            raise ConflictError("This is the team's last project; make another one first.")
        self._delete_project(project)

    def _delete_project(self, project: Project) -> None:
        """What merely belongs to it goes with it; cases, runs, data sets and the like keep it."""
        for table in Base.metadata.tables.values():
            if "project_id" not in table.c or table.name in GOES_ALONG:
                continue
            query = select(func.count()).select_from(table).where(table.c.project_id == project.id)
            if table.name == DataSet.__tablename__:
                query = query.where(table.c.content_hash.not_in(bundled_hashes()))
            if held := self.session.scalar(query):
                raise ConflictError(f"The project {project.name!r} still holds {held} {table.name}; delete them first.")
        for model in (DataSet, IdempotencyKey, Preview):
            self.session.execute(delete(model).where(model.project_id == project.id))
        self.session.execute(update(SignIn).where(SignIn.project_id == project.id).values(project_id=None))
        self.session.delete(project)
        self.session.flush()

    # -- invitations

    def invite(self, invitation: Invitation) -> Invitation:
        self.session.add(invitation)
        self.session.flush()
        return invitation

    def invitations(self, team_id: str) -> Sequence[Invitation]:
        """Those still open, newest first."""
        query = select(Invitation).where(Invitation.team_id == team_id, Invitation.used_at.is_(None))
        return self.session.scalars(query.where(Invitation.expires_at > utc_now()).order_by(Invitation.id.desc())).all()

    def invitations_to(self, email: str) -> Sequence[Invitation]:
        """Into teams, for this address and no other; still good, oldest first, locked."""
        named = (Invitation.email == email) & Invitation.user_id.is_(None) & Invitation.team_id.is_not(None)
        good = Invitation.used_at.is_(None) & (Invitation.expires_at > utc_now()) & ~Invitation.is_admin
        return self.session.scalars(
            select(Invitation).where(named, good).order_by(Invitation.id).with_for_update()
        ).all()

    def invitation(self, digest: str) -> Invitation:
        """One that is still good, locked: it works once."""
        good = (Invitation.digest == digest) & Invitation.used_at.is_(None) & (Invitation.expires_at > utc_now())
        found = self.session.scalars(select(Invitation).where(good).with_for_update()).one_or_none()
        if found is None or (found.is_admin and self.session.scalar(select(User.id).limit(1)) is not None):
            raise NotFoundError("invitation", "")  # the first administrator's is over once there is an account
        return found

    def use(self, invitation: Invitation, user_id: str) -> None:
        """ConflictError where it was used meanwhile (SQLite locks no row)."""
        query = update(Invitation).where(Invitation.id == invitation.id, Invitation.used_at.is_(None))
        done = self.session.scalar(query.values(used_at=utc_now(), used_by=user_id).returning(Invitation.id))
        if done is None:
            raise ConflictError("The invitation has been used.")

    def withdraw(self, team_id: str, key: str) -> None:
        query = delete(Invitation).where(
            Invitation.id == key, Invitation.team_id == team_id, Invitation.used_at.is_(None)
        )
        if self.session.scalar(query.returning(Invitation.id)) is None:
            raise NotFoundError("invitation", key)

    # -- the log

    def audit(self, team_id: str, limit: int, cursor: str | None) -> Sequence[Audit]:
        """Newest first."""
        query = select(Audit).where(Audit.team_id == team_id).order_by(Audit.id.desc()).limit(limit)
        return self.session.scalars(query.where(Audit.id < cursor) if cursor else query).all()
