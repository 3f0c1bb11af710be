"""Hydrodynamic data: blobs, versioned under their name, found by id, content hash or name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sqlalchemy import func, or_, select

from ..errors import ConflictError, NotFoundError
from ..models import DataSet, Run
from .scoped import Scoped

TRIES = 5
"""At a version number, which another upload of the same name may take first."""


class DataSetRepository(Scoped):
    def save(
        self, name: str, filename: str, content_hash: str, payload: bytes, summary: dict[str, Any]
    ) -> tuple[DataSet, bool]:
        """The data set with this content, and whether it had to be made."""
        same = self._select(DataSet).where(DataSet.content_hash == content_hash)
        known = self.session.scalars(same).one_or_none()
        if known is not None:
            return known, False
        for _ in range(TRIES - 1):
            try:
                return self._add_or_find(self._next(name, filename, content_hash, payload, summary), same)
            except ConflictError:  # another request took the number
                continue
        return self._add_or_find(self._next(name, filename, content_hash, payload, summary), same)

    def _next(self, name: str, filename: str, content_hash: str, payload: bytes, summary: dict[str, Any]) -> DataSet:
        """A row of the version that follows the last of this name."""
        last = self.session.scalar(
            select(func.max(DataSet.version)).where(DataSet.project_id == self.scope.project_id, DataSet.name == name)
        )
        return DataSet(
            project_id=self.scope.project_id,
            name=name,
            version=(last or 0) + 1,
            filename=filename,
            content_hash=content_hash,
            size=len(payload),
            summary=summary,
            payload=payload,
        )

    def get(self, key: str) -> DataSet:
        return self._one(DataSet, key, "data set")

    def find(self, reference: str) -> DataSet:
        """By id or content hash, else the newest version of that name."""
        if not reference.isprintable():  # null bytes, half surrogates: no name of ours, and no text for a database
            raise NotFoundError("data set", repr(reference))
        keys = or_(DataSet.id == reference, DataSet.content_hash == reference, DataSet.name == reference)
        query = self._select(DataSet).where(keys).order_by(DataSet.version.desc()).limit(1)
        row = self.session.scalars(query).one_or_none()
        if row is None:
            raise NotFoundError("data set", reference)
        return row

    def has_content(self, content_hash: str) -> bool:
        query = self._select(DataSet).where(DataSet.content_hash == content_hash)
        return self.session.scalars(query).one_or_none() is not None

    def names(self) -> Sequence[str]:
        query = select(DataSet.name).where(self._mine(DataSet)).distinct()
        return self.session.scalars(query.order_by(DataSet.name).limit(20)).all()

    def payload(self, key: str) -> bytes:
        return self.get(key).payload

    def page(self, limit: int, cursor: str | None) -> Sequence[DataSet]:
        query = self._select(DataSet).order_by(DataSet.id.desc()).limit(limit)
        if cursor:
            query = query.where(DataSet.id < cursor)
        return self.session.scalars(query).all()

    def delete(self, key: str) -> None:
        row = self.get(key)
        runs = self.session.scalar(select(func.count()).select_from(Run).where(Run.data_set_id == key))
        if runs:
            raise ConflictError(f"{runs} run(s) were computed with this data set; delete them first.")
        self.session.delete(row)
