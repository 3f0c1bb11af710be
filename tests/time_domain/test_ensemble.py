"""Seeds together or alone, in threads, resumed, and turned about the vertical: the same numbers."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from solver.outcome import Cancelled, CaseError
from solver.time_domain import block as blocks
from solver.time_domain import pace
from solver.time_domain.ensemble import Record, march_ensemble
from tests.systems import Source, moored_box, span
from tests.time_domain.systems import block_of, marched, prepared, timed

Array = np.ndarray


def _box(turn: float = 0.0, **spec: Any) -> dict[str, Any]:
    """The moored box in two random seas with slow drift and memory, everything turned about the vertical [deg]."""
    data = moored_box(6, 3, hydrodynamics={"data": "box.nc", "radiation": "cummins", "drift": "newman"})
    data["vessel"]["heading"] = f"{20 + turn} deg"
    data["vessel"]["damping"] = {"linear": {"surge": 5e4, "sway": 8e4, "yaw": 1e7}}
    for line in data["lines"].values():
        anchor = line["end_a"]["anchor"]
        anchor["azimuth"] = f"{float(anchor['azimuth'].split()[0]) + 20 + turn} deg"
    data["environment"]["seastates"] = [
        {"spectrum": "jonswap", "hs": 3, "tp": 9, "gamma": 2, "direction": f"{200 + turn} deg"},
        {"spectrum": "jonswap", "hs": 1, "tp": 14, "gamma": 1, "direction": f"{170 + turn} deg"},
    ]
    data["environment"]["current"] = {"depths": [0, 60], "speeds": [0.8, 0.2], "direction": f"{240 + turn} deg"}
    data["analyses"] = {"frequency_domain": {"wave": {"from": 0.3, "to": 1.5}, "low": {"to": 0.3}}}
    return timed(data, **{"step": 0.1, "build_up": 20.0, "duration": 60.0, "output_step": 0.5, **spec})


def _line(turn: float = 0.0, **spec: Any) -> dict[str, Any]:
    """A line between two points, in a regular wave and a current, turned about the vertical [deg]."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    ends = [(x * c - y * s, x * s + y * c, z) for x, y, z in ((0.0, 0.0, -90.0), (80.0, 20.0, -4.0))]
    data = span(140.0, *ends, 12, mass=60.0, EI=2e4, drag={"normal": 1.2, "tangential": 0.1})
    data["environment"]["seastates"] = [{"wave": "regular", "height": 6, "period": 9, "direction": f"{30 + turn} deg"}]
    data["environment"]["current"] = {"depths": [0, 60], "speeds": [0.8, 0.2], "direction": f"{240 + turn} deg"}
    data["environment"]["seabed"] = {"friction": 0.5, "friction_speed": 0.05}
    return timed(data, **{"step": 0.05, "build_up": 27.0, "duration": 27.0, "output_step": 0.5, **spec})


def _same(one: Record, other: Record, tolerance: float) -> None:
    for name in ("vessel", "tension", "ends", "lowest", "highest", "slack"):
        a, b = getattr(one, name), getattr(other, name)
        np.testing.assert_allclose(a, b, rtol=tolerance, atol=tolerance * np.abs(a).max(initial=0.0), err_msg=name)


@pytest.fixture(scope="module")
def together(source: Source) -> Record:
    return marched(_box(), source, (1, 2, 3, 4))[0]


