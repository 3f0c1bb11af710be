"""Who may do what, decided in one place; a route that says nothing is closed to strangers and readers alike.

How to use it in a route under /api/v1: take `scope: ScopeDep` (api/context.py) and pass it to every repository. GET
then needs a viewer of the project, anything else an editor (with a key: scope `submit`). For another need write
`@needs("read")` between the router's decorator and the function: "read", "edit", "own" (the team's owner), "admin", …
are listed in `NEEDS`. Then give the route its row in tests/access/matrix.py: a route without one fails the test.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeVar

from fastapi import Depends, Request
from starlette.concurrency import run_in_threadpool

from store.errors import ForbiddenError, NotFoundError, SignInError
from store.models import Project
from store.people import ADMIN, EDITOR, KEY_SCOPES, OWNER, READ, ROLES, SUBMIT, VIEWER, Share, User
from store.repositories.entry import PLACES, EntryRepository, Home, stale
from store.scope import Scope
from store.tokens import SHARE, digest, is_token

from .context import Context, acting, context_of

SAFE = ("GET", "HEAD", "OPTIONS")
SHARE_TOKEN = "share_token"
"""The parameter of addresses behind a share link."""
Need = Literal["open", "link", "account", "self", "manage", "read", "edit", "own", "admin"]
Endpoint = TypeVar("Endpoint", bound=Callable[..., Any])


@dataclass(frozen=True)
class Demand:
    """`role` in the team, and what a key must be good for; `key` None: no key will do, only somebody signed in."""

    role: str | None = None
    key: str | None = READ
    administrator: bool = False


NEEDS: dict[str, Demand | None] = {
    "open": None,  # anybody
    "link": None,  # whoever has the share link whose token is in the address
    "account": Demand(),
    "self": Demand(key=None),  # one's own keys and password
    "manage": Demand(key=ADMIN),
    "read": Demand(VIEWER),
    "edit": Demand(EDITOR, SUBMIT),
    "own": Demand(OWNER, ADMIN),
    "admin": Demand(key=ADMIN, administrator=True),
}


@dataclass(frozen=True)
class Principal:
    """Who asks: the one person of a service without accounts, somebody signed in, or a key acting for its user."""

    kind: Literal["local", "session", "key"]
    actor: str
    user: User | None = None
    credential_id: str | None = None
    key_scope: str | None = None
    home: str | None = None
    """The project to work in where the request names none."""
    homes: tuple[Home, ...] = ()
    by_provider: bool = False
    """Signed in by an OpenID Connect provider."""

    @property
    def is_admin(self) -> bool:
        return self.kind == "local" or (self.user is not None and self.user.is_admin)

    def role_in(self, team_id: str) -> str | None:
        return next((home.role for home in self.homes if home.team_id == team_id), None)


def needs(need: Need) -> Callable[[Endpoint], Endpoint]:
    """Says what a route needs, where the rule for its method is not the right one."""

    def mark(endpoint: Endpoint) -> Endpoint:
        endpoint.needs = need  # type: ignore[attr-defined]
        return endpoint

    return mark


def need_of(endpoint: Any, method: str, parameters: Container[str]) -> Need:
    """What a route needs; one with a share link's token in its address needs that link and nothing else."""
    if SHARE_TOKEN in parameters:
        return "link"
    found: Need = getattr(endpoint, "needs", "read" if method in SAFE else "edit")
    return found


async def admit(request: Request) -> None:
    """Lets the request in, or raises SignInError, ForbiddenError or NotFoundError; notes whose rows it may touch.

    A dependency of every route under /api/v1 (api/main.py); `ScopeDep` gives what it noted.
    """
    need = need_of(request.scope.get("endpoint"), request.method, request.path_params)
    asks = _asks_the_database(request, need)
    scope, changes = await run_in_threadpool(_decide, request, need) if asks else _decide(request, need)
    act = acting.get()
    if act is not None:
        act.team_id, act.project_id = scope.team_id, scope.project_id
        act.action = f"{request.method} {_template(request)}"
        act.subject = {name: str(value)[:100] for name, value in request.path_params.items() if "token" not in name}
        act.silent = not changes
    request.scope.setdefault("state", {})["admitted"] = scope


def _template(request: Request) -> str:
    """The address with the names of its parameters for their values: they may be secret, and stand in `subject`."""
    path: str = request.scope["path"]
    for name, value in request.path_params.items():
        path = path.replace(f"/{value}", f"/{{{name}}}")
    return path


