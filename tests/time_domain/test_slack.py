"""Lines that go slack in the time domain: no push, and the time that they are slack (docs/theory.md, L17)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.kernels.compression import SHARE
from solver.run import run
from solver.time_domain import pace
from solver.time_domain.ensemble import march_ensemble
from solver.time_domain.probe import StepTooLong
from tests.systems import span
from tests.time_domain.systems import marched, prepared, timed

DEPTH, PERIOD = 40.0, 6.0
WIRE = {"diameter": 0.1, "mass": 80.0, "EA": 1e8, "drag": {"normal": 1.2, "tangential": 0.1}}
TOP = (52.0, 0, -3)


def _snatched(heave: float, length: float = 65.0, h: float = 0.01, **kind: Any) -> dict[str, Any]:
    """A short line from the bed to a point that heaves, clear of the bed; 20 elements."""
    data = span(length, (0, 0, -DEPTH), TOP, 20, 80.0, **{**WIRE, **kind})
    data["lines"]["line"]["end_b"]["motion"] = {"heave": {"amplitude": heave, "period": PERIOD}}
    return timed(data, step=h, build_up=3 * PERIOD, duration=4 * PERIOD, output_step=h)


def _weight(length: float = 65.0) -> float:
    return (80.0 - 1000.0 * np.pi / 4 * 0.1**2) * 9.807 * min(80.0, length)


@pytest.mark.slow
@pytest.mark.parametrize(("heave", "length", "h"), [(2.5, 65.0, 0.01), (3.0, 65.0, 0.01), (3.5, 66.0, 0.005)])
def test_a_line_that_is_snatched_does_not_push_and_says_how_long_it_is_slack(
    heave: float, length: float, h: float
) -> None:
    result = run(parse_case(_snatched(heave, length, h)), None)
    assert result.failures == {}
    model, static, spec = prepared(_snatched(heave, length, h))
    record, timing = march_ensemble(model, static, spec, [1])
    history = record.tension[:, :, 0, 0]
    share = (history <= 0.0).mean(axis=0)  # every step is an output
    assert timing.every == 1
    assert 0.05 < share.max() < 0.8
    assert history.min() >= -SHARE * _weight(length)
    line = result.summary["time_domain"]["lines"]["line"]
    worst = int(np.argmax(share))
    assert line["slack"]["share"] == pytest.approx(share.max(), abs=1.5 / history.shape[0])
    assert line["slack"]["arc_length"] == pytest.approx(line["arc_length"][worst])
    (said,) = [text for text in result.summary["warnings"] if "is slack (axial force at most 0) for" in text]
    assert f"line 'line', {line['slack']['arc_length']:.4g} m from end a" in said
    assert f"for {100 * line['slack']['share']:.3g} % of the time" in said


@pytest.mark.slow
def test_a_step_that_jumps_over_the_snatch_is_refused() -> None:
    """In steps of 20 ms tension jumps by its whole range, and the peak is 41 % above that of steps of 2.5 ms."""
    with pytest.raises(StepTooLong, match=r"the line was slack, .* refused above 150 %"):
        marched(_snatched(3.5, 66.0, h=0.02))


@pytest.mark.slow
def test_the_peak_when_it_tightens_again_does_not_depend_on_the_step() -> None:
    peaks = [marched(_snatched(2.5, h=h))[0].highest.max() for h in (0.04, 0.01, 0.0025)]
    np.testing.assert_allclose(peaks, peaks[-1], rtol=0.03)


@pytest.mark.slow
def test_with_compression_allowed_it_pushes_and_that_is_said() -> None:
    data = _snatched(2.5, compression="allowed", EI=2e3)
    result = run(parse_case(data), None)
    line = result.summary["time_domain"]["lines"]["line"]
    euler = np.pi**2 * 2e3 / (65.0 / 20) ** 2
    least = min(line["tension_min"])
    assert least < -2.0 * euler
    said = [text for text in result.summary["warnings"] if "Euler load" in text]
    assert len(said) == 1
    assert f"compression is {-least / 1e3:.3g} kN, above the Euler load of the element, {euler / 1e3:.3g} kN" in said[0]


def test_a_taut_line_is_never_slack_and_nothing_is_said() -> None:
    result = run(parse_case(_snatched(0.05, h=0.05)), None)
    line = result.summary["time_domain"]["lines"]["line"]
    assert line["slack"]["share"] == 0.0
    assert line["slack"]["arc_length"] == line["arc_length"][int(np.argmin(line["tension_min"]))]
    assert result.summary["warnings"] == []


@pytest.mark.slow
def test_the_count_goes_on_from_a_checkpoint(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "BLOCK_SECONDS", 7.0)
    model, static, spec = prepared(_snatched(2.5))
    saved: list[bytes] = []
    whole, _ = march_ensemble(model, static, spec, [1], 1, lambda _share, save: saved.append(save()))
    resumed, _ = march_ensemble(model, static, spec, [1], 1, None, saved[len(saved) * 2 // 3])
    assert whole.slack.max() > 0.05
    np.testing.assert_array_equal(resumed.slack, whole.slack)