def _pick(record: Record, index: list[int]) -> Record:
    return Record(
        [record.seeds[k] for k in index], record.vessel[:, index], record.tension[..., index], record.ends[..., index],
        record.lowest[..., index], record.highest[..., index], record.ends_range[..., index], record.slack[..., index],
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("groups", [((1,), (2,), (3,), (4,)), ((4, 1), (3, 2)), ((2, 3, 4), (1,))])
def test_seeds_do_not_depend_on_their_company(
    groups: tuple[tuple[int, ...], ...], together: Record, source: Source
) -> None:
    for seeds in groups:
        _same(_pick(together, [s - 1 for s in seeds]), marched(_box(), source, seeds)[0], 1e-10)


def test_seeds_differ(together: Record) -> None:
    for k in range(1, 4):
        gap = np.std(together.vessel[:, 0] - together.vessel[:, k], axis=0)
        assert np.all(gap > 0.1 * np.std(together.vessel[:, 0], axis=0))


def test_threads_and_sizes_of_blocks_change_nothing(
    together: Record, source: Source, monkeypatch: pytest.MonkeyPatch
) -> None:
    _same(together, marched(_box(), source, (1, 2, 3, 4), threads=2)[0], 1e-10)
    monkeypatch.setattr(blocks, "LANES_WANTED", 100)
    _same(together, marched(_box(), source, (1, 2, 3, 4))[0], 1e-10)


@pytest.mark.parametrize(("make", "step"), [(_box, 0.1), (_line, 0.04)], ids=["box", "line"])
def test_a_resumed_run_is_the_run(
    make: Callable[..., dict[str, Any]], step: float, source: Source, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where a stride of 7 s is no whole number of renewals of Newton's matrix."""
    monkeypatch.setattr(pace, "BLOCK_SECONDS", 7.0)
    monkeypatch.setattr(blocks, "LANES_WANTED", 3)
    model, static, spec = prepared(make(step=step, build_up=20.0, duration=40.0, output_step=0.2), source)
    seeds = [1, 2]
    saved: list[bytes] = []
    whole, _ = march_ensemble(model, static, spec, seeds, 1, lambda _share, save: saved.append(save()))
    assert len(saved) >= 9
    for checkpoint in saved[1::3]:
        again, _ = march_ensemble(model, static, spec, seeds, 1, None, checkpoint)
        _same(whole, again, 0.0)
        assert again.retries == whole.retries


def test_a_checkpoint_taken_while_the_block_marches_on_is_that_of_the_last_stride() -> None:
    """Another thread may ask at any time: what it gets must not move any more."""
    data = _line()
    block, resumed, whole = block_of(data), block_of(data), block_of(data)
    block.go(80)
    arrays = block.arrays()
    block.go(80)
    assert int(arrays["step"]) == 80
    resumed.restore({name: value.copy() for name, value in arrays.items()})
    for one in (resumed, whole):
        one.go(one.run.total)
    np.testing.assert_array_equal(resumed.out[1], whole.out[1])
    np.testing.assert_array_equal(resumed.watch.range, whole.watch.range)


def test_what_progress_raises_stops_all_threads(source: Source, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "BLOCK_SECONDS", 2.0)
    model, static, spec = prepared(_box(), source)

    def stop(_share: float, _save: Callable[[], bytes]) -> None:
        raise Cancelled("enough")

    for threads in (1, 2):
        with pytest.raises(Cancelled):
            march_ensemble(model, static, spec, [1, 2, 3, 4, 5, 6], threads, stop)


@pytest.mark.slow
def test_turning_a_moored_vessel_turns_nothing_in_its_own_axes(together: Record, source: Source) -> None:
    turned = marched(_box(turn=77.0), source, (1, 2, 3, 4))[0]
    np.testing.assert_allclose(turned.vessel, together.vessel, atol=1e-8 * np.abs(together.vessel).max())
    np.testing.assert_allclose(turned.ends, together.ends, atol=1e-8 * together.ends.max())


@pytest.mark.parametrize("kinematics", ["mean", "instantaneous"])
@pytest.mark.parametrize("make", ["waves", "random", "top"])
def test_turning_a_line_turns_its_motion(make: str, kinematics: str) -> None:
    """Position to 1e-8 of the motion, in regular and random waves and with a moving top, a current and friction in all."""
    cases = {"waves": _line, "random": _random_line, "top": _moved}
    one, other = (block_of(cases[make](angle, tolerance=1e-10, wave_kinematics=kinematics)) for angle in (0.0, 77.0))
    start = one.state.x.copy()
    c, s = np.cos(np.radians(77.0)), np.sin(np.radians(77.0))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    for block in (one, other):
        block.go(block.run.total)
    motion = np.abs(one.state.x - start).max()
    gap = np.abs(np.einsum("pq,iqn->ipn", turn, one.state.x) - other.state.x).max()
    assert motion > 0.1
    assert gap < 1e-8 * motion


def _random_line(turn: float, **spec: Any) -> dict[str, Any]:
    """The line in two random seas."""
    data = _line(turn, **spec)
    data["environment"]["seastates"] = [
        {"spectrum": "jonswap", "hs": 4, "tp": 9, "gamma": 2, "direction": f"{200 + turn} deg"},
        {"spectrum": "jonswap", "hs": 2, "tp": 14, "gamma": 1, "direction": f"{170 + turn} deg"},
    ]
    return data


def _moved(turn: float, **spec: Any) -> dict[str, Any]:
    """The line with a moving top instead of waves."""
    data = copy.deepcopy(_line(turn, **spec))
    del data["environment"]["seastates"]
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    along = {"amplitude": 3.0 * c, "period": 9.0}
    data["lines"]["line"]["end_b"]["motion"] = {"surge": along, "sway": {"amplitude": 3.0 * s, "period": 9.0}}
    return data


def test_an_output_step_that_is_no_multiple_is_refused() -> None:
    with pytest.raises(CaseError, match="no multiple"):
        marched(_line(output_step=0.07))


def test_outputs_begin_one_output_step_after_the_build_up() -> None:
    """Also where the build-up is no whole number of output steps."""
    h, build_up, every = 0.05, 10.15, 0.5
    record, timing = marched(_moved_with(step=h, build_up=build_up, duration=20.0, output_step=every))
    block = block_of(_moved_with(step=h, build_up=build_up, duration=20.0, output_step=h))
    block.go(block.run.total)
    assert record.tension.shape[0] == 40 == timing.outputs
    np.testing.assert_array_equal(record.tension[:, :, 0, 0], block.out[1][9::10, :, 0])


def _moved_with(**spec: Any) -> dict[str, Any]:
    data = _moved(0.0)
    data["analyses"]["time_domain"].update(spec)
    return data
