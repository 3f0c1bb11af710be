"""What `slowdrift user` and `slowdrift key` share: the database, passwords from a terminal or a pipe, the log."""

from __future__ import annotations

import argparse
import getpass
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from typing import TYPE_CHECKING

from .options import RefusedError, read_settings

if TYPE_CHECKING:
    from sqlalchemy.orm import Session

    from store.people import User
    from store.settings import Settings


@contextmanager
def changing(options: argparse.Namespace, **subject: str) -> Iterator[tuple[Session, Settings]]:
    """One unit of work on the service's database, written into the audit log. Raises RefusedError."""
    from solver.outcome import SlowdriftError
    from store import migrations
    from store.database import Database
    from store.people import Audit

    settings = read_settings(options.data_dir)
    database = Database(settings.database)
    try:
        migrations.upgrade(database)
        with database.write() as session:
            yield session, settings
            if options.changes:
                action = f"slowdrift {options.command} {options.what}"
                session.add(Audit(actor="command line", action=action, subject=subject))
    except SlowdriftError as error:
        raise RefusedError(str(error)) from None
    finally:
        database.close()


def the_user(session: Session, email: str) -> User:
    from store.repositories.accounts import AccountRepository

    user = AccountRepository(session).by_email(email.strip().lower())
    if user is None:
        raise RefusedError(f"there is no account {email!r}; `slowdrift user list` shows them")
    return user


def ask_password(options: argparse.Namespace) -> str:
    """From the first line of a pipe with --password-stdin, else typed twice."""
    from store.passwords import MAX_LENGTH, MIN_LENGTH

    if options.password_stdin:
        password = sys.stdin.readline().rstrip("\r\n")
    else:
        password = getpass.getpass("Password: ")
        if getpass.getpass("Again: ") != password:
            raise RefusedError("the two passwords differ; nothing was changed")
    if not MIN_LENGTH <= len(password) <= MAX_LENGTH:
        raise RefusedError(f"the password has {len(password)} characters; allowed: {MIN_LENGTH} to {MAX_LENGTH}")
    return password


def make_link(session: Session, settings: Settings, days: int, **invitation: object) -> str:
    """An invitation's address, to be opened once; without SLOWDRIFT_PUBLIC_URL only what stands behind the host.

    `invitation`: the row's columns.
    """
    from store.clock import utc_now
    from store.people import Invitation
    from store.repositories.teams import TeamRepository
    from store.tokens import INVITATION, digest, new_token

    token = new_token(INVITATION)
    hashed = digest(token, read_secret_of(settings))
    expires_at = utc_now() + timedelta(days=days)
    TeamRepository(session).invite(Invitation(digest=hashed, expires_at=expires_at, **invitation))
    return f"{settings.public_url.rstrip('/')}/app/invitations/{token}"


def read_secret_of(settings: Settings) -> bytes:
    """The secret of the API. Raises RefusedError where a new one would be made beside a server's database: tokens made
    with it would open nothing."""
    from store.tokens import SECRET_FILE, read_secret

    path = settings.data_dir / SECRET_FILE
    if not settings.secret and not settings.database.startswith("sqlite") and not path.exists():
        raise RefusedError(
            f"SLOWDRIFT_SECRET is not set, and {path} does not exist: a key or link made with a new secret would open "
            "nothing. Set SLOWDRIFT_SECRET to the secret of the API processes, or --data-dir to their data folder."
        )
    try:
        return read_secret(settings)
    except (OSError, ValueError) as error:
        raise RefusedError(f"the secret cannot be read: {error}") from None
