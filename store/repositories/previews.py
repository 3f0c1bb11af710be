"""The letter box of previews."""

from __future__ import annotations

from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from ..clock import clock
from ..models import QUEUED, RUNNING, Preview
from ..scope import Scope

KEEP_SECONDS = 60.0


class PreviewRepository:
    def __init__(self, session: Session, scope: Scope | None = None):
        self.session, self.scope = session, scope or Scope()

    def ask(self, canonical: str, data_set_id: str | None) -> str:
        asked_at = self.session.scalar(select(clock(self.session)))
        row = Preview(project_id=self.scope.project_id, canonical=canonical, data_set_id=data_set_id, asked_at=asked_at)
        self.session.add(row)
        self.session.flush()
        return row.id

    def claim(self, key: str, not_older_than: float) -> Preview | None:
        """The letter, for one worker only, if somebody still waits for its answer."""
        since = clock(self.session) - not_older_than
        taken = self.session.execute(
            update(Preview)
            .where(Preview.id == key, Preview.state == QUEUED, Preview.asked_at > since)
            .values(state=RUNNING)
            .execution_options(synchronize_session=False)
        )
        return self.session.get(Preview, key) if taken.rowcount else None  # type: ignore[attr-defined]

    def answer(self, key: str, state: str, answer: str) -> None:
        self.session.execute(update(Preview).where(Preview.id == key).values(state=state, answer=answer))

    def collect(self, key: str) -> tuple[str, str] | None:
        """State and answer, once there is one."""
        row = self.session.execute(select(Preview.state, Preview.answer).where(Preview.id == key)).one_or_none()
        return None if row is None or row.answer is None else (row.state, row.answer)

    def remove(self, key: str) -> None:
        self.session.execute(delete(Preview).where(Preview.id == key))

    def sweep(self) -> None:
        self.session.execute(delete(Preview).where(Preview.asked_at < clock(self.session) - KEEP_SECONDS))
