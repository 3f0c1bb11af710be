"""Data sets from the database as the solver's data source."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable

from solver.case.vessel import WamitFiles
from solver.outcome import DataError
from solver.vessel import data as hydrodynamics
from solver.vessel.data import HydrodynamicData

from .models import DataSet

KEEP, KEEP_BYTES = 8, 256 * 1024 * 1024
"""Sets that a process keeps after reading them, and their bytes together; one is kept however large."""
_read: OrderedDict[str, HydrodynamicData] = OrderedDict()
_lock = threading.Lock()


Reader = Callable[[bytes, str, WamitFiles | None], HydrodynamicData]


class PinnedSource:
    """One data set under whatever reference the case has for it: the version that was chosen when the run was made.

    `reader`: store.reading.read_bytes in a process that answers requests; a worker is itself a process that is ended
    when it takes too long (docs/decisions/0048-limits-of-a-task.md), and reads in itself.
    """

    def __init__(self, row: DataSet | None, reader: Reader = hydrodynamics.read_bytes, stated: bool = True):
        """stated : whether the case may state conventions of WAMIT files, which are compared with the upload's own; if
        not, the bytes of a set that has been read are not fetched from the database again."""
        self._reader = reader
        self._known = None if row is None else _recall(row.content_hash)
        if row is None:
            self._found = None
        else:
            fetched = b"" if self._known is not None and not stated else row.payload
            self._found = (row.content_hash, row.filename, fetched)

    def open(self, reference: str, wamit: WamitFiles | None = None) -> HydrodynamicData:
        if self._found is None:
            raise DataError(f"There is no data set {reference[:100]!r} here; upload it first (POST /data-sets).")
        content_hash, filename, payload = self._found
        if wamit is not None:  # the upload's conventions hold; a case that states others is refused
            return self._reader(payload, filename, wamit)
        known = self._known or _recall(content_hash)
        if known is not None:
            return known
        made = self._reader(payload, filename, None)
        with _lock:
            _read[content_hash] = made
            while len(_read) > KEEP or (len(_read) > 1 and sum(data.nbytes for data in _read.values()) > KEEP_BYTES):
                _read.popitem(last=False)
        return made


def _recall(content_hash: str) -> HydrodynamicData | None:
    """A set that this process has read of late."""
    with _lock:
        if content_hash not in _read:
            return None
        _read.move_to_end(content_hash)
        return _read[content_hash]
