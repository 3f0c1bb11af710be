"""Links that show a few runs to whoever has them."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import select

from ..clock import utc_now
from ..errors import NotFoundError
from ..models import Run
from ..people import Share
from .scoped import Scoped


class ShareRepository(Scoped):
    def add(
        self, title: str, run_ids: Sequence[str], view: dict[str, Any], digest: str, expires_at: datetime | None
    ) -> Share:
        """Raises NotFoundError for a run that is not of the project."""
        known = set(self.session.scalars(select(Run.id).where(self._mine(Run), Run.id.in_(run_ids))))
        for run_id in run_ids:
            if run_id not in known:
                raise NotFoundError("run", run_id)
        share = Share(
            project_id=self.scope.project_id,
            title=title,
            run_ids=list(dict.fromkeys(run_ids)),
            view=view,
            digest=digest,
            made_by=self.scope.user_id,
            expires_at=expires_at,
        )
        self.session.add(share)
        self.session.flush()
        return share

    def page(self, limit: int, cursor: str | None) -> Sequence[Share]:
        """Newest first."""
        query = self._select(Share).order_by(Share.id.desc()).limit(limit)
        return self.session.scalars(query.where(Share.id < cursor) if cursor else query).all()

    def revoke(self, key: str) -> None:
        share = self._one(Share, key, "share link")
        share.revoked_at = share.revoked_at or utc_now()
