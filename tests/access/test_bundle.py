"""A run as one file: out, in somewhere else, the same numbers; and every way in which such a file may lie."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sqlalchemy import func, select
from sqlalchemy.orm import undefer

from store.arrays import encode_values
from store.models import CaseVersion, ChannelRow, DataSet, Run
from store.repositories.imports import ImportRepository
from tests.access.conftest import World

URL = "/api/v1/imports/run"


@pytest.fixture(scope="module")
def run(world: World) -> dict[str, Any]:
    return world.run("travels")


@pytest.fixture(scope="module")
def bundle(world: World, run: dict[str, Any]) -> bytes:
    answer = world.signed_in("viewer").get(f"/api/v1/runs/{run['id']}/bundle")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/zip")
    return answer.content


def unpacked(content: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def packed(files: dict[str, bytes]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, compress_type=zipfile.ZIP_DEFLATED)
    return target.getvalue()


def relabelled(files: dict[str, bytes], change: Callable[[dict[str, Any]], None]) -> bytes:
    """With a changed manifest, whose hashes fit the files again."""
    manifest = json.loads(files["manifest.json"])
    change(manifest)
    for name in manifest["files"]:
        if name in files:
            manifest["files"][name] = {"sha256": hashlib.sha256(files[name]).hexdigest(), "size": len(files[name])}
    return packed(files | {"manifest.json": json.dumps(manifest).encode()})


def stored(world: World) -> list[int]:
    with world.database.read() as session:
        models = (Run, CaseVersion, DataSet, ChannelRow)
        return [session.scalar(select(func.count()).select_from(model)) or 0 for model in models]


def test_the_same_numbers_in_another_team_once(world: World, bundle: bytes, run: dict[str, Any]) -> None:
    there = world.signed_in("stranger")
    first = there.post(URL, content=bundle)
    assert first.status_code == 201, first.text
    new, old = first.json(), run
    assert new["id"] != old["id"]
    for name in ("case_name", "content_hash", "analyses", "state", "outcomes", "solver_version", "data_set_id"):
        assert new[name] == old[name], name
    assert new["progress"] == 1.0
    assert "computed elsewhere" in new["warnings"][-1]
    again = there.post(URL, content=bundle)
    assert (again.status_code, again.json()["id"]) == (200, new["id"])
    with world.database.read() as session:
        blobs = (undefer(ChannelRow.payload), undefer(ChannelRow.axes_payload))
        columns = ("number", "name", "unit", "axes", "shape", "codec", "payload", "axes_payload")
        kept = {}
        for run in (old, new):
            rows = session.scalars(select(ChannelRow).where(ChannelRow.run_id == run["id"]).options(*blobs))
            kept[run["id"]] = sorted(tuple(getattr(row, column) for column in columns) for row in rows)
    assert kept[old["id"]] == kept[new["id"]]
    assert kept[new["id"]]
    base = f"/api/v1/runs/{new['id']}"
    old_summary = world.signed_in("viewer").get(f"/api/v1/runs/{old['id']}/summary").json()
    assert there.get(f"{base}/summary").json() == old_summary
    assert there.get(f"{base}/channels/frequency/vessel/surge").status_code == 200
    assert there.get(f"/api/v1/cases/{new['case_id']}").json()["content_hash"] == old["content_hash"]


def test_what_was_exported_again_is_known_too(world: World, bundle: bytes, run: dict[str, Any]) -> None:
    """The time of the export is no part of what the file is."""
    later = world.signed_in("editor").get(f"/api/v1/runs/{run['id']}/bundle").content
    assert later != bundle
    there = world.signed_in("stranger")
    first = there.post(URL, content=bundle).json()
    again = there.post(URL, content=later)
    assert (again.status_code, again.json()["id"]) == (200, first["id"])


def test_with_its_hydrodynamic_data(world: World, tmp_path: Path, fpso: str) -> None:
    from tests.access.conftest import netcdf, with_data

    with_data(world)
    editor = world.signed_in("editor")
    run = editor.post("/api/v1/runs", json={"yaml": fpso, "analyses": ["statics"]}).json()
    world.finish()
    content = editor.get(f"/api/v1/runs/{run['id']}/bundle").content
    files = unpacked(content)
    assert any(name.startswith("data/") for name in files)
    stranger = world.signed_in("stranger")
    made = stranger.post(URL, content=content)
    assert made.status_code == 201, made.text
    mine = stranger.get(f"/api/v1/data-sets/{made.json()['data_set_id']}").json()
    assert mine["content_hash"] == editor.get(f"/api/v1/data-sets/{run['data_set_id']}").json()["content_hash"]
    name = next(name for name in files if name.startswith("data/"))
    swapped = relabelled(files | {name: netcdf(tmp_path, 3).getvalue()}, lambda _: None)
    assert_refused(world, swapped, name)


def assert_refused(world: World, content: bytes, field: str) -> None:
    """A 422 that names the field, and nothing is stored."""
    before = stored(world)
    answer = world.signed_in("stranger").post(URL, content=content)
    assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json"), answer.text
    assert any(fault["field"].startswith(field) for fault in answer.json()["errors"]), answer.text
    assert stored(world) == before


def first_channel(files: dict[str, bytes]) -> str:
    return next(name for name in files if name.endswith(".values"))


def test_archives_that_are_none(world: World, bundle: bytes) -> None:
    assert_refused(world, b"", "file")
    assert_refused(world, b"PK\x03\x04 nonsense", "file")
    assert_refused(world, bundle[: len(bundle) // 2], "file")
    files = unpacked(bundle)
    assert_refused(world, packed({key: value for key, value in files.items() if key != "manifest.json"}), "file")
    assert_refused(world, packed(files | {"manifest.json": b"{}"}), "manifest.json")
    assert_refused(world, packed(files | {"manifest.json": b"[" * 100_000}), "manifest.json")


@pytest.mark.parametrize("name", ["../../etc/cron.d/x", "/etc/passwd", "channels/../../x", "C:\\x", "extra.txt"])
def test_names_that_lead_elsewhere(world: World, bundle: bytes, name: str) -> None:
    """No file is ever written under a name of the archive; one that the manifest does not know is refused anyway."""
    assert_refused(world, packed(unpacked(bundle) | {name: b"x"}), "manifest.json")
    files = unpacked(bundle) | {name: b"x"}

    def point(manifest: dict[str, Any]) -> None:
        manifest["files"][name] = {}
        manifest["channels"][0]["values"] = name

    assert_refused(world, relabelled(files, point), "manifest.json")


def test_a_name_twice(world: World, bundle: bytes) -> None:
    target = io.BytesIO(bundle)
    with pytest.warns(UserWarning, match="Duplicate name"), zipfile.ZipFile(target, "a") as archive:
        archive.writestr("summary.json", b"{}")
    assert_refused(world, target.getvalue(), "file")


def test_wrong_hashes(world: World, bundle: bytes) -> None:
    files = unpacked(bundle)
    values = first_channel(files)
    for name in ("summary.json", "case.json", "case.yaml", values):
        changed = bytearray(files[name])
        changed[len(changed) // 2] ^= 1
        assert_refused(world, packed(files | {name: bytes(changed)}), name)


def test_hashes_that_fit_a_forgery(world: World, bundle: bytes) -> None:
    """Whoever can write the manifest can write its hashes: what the files mean is checked as well."""
    files = unpacked(bundle)
    other = files["case.json"].replace(b'"travels"', b'"changed"')
    assert other != files["case.json"]
    assert_refused(world, relabelled(files | {"case.json": other}, lambda _: None), "case.json")
    text = files["case.yaml"].replace(b"travels", b"changed")
    assert_refused(world, relabelled(files | {"case.yaml": text}, lambda _: None), "case.json")
    assert_refused(world, relabelled(files, lambda m: m["run"].update(analyses=["modes"])), "manifest.json")
    assert_refused(world, relabelled(files, lambda m: m["run"].update(state="running")), "manifest.json")
    assert_refused(world, relabelled(files, lambda m: m["run"].update(name="a\0b")), "manifest.json")
    assert_refused(world, relabelled(files | {"summary.json": b"[1]"}, lambda _: None), "summary.json")
    assert_refused(world, relabelled(files | {"summary.json": b'{"a": NaN}'}, lambda _: None), "summary.json")
    values = first_channel(files)
    assert_refused(world, relabelled(files | {values: b"no zstd"}, lambda _: None), values)
    assert_refused(world, relabelled(files, lambda m: m["channels"][0].update(shape=[7])), "channels/")
    assert_refused(world, relabelled(files, lambda m: m["channels"][0].update(shape=[10**9, 10**9])), "channels/")


@pytest.mark.parametrize("place", ["reason", "solver_version", "description", "band"])
def test_null_bytes_which_not_every_database_takes(world: World, bundle: bytes, place: str) -> None:
    def change(manifest: dict[str, Any]) -> None:
        part = manifest["run"] if place in manifest["run"] else manifest["channels"][0]
        part[place] = "a\0b"

    assert_refused(world, relabelled(unpacked(bundle), change), "manifest.json")


def test_channels_that_cannot_be_shown(world: World, bundle: bytes) -> None:
    """One name twice; a number that is none, among the values or on an axis."""
    files = unpacked(bundle)
    twice = relabelled(files, lambda m: m["channels"].append(m["channels"][0]))
    assert_refused(world, twice, "manifest.json")
    values = first_channel(files)
    listed = next(each for each in json.loads(files["manifest.json"])["channels"] if each["values"] == values)
    bad = encode_values(np.full(listed["shape"], np.nan), listed["codec"])
    assert_refused(world, relabelled(files | {values: bad}, lambda _: None), values)

    def unbounded(manifest: dict[str, Any]) -> None:
        axis = next(each for each in manifest["channels"] if each["values"] == values)["axes"][0]
        axis["last"] = float("inf")

    assert_refused(world, relabelled(files, unbounded), values)


def test_the_same_file_twice_at_once(world: World, bundle: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second looked before the first was stored: it is told to try again, and leaves nothing behind."""
    there = world.signed_in("stranger")
    assert there.post(URL, content=bundle).status_code in (200, 201)
    before = stored(world)
    with monkeypatch.context() as patched:
        patched.setattr(ImportRepository, "known", lambda *_: None)
        clash = there.post(URL, content=bundle)
    assert (clash.status_code, clash.json()["type"]) == (409, "conflict"), clash.text
    assert stored(world) == before
    assert there.post(URL, content=bundle).status_code == 200


