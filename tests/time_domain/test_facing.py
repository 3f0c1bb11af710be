"""A fairlead at end a: the same line told from its other end gives the same answer, in the order of its telling."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.kernels.arrays import GROUNDED
from solver.outcome import CaseError
from solver.run import run
from solver.time_domain.ensemble import Record
from solver.time_domain.facing import SWAPPED
from tests.systems import Source, moored_box
from tests.time_domain.systems import marched, timed

FLIPPED = ("line-0", "line-2")


def _box() -> dict[str, Any]:
    """Three lines of two unlike segments, one line shorter in elements than the others, with a clump weight."""
    data = moored_box(6, 3, hydrodynamics={"data": "box.nc", "radiation": "constant", "frequency": 0.6})
    data["line_types"]["wire"] = {"diameter": 0.08, "mass": 40.0, "EA": 3e8, "EI": 1e4}
    for k, line in enumerate(data["lines"].values()):
        line["segments"] = [
            {"type": "chain", "length": 300.0, "elements": 5 - (k == 2)},
            {"type": "wire", "length": 120.0, "elements": 3},
        ]
    data["attachments"] = [{"line": "line-0", "arc_length": 300.0, "mass": 3000.0, "volume": 0.5, "drag_area": 2.0}]
    data["environment"]["seastates"] = [{"spectrum": "jonswap", "hs": 3, "tp": 9, "gamma": 2, "direction": "200 deg"}]
    data["analyses"] = {"frequency_domain": {"wave": {"from": 0.3, "to": 1.5}, "low": {"to": 0.3}}}
    return timed(data, step=0.1, build_up=20.0, duration=30.0, output_step=0.5)


def _told_backwards(data: dict[str, Any]) -> dict[str, Any]:
    out = copy.deepcopy(data)
    for name in FLIPPED:
        line = out["lines"][name]
        line["segments"] = line["segments"][::-1]
        line["end_a"], line["end_b"] = line["end_b"], line["end_a"]
    out["attachments"][0]["arc_length"] = 420.0 - 300.0
    return out


@pytest.fixture(scope="module")
def both(source: Source) -> tuple[Record, Record]:
    return marched(_box(), source, (1, 2))[0], marched(_told_backwards(_box()), source, (1, 2))[0]


def test_the_vessel_and_untouched_lines_move_alike(both: tuple[Record, Record]) -> None:
    one, other = both
    assert np.abs(one.vessel).max() > 0.1
    np.testing.assert_allclose(other.vessel, one.vessel, atol=1e-9 * np.abs(one.vessel).max())
    np.testing.assert_allclose(other.ends[:, :, 1], one.ends[:, :, 1], rtol=1e-9)


@pytest.mark.parametrize("index", [0, 2])
def test_a_line_told_backwards_has_the_same_tensions_from_its_other_end(
    index: int, both: tuple[Record, Record]
) -> None:
    one, other = both
    gap = 1 if index == 2 else 0
    np.testing.assert_allclose(other.ends[:, SWAPPED, index], one.ends[:, :4, index], rtol=1e-9)
    np.testing.assert_allclose(other.ends_range[:, SWAPPED, index], one.ends_range[:, :, index], rtol=1e-9)
    np.testing.assert_allclose(other.ends[:, GROUNDED, index], one.ends[:, GROUNDED, index], rtol=1e-9)
    assert one.ends[:, GROUNDED, index].min() > 10.0
    for name in ("lowest", "highest"):
        mine, theirs = getattr(one, name)[gap:, index], getattr(other, name)[gap:, index]
        np.testing.assert_allclose(theirs[::-1], mine, rtol=1e-9)
        assert np.abs(mine[0] - mine[-1]).min() > 1e4  # the ends differ, so that the order is seen
    # stored in single precision
    np.testing.assert_allclose(other.tension[:, gap:, index][:, ::-1], one.tension[:, gap:, index], rtol=2e-7)


def test_arc_lengths_and_end_tensions_are_in_the_order_of_the_case(source: Source) -> None:
    data = _told_backwards(_box())
    del data["analyses"]["frequency_domain"]
    data["environment"]["seastates"] = [{"wave": "regular", "height": 2, "period": 10, "direction": "200 deg"}]
    data["analyses"]["statics"] = {}
    summary = run(parse_case(data), source).summary
    told, plain = (summary["time_domain"]["lines"][name] for name in ("line-0", "line-1"))
    assert told["arc_length"][0] == pytest.approx(20.0)  # wire first
    assert plain["arc_length"][0] == pytest.approx(30.0)
    assert told["tension_mean"][0] > told["tension_mean"][-1]  # the fairlead is at arc length 0
    assert plain["tension_mean"][0] < plain["tension_mean"][-1]


def test_what_lies_on_the_bed_is_as_long_from_either_end(source: Source) -> None:
    lengths = []
    for data in (_box(), _told_backwards(_box())):
        data["analyses"] = {"statics": {}}
        lines = run(parse_case(data), source).summary["statics"]["lines"]
        lengths.append([line["grounded_length"] for line in lines.values()])
    assert min(lengths[0]) > 50.0
    np.testing.assert_allclose(lengths[1], lengths[0], rtol=1e-12)


def test_a_line_between_two_fairleads_is_refused() -> None:
    data = _box()
    data["lines"]["line-0"]["end_a"] = {"fairlead": [-25.0, 9.0, -4.0]}
    with pytest.raises(CaseError, match=r"lines\.line-0\.end_a\.fairlead.*one end of a line only"):
        parse_case(data)
