"""Waves at the instantaneous position against sums written out, and what they do to the example riser."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.kernels.waves import water_at, water_where
from solver.time_domain import block as blocks
from solver.time_domain.block import Block
from solver.time_domain.probe import Probe, StepTooLong
from solver.time_domain.resolution import Seen, observed
from solver.waves.kinematics import velocity
from tests.systems import span
from tests.time_domain.systems import block_of, marched, riser, timed

Array = np.ndarray
RANDOM = [
    {"spectrum": "jonswap", "hs": 5, "tp": 10, "gamma": 2, "direction": "30 deg"},
    {"spectrum": "jonswap", "hs": 2, "tp": 13, "gamma": 1, "direction": "140 deg"},
]
REGULAR = [
    {"wave": "regular", "height": 6, "period": 9, "direction": "30 deg", "phase": "50 deg"},
    {"wave": "regular", "height": 3, "period": 9, "direction": "250 deg"},
]


def _line(seas: list[dict[str, Any]], depth: float, **spec: Any) -> dict[str, Any]:
    """A line from the bed to the surface, 6 % longer than the straight distance."""
    data = span(1.06 * np.hypot(44.7, depth + 0.5), (0, 0, -depth), (40, 20, 0.5), 14, depth, mass=60.0, EI=2e4)
    data["environment"]["seastates"] = seas
    given = {"step": 0.1, "build_up": 0.0, "duration": 120.0, "output_step": 0.5, "wave_kinematics": "instantaneous"}
    return timed(data, **{**given, **spec})


def _direct(block: Block, points: Array, t: float, origin: Array) -> Array:
    """Velocity and acceleration at points, component by component (P, 6)."""
    waves, environment = block.run.waves, block.run.model.case.environment
    assert waves is not None
    z = np.minimum(points[:, 2:], 0.0)
    where = np.concatenate([points[:, :2], z], axis=1)
    turn = np.exp(1j * waves.omega * t)
    parts = [velocity(waves.omega, d, where, environment.depth, environment.water.gravity) for d in waves.directions]
    pairs = list(zip(block.amplitudes[0], parts, strict=True))
    u = sum(np.einsum("w,wpk->pk", a * turn, part) for a, part in pairs)
    du = sum(np.einsum("w,wpk->pk", 1j * waves.omega * a * turn, part) for a, part in pairs)
    return np.concatenate([np.real(u), np.real(du)], axis=1)


@pytest.mark.parametrize(("seas", "depth", "allowed"), [
    (RANDOM, 70.0, 2e-3), (RANDOM, 15.0, 2e-3), (RANDOM, 500.0, 2e-3), (REGULAR, 70.0, 1e-12), (REGULAR, 15.0, 1e-12),
])  # fmt: skip
@pytest.mark.parametrize("far", [0.0, 4.0, 15.0])
def test_water_is_the_sum_of_the_components_where_the_node_is(
    seas: list[dict[str, Any]], depth: float, allowed: float, far: float
) -> None:
    """What is left is the table's interpolation in time, the same as at the static position."""
    block = block_of(_line(seas, depth))
    block._cover(1)
    sea, work, first = block.setup.sea, block.work, block.setup.lines.first_wave
    rng = np.random.default_rng(1)
    size, worst = np.zeros(6), np.zeros(6)
    for t in rng.uniform(0, 0.15, 60):
        points = block.state.x[..., 0] + far * rng.uniform(-1, 1, block.state.x.shape[:2]) / np.sqrt(3)
        points[:, 2] = np.maximum(points[:, 2], -depth)
        water_at(sea, t, 1.0, work.terms)
        water_where(sea, work, np.ascontiguousarray(points[..., None]), t, 1.0)
        expected = _direct(block, points, t, block.state.x[..., 0])[first:]
        size = np.maximum(size, np.abs(expected).max(axis=0))
        worst = np.maximum(worst, np.abs(work.water[..., 0] - expected).max(axis=0))
    for part, limit in ((slice(0, 3), 0.5 * allowed), (slice(3, 6), allowed)):
        assert worst[part].max() < limit * size[part].max()


def test_a_table_made_in_windows_is_the_table(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, _ = marched(_line(RANDOM, 70.0))
    made = []
    monkeypatch.setattr(blocks, "WATER_BYTES", 2e5)
    monkeypatch.setattr(blocks.Water, "table", _counted(blocks.Water.table, made))
    parts, _ = marched(_line(RANDOM, 70.0))
    assert len(made) == 2
    np.testing.assert_allclose(parts.tension, whole.tension, rtol=1e-6)


def _counted(table: Any, made: list[int]) -> Any:
    def count(self: Any, line: int, amplitudes: Array, index: Array) -> Array:
        made.append(index.size)
        return table(self, line, amplitudes, index)

    return count


def test_a_motion_beyond_the_series_is_refused_with_the_distance() -> None:
    block = block_of(_line(RANDOM, 70.0))
    water = block.run.water
    assert water is not None
    assert water.missed(10.0) < 1e-5
    reach = next(r for r in np.arange(10.0, 500.0, 5.0) if water.missed(r) > 1e-2)
    N = block.work.length.shape[0]
    none, bed = np.zeros((N, 1, 1)), np.zeros((4, N + 1, 1, 1))
    seen = Seen(none, none, none, bed, np.full((1, 1), reach))
    (one,) = observed(block.run, seen)
    assert (one.what, one.place) == ("reach", reach)
    assert one.severity > 1.0
    assert observed(block.run, seen._replace(reach=np.full((1, 1), 10.0))) == []
    block.early.reach[:] = block.watch.reach[:] = reach
    probe = Probe(block)
    probe.least = 0
    said = (
        r"nodes go too far .* a node in waves went .* m .* wrong by up to .* % of their σ .* Use wave_kinematics: mean"
    )
    with pytest.raises(StepTooLong, match=said):
        probe.look(lambda: None)


@pytest.mark.slow
@pytest.mark.parametrize(("kinematics", "expected"), [("mean", (42.15, 52.33)), ("instantaneous", (42.10, 52.16))])
def test_the_riser_in_waves_at_the_instantaneous_position(kinematics: str, expected: tuple[float, float]) -> None:
    """Range of the top element [kN], against an independent integration in deep water."""
    record, _ = marched(riser("case2", depth=1e4, wave_kinematics=kinematics))
    top = record.tension[:, -1, 0, 0] / 1e3
    np.testing.assert_allclose([top.min(), top.max()], expected, atol=0.012)
    assert record.findings == []
