"""Cases: names with numbered versions, each a content hash that is unique in its project."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import func, select
from sqlalchemy.orm import undefer

from ..errors import ConflictError
from ..models import Case, CaseVersion, Run, Study
from .scoped import Scoped


@dataclass(frozen=True)
class NewCase:
    name: str
    content_hash: str
    canonical: str
    yaml: str
    warnings: tuple[str, ...] = ()


class CaseRepository(Scoped):
    def save(self, new: NewCase) -> tuple[CaseVersion, bool]:
        """The version with this content, and whether it had to be made."""
        same = self._select(CaseVersion).where(CaseVersion.content_hash == new.content_hash)
        known = self.session.scalars(same).one_or_none()
        if known is not None:
            return known, False
        case_id = self._case(new.name).id
        last = self.session.scalar(select(func.max(CaseVersion.number)).where(CaseVersion.case_id == case_id))
        version = CaseVersion(
            project_id=self.scope.project_id,
            case_id=case_id,
            number=(last or 0) + 1,
            name=new.name,
            content_hash=new.content_hash,
            canonical=new.canonical,
            yaml=new.yaml,
            warnings=list(new.warnings),
        )
        return self._add_or_find(version, same)

    def _case(self, name: str) -> Case:
        """The row of that name, locked, so that versions are numbered one after another."""
        query = self._select(Case).where(Case.name == name).with_for_update()
        found = self.session.scalars(query).one_or_none()
        return found or self._add_or_find(Case(project_id=self.scope.project_id, name=name), query)[0]

    def get(self, key: str) -> CaseVersion:
        return self._one(CaseVersion, key, "case")

    def get_with_text(self, key: str) -> CaseVersion:
        query = self._select(CaseVersion).where(CaseVersion.id == key)
        found = self.session.scalars(query.options(undefer(CaseVersion.canonical), undefer(CaseVersion.yaml)))
        return found.one_or_none() or self.get(key)

    def page(self, limit: int, cursor: str | None) -> Sequence[CaseVersion]:
        """Newest first, from below the id `cursor`."""
        query = self._select(CaseVersion).order_by(CaseVersion.id.desc()).limit(limit)
        if cursor:
            query = query.where(CaseVersion.id < cursor)
        return self.session.scalars(query).all()

    def delete(self, key: str) -> None:
        version = self.get(key)
        for model, what in ((Run, "run(s)"), (Study, "study(ies)")):  # a study may have lost its runs one by one
            count = self.session.scalar(select(func.count()).select_from(model).where(model.case_version_id == key))
            if count:
                raise ConflictError(f"{count} {what} refer to this case; delete them first.")
        self.session.delete(version)
        self.session.flush()
        left = self.session.scalar(
            select(func.count()).select_from(CaseVersion).where(CaseVersion.case_id == version.case_id)
        )
        if not left:
            self.session.delete(self._one(Case, version.case_id, "case"))
