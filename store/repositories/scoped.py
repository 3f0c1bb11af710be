"""The one place where a query learns whose rows it may see."""

from __future__ import annotations

from typing import Any, TypeVar

from sqlalchemy import ColumnElement, Select, false, select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from ..errors import ConflictError, NotFoundError
from ..models import CaseVersion, Run
from ..scope import Scope

Row = TypeVar("Row")


class Scoped:
    """A repository of rows that carry a project_id."""

    def __init__(self, session: Session, scope: Scope):
        self.session, self.scope = session, scope

    def _mine(self, model: type[Any]) -> ColumnElement[bool]:
        """The condition that every query of rows with a project_id holds."""
        mine: ColumnElement[bool] = model.project_id == self.scope.project_id
        runs = self.scope.run_ids
        if runs is None:
            return mine
        if model is Run:
            return mine & Run.id.in_(runs)
        if model is CaseVersion:
            return mine & CaseVersion.id.in_(select(Run.case_version_id).where(self._mine(Run)))
        return false()

    def _select(self, model: type[Row]) -> Select[Row]:
        return select(model).where(self._mine(model))

    def _one(self, model: type[Row], key: str, what: str) -> Row:
        mine: Any = model
        row = self.session.scalars(self._select(model).where(mine.id == key)).one_or_none()
        if row is None:
            raise NotFoundError(what, key)
        return row

    def _add_or_find(self, row: Row, same: Select[Row]) -> tuple[Row, bool]:
        """Insert the row; where another request was quicker with the same key, that one's row."""
        try:
            with self.session.begin_nested():
                self.session.add(row)
                self.session.flush()
        except IntegrityError:
            found = self.session.scalars(same).one_or_none()
            if found is None:
                raise ConflictError("Another request changed the same thing at the same time; try again.") from None
            return found, False
        return row, True
