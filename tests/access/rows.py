"""Rows of team `default` for the access matrix, made when an address or a body asks for them."""

from __future__ import annotations

import io
import itertools
import json
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from tests.access.conftest import PASSWORD, World, netcdf, with_data
from tests.service.running import a_case


@dataclass
class Rows:
    """Rows of team `default`, made when an address asks for them; `new_…` anew each time."""

    world: World
    folder: Path
    numbers: itertools.count[int] = field(default_factory=itertools.count)

    def __getitem__(self, name: str) -> str:
        return str(getattr(self, name)) if hasattr(type(self), name) else self.world.ids[name]

    def post(self, path: str, **sent: Any) -> dict[str, Any]:
        answer = self.world.signed_in("owner").post(f"/api/v1{path}", **sent)
        assert answer.status_code in (200, 201, 202), f"{path}: {answer.text}"
        return dict(answer.json())

    @property
    def name(self) -> str:
        return f"name {next(self.numbers)}"

    @cached_property
    def run(self) -> str:
        return str(self.world.run("shown", who="owner")["id"])

    @cached_property
    def case(self) -> str:
        return str(self.world.signed_in("owner").get(f"/api/v1/runs/{self.run}").json()["case_id"])

    @cached_property
    def deck_case(self) -> str:
        text = (Path(__file__).resolve().parents[2] / "examples" / "hanging-riser-case1.yaml").read_text()
        return str(self.post("/cases", content=text, headers={"content-type": "application/yaml"})["id"])

    @property
    def new_run(self) -> str:
        """Queued."""
        return str(self.post("/runs", json={"case": a_case(self.name)})["id"])

    @property
    def new_final_run(self) -> str:
        key = self.new_run
        self.post(f"/runs/{key}/cancel")
        return key

    @property
    def new_case(self) -> str:
        return str(self.post("/cases", json=a_case(self.name))["id"])

    @cached_property
    def data_set(self) -> str:
        with_data(self.world)
        return str(self.world.signed_in("owner").get("/api/v1/data-sets").json()["items"][0]["id"])

    @property
    def new_data_set(self) -> str:
        file = netcdf(self.folder, seed=1000 + next(self.numbers))
        return str(self.post("/data-sets", files={"file": ("a.nc", file)})["id"])

    @property
    def study_request(self) -> dict[str, Any]:
        case = a_case(self.name)
        return {"case": case, "name": "study", "overrides": [{"/environment/depth": 110}]}

    @cached_property
    def study(self) -> str:
        return str(self.post("/studies", json=self.study_request)["id"])

    @property
    def new_study(self) -> str:
        return str(self.post("/studies", json=self.study_request)["id"])

    @property
    def new_final_study(self) -> str:
        key = self.new_study
        self.post(f"/studies/{key}/cancel")
        return key

    @property
    def mesh_file(self) -> dict[str, Any]:
        return {"file": (f"{self.name}.gdf", a_box(next(self.numbers)))}

    @cached_property
    def mesh(self) -> str:
        return self.new_mesh

    @property
    def new_mesh(self) -> str:
        return str(self.post("/hydrodynamics/meshes", files=self.mesh_file)["id"])

    @cached_property
    def job(self) -> str:
        return self.new_job

    @property
    def new_job(self) -> str:
        return str(self.post("/hydrodynamics", json=a_job(self.name))["id"])

    @property
    def new_final_job(self) -> str:
        key = self.new_job
        self.post(f"/hydrodynamics/{key}/cancel")
        return key

    @cached_property
    def link(self) -> str:
        return str(self.post("/shares", json={"run_ids": [self.run]})["token"])

    @cached_property
    def revoked_link(self) -> str:
        made = self.post("/shares", json={"run_ids": [self.run]})
        assert self.world.signed_in("owner").delete(f"/api/v1/shares/{made['id']}").status_code == 204
        return str(made["token"])

    @property
    def new_share(self) -> str:
        return str(self.post("/shares", json={"run_ids": [self.run]})["id"])

    @cached_property
    def invitation(self) -> str:
        return str(self.post(f"/teams/{self['team']}/invitations", json={})["token"])

    @property
    def new_invitation(self) -> str:
        return str(self.post(f"/teams/{self['team']}/invitations", json={})["token"])

    @property
    def new_invitation_id(self) -> str:
        return str(self.post(f"/teams/{self['team']}/invitations", json={})["id"])

    @property
    def new_team(self) -> str:
        """The owner's, and nobody else's."""
        return str(self.post("/teams", json={"name": self.name})["id"])

    @property
    def new_project(self) -> str:
        return str(self.post(f"/teams/{self['team']}/projects", json={"name": self.name})["project_id"])

    @property
    def new_member(self) -> str:
        """Somebody who has joined team `default`."""
        token, guest = self.new_invitation, self.world.client()
        given = {"email": f"{next(self.numbers)}@x.org", "name": "New", "password": PASSWORD}
        answer = guest.post(f"/api/v1/invitations/{token}/accept", json=given)
        assert answer.status_code == 200, answer.text
        return str(answer.json()["user"]["id"])


