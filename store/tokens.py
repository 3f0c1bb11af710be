"""Opaque tokens: `sdk_` and 43 random characters and 6 of a checksum. Only their HMAC is kept.

The prefix says what a token is for, to people and to scanners for leaked secrets; the checksum tells a mistyped one
without asking the database. With 256 random bits a token cannot be guessed; the HMAC's key makes a stolen database
useless for signing in.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import os
import secrets
import zlib
from pathlib import Path

from .settings import Settings

SESSION, KEY, INVITATION, SHARE = "sds", "sdk", "sdi", "sdl"
SECRET_FILE = "secret"
"""In the data folder, where the setting `secret` is empty."""
START = 10
"""How many characters of a key may be shown later, to tell keys apart."""
_LENGTH = len("sdk_") + 43 + 6


def new_token(kind: str) -> str:
    body = f"{kind}_{secrets.token_urlsafe(32)}"
    return body + _checksum(body)


def is_token(text: str, kind: str) -> bool:
    """Whether it has the form and the checksum of such a token; nothing about whether it is good."""
    if len(text) != _LENGTH or not text.startswith(f"{kind}_") or not text.isascii():
        return False
    return hmac.compare_digest(_checksum(text[:-6]), text[-6:])


def digest(token: str, secret: bytes) -> str:
    return hmac.new(secret, token.encode(), hashlib.sha256).hexdigest()


def csrf_token(session_token: str) -> str:
    """What a request with this session's cookie shows when no browser vouches for its origin: it knows the token."""
    return hashlib.sha256(b"slowdrift csrf " + session_token.encode()).hexdigest()


def read_secret(settings: Settings) -> bytes:
    """The HMAC's key: the setting, or a file of the data folder that is made when there is none."""
    if settings.secret:
        return settings.secret.encode()
    path = settings.data_dir / SECRET_FILE
    try:
        return _kept(path)
    except FileNotFoundError:
        pass
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f".secret.{os.getpid()}.{secrets.token_hex(4)}")
    with open(os.open(fresh, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(secrets.token_hex(32).encode())
    try:
        os.link(fresh, path)  # whoever is first wins, whole
    except FileExistsError:
        pass
    finally:
        fresh.unlink()
    return _kept(path)


def _kept(path: Path) -> bytes:
    kept = path.read_bytes().strip()
    if len(kept) < 32:
        raise ValueError(f"{path} holds {len(kept)} characters; a secret has at least 32")
    return kept


def _checksum(body: str) -> str:
    return base64.urlsafe_b64encode(zlib.crc32(body.encode()).to_bytes(4)).decode()[:6]
