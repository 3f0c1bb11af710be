"""The data sets that come with Slowdrift, put into a project."""

from __future__ import annotations

import hashlib
import logging

from solver.outcome import SlowdriftError
from solver.vessel import data as hydrodynamics

from .database import Database
from .examples import examples_dir
from .repositories import DataSetRepository
from .scope import Scope

__all__ = ["examples_dir", "register_bundled"]
log = logging.getLogger(__name__)


def register_bundled(database: Database, scope: Scope | None = None) -> list[str]:
    """Put every bundled data set that the project has not yet into it; gives their names."""
    scope = scope or Scope()
    added = []
    for path in sorted(examples_dir().glob("*.nc")):
        payload = path.read_bytes()
        content_hash = hashlib.sha256(payload).hexdigest()
        with database.read() as session:
            if DataSetRepository(session, scope).has_content(content_hash):
                continue
        try:
            summary = hydrodynamics.read_bytes(payload, path.name).describe()
        except SlowdriftError as error:
            log.warning("The bundled data set %s cannot be read: %s", path.name, error)
            continue
        with database.write() as session:
            DataSetRepository(session, scope).save(path.name, path.name, content_hash, payload, summary)
        added.append(path.name)
    return added
