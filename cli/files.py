"""Files that a command writes: there whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO


def write_whole(path: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all. Raises CaseError when it cannot be written."""
    with whole(path) as file:
        file.write(text.encode())


@contextmanager
def whole(path: Path) -> Iterator[IO[bytes]]:
    """An open file that takes the place of `path` at the end, and leaves nothing when it is not reached."""
    from solver.outcome import CaseError, FieldError

    try:
        file = tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False)  # noqa: SIM115 (kept)
    except OSError as error:
        raise CaseError([FieldError((), f"{path} cannot be written: {error.strerror}")]) from None
    try:
        with file:
            yield file  # type: ignore[misc]
        os.chmod(file.name, 0o666 & ~_umask())  # as any new file, where a temporary one is its owner's alone
        os.replace(file.name, path)
    except OSError as error:
        raise CaseError([FieldError((), f"{path} cannot be written: {error.strerror}")]) from None
    finally:
        Path(file.name).unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def size_of(path: Path) -> str:
    """The size of a file in words, e.g. `16.4 MB`."""
    size = float(path.stat().st_size)
    for unit in ("bytes", "kB", "MB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} GB"
