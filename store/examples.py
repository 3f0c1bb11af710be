"""Where the examples are that come with Slowdrift: in ./examples of a checkout, in solver/examples of a wheel."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import solver


def examples_dir() -> Path:
    package = Path(solver.__file__).parent
    installed = package / "examples"
    return installed if installed.is_dir() else package.parent / "examples"


@cache
def bundled_hashes() -> tuple[str, ...]:
    """SHA-256 of each bundled data set."""
    return tuple(hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(examples_dir().glob("*.nc")))
