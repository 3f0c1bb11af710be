"""The hanging riser (Low & Langley 2006, section 5) in the frequency domain.

The reference is an independent time integration's half-range of element tension, averaged along the line: 2.39 kN (case
1) and 1.97 kN (case 2); there the frequency domain differed by 24.5 and 12.2 % in the mean over the line at full amplitude.
"""

from __future__ import annotations

import copy
from functools import cache

import numpy as np
import pytest

from solver.case import parse_case
from solver.run import run
from tests.systems import example


@cache
def _amplitude(name: str, factor: float = 1.0, elements: int = 68) -> np.ndarray:
    """Tension amplitude of every element per factor [N]."""
    data = copy.deepcopy(example(f"hanging-riser-{name}"))
    data["lines"]["riser"]["segments"][0]["elements"] = elements
    data["analyses"].pop("time_domain", None)
    data["analyses"]["frequency_domain"]["tolerance"] = 1e-6
    if name == "case1":
        data["lines"]["riser"]["end_b"]["motion"]["surge"]["amplitude"] = f"{10 * factor} m"
    else:
        data["environment"]["seastates"][0]["height"] = f"{10 * factor} m"
    summary = run(parse_case(data), None).summary
    assert not summary["failures"]
    return np.array(summary["frequency_domain"]["lines"]["riser"]["tension_amplitude"]) / factor


def test_a_moving_top_differs_from_the_half_range_by_the_known_gap() -> None:
    """Case 1, mean over the line: the reference's 24.5 % is nearly all of one sign, so the means differ by that much at most.

    In case 2 the second harmonic adds to some elements and takes from others, and the ratio of means says nothing.
    """
    gap = 1 - float(_amplitude("case1").mean()) / 2.39e3
    assert 0.20 < gap < 0.245


@pytest.mark.parametrize("name", ["case1", "case2"])
def test_elements_of_half_the_length_change_little(name: str) -> None:
    coarse, fine = _amplitude(name), _amplitude(name, 1.0, 136)
    np.testing.assert_allclose(coarse, 0.5 * (fine[::2] + fine[1::2]), atol=0.02 * fine.max())


def test_top_element_at_full_amplitude_beside_the_time_domain() -> None:
    """Half-range of the top element, independent time integration: case 1 5.31 kN, case 2 5.09 kN.

    A first harmonic lies below a half-range that has higher harmonics in it; by no more than the mean gap of the line.
    """
    for name, low, high, gap in (("case1", 41.18, 51.80, 0.245), ("case2", 42.15, 52.33, 0.122)):
        half = 0.5e3 * (high - low)
        assert (1 - 2 * gap) * half < _amplitude(name)[-1] < 1.1 * half


def test_phase_of_the_prescribed_motion_does_not_matter() -> None:
    data = example("hanging-riser-case1")
    data["lines"]["riser"]["end_b"]["motion"]["surge"]["phase"] = "33 deg"
    data["analyses"].pop("time_domain", None)
    other = run(parse_case(data), None).summary["frequency_domain"]["lines"]["riser"]["tension_amplitude"]
    np.testing.assert_allclose(other, _amplitude("case1"), rtol=1e-4)
