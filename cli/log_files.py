"""Output of child processes into files of bounded size."""

from __future__ import annotations

import os
import threading
from itertools import pairwise
from pathlib import Path

LOG_BYTES, KEPT = 5_000_000, 3
"""Of one file, and how many older ones (NAME.log.1 …) are kept."""
CHUNK = 65_536


class LogFile:
    """A file that is moved to NAME.log.1 when it is full, and so on; a full disk loses lines and stops nobody."""

    def __init__(self, path: Path, most: int = LOG_BYTES, kept: int = KEPT):
        self._path, self._most, self._kept = path, most, kept
        self._lock = threading.Lock()
        path.parent.mkdir(parents=True, exist_ok=True)

    def copy_from(self, pipe: int) -> None:
        """In a thread: everything from the pipe, until its last writer has ended."""
        threading.Thread(target=self._copy, args=(pipe,), name=f"log-{self._path.stem}", daemon=True).start()

    def _copy(self, pipe: int) -> None:
        with open(pipe, "rb", buffering=0) as source:
            while chunk := source.read(CHUNK):
                self.write(chunk)

    def write(self, chunk: bytes) -> None:
        with self._lock:
            try:
                if self._path.exists() and self._path.stat().st_size + len(chunk) > self._most:
                    self._rotate()
                with self._path.open("ab") as file:
                    file.write(chunk)
            except OSError:
                return

    def _rotate(self) -> None:
        names = [self._path, *(self._path.with_name(f"{self._path.name}.{n}") for n in range(1, self._kept + 1))]
        for newer, older in reversed(list(pairwise(names))):
            if newer.exists():
                os.replace(newer, older)
