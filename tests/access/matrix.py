"""Every route of the app and what each kind of caller is answered. A new route gets its line here.

A line: what it needs, the status when all is well, the address with names from `Rows` for its parameters, and the body.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fastapi.testclient import TestClient

from tests.access.conftest import World, netcdf
from tests.access.rows import Rows, a_bundle, a_deck, a_job, names
from tests.service.running import a_case

CALLERS = (
    "anonymous",
    "stranger",
    "viewer",
    "editor",
    "owner",
    "key: read",
    "key: submit",
    "key: admin",
    "key: viewers",
    "key: expired",
    "revoked link",
)
"""The stranger owns another team. `key: viewers` has scope admin and belongs to the viewer; all others the owner's."""

NOBODY = dict.fromkeys(("anonymous", "key: expired", "revoked link"), 401)
_SUBMIT = {"viewer": 403, "key: read": 403, "key: viewers": 403}
_ADMIN = {"viewer": 403, "editor": 403, "key: read": 403, "key: submit": 403, "key: viewers": 403}
_KEYS = {name: 403 for name in CALLERS if name.startswith("key") and name != "key: expired"}

KINDS: dict[str, dict[str, int]] = {
    "open": {},
    "link": {"revoked link": 404},
    "account": NOBODY,
    "self": NOBODY | _KEYS,
    "manage": NOBODY | {"key: read": 403, "key: submit": 403},
    "read": NOBODY,  # in one's own project
    "read row": NOBODY | {"stranger": 404},
    "edit": NOBODY | _SUBMIT,
    "edit row": NOBODY | _SUBMIT | {"stranger": 404},
    "own row": NOBODY | _ADMIN | {"stranger": 404},
    "admin": NOBODY | _ADMIN | {"stranger": 403},
}
"""Who is answered otherwise than when all is well."""


@dataclass
class Line:
    kind: str
    good: int
    address: str = ""
    """The route's own where it has no parameters."""
    body: Any = None
    sent: Callable[[Rows], dict[str, Any]] | None = None
    """Instead of a JSON body: what the client is given."""
    forgetful: bool = False
    """Asked without the session that the others go on to use: signing out would end it."""
    stream: bool = False
    """An endless answer: only its status is looked at, and a final run ends it."""


SHARED, RUN, TEAM = "/api/v1/shared/{link}", "/api/v1/runs/{run}", "/api/v1/teams/{team}"
DATA, STUDY, HYDRO = "/api/v1/data-sets/{data_set}", "/api/v1/studies/{study}", "/api/v1/hydrodynamics"
CHANNEL = "frequency/vessel/surge"