@contextmanager
def limit(world: World, size: int) -> Iterator[None]:
    """What may come in."""
    context = world.app.state.context
    world.app.state.context = replace(context, settings=context.settings.model_copy(update={"max_bundle_bytes": size}))
    yield
    world.app.state.context = context


def test_bombs(world: World, bundle: bytes) -> None:
    import zstandard

    files = unpacked(bundle)
    huge = packed({**files, "a": b"\0" * 20_000_001})
    assert len(huge) < 100_000
    with limit(world, 10_000_000):
        assert_refused(world, huge, "file")
    manifest = json.loads(files["manifest.json"])
    manifest["files"]["summary.json"]["size"] = 10
    long = files | {"manifest.json": json.dumps(manifest).encode(), "summary.json": b" " * 1_000_000}
    assert_refused(world, packed(long), "summary.json")
    values = first_channel(files)
    bomb = zstandard.ZstdCompressor(level=19).compress(b"\0" * 100_000_000)
    assert len(bomb) < 20_000
    assert_refused(world, relabelled(files | {values: bomb}, lambda _: None), values)


def test_too_large(world: World) -> None:
    with limit(world, 1000):
        assert_refused(world, b"x" * 5000, "file")


def test_only_what_has_results(world: World) -> None:
    editor = world.signed_in("editor")
    from tests.service.running import a_case

    run = editor.post("/api/v1/runs", json={"case": a_case("waits")}).json()
    assert editor.get(f"/api/v1/runs/{run['id']}/bundle").status_code == 409
    editor.post(f"/api/v1/runs/{run['id']}/cancel")
    assert editor.get(f"/api/v1/runs/{run['id']}/bundle").status_code == 409
