"""schemathesis: requests made from the OpenAPI description, valid and not, of somebody who may do everything.

No answer is a 500, and every refusal is a problem of ours. SLOWDRIFT_FUZZ_EXAMPLES asks for a longer run.
"""

from __future__ import annotations

import os
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from schemathesis.checks import not_a_server_error

from api.attempts import Attempts
from tests.access.conftest import World
from tests.access.matrix import MATRIX
from tests.access.rows import Rows

EXAMPLES = int(os.environ.get("SLOWDRIFT_FUZZ_EXAMPLES", "4"))


ENDLESS = ("GET /api/v1/events", "GET /api/v1/runs/{run_id}/events")
ENDS_OUR_ACCESS = ("PATCH /api/v1/users/{user_id}", "DELETE /api/v1/teams/{team_id}/members/{user_id}")
ROUTES = sorted(
    route.replace(":path}", "}")
    for route in MATRIX
    if "/api/" in route and "/shared/" not in route and route not in (*ENDLESS, *ENDS_OUR_ACCESS)
    if route != "GET /api/v1/openapi.json"
)


REAL = {
    "run_id": "run", "case_id": "deck_case", "data_set_id": "data_set", "study_id": "study", "mesh_id": "mesh",
    "job_id": "job", "team_id": "team", "project_id": "project",
}  # fmt: skip
"""Parameters for which a row is put in: past a 404 lies more."""


@schemathesis.serializer("application/zip")
def as_it_is(_: Any, value: Any) -> bytes:
    return value if isinstance(value, bytes) else str(value).encode(errors="replace")


@pytest.fixture(scope="module")
def description(world: World) -> Any:
    found = schemathesis.openapi.from_dict(world.app.openapi())
    found.app = world.app
    return found


@pytest.fixture(scope="module")
def rows(world: World, tmp_path_factory: pytest.TempPathFactory) -> Rows:
    made = Rows(world, tmp_path_factory.mktemp("rows"))
    made.run  # noqa: B018  (now: a run is finished by doing whatever stands in the queue)
    return made


@pytest.mark.slow  # a minute altogether
@pytest.mark.parametrize("route", ROUTES)
def test_no_request_is_a_500(world: World, rows: Rows, description: Any, route: str) -> None:
    method, _, path = route.partition(" ")
    headers = {"host": "localhost", "authorization": f"Bearer {world.keys['admin']}"}
    if path.startswith(("/api/v1/keys", "/api/v1/me")):  # no key may: the session, then
        cookies = "; ".join(f"{name}={value}" for name, value in world.signed_in("owner").cookies.items())
        headers = {"host": "localhost", "origin": "http://localhost", "cookie": cookies}
    world.app.state.attempts = Attempts(world.settings)

    there = {
        name: rows[row] for name, row in REAL.items() if f"{{{name}}}" in path and method in ("GET", "PATCH", "PUT")
    }

    @given(case=description[path][method].as_strategy())
    @settings(
        max_examples=EXAMPLES,
        deadline=None,
        derandomize=EXAMPLES < 10,
        database=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.explicit, Phase.generate],
    )
    def asked(case: Any) -> None:
        case.path_parameters.update(there)
        answer = case.call(headers=headers)
        case.validate_response(answer, checks=[not_a_server_error])
        if answer.status_code >= 400:
            assert answer.headers["content-type"][0].startswith("application/problem+json"), answer.text

    asked()