MATRIX: dict[str, Line] = {
    "GET /healthz": Line("open", 200),
    "GET /readyz": Line("open", 200),
    "GET /metrics": Line("open", 200),  # to this machine or with a token of its own: tests/service
    "GET /api/v1/openapi.json": Line("open", 200),
    # signing in, oneself
    "GET /api/v1/auth": Line("open", 200),
    "GET /api/v1/auth/oidc/start": Line("open", 404),  # with a provider: test_oidc.py
    "GET /api/v1/auth/oidc/callback": Line("open", 404),
    "GET /api/v1/auth/oidc/sign-out": Line("open", 404),
    "POST /api/v1/auth/sign-in": Line("open", 422, body={}),  # with a password: test_sessions.py
    "POST /api/v1/auth/sign-out": Line("open", 204, forgetful=True),
    "GET /api/v1/me": Line("account", 200),
    "PATCH /api/v1/me": Line("self", 200, body={}),
    "PUT /api/v1/me/password": Line("self", 422, body={}),
    "GET /api/v1/keys": Line("self", 200),
    "POST /api/v1/keys": Line("self", 201, sent=names("name")),
    "DELETE /api/v1/keys/{key_id}": Line("self", 404, "/api/v1/keys/none"),
    # people
    "GET /api/v1/users": Line("admin", 200),
    "POST /api/v1/users": Line(
        "admin", 201, sent=lambda r: {"json": {"email": f"{next(r.numbers)}@y.org", "name": "New"}}
    ),
    "PATCH /api/v1/users/{user_id}": Line("admin", 200, "/api/v1/users/{viewer}", {"name": "Viewer"}),
    "POST /api/v1/users/{user_id}/reset": Line("admin", 201, "/api/v1/users/{viewer}/reset"),
    "GET /api/v1/teams": Line("account", 200),
    "POST /api/v1/teams": Line("manage", 201, sent=names("name")),
    "PATCH /api/v1/teams/{team_id}": Line("own row", 204, TEAM, sent=names("name")),
    "DELETE /api/v1/teams/{team_id}": Line("own row", 409, TEAM),  # one that is empty: test_teams.py
    "GET /api/v1/teams/{team_id}/audit": Line("own row", 200, f"{TEAM}/audit"),
    "GET /api/v1/teams/{team_id}/members": Line("read row", 200, f"{TEAM}/members"),
    "PUT /api/v1/teams/{team_id}/members/{user_id}": Line(
        "own row", 204, f"{TEAM}/members/{{editor}}", {"role": "editor"}
    ),
    "DELETE /api/v1/teams/{team_id}/members/{user_id}": Line("own row", 204, f"{TEAM}/members/{{new_member}}"),
    "POST /api/v1/teams/{team_id}/projects": Line("own row", 201, f"{TEAM}/projects", sent=names("name")),
    "GET /api/v1/teams/{team_id}/invitations": Line("own row", 200, f"{TEAM}/invitations"),
    "POST /api/v1/teams/{team_id}/invitations": Line("own row", 201, f"{TEAM}/invitations", {}),
    "DELETE /api/v1/teams/{team_id}/invitations/{invitation_id}": Line(
        "own row", 204, f"{TEAM}/invitations/{{new_invitation_id}}"
    ),
    "GET /api/v1/invitations/{token}": Line("open", 200, "/api/v1/invitations/{invitation}"),
    "POST /api/v1/invitations/{token}/accept": Line("open", 404, "/api/v1/invitations/none/accept"),
    "GET /api/v1/projects": Line("account", 200),
    "PATCH /api/v1/projects/{project_id}": Line("own row", 204, "/api/v1/projects/{project}", sent=names("name")),
    "DELETE /api/v1/projects/{project_id}": Line("own row", 204, "/api/v1/projects/{new_project}"),
    # cases
    "GET /api/v1/schema": Line("account", 200),
    "GET /api/v1/examples": Line("account", 200),
    "GET /api/v1/catalogue": Line("account", 200),
    "GET /api/v1/catalogue/{name}": Line("account", 200, "/api/v1/catalogue/polyester?diameter=0.2"),
    "POST /api/v1/preview": Line("read", 504, body=a_case("nobody answers")),
    "POST /api/v1/cases": Line("edit", 201, sent=lambda r: {"json": a_case(r.name)}),
    "POST /api/v1/cases/check": Line("read", 200, body=a_case("checked")),
    "GET /api/v1/cases": Line("read", 200),
    "GET /api/v1/cases/{case_id}": Line("read row", 200, "/api/v1/cases/{case}"),
    "DELETE /api/v1/cases/{case_id}": Line("edit row", 204, "/api/v1/cases/{new_case}"),
    "GET /api/v1/cases/{case_id}/moordyn": Line("read row", 200, "/api/v1/cases/{deck_case}/moordyn"),
    "POST /api/v1/imports/moordyn": Line("read", 200, sent=a_deck),
    # data sets
    "POST /api/v1/data-sets": Line(
        "edit", 201, sent=lambda r: {"files": {"file": ("a.nc", netcdf(r.folder, next(r.numbers)))}}
    ),
    "GET /api/v1/data-sets": Line("read", 200),
    "GET /api/v1/data-sets/{data_set_id}": Line("read row", 200, DATA),
    "GET /api/v1/data-sets/{data_set_id}/coefficients": Line(
        "read row", 200, f"{DATA}/coefficients?quantity=added_mass&i=0&j=0"
    ),
    "GET /api/v1/data-sets/{data_set_id}/stiffness": Line("read row", 200, f"{DATA}/stiffness"),
    "GET /api/v1/data-sets/{data_set_id}/export": Line("read row", 200, f"{DATA}/export"),
    "DELETE /api/v1/data-sets/{data_set_id}": Line("edit row", 204, "/api/v1/data-sets/{new_data_set}"),
    # hydrodynamics
    "GET /api/v1/hydrodynamics/schema": Line("read", 200),
    "POST /api/v1/hydrodynamics/meshes": Line("edit", 201, sent=lambda r: {"files": r.mesh_file}),
    "GET /api/v1/hydrodynamics/meshes": Line("read", 200),
    "GET /api/v1/hydrodynamics/meshes/{mesh_id}": Line("read row", 200, f"{HYDRO}/meshes/{{mesh}}"),
    "DELETE /api/v1/hydrodynamics/meshes/{mesh_id}": Line("edit row", 204, f"{HYDRO}/meshes/{{new_mesh}}"),
    "POST /api/v1/hydrodynamics/mesh": Line("read", 200, body={"geometry": a_job("")["geometry"]}),
    "POST /api/v1/hydrodynamics": Line("edit", 202, sent=lambda r: {"json": a_job(r.name)}),
    "GET /api/v1/hydrodynamics": Line("read", 200),
    "GET /api/v1/hydrodynamics/{job_id}": Line("read row", 200, f"{HYDRO}/{{job}}"),
    "POST /api/v1/hydrodynamics/{job_id}/cancel": Line("edit row", 202, f"{HYDRO}/{{new_job}}/cancel"),
    "DELETE /api/v1/hydrodynamics/{job_id}": Line("edit row", 204, f"{HYDRO}/{{new_final_job}}"),
    # runs
    "POST /api/v1/runs": Line("edit", 202, sent=lambda r: {"json": {"case": a_case(r.name)}}),
    "GET /api/v1/runs": Line("read", 200),
    "GET /api/v1/events": Line("read", 200, stream=True),
    "GET /api/v1/runs/{run_id}": Line("read row", 200, RUN),
    "GET /api/v1/runs/{run_id}/events": Line("read row", 200, f"{RUN}/events", stream=True),
    "GET /api/v1/runs/{run_id}/case": Line("read row", 200, f"{RUN}/case"),
    "GET /api/v1/runs/{run_id}/summary": Line("read row", 200, f"{RUN}/summary"),
    "GET /api/v1/runs/{run_id}/channels": Line("read row", 200, f"{RUN}/channels"),
    "GET /api/v1/runs/{run_id}/channels/{name:path}": Line("read row", 200, f"{RUN}/channels/{CHANNEL}"),
    "GET /api/v1/runs/{run_id}/export": Line("read row", 200, f"{RUN}/export"),
    "GET /api/v1/runs/{run_id}/bundle": Line("read row", 200, f"{RUN}/bundle"),
    "PATCH /api/v1/runs/{run_id}": Line("edit row", 200, RUN, {"name": "renamed"}),
    "POST /api/v1/runs/{run_id}/cancel": Line("edit row", 202, "/api/v1/runs/{new_run}/cancel"),
    "POST /api/v1/runs/{run_id}/rerun": Line("edit row", 202, f"{RUN}/rerun"),
    "DELETE /api/v1/runs/{run_id}": Line("edit row", 204, "/api/v1/runs/{new_final_run}"),
    "POST /api/v1/imports/run": Line("edit", 201, sent=a_bundle),
    # studies
    "GET /api/v1/queue": Line("read", 200),  # in numbers only
    "GET /api/v1/quota": Line("read", 200),
    "POST /api/v1/studies": Line("edit", 202, sent=lambda r: {"json": r.study_request}),
    "GET /api/v1/studies": Line("read", 200),
    "GET /api/v1/studies/{study_id}": Line("read row", 200, STUDY),
    "GET /api/v1/studies/{study_id}/runs": Line("read row", 200, f"{STUDY}/runs"),
    "GET /api/v1/studies/{study_id}/table": Line("read row", 200, f"{STUDY}/table"),
    "POST /api/v1/studies/{study_id}/cancel": Line("edit row", 202, "/api/v1/studies/{new_study}/cancel"),
    "DELETE /api/v1/studies/{study_id}": Line("edit row", 204, "/api/v1/studies/{new_final_study}"),
    # sharing
    "GET /api/v1/shares": Line("read", 200),
    "POST /api/v1/shares": Line("edit row", 201, "/api/v1/shares", sent=lambda r: {"json": {"run_ids": [r.run]}}),
    "DELETE /api/v1/shares/{share_id}": Line("edit row", 204, "/api/v1/shares/{new_share}"),
    "GET /api/v1/shared/{share_token}": Line("link", 200, SHARED),
    "GET /api/v1/shared/{share_token}/runs/{run_id}": Line("link", 200, f"{SHARED}/runs/{{run}}"),
    "GET /api/v1/shared/{share_token}/runs/{run_id}/events": Line(
        "link", 200, f"{SHARED}/runs/{{run}}/events", stream=True
    ),
    "GET /api/v1/shared/{share_token}/runs/{run_id}/case": Line("link", 200, f"{SHARED}/runs/{{run}}/case"),
    "GET /api/v1/shared/{share_token}/runs/{run_id}/summary": Line("link", 200, f"{SHARED}/runs/{{run}}/summary"),
    "GET /api/v1/shared/{share_token}/runs/{run_id}/channels": Line("link", 200, f"{SHARED}/runs/{{run}}/channels"),
    "GET /api/v1/shared/{share_token}/runs/{run_id}/channels/{name:path}": Line(
        "link", 200, f"{SHARED}/runs/{{run}}/channels/{CHANNEL}"
    ),
    "GET /api/v1/shared/{share_token}/cases/{case_id}": Line("link", 200, f"{SHARED}/cases/{{case}}"),
}


class _Address(dict[str, str]):
    """Parameters of an address, each asked of the rows by its name."""

    def __init__(self, rows: Rows, link: str):
        super().__init__()
        self.rows, self.link = rows, link

    def __missing__(self, name: str) -> str:
        return self.rows[self.link if name == "link" else name]


def caller(world: World, name: str) -> TestClient:
    if name in ("anonymous", "revoked link"):
        return world.client()
    if name.startswith("key: "):
        return world.with_key(name.removeprefix("key: "))
    return world.signed_in(name)


def ask(rows: Rows, route: str, line: Line, name: str) -> tuple[int, str]:
    """The status and the body that this caller gets."""
    method, _, path = route.partition(" ")
    link = "revoked_link" if name == "revoked link" else "link"
    address = (line.address or path).format_map(_Address(rows, link))
    client = rows.world.client() if line.forgetful else caller(rows.world, name)
    if line.stream:
        return rows.world.status_of_stream(client, address)
    sent = line.sent(rows) if line.sent else {} if line.body is None else {"json": line.body}
    answer = client.request(method, address, **sent)
    return answer.status_code, answer.text
