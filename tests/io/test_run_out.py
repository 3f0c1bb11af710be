"""`slowdrift run --out`: the channels of a run as a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cli.main import main
from solver.case import load_case

from .decks import ROOT


@pytest.fixture(scope="module")
def netcdf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("out") / "riser.nc"
    case = ROOT / "examples" / "hanging-riser-case1.yaml"
    arguments = ["run", str(case), "--quiet", "--only", "statics,frequency_domain", "--out", str(path)]
    assert main([*arguments, "--json", str(path.with_suffix(".json"))]) == 0
    return path


def test_the_file_holds_channels_case_and_summary(netcdf: Path) -> None:
    xr = pytest.importorskip("xarray")
    with xr.open_datatree(netcdf) as tree:
        tension = tree["static/line/riser/tension"]
        assert tension.dims[0].startswith("arc_length")
        assert tension.attrs["units"] == "N"
        assert float(tension[-1]) == pytest.approx(46.6e3, rel=0.01)
        assert np.all(np.diff(tree["static/line/riser/position"].values[:, 2]) > -3)
        case = load_case(str(tree["case"].values))
        assert case.content_hash() == tree.attrs["case_hash"]
        assert netcdf.with_suffix(".json").read_text().strip().startswith("{")


def test_a_wrong_ending_or_folder_is_told_before_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = str(ROOT / "examples" / "hanging-riser-case1.yaml")
    assert main(["run", case, "--quiet", "--out", str(tmp_path / "results.xls")]) == 2
    assert "allowed: .nc" in capsys.readouterr().err
    assert main(["run", case, "--quiet", "--out", str(tmp_path / "none" / "results.nc")]) == 2
    assert "no such folder" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
