"""Signing in by an OpenID Connect provider: the way there and back, and to which account a person belongs."""

from __future__ import annotations

import base64
import hmac
import logging
import secrets
import time
from dataclasses import dataclass

from store.people import Identity, User
from store.repositories.accounts import AccountRepository
from store.repositories.identities import IdentityRepository
from store.repositories.teams import TeamRepository
from store.tokens import digest

from ..attempts import Attempts
from ..context import Context, Unit, acting
from ..oidc_provider import OidcError, Person, Provider
from .accounts import Browser, note, open_session

BEGUN, SECURE_BEGUN = "slowdrift-oidc", "__Host-slowdrift-oidc"
"""The cookie of a sign-in that is under way, over http and https."""
SECONDS = 600
"""How long one may take at the provider."""
HOME = "/app/"
SIGN_IN = "/app/sign-in"
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Journey:
    """A sign-in that a browser has begun. Its cookie holds a random number; what must not be guessed is made from it with
    the service's secret, so that nothing is kept here."""

    body: str
    """`number.time.next`, the last in base64."""
    secret: bytes

    @classmethod
    def begin(cls, next_page: str, secret: bytes) -> Journey:
        page = base64.urlsafe_b64encode(inner(next_page).encode()).decode()
        return cls(f"{secrets.token_urlsafe(32)}.{int(time.time())}.{page}", secret)

    @classmethod
    def of(cls, cookie: str, secret: bytes) -> Journey:
        """Raises OidcError: none was begun in this browser, or too long ago."""
        body, _, signature = cookie.rpartition(".")
        found = cls(body, secret)
        if not body or not hmac.compare_digest(found._made("cookie").encode(), signature.encode()):
            raise OidcError("expired", "No sign-in was begun in this browser.")
        if time.time() - int(body.split(".")[1]) > SECONDS:
            raise OidcError("expired", f"The sign-in was begun more than {SECONDS} s ago.")
        return found

    @property
    def cookie(self) -> str:
        return f"{self.body}.{self._made('cookie')}"

    @property
    def state(self) -> str:
        return self._made("state")

    @property
    def nonce(self) -> str:
        return self._made("nonce")

    @property
    def verifier(self) -> str:
        return self._made("verifier")

    @property
    def next_page(self) -> str:
        return inner(base64.urlsafe_b64decode(self.body.split(".")[2]).decode())

    def _made(self, what: str) -> str:
        return digest(f"slowdrift oidc {what} {self.body}", self.secret)


def inner(page: str) -> str:
    """Only addresses of our own pages: a link from elsewhere must not lead on to a stranger."""
    good = page.startswith(HOME) and page.isascii() and page.isprintable() and "\\" not in page and len(page) <= 1000
    return page if good else HOME


@dataclass(frozen=True)
class Answer:
    """What the provider sends the browser back with."""

    state: str = ""
    code: str = ""
    issuer: str | None = None
    error: str = ""


def finish(
    context: Context, provider: Provider, attempts: Attempts, cookie: str, answer: Answer, browser: Browser
) -> tuple[str, User, str]:
    """A new session's token, whose it is, and the page to go on to. Raises OidcError, TooManyError."""
    attempts.begin_from(browser.address)
    journey = Journey.of(cookie, context.secret)
    if not hmac.compare_digest(journey.state.encode(), answer.state.encode()):
        raise OidcError("expired", "The answer does not belong to the sign-in that this browser has begun.")
    if answer.error or not answer.code:
        raise OidcError("refused", f"The provider refused: {answer.error[:100]!r}.")
    act = acting.get()
    if act is not None:
        act.silent = False  # a GET, and yet what it changes belongs into the audit log
    person = provider.person(answer.code, answer.issuer, journey.nonce, journey.verifier)
    with context.change() as unit:
        user = _account_of(context, unit, person)
        if user.disabled_at is not None:
            raise OidcError("disabled", f"The account {user.email!r} is disabled.")
        note(user)
        unit.tell(issuer=person.issuer, email=user.email)
        return open_session(context, unit, user.id, browser, by_provider=True), user, journey.next_page


def _account_of(context: Context, unit: Unit, person: Person) -> User:
    """Whoever signed in with this subject before; else the account, the invitation, or the domain of the address."""
    identities, accounts = IdentityRepository(unit.session), AccountRepository(unit.session)
    known = identities.user_of(person.issuer, person.subject)
    if known is not None:
        return known
    if not person.email or not person.email_verified:
        raise OidcError("email", f"The provider does not vouch for the e-mail address {person.email!r}.")
    if len(person.subject) > 255:
        raise OidcError("failed", "The provider's subject has more than 255 characters.")
    user = accounts.by_email(person.email) or _newcomer(context, unit, person)
    if identities.has(person.issuer, user.id):
        raise OidcError("other", f"The account {user.email!r} belongs to another person at the provider.")
    identities.add(Identity(issuer=person.issuer, subject=person.subject, user_id=user.id))
    unit.tell(linked=person.subject)
    return user


def _newcomer(context: Context, unit: Unit, person: Person) -> User:
    """A new account, where an invitation names the address or a setting its domain."""
    accounts, teams = AccountRepository(unit.session), TeamRepository(unit.session)
    invitations = teams.invitations_to(person.email)
    domains = [one.strip().lower() for one in context.settings.oidc_domains.split(",") if one.strip()]
    valid = person.email.isprintable() and " " not in person.email and len(person.email) <= 254
    if not valid or not (invitations or person.email.rpartition("@")[2] in domains):
        raise OidcError("unknown", f"There is no account and no invitation for {person.email!r}.")
    user = accounts.add(person.email, _name(person), None, False)
    for invitation in invitations:
        if invitation.team_id is not None:
            teams.join(invitation.team_id, user.id, invitation.role)
        teams.use(invitation, user.id)
    return user


def _name(person: Person) -> str:
    name = "".join(each for each in person.name if each.isprintable()).strip()[:100]
    return name or person.email.partition("@")[0][:100]
