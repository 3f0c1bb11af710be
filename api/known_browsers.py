"""A cookie by which a browser shows that somebody has signed in to an account with it before.

Strangers can use up an account's attempts at its password; a known browser has a count of its own (api/attempts.py), so
that they cannot keep the owner out. The cookie opens nothing: whoever steals it may try a few passwords.
"""

from __future__ import annotations

import hmac
import secrets
import time

from store.tokens import digest

from .guard import cookie_value

KNOWN, SECURE_KNOWN = "slowdrift-known", "__Host-slowdrift-known"
"""The cookie's name over http and https."""
DAYS = 365


def known_value(user_id: str, secret: bytes, now: float | None = None) -> str:
    """`user.number.day.signature`: a random number for the browser, and the day on which it ends."""
    ends = int((time.time() if now is None else now) // 86_400) + DAYS
    body = f"{user_id}.{secrets.token_urlsafe(16)}.{ends}"
    return f"{body}.{_signature(body, secret)}"


def known_browser(cookies: str, user_id: str, secret: bytes, now: float | None = None) -> str | None:
    """The browser's number, where the Cookie header shows that this account was signed in to with it; else None."""
    body, _, signature = cookie_value(cookies, SECURE_KNOWN, KNOWN).rpartition(".")
    if not hmac.compare_digest(_signature(body, secret).encode(), signature.encode()):
        return None
    known_user, number, ends = body.split(".")
    today = (time.time() if now is None else now) // 86_400
    return number if known_user == user_id and today <= int(ends) else None


def _signature(body: str, secret: bytes) -> str:
    return digest(f"slowdrift known browser {body}", secret)
