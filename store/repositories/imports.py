"""Runs that come from another Slowdrift: their rows as they were, each bundle once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import undefer

from ..models import ChannelRow, Run, Task
from ..people import RunImport
from .scoped import Scoped


class ImportRepository(Scoped):
    def channel_rows(self, run_id: str) -> Iterator[ChannelRow]:
        """With their blobs, one in memory at a time. The caller holds a run of its own scope."""
        query = select(ChannelRow).where(ChannelRow.run_id == run_id).order_by(ChannelRow.number)
        blobs = (undefer(ChannelRow.payload), undefer(ChannelRow.axes_payload))
        for row in self.session.scalars(query.options(*blobs).execution_options(yield_per=1)):
            yield row
            self.session.expunge(row)

    def known(self, content_hash: str) -> str | None:
        """The run that this bundle became here."""
        query = select(RunImport.run_id).where(self._mine(RunImport), RunImport.content_hash == content_hash)
        return self.session.scalar(query)

    def add(self, run: Run, channels: Iterable[ChannelRow], content_hash: str, origin: dict[str, Any]) -> str:
        """A finished run with one finished task, its channels, and where it comes from; gives its id."""
        run.project_id, run.created_by = self.scope.project_id, self.scope.user_id
        self.session.add(run)
        self.session.flush()
        self.session.add(Task(run_id=run.id, number=0, chunk={}, state=run.state, progress=1.0))
        for row in channels:
            row.run_id = run.id
            self.session.add(row)
            self.session.flush()
            self.session.expunge(row)
        made = RunImport(project_id=self.scope.project_id, run_id=run.id, content_hash=content_hash, origin=origin)
        self.session.add(made)
        self.session.flush()
        return run.id
