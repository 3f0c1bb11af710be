"""Forces at the ends of lines: in statics, frequency domain and time domain one answer, and in every maximum."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.run import run
from tests.systems import moored_box, span


def _heaved(amplitude: float, **types: Any) -> dict[str, Any]:
    """A chain, half of it on the bed, whose top is moved in heave and surge."""
    data = span(420.0, (0, 0, -100), (380, 0, -5), 30, 100.0, mass=140.0, diameter=0.12, EA=6e8, **types)
    data["environment"]["seabed"] = {"soil": 1e5}
    data["line_types"]["wire"]["drag"] = {"normal": 1.2, "tangential": 0.1}
    data["lines"]["line"]["end_b"]["motion"] = {
        "heave": {"amplitude": amplitude, "period": 12.0}, "surge": {"amplitude": 0.5 * amplitude, "period": 12.0}
    }  # fmt: skip
    data["analyses"] = {
        "statics": {}, "frequency_domain": {"tolerance": 1e-7},
        "time_domain": {"step": 0.02, "build_up": 120.0, "duration": 24.0, "output_step": 0.02, "tolerance": 1e-8},
    }  # fmt: skip
    return data


@pytest.fixture(scope="module")
def small() -> Any:
    return run(parse_case(_heaved(0.02)), None, threads=1)


def test_end_forces_of_a_small_motion_are_the_same_in_both_domains(small: Any) -> None:
    frequency = small.summary["frequency_domain"]["lines"]["line"]
    time = small.summary["time_domain"]["lines"]["line"]
    channels = {channel.name: channel.values for channel in small.channels}
    turn = np.exp(-2j * np.pi * 0.02 * np.arange(1, 1201) / 12.0)
    for name in ("end_a_tension", "end_b_tension", "anchor_vertical"):
        found = 2.0 * abs(np.mean(channels[f"time/line/line/{name}"][:, 0] * turn))
        assert found == pytest.approx(frequency[f"{name}_amplitude"], rel=0.02), name
        assert found == pytest.approx(0.5 * (time[name]["max"] - time[name]["min"]), rel=0.1), name


def test_mean_end_forces_of_a_small_motion_are_the_static_ones(small: Any) -> None:
    statics, time = (small.summary[key]["lines"]["line"] for key in ("statics", "time_domain"))
    for end in ("end_a", "end_b"):
        assert time[f"{end}_tension"]["mean"] == pytest.approx(statics[end]["tension"], rel=1e-3)
    assert time["anchor_vertical"]["mean"] == pytest.approx(statics["end_a"]["force"][2], rel=0.01)
    assert time["grounded_length"]["mean"] == pytest.approx(statics["grounded_length"], rel=0.01)
    assert time["touchdown"]["mean"] == pytest.approx(statics["grounded_length"], abs=14.0)


def test_statistics_of_the_ends_are_those_of_their_histories() -> None:
    result = run(parse_case(_heaved(2.0)), None, threads=1)
    line = result.summary["time_domain"]["lines"]["line"]
    channels = {channel.name: channel.values for channel in result.channels}
    for name in ("end_a_tension", "end_b_tension", "anchor_vertical", "grounded_length", "touchdown"):
        history = channels[f"time/line/line/{name}"].astype(float)
        found = line[name]
        assert found["mean"] == pytest.approx(history.mean(), rel=1e-6)
        assert found["std"] == pytest.approx(history.std(), rel=1e-5)
        assert found["min"] == pytest.approx(history.min(), rel=1e-6)  # every step is an output here
        assert found["max"] == pytest.approx(history.max(), rel=1e-6)
        assert found["std"] > 0
    assert line["end_b_max_per_seed"] == [line["end_b_tension"]["max"]]
    assert 0 < line["grounded_length"]["min"] < line["grounded_length"]["max"] < 420.0


def test_extremes_of_the_ends_are_those_of_every_step_not_of_the_outputs() -> None:
    fine, coarse = _heaved(2.0), _heaved(2.0)
    coarse["analyses"]["time_domain"]["output_step"] = 0.5
    coarse["analyses"]["time_domain"]["duration"] = fine["analyses"]["time_domain"]["duration"] = 25.0
    found = [run(parse_case(data), None, threads=1).summary["time_domain"]["lines"]["line"] for data in (fine, coarse)]
    for name in ("end_a_tension", "end_b_tension"):
        for extreme in ("min", "max"):
            assert found[1][name][extreme] == pytest.approx(found[0][name][extreme], rel=1e-3), (name, extreme)


def test_largest_tension_and_utilisation_are_those_of_the_upper_end() -> None:
    data = _heaved(2.0, breaking_load=1e7)
    result = run(parse_case(data), None, threads=1)
    statics, time = (result.summary[key]["lines"]["line"] for key in ("statics", "time_domain"))
    assert statics["largest"] == {"tension": statics["end_b"]["tension"], "arc_length": statics["length"]}
    assert statics["end_b"]["tension"] > max(statics["tension"])
    assert statics["utilisation"] == pytest.approx(statics["end_b"]["tension"] / 1e7, rel=1e-12)
    assert time["largest"]["tension"] == time["end_b_tension"]["max"]


def test_utilisation_takes_each_place_with_its_own_breaking_load() -> None:
    data = span(420.0, (0, 0, -100), (380, 0, -5), 30, 100.0, mass=140.0, diameter=0.12, EA=6e8, breaking_load=8e6)
    data["line_types"]["weak"] = {**data["line_types"]["wire"], "breaking_load": 1e6}
    data["lines"]["line"]["segments"] = [
        {"type": "weak", "length": 200.0, "elements": 10}, {"type": "wire", "length": 220.0, "elements": 20}
    ]  # fmt: skip
    line = run(parse_case(data), None).summary["statics"]["lines"]["line"]
    expected = max(
        line["end_a"]["tension"] / 1e6, max(line["tension"][:10]) / 1e6, max(line["tension"][10:]) / 8e6,
        line["end_b"]["tension"] / 8e6,
    )  # fmt: skip
    assert line["utilisation"] == pytest.approx(expected, rel=1e-12)


def test_line_turned_round_has_its_anchor_at_end_b() -> None:
    """A line given from the vessel down: what belongs to the anchor is found at end b, in all analyses."""
    plain = moored_box(10, 1)
    plain["vessel"]["line_coefficients"] = {"stiffness": np.diag([3e5, 4e5, 0, 0, 0, 9e7]).tolist()}
    plain["analyses"] = {
        "statics": {}, "time_domain": {"step": 0.05, "build_up": 0.0, "duration": 2.0, "output_step": 0.05}
    }  # fmt: skip
    other = copy.deepcopy(plain)
    line = other["lines"]["line-0"]
    line["end_a"], line["end_b"] = line["end_b"], line["end_a"]
    found = [
        run(parse_case(data), None, threads=1).summary["time_domain"]["lines"]["line-0"] for data in (plain, other)
    ]
    for name in ("mean", "min", "max"):
        assert found[0]["end_a_tension"][name] == pytest.approx(found[1]["end_b_tension"][name], rel=1e-6)
        assert found[0]["anchor_vertical"][name] == pytest.approx(found[1]["anchor_vertical"][name], rel=1e-6)
        assert found[0]["grounded_length"][name] == pytest.approx(found[1]["grounded_length"][name], rel=1e-6)
        assert found[0]["touchdown"][name] == pytest.approx(420.0 - found[1]["touchdown"][name], rel=1e-6)
