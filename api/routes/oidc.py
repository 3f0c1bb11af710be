"""Signing in by an OpenID Connect provider: addresses that a browser visits, so they answer by sending it on."""

from __future__ import annotations

import logging
from typing import Annotated
from urllib.parse import urlencode

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import RedirectResponse

from store.errors import ConflictError, NotFoundError, TooManyError

from ..access import needs
from ..context import Context, ContextDep
from ..guard import cookie_value
from ..oidc_provider import OidcError, Provider
from ..services import oidc as service
from .auth import AttemptsDep, browser_of, give_session, is_secure
from .common import problems

router = APIRouter(tags=["accounts"], prefix="/auth/oidc")
log = logging.getLogger(__name__)
Text = Annotated[str, Query(max_length=4000)]


async def get_provider(request: Request) -> Provider:
    """Raises NotFoundError where the settings name no provider."""
    found: Provider | None = request.app.state.oidc
    if found is None:
        raise NotFoundError("OpenID Connect provider", "")
    return found


ProviderDep = Annotated[Provider, Depends(get_provider)]


@router.get("/start", status_code=303, response_class=RedirectResponse, responses=problems(404, 429))
@needs("open")
def start(context: ContextDep, provider: ProviderDep, request: Request, next: Text = service.HOME) -> RedirectResponse:
    """Sends the browser to the provider. `next`: the page to go on to afterwards."""
    journey = service.Journey.begin(next, context.secret)
    try:
        answer = RedirectResponse(provider.authorization_url(journey.state, journey.nonce, journey.verifier), 303)
    except OidcError as error:
        return _refused(context, error.reason, str(error))
    secure = is_secure(context, request)
    name = service.SECURE_BEGUN if secure else service.BEGUN
    answer.set_cookie(
        name, journey.cookie, max_age=service.SECONDS, path="/", secure=secure, httponly=True, samesite="lax"
    )
    return answer


@router.get("/callback", status_code=303, response_class=RedirectResponse, responses=problems(404, 429))
@needs("open")
def callback(
    context: ContextDep, provider: ProviderDep, attempts: AttemptsDep, request: Request, state: Text = "",
    code: Text = "", iss: Text | None = None, error: Text = "",
) -> RedirectResponse:  # fmt: skip
    """Where the provider sends the browser back: begins a session, or goes to the sign-in page with the reason."""
    browser = browser_of(request)
    cookie = cookie_value(browser.cookies, service.SECURE_BEGUN, service.BEGUN)
    given = service.Answer(state, code, iss, error)
    try:
        token, user, page = service.finish(context, provider, attempts, cookie, given, browser)
    except OidcError as refused:
        return _forget(context, request, _refused(context, refused.reason, str(refused)))
    except ConflictError as refused:
        return _forget(context, request, _refused(context, "failed", str(refused)))
    except TooManyError as refused:
        return _refused(context, "many", str(refused))
    answer = RedirectResponse(_address(context, page), 303)
    give_session(context, request, answer, token, user.id)
    return _forget(context, request, answer)


@router.get("/sign-out", status_code=303, response_class=RedirectResponse, responses=problems(404))
@needs("open")
def sign_out(context: ContextDep, provider: ProviderDep) -> RedirectResponse:
    """Sends the browser to where it ends its session at the provider, and from there to the sign-in page."""
    after = _address(context, service.SIGN_IN)
    try:
        return RedirectResponse(provider.sign_out_url(after) or after, 303)
    except OidcError as error:
        log.warning("The session at the provider goes on: %s", error)
        return RedirectResponse(after, 303)


def _address(context: Context, page: str) -> str:
    return context.settings.public_url.rstrip("/") + page


def _refused(context: Context, reason: str, why: str) -> RedirectResponse:
    log.warning("A sign-in by OpenID Connect was refused: %s", why[:500])
    return RedirectResponse(_address(context, f"{service.SIGN_IN}?{urlencode({'oidc': reason})}"), 303)


def _forget(context: Context, request: Request, answer: RedirectResponse) -> RedirectResponse:
    """The sign-in that was under way is over: it works once."""
    secure = is_secure(context, request)
    answer.delete_cookie(service.SECURE_BEGUN if secure else service.BEGUN, path="/", secure=secure, httponly=True)
    return answer
