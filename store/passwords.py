"""Passwords: Argon2id through pwdlib, a few at a time."""

from __future__ import annotations

import threading
from functools import cache

from pwdlib import PasswordHash
from pwdlib.exceptions import UnknownHashError

MIN_LENGTH, MAX_LENGTH = 10, 200
AT_ONCE = threading.BoundedSemaphore(2)
"""Each hash takes 64 MB for some 50 ms: more at a time would take the machine's memory and gain nothing."""


@cache
def _hasher() -> PasswordHash:
    return PasswordHash.recommended()


@cache
def _nobodys() -> str:
    """Checked where there is no account, so that the answer takes as long."""
    return hash_password("nobody has this password")


def hash_password(password: str) -> str:
    with AT_ONCE:
        return _hasher().hash(password)


def check_password(password: str, kept: str | None) -> tuple[bool, str | None]:
    """Whether it is the password; and a new hash to keep where the old one has weaker parameters than today's."""
    against = kept or _nobodys()
    try:
        with AT_ONCE:
            good, fresh = _hasher().verify_and_update(password, against)
    except UnknownHashError:
        return False, None
    return (good, fresh) if kept else (False, None)
