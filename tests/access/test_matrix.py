"""The access matrix, over every route that the app has."""

from __future__ import annotations

import pytest
from fastapi.routing import iter_route_contexts

from tests.access.conftest import World
from tests.access.matrix import CALLERS, KINDS, MATRIX, ask
from tests.access.rows import Rows


@pytest.fixture(scope="module")
def rows(world: World, tmp_path_factory: pytest.TempPathFactory) -> Rows:
    return Rows(world, tmp_path_factory.mktemp("rows"))


def routes_of(world: World) -> set[str]:
    found = set()
    for context in iter_route_contexts(world.app.routes):
        found |= {f"{method} {context.path}" for method in context.methods or () if method != "HEAD"}
    return found


def test_every_route_has_its_line(world: World) -> None:
    assert routes_of(world) == set(MATRIX)


@pytest.mark.parametrize("route", MATRIX)
def test_everybody_gets_the_right_answer(rows: Rows, route: str) -> None:
    line = MATRIX[route]
    expected = {name: KINDS[line.kind].get(name, line.good) for name in CALLERS}
    answers = {name: ask(rows, route, line, name) for name in CALLERS}
    assert {name: status for name, (status, _) in answers.items()} == expected, answers


def test_what_is_not_there_and_what_is_not_mine_look_alike(rows: Rows) -> None:
    """Their ids apart, and the body tells no more."""
    stranger = rows.world.signed_in("stranger")
    for path in ("runs", "cases", "data-sets", "studies"):
        theirs = rows[path.removesuffix("s").replace("-", "_").replace("studie", "study")]
        for key in (theirs, "0" * 32):
            answer = stranger.get(f"/api/v1/{path}/{key}")
            assert answer.status_code == 404
            assert answer.text.replace(key, "KEY") == stranger.get(f"/api/v1/{path}/{'1' * 32}").text.replace(
                "1" * 32, "KEY"
            )


def test_lists_hold_ones_own_only(rows: Rows) -> None:
    rows.run, rows.case, rows.data_set, rows.study, rows.mesh, rows.job, rows.new_share  # noqa: B018  (made by asking)
    lists = ("runs", "cases", "data-sets", "studies", "hydrodynamics", "hydrodynamics/meshes", "shares")
    here, there = rows.world.signed_in("viewer"), rows.world.signed_in("stranger")
    for path in lists:
        ours = {item["id"] for item in here.get(f"/api/v1/{path}").json()["items"]}
        theirs = {item["id"] for item in there.get(f"/api/v1/{path}").json()["items"]}
        assert ours, path
        assert not ours & theirs, path
    by_project = there.get("/api/v1/runs", params={"project": rows["project"]})
    assert by_project.status_code == 404
    assert there.get("/api/v1/runs", headers={"slowdrift-project": rows["project"]}).status_code == 404
