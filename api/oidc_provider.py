"""An OpenID Connect provider as this service sees it: where it is, its keys, and whom it says that somebody is.

The flow is the authorization code with PKCE (RFC 7636), state and nonce; Authlib speaks it. What the provider answers is
believed only when its signature, issuer, audience, time and nonce are right.
"""

from __future__ import annotations

import logging
import threading
import time
from dataclasses import dataclass
from typing import Any, Literal
from urllib.parse import urlsplit

import requests
from authlib.integrations.requests_client import OAuth2Session, OAuthError
from authlib.oidc.core import CodeIDToken
from joserfc import jwt
from joserfc.errors import InvalidKeyIdError, JoseError
from joserfc.jwk import KeySet

from solver.outcome import SlowdriftError
from store.settings import Settings

ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA")
"""Signatures by the provider's own key: never `none`, and never a secret that others share."""
SECONDS = 5.0
"""How long an answer of the provider is waited for."""
KEPT_SECONDS = 3600.0
LEEWAY = 60
"""Seconds by which the provider's clock and ours may differ."""
AUTHENTICATION = ("client_secret_basic", "client_secret_post")
log = logging.getLogger(__name__)

Reason = Literal["expired", "refused", "failed", "unavailable", "email", "unknown", "disabled", "other"]


class OidcError(SlowdriftError):
    """Somebody cannot sign in by the provider; `reason` is what the sign-in page is told."""

    def __init__(self, reason: Reason, message: str):
        self.reason: Reason = reason
        super().__init__(message)


@dataclass(frozen=True)
class Person:
    """Whom the provider vouches for."""

    issuer: str
    subject: str
    email: str
    email_verified: bool
    name: str


