"""Compiled kernels, arrays in and arrays out.

Numba keeps compiled code beside the sources and looks only at the file of the function itself: a function that calls
another file's keeps the old code of it. So what is kept is thrown away as soon as any compiled source has changed.
"""

from __future__ import annotations

import contextlib
import hashlib
from pathlib import Path


def _forget_outdated(root: Path) -> bool:
    """Delete kept code under a folder that is older than any compiled source there; True where it did so."""
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        text = path.read_bytes()
        if b"njit" in text:
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + text)
    mark = root / "kernels" / "__pycache__" / "sources.sha256"
    if mark.exists() and mark.read_text() == digest.hexdigest():
        return False
    for kept in root.rglob("__pycache__/*.nb[ic]"):
        kept.unlink(missing_ok=True)
    mark.parent.mkdir(exist_ok=True)
    mark.write_text(digest.hexdigest())
    return True


with contextlib.suppress(OSError):  # an installation that cannot be written to keeps its code elsewhere
    _forget_outdated(Path(__file__).parents[1])
