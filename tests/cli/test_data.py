"""`slowdrift data`: checks and conversions of hydrodynamic data, by exit status and text."""

import json

import numpy as np
import pytest

from cli.main import main
from solver.vessel.data import FileSource
from tests.vessel.wamit_sets import OPTIONS, files

SAID = ["--length", "10 m", "--density", "1025", "--gravity", "9.807", "--centre-of-mass", "0, 0, 2"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name, payload in files().items():
        (tmp_path / name).write_bytes(payload)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_check_tells_what_is_there_and_what_is_doubtful(folder, capsys):
    assert main(["data", "check", "t.1", *SAID]) == 1
    said = capsys.readouterr().out
    assert "5 frequencies, 0.3 to 1.5 rad/s and zero and infinite" in said
    assert "warning  reciprocity" in said
    assert main(["data", "check", "t", "--json", *SAID]) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["qtf"]["frequencies"]["count"] == 4
    assert {check["name"] for check in told["checks"]} >= {"reciprocity", "haskind", "qtf-hermitian"}


def test_check_of_the_example_is_content(capsys):
    assert main(["data", "check", str(_example())]) == 0
    assert "warning" not in capsys.readouterr().out


def _example():
    from store.bundled import examples_dir

    return examples_dir() / "barge-240x46x10.nc"


def test_what_is_missing_or_wrong_is_said(folder, capsys):
    assert main(["data", "check", "t"]) == 2
    assert "ULEN" in capsys.readouterr().err
    assert main(["data", "check", "t", *SAID, "--length", "-1"]) == 2
    assert "--length: Input should be greater than 0" in capsys.readouterr().err
    assert main(["data", "convert", "t", "nowhere/out.nc", *SAID]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_there_and_back(folder, capsys):
    assert main(["data", "convert", "t", "a.nc", *SAID]) == 0
    assert main(["data", "convert", "a.nc", "b", "--to-length", "3"]) == 0
    assert "length 3.0" in capsys.readouterr().out
    assert main(["data", "convert", "a.nc", "c.zip"]) == 0
    source = FileSource(folder)
    first = source.open("t", OPTIONS)
    for other in (
        source.open("a.nc"), source.open("c.zip"), source.open("b", OPTIONS.model_copy(update={"length": 3.0})),
    ):  # fmt: skip
        for field in ("omega", "added_mass", "damping", "excitation", "mean_drift", "motions", "hydrostatic_stiffness"):
            ours, theirs = getattr(first, field), getattr(other, field)
            assert np.allclose(ours, theirs, rtol=2e-6, atol=2e-6 * np.abs(ours).max()), field