class Provider:
    """Finds the provider's addresses and keys when they are first needed, and keeps them for an hour."""

    def __init__(self, settings: Settings):
        self._settings = settings
        self._lock = threading.Lock()
        self._metadata: dict[str, Any] = {}
        self._keys: KeySet | None = None
        self._found_at = -KEPT_SECONDS

    @property
    def redirect_uri(self) -> str:
        """Where the provider sends people back; it has to be registered there."""
        return f"{self._settings.public_url.rstrip('/')}/api/v1/auth/oidc/callback"

    def authorization_url(self, state: str, nonce: str, verifier: str) -> str:
        """Where the browser goes to sign in. Raises OidcError."""
        endpoint = self._endpoint("authorization_endpoint")
        with self._session() as session:
            url, _ = session.create_authorization_url(endpoint, state=state, nonce=nonce, code_verifier=verifier)
        return str(url)

    def sign_out_url(self, after: str) -> str | None:
        """Where the browser ends its session at the provider; None where the provider has no such place."""
        if not self._found().get("end_session_endpoint"):
            return None
        asked = {"client_id": self._settings.oidc_client_id, "post_logout_redirect_uri": after}
        prepared = requests.Request("GET", self._endpoint("end_session_endpoint"), params=asked).prepare()
        return prepared.url

    def person(self, code: str, issuer: str | None, nonce: str, verifier: str) -> Person:
        """Exchanges the code, and checks what comes for it. `issuer`: what the callback names. Raises OidcError."""
        self._check_issuer(issuer)
        try:
            with self._session() as session:
                token = session.fetch_token(
                    self._endpoint("token_endpoint"), code=code, code_verifier=verifier, timeout=SECONDS
                )
                claims = self._claims(token, nonce)
                if "email" not in claims and self._found().get("userinfo_endpoint"):
                    claims |= self._userinfo(session, claims["sub"])
        except (OAuthError, JoseError, ValueError) as error:
            raise OidcError("failed", f"The provider's answer is not good: {type(error).__name__}: {error}") from None
        except requests.RequestException as error:
            raise OidcError("unavailable", f"The provider cannot be reached: {error}") from None
        return Person(
            self._settings.oidc_issuer,
            str(claims["sub"])[:256],
            str(claims.get("email") or "").strip().lower(),
            claims.get("email_verified") is True or claims.get("email_verified") == "true",
            str(claims.get("name") or ""),
        )

    def _session(self) -> OAuth2Session:
        secret = self._settings.oidc_client_secret
        offered = self._found().get("token_endpoint_auth_methods_supported", AUTHENTICATION[:1])
        method = next((one for one in AUTHENTICATION if one in offered), AUTHENTICATION[0]) if secret else "none"
        return OAuth2Session(
            self._settings.oidc_client_id,
            secret or None,
            token_endpoint_auth_method=method,
            scope=self._settings.oidc_scopes,
            redirect_uri=self.redirect_uri,
            code_challenge_method="S256",
        )

    def _claims(self, token: dict[str, Any], nonce: str) -> dict[str, Any]:
        """Of the ID token. Raises JoseError, ValueError."""
        given = token.get("id_token")
        if not isinstance(given, str):
            raise ValueError("it holds no ID token")
        try:
            decoded = jwt.decode(given, self._key_set(), algorithms=ALGORITHMS)
        except InvalidKeyIdError:  # signed with a key that is newer than what we have
            decoded = jwt.decode(given, self._key_set(fresh=True), algorithms=ALGORITHMS)
        options = {"iss": {"values": [self._settings.oidc_issuer]}, "aud": {"value": self._settings.oidc_client_id}}
        params = {"nonce": nonce, "client_id": self._settings.oidc_client_id, "access_token": token.get("access_token")}
        claims = CodeIDToken(decoded.claims, decoded.header, options, params)
        claims.validate(leeway=LEEWAY)
        return dict(claims)

    def _userinfo(self, session: OAuth2Session, subject: str) -> dict[str, Any]:
        answer = session.get(self._endpoint("userinfo_endpoint"), timeout=SECONDS)
        answer.raise_for_status()
        found = answer.json()
        if not isinstance(found, dict) or found.get("sub") != subject:
            raise ValueError("userinfo tells of somebody else")
        return {name: found.get(name) for name in ("email", "email_verified", "name")}

    def _check_issuer(self, issuer: str | None) -> None:
        """RFC 9207: the answer may name its issuer, and must where the provider says that it does."""
        told = bool(self._found().get("authorization_response_iss_parameter_supported"))
        if issuer != self._settings.oidc_issuer and (told or issuer is not None):
            raise OidcError("failed", f"The answer comes from the issuer {issuer!r}.")

    def _endpoint(self, name: str) -> str:
        address = self._found().get(name)
        secure = urlsplit(self._settings.oidc_issuer).scheme
        if not isinstance(address, str) or urlsplit(address).scheme not in ("https", secure):
            raise OidcError("unavailable", f"The provider names no {name} over https.")
        return address

    def _found(self) -> dict[str, Any]:
        with self._lock:
            if time.monotonic() - self._found_at > KEPT_SECONDS:
                found = _get(self._settings.oidc_issuer.rstrip("/") + "/.well-known/openid-configuration")
                if found.get("issuer") != self._settings.oidc_issuer:
                    raise OidcError("unavailable", f"The provider says that it is {found.get('issuer')!r}.")
                self._metadata, self._keys, self._found_at = found, None, time.monotonic()
            return self._metadata

    def _key_set(self, fresh: bool = False) -> KeySet:
        address = self._endpoint("jwks_uri")
        with self._lock:
            if self._keys is None or fresh:
                self._keys = KeySet.import_key_set(_get(address))  # type: ignore[arg-type]
            return self._keys


def _get(address: str) -> dict[str, Any]:
    """A JSON object from the provider. Raises OidcError."""
    try:
        answer = requests.get(address, timeout=SECONDS)
        answer.raise_for_status()
        found = answer.json()
    except (requests.RequestException, ValueError) as error:
        raise OidcError("unavailable", f"The provider does not answer at {address}: {error}") from None
    if not isinstance(found, dict):
        raise OidcError("unavailable", f"The provider answers something else at {address}.")
    return found