def _asks_the_database(request: Request, need: Need) -> bool:
    """Whether deciding takes a look-up, which then must not hold up the others."""
    principal = get_principal(request)
    if need == "link" or principal is None:
        return need == "link"
    if principal.kind == "local":
        return bool(_named_project(request)) or "team_id" in request.path_params
    return len(principal.homes) > 1 and any(name in PLACES for name in request.path_params)


def _decide(request: Request, need: Need) -> tuple[Scope, bool]:
    context, principal = context_of(request), get_principal(request)
    changes = request.method not in SAFE and need != "read"
    if need == "link":
        return _shared(context, str(request.path_params[SHARE_TOKEN])), False
    demand = NEEDS[need]
    if demand is None:
        return Scope(user_id=principal.user.id if principal and principal.user else None), changes
    if principal is None:
        raise SignInError("Sign in, or send a key as `Authorization: Bearer …`.")
    _check_key(principal, demand)
    if demand.administrator and not principal.is_admin:
        raise ForbiddenError("Only administrators of this installation may do this.")
    home = _place(context, principal, request)
    if demand.role is not None:
        _check_role(home, demand.role)
    user_id = principal.user.id if principal.user else None
    return (Scope(user_id=user_id) if home is None else Scope(home.team_id, home.project_id, user_id)), changes


def _check_key(principal: Principal, demand: Demand) -> None:
    if principal.kind != "key":
        return
    if demand.key is None:
        raise ForbiddenError("No key may do this: sign in.")
    if KEY_SCOPES.index(principal.key_scope or READ) < KEY_SCOPES.index(demand.key):
        raise ForbiddenError(f"The key's scope is {principal.key_scope}; this needs {demand.key}.")


def _check_role(home: Home | None, role: str) -> None:
    if home is None:
        raise ForbiddenError("You belong to no team yet; ask an owner of one for an invitation.")
    if ROLES.index(home.role) < ROLES.index(role):
        raise ForbiddenError(f"You are {home.role} of the team {home.team_name!r}; this needs {role}.")


def _place(context: Context, principal: Principal, request: Request) -> Home | None:
    """The project that the request is about: named by it, or by a row in its address, or where one works at present.

    Raises NotFoundError for a team or project that is not the caller's.
    """
    given, asked = request.path_params, _named_project(request)
    if principal.kind == "local" and not asked and "team_id" not in given:
        return Home(Scope().team_id, "default", Scope().project_id, "default", OWNER)
    homes = principal.homes
    if principal.kind == "local":
        with context.database.read() as session:
            homes = tuple(EntryRepository(session).all_homes())
    if "team_id" in given:
        return _first(homes, "team", given["team_id"], "team_id")
    if asked:
        return _first(homes, "project", asked, "project_id")
    home = next((home for home in principal.homes if home.project_id == principal.home), None)
    home = home or next(iter(principal.homes), None)
    row = next((name for name in given if name in PLACES), None)
    if row is None or len(principal.homes) < 2:
        return home
    with context.database.read() as session:
        there = EntryRepository(session).project_of(row, given[row], [each.project_id for each in principal.homes])
    return next((each for each in principal.homes if each.project_id == there), home)


def _named_project(request: Request) -> str | None:
    named = request.path_params.get("project_id") or request.query_params.get("project")
    return named or request.headers.get("slowdrift-project")


def _first(homes: Iterable[Home], what: str, key: str, attribute: str) -> Home:
    for home in homes:
        if getattr(home, attribute) == key:
            return home
    raise NotFoundError(what, key)


def _shared(context: Context, token: str) -> Scope:
    """What a share link opens. NotFoundError when there is no such link, or no longer."""
    share: Share | None = None
    if is_token(token, SHARE):
        with context.database.read() as session:
            share = EntryRepository(session).share(digest(token, context.secret))
            team_id = session.get_one(Project, share.project_id).team_id if share else ""
    if share is None:
        raise NotFoundError("share link", "")
    if stale(share):
        with context.database.write() as session:
            EntryRepository(session).touch(share)
    return Scope(team_id, share.project_id, None, tuple(share.run_ids))


def get_principal(request: Request) -> Principal | None:
    """Who asks; None for a stranger. The doorkeeper (api/doorkeeper.py) has put it there."""
    found: Principal | None = request.scope.get("state", {}).get("principal")
    return found


async def get_person(request: Request) -> Principal:
    principal = get_principal(request)
    if principal is None:
        raise SignInError("Sign in first.")
    return principal


PrincipalDep = Annotated[Principal, Depends(get_person)]
