"""Keys under which a request has made something."""

from __future__ import annotations

from datetime import timedelta

from sqlalchemy import delete

from ..clock import utc_now
from ..errors import ConflictError
from ..models import IdempotencyKey
from .scoped import Scoped

KEEP = timedelta(days=2)


class IdempotencyRepository(Scoped):
    def reserve(self, key: str, fingerprint: str) -> tuple[IdempotencyKey, bool]:
        """The key's row, and whether it is new: then the caller sets what it makes as `resource_id`.

        In the transaction of the making: both are there, or neither. A second request with the key waits for the first
        to end. Raises ConflictError where the key was used for another request.
        """
        same = self._select(IdempotencyKey).where(IdempotencyKey.key == key)
        known = self.session.scalars(same).one_or_none()
        if known is not None:
            row, made = known, False
        else:
            fresh = IdempotencyKey(project_id=self.scope.project_id, key=key, fingerprint=fingerprint, resource_id="")
            row, made = self._add_or_find(fresh, same)
        if row.fingerprint != fingerprint:
            raise ConflictError("This Idempotency-Key was used for another request; take a new key for a new request.")
        return row, made

    def sweep(self) -> None:
        """Forget keys that nobody repeats any more."""
        self.session.execute(delete(IdempotencyKey).where(IdempotencyKey.created_at < utc_now() - KEEP))
