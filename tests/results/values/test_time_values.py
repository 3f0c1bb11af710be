"""Every value of the time domain, and every channel of it, against plain formulas on the recorded histories."""

from __future__ import annotations

import numpy as np
import pytest

from solver.results.doubt import add_doubtful
from solver.results.part import Part
from solver.results.time import merge_time

from .compare import differences
from .linear_channels import as_dict
from .scenes import Timed
from .timed import channels, rainflow, summary

SCENES = ("storm", "shaken")


@pytest.mark.parametrize("scene", SCENES)
def test_every_value_of_the_summary(timed_scenes: dict[str, Timed], scene: str) -> None:
    found = timed_scenes[scene]
    assert differences(summary(found), found.made.summary["time_domain"]) == []


@pytest.mark.parametrize("scene", SCENES)
def test_every_channel(timed_scenes: dict[str, Timed], scene: str) -> None:
    found = timed_scenes[scene]
    assert differences(channels(found), {one.name: as_dict(one) for one in found.made.channels}) == []


@pytest.mark.parametrize("scene", SCENES)
def test_a_refused_run_says_the_same_under_another_name(timed_scenes: dict[str, Timed], scene: str) -> None:
    found = timed_scenes[scene]
    said = {"failures": {"time_domain": "the step is too long."}}
    add_doubtful(said, merge_time([Part.from_bytes(part.to_bytes()) for part in found.parts]))
    expected = {
        **summary(found),
        "converged": False,
        "doubt": "the step is too long.",
        "seeds": list(found.record.seeds),
    }
    assert differences(expected, said["time_domain_doubtful"]) == []
    words = said["failures"]["time_domain"]
    assert words.startswith("the step is too long. What was computed")
    count, kept = len(found.record.seeds), found.timing.kept * found.timing.h
    assert f"({count} seed{'s' * (count > 1)}, {kept:.4g} s after the build-up)" in words


def test_rainflow_of_the_standards_example() -> None:
    """ASTM E1049-85, figure 6: -2, 1, -3, 5, -1, 3, -4, 4, -2."""
    counts: dict[float, float] = {}
    for size, cycles in rainflow(np.array([-2.0, 1, -3, 5, -1, 3, -4, 4, -2])):
        counts[size] = counts.get(size, 0.0) + cycles
    assert counts == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}


def test_scenes_have_what_they_claim(timed_scenes: dict[str, Timed]) -> None:
    """Seeds that differ, a line with padding, a border inside the record, outputs of two steps."""
    storm = timed_scenes["storm"]
    assert storm.record.seeds == [4, 5, 6]
    assert storm.timing.every == 2
    assert {line.nodes for line in storm.lines.values()} == {9, 10}
    made = storm.made.summary["time_domain"]
    assert min(made["vessel_std"]["lf"]["surge"], made["vessel_std"]["wf"]["heave"]) > 0.05
    assert np.ptp(made["lines"]["line-0"]["end_b_max_per_seed"]) > 0
    assert "touchdown" in made["lines"]["line-1"]
    assert "touchdown" not in timed_scenes["shaken"].made.summary["time_domain"]["lines"]["riser"]