def a_box(number: int) -> bytes:
    """A floating box as a GDF, a little longer each time."""
    half, breadth, draft = 20.0 + 0.01 * number, 10.0, 8.0
    x, y, z = (-half, half), (-breadth, breadth), (-draft, 0.0)
    sides = [
        [(x[0], y[0], z[0]), (x[0], y[1], z[0]), (x[1], y[1], z[0]), (x[1], y[0], z[0])],
        [(x[0], y[0], z[1]), (x[0], y[0], z[0]), (x[1], y[0], z[0]), (x[1], y[0], z[1])],
        [(x[1], y[1], z[1]), (x[1], y[1], z[0]), (x[0], y[1], z[0]), (x[0], y[1], z[1])],
        [(x[1], y[0], z[1]), (x[1], y[0], z[0]), (x[1], y[1], z[0]), (x[1], y[1], z[1])],
        [(x[0], y[1], z[1]), (x[0], y[1], z[0]), (x[0], y[0], z[0]), (x[0], y[0], z[1])],
    ]
    points = "\n".join(" ".join(str(value) for value in point) for side in sides for point in side)
    return f"a box\n1.0 9.81\n0 0\n{len(sides)}\n{points}\n".encode()


def a_job(name: str) -> dict[str, Any]:
    return {
        "name": name,
        "geometry": {"hull": {"kind": "barge", "length": 40, "breadth": 20, "draft": 8}, "panel_size": 4},
        "body": {"centre_of_gravity": [0, 0, 0], "mass": 6.4e6, "radii_of_gyration": [7, 12, 12]},
        "frequencies": {"from": 0.4, "to": 0.8, "step": 0.2},
    }


def a_deck(rows: Rows) -> dict[str, Any]:
    deck = rows.world.signed_in("owner").get(f"/api/v1/cases/{rows.deck_case}/moordyn")
    assert deck.status_code == 200, deck.text
    return {"content": deck.content, "headers": {"content-type": "text/plain"}}


def a_bundle(rows: Rows) -> dict[str, Any]:
    """Of a run by another name each time, so that it is not here already."""
    content = rows.world.signed_in("owner").get(f"/api/v1/runs/{rows.run}/bundle").content
    target = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            text = old.read(name)
            if name == "manifest.json":
                manifest = json.loads(text)
                manifest["run"]["name"] = rows.name
                text = json.dumps(manifest).encode()
            new.writestr(name, text)
    return {"content": target.getvalue()}


def names(*keys: str) -> Callable[[Rows], dict[str, Any]]:
    """A JSON object in which each key holds a new name."""
    return lambda rows: {"json": dict.fromkeys(keys, rows.name)}
