"""A cancelled march stops soon, however large the system."""

from __future__ import annotations

import time

import pytest

from solver.time_domain.pace import BLOCK_SECONDS, FEWEST_LANES, NODE_SECONDS, STRIDE_SECONDS, stride
from tests.time_domain.systems import block_of, riser


@pytest.mark.parametrize("lanes", [1, 8, 24, 2000])
@pytest.mark.parametrize("nodes", [2, 51, 5000])
@pytest.mark.parametrize("h", [0.001, 0.04, 5.0])
def test_a_stride_is_whole_renewals_within_its_bounds(h: float, nodes: int, lanes: int) -> None:
    steps = stride(h, nodes, lanes, 8)
    assert steps >= 8
    assert steps % 8 == 0
    if steps > 8:
        assert steps * h <= BLOCK_SECONDS
        assert steps * NODE_SECONDS * nodes * max(lanes, FEWEST_LANES) <= STRIDE_SECONDS


def test_a_stride_of_a_long_line_takes_a_fraction_of_a_second() -> None:
    """1000 elements, one lane: without the bound by work a stride would be 1200 steps, some two seconds."""
    block = block_of(riser("case1", 0.1, elements=1000, build_up=0.0, duration=270.0))
    block.go(8)
    steps = stride(0.05, 1001, 1, 8)
    assert steps < 200
    began = time.process_time()
    block.go(steps)
    assert time.process_time() - began < 1.0
