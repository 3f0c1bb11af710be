"""Hydrodynamic data over REST: WAMIT sets with their conventions, checks, arrays to draw, and what is refused."""

import io
import json
import zipfile

import numpy as np
import pytest

from solver.vessel.data import read_files
from tests.vessel.wamit_sets import OPTIONS, files

URL = "/api/v1/data-sets"
FORM = {"length": "10 m", "density": "1025", "gravity": "9.807", "centre_of_mass": "0, 0, 2"}


@pytest.fixture
def made(client):
    answer = client.post(URL, files=several(files()), data=FORM)
    assert answer.status_code == 201, answer.text
    return answer.json()


def several(parts):
    return [("file", item) for item in parts.items()]


def archive(parts, method=zipfile.ZIP_DEFLATED):
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", method) as packed:
        for name, payload in parts.items():
            packed.writestr(f"folder/{name}", payload)
    return target.getvalue()


def test_a_set_is_stored_with_its_conventions(client, made):
    assert made["name"] == "t.zip"
    assert made["summary"]["qtf"]["heading_pairs_deg"] == [[0.0, 45.0]]
    assert made["summary"]["provenance"]["conventions"]["length"] == 10.0
    assert made["content_hash"] == read_files(files(), OPTIONS).content_hash
    again = client.post(URL, files={"file": ("other.zip", archive(files()))}, data=FORM)
    assert again.status_code == 200
    assert again.json()["id"] == made["id"]
    other = client.post(URL, files=several(files()), data=FORM | {"length": "11"})
    assert other.status_code == 201
    assert other.json()["version"] == 2


def test_checks_and_arrays(client, made):
    expected, url = read_files(files(), OPTIONS), f"{URL}/{made['id']}"
    checks = {check["name"]: check for check in client.get(url).json()["checks"]}
    assert checks["reciprocity"]["state"] == "warning"
    assert checks["reciprocity"]["value"] > checks["reciprocity"]["threshold"]

    def get(**asked):
        return client.get(f"{url}/coefficients", params=asked).json()

    one = get(quantity="added_mass", i=0, j=4)
    assert np.allclose(one["series"][0]["values"], expected.added_mass[:, 0, 4])
    assert one["series"][0]["infinite"] == expected.added_mass_infinite[0, 4]
    assert len(get(quantity="damping")["series"]) == 36
    forces = get(quantity="excitation", i=2, heading=45)["series"][0]
    assert np.allclose(np.array(forces["values"]) + 1j * np.array(forces["imaginary"]), expected.excitation[:, 1, 2])
    drift = get(quantity="mean_drift", heading=22.5, i=1)["series"][0]["values"]
    assert np.allclose(drift, expected.mean_drift[:, :2, 1].mean(axis=1))
    table = get(quantity="qtf", i=5)
    assert np.allclose(table["series"][0]["imaginary"], expected.qtf.values[0, ..., 5].imag)
    assert np.allclose(table["omega"], expected.qtf.omega)
    kernel = get(quantity="retardation", i=0, j=0)
    assert kernel["omega"] is None
    assert len(kernel["time"]) == len(kernel["series"][0]["values"])
    assert np.allclose(client.get(f"{url}/stiffness").json()["hydrostatic_stiffness"], expected.hydrostatic_stiffness)


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ({"quantity": "qtf"}, "i"), ({"quantity": "excitation", "heading": 225, "i": 0}, ""),
        ({"quantity": "mass"}, "quantity"),
        ({"quantity": "added_mass", "i": 6}, "i"), ({"quantity": "qtf", "i": 0, "heading": 60}, "heading"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_names_the_field(client, made, asked, field):
    answer = client.get(f"{URL}/{made['id']}/coefficients", params=asked)
    if field:
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["field"] == field
    else:
        assert answer.status_code == 200


@pytest.mark.parametrize("field", ["length", "density", "gravity", "centre_of_mass"])
def test_what_the_files_cannot_say_is_asked_for(client, field):
    form = {key: value for key, value in FORM.items() if key != field}
    answer = client.post(URL, files=several(files()), data=form)
    assert answer.status_code == 422
    assert [error["field"] for error in answer.json()["errors"]] == [field]
    wrong = client.post(URL, files=several(files()), data=FORM | {field: "0, 0" if field == "centre_of_mass" else "-3"})
    assert wrong.status_code == 422
    assert wrong.json()["errors"][0]["field"] == field
    assert client.get(URL).json()["items"] == []


def cut(parts, name, keep):
    return parts | {name: parts[name][: int(len(parts[name]) * keep)]}


@pytest.mark.parametrize(
    ("parts", "text"),
    [
        (lambda: cut(files(), "t.3", 0.6), "t.3"),
        (lambda: files() | {"t.1": files()["t.1"].replace(b"E+0", b"E+*", 1)}, "t.1, line 1"),
        (lambda: {name: payload for name, payload in files().items() if name != "t.1"}, "added mass"),
        (lambda: {"a.zip": archive({"x.1": b"\0" * 150_000_000})}, "more than 128 MB"),
        (lambda: {"a.zip": archive(files())[:-40]}, "damaged"),
        (lambda: {"a.zip": archive({f"{k}.txt": b"" for k in range(70)})}, "70 files"),
        (lambda: files() | {"u.1": files()["t.1"]}, "2 runs"),
        (lambda: {"a.1": b"", "a.3": b"1"}, "empty"),
        (lambda: {"a.txt": b"of no kind"}, "neither NetCDF"),
    ],
    ids=["cut", "damaged row", "half a set", "bomb", "half an archive", "many files", "two runs", "empty", "text"],
)
def test_what_is_wrong_is_said_and_nothing_stored(client, parts, text):
    answer = client.post(URL, files=several(parts()), data=FORM)
    assert answer.status_code == 422
    assert text in json.dumps(answer.json(), ensure_ascii=False)
    assert client.get(URL).json()["items"] == []


def test_a_case_runs_on_a_stored_set_and_may_not_contradict_it(client, made, fpso):
    text = fpso.replace("barge-240x46x10.nc", made["id"])
    said = text.replace(f"data: {made['id']}", f"data: {made['id']}, wamit: {{length: 12}}")
    assert said != text
    answer = client.post("/api/v1/cases/check", content=said, headers={"content-type": "application/yaml"})
    assert answer.status_code == 422
    assert "uploaded with 10" in answer.text
