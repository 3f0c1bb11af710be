"""A march whose steps are too long is stopped early, and what it names instead does the whole run."""

from __future__ import annotations

import json
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.outcome import Cancelled
from solver.results.part import Chunk, Part
from solver.run import merge, run, run_chunk
from solver.time_domain import block as blocks
from solver.time_domain import probe
from solver.time_domain.ensemble import FEWEST_OUTPUTS, march_ensemble
from solver.time_domain.probe import StepTooLong, periods_watched
from solver.time_domain.resolution import Finding
from tests.systems import Source, example
from tests.time_domain.systems import block_of, marched, prepared, timed
from tests.time_domain.test_ensemble import _box
from tests.time_domain.test_refusals import _bed, _buoy, _riser
from worker.execute import conclude


def _loose(name: str, h: float, tolerance: float = 1e-3) -> dict[str, Any]:
    """An example as it is, with another step and tolerance."""
    data = example(name)
    data["analyses"]["time_domain"].update(step=h, output_step=h, tolerance=tolerance)
    return data


def _refused(data: dict[str, Any]) -> StepTooLong:
    with pytest.raises(StepTooLong) as failure:
        marched(data)
    return failure.value


@pytest.mark.parametrize(("case", "h"), [(1, 0.2), (1, 0.1), (1, 0.05), (2, 0.1), (2, 0.05)])
def test_a_tolerance_that_is_too_loose_is_named_and_no_step(case: int, h: float) -> None:
    said = str(_refused(_loose(f"hanging-riser-case{case}", h)))
    assert said.startswith("the tolerance is too loose: line 'riser', ")
    assert "with the default tolerance, 1e-06, instead of 0.001. Set analyses.time_domain.tolerance to 1e-06." in said
    assert "smaller step" not in said


@pytest.mark.parametrize(("tolerance", "said"), [(1e-4, True), (1e-5, False)])
def test_a_warning_names_the_tolerance_where_it_is_loose(tolerance: float, said: bool) -> None:
    """1e-4 bends tension by 19 % of its range from step to step; the peak is 0.4 % off."""
    data = _loose("hanging-riser-case1", 0.05, tolerance)
    summary = run(parse_case(data | {"analyses": _only_time(data)}), None).summary
    assert summary["failures"] == {}
    assert [text for text in summary["warnings"] if "tension bends by" in text] == summary["warnings"]
    assert len(summary["warnings"]) == said
    if said:
        assert summary["warnings"][0].endswith(
            "; compare with the default tolerance, 1e-06 instead of 0.0001, then with half the step"
        )


@pytest.mark.slow
@pytest.mark.parametrize(("case", "h"), [(1, 0.9), (1, 0.5), (2, 0.9), (2, 0.5), (2, 0.2)])
def test_step_and_tolerance_are_named_where_both_are_needed(case: int, h: float) -> None:
    """And the whole run with both is answered."""
    name = f"hanging-riser-case{case}"
    said = str(_refused(_loose(name, h)))
    assert said.startswith("the step is too long and the tolerance too loose: ")
    named = re.search(r"a step of (\S+) s with the default tolerance, 1e-06, would do\. Use both\.", said)
    assert named is not None, said
    assert all(one.severity < 1.0 for one in marched(_loose(name, float(named[1]), 1e-6))[0].findings)


@pytest.mark.slow
@pytest.mark.parametrize("make", [
    lambda h: _riser(10.0, 8.0, h, compression="allowed"), lambda h: _riser(5.0, 5.0, h, compression="allowed"),
    lambda h: _buoy(h, 2.0), lambda h: _bed(2e5, 0.5, h),
], ids=["snaps", "waves along", "current", "bed"])  # fmt: skip
@pytest.mark.parametrize("h", [0.5, 0.2])
def test_the_step_that_is_named_does_the_whole_run(make: Any, h: float) -> None:
    environment = make(h)["environment"]
    if h == 0.2 and (environment.get("current") or environment.get("seabed")):
        pytest.skip("0.2 s is answered there")
    said = str(_refused(make(h)))
    named = re.search(r"In a trial from t = \S+ to \S+ s a step of (\S+) s would do", said)
    assert named is not None, said
    assert float(named[1]) < h
    assert all(one.severity < 1.0 for one in marched(make(float(named[1])))[0].findings)


@pytest.mark.slow
@pytest.mark.parametrize("h", [0.2, 0.1])
def test_where_none_of_those_tried_does_the_step_is_estimated(h: float) -> None:
    """A stiff bed: of the step study's steps 0.005 s is answered with 5.4 % of the 6 % allowed, 0.01 s is not."""
    said = str(_refused(_bed(2e6, 0.05, h)))
    named = re.search(
        rf"steps down to {h / 20:g} s would not do; by what was left .* about (\S+) s would\. Use that", said
    )
    assert named is not None, said
    assert 0.001 <= float(named[1]) <= 0.005
    assert said.endswith("compare it with half of it, or a softer seabed with a wider transition.")


def _long(h: float, duration: float = 4000.0) -> dict[str, Any]:
    """The snapping riser for a long time."""
    data = _riser(10.0, 8.0, h)
    return timed(data, step=h, build_up=240.0, duration=duration, output_step=h)


def test_a_hopeless_step_is_refused_within_a_tenth_of_the_run() -> None:
    """181 % of the range: seen in the second half of the build-up, 4.3 minutes of 70 before its end."""
    failure = _refused(_long(0.2))
    at = float(re.search(r"by t = (\S+) s \(0 ends", str(failure))[1])  # type: ignore[index]
    assert -120.0 < at <= 0.0
    assert failure.partial is None


def _storm(h: float) -> dict[str, Any]:
    """The riser in a storm, its top driven as well: slack in places."""
    data = _riser(6.0, 9.0, h)
    data["environment"]["seastates"] = [{"spectrum": "jonswap", "hs": 6, "tp": 9, "gamma": 2, "direction": "0 deg"}]
    data["analyses"] = {}
    return timed(data, step=h, build_up=240.0, duration=3000.0, output_step=h)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_random_sea_is_refused_early_by_any_of_its_seeds(threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of one seed each, alone or beside each other: the first that is refused ends the run, with its seed."""
    monkeypatch.setattr(blocks, "LANES_WANTED", 1)
    with pytest.raises(StepTooLong) as failure:
        marched(_storm(0.5), seeds=(1, 2), threads=threads)
    at = re.search(
        r"by t = (\S+) s \(0 ends the build-up\)\. In a trial from t = \S+ to \S+ s a step of (\S+) s would do",
        str(failure.value),
    )
    assert at is not None, str(failure.value)
    assert float(at[1]) < 0.1 * 3240.0
    assert failure.value.partial is None or failure.value.partial[0].seeds in ([1], [2])


def test_what_progress_raises_stops_the_trials() -> None:
    model, static, spec = prepared(_long(0.2))
    told = []

    def stop(share: float, _save: Any) -> None:
        told.append(share)
        if len(told) > 1 and told[-1] == told[-2]:  # no step of the run since: a trial goes on
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        march_ensemble(model, static, spec, [1], 1, stop)


def test_between_the_limit_and_its_double_the_run_goes_to_its_end() -> None:
    """35 % of the range with 0.1 s: refused, with all that was computed."""
    failure = _refused(_riser(10.0, 8.0, 0.1))
    record, timing = failure.partial
    assert "by t = 32 s (0 ends the build-up)." in str(failure)
    assert timing.duration == pytest.approx(32.0)
    assert record.tension.shape[0] == 320
    assert [one.what for one in record.findings] == ["kink"]
    assert 1.0 < record.findings[0].severity < probe.EARLY


def test_what_the_build_up_alone_does_is_not_refused_at_the_end() -> None:
    """The watch of the kept part begins anew at its start: kinks of the build-up are not in its findings."""
    block = block_of(_riser(10.0, 27.0, 0.05))
    block.early.kink[:] = 1e9
    while not block.done:
        block.go(block.stride)
    assert block.watch.kink.max() < 1e5
    assert np.isfinite(block.watch.range).all()


def test_a_trial_goes_on_from_where_the_run_was(source: Source) -> None:
    """A moored box with memory in random seas: the same motion by the same steps; by shorter ones it converges with h²."""
    block = block_of(_box(step=0.1, build_up=20.0, duration=80.0), source, (1, 2))
    block.go(240)
    mark = block.mark
    trials = {parts: block.finer(mark, parts, float(block.run.spec.tolerance), 280) for parts in (1, 2, 4)}
    block.go(240)
    for parts, trial in trials.items():
        np.testing.assert_array_equal(trial.state.s, mark["state/s"])
        trial.go(240 * parts)
        assert np.isfinite(trial.watch.range).all()
    assert np.abs(block.state.s - mark["state/s"]).max() > 0.05
    np.testing.assert_array_equal(trials[1].state.s, block.state.s)
    np.testing.assert_array_equal(trials[1].state.x, block.state.x)
    gaps = [float(np.abs(trials[parts].state.s - trials[4].state.s).max()) for parts in (1, 2)]
    assert gaps[0] / gaps[1] == pytest.approx((1 - 1 / 16) / (1 / 4 - 1 / 16), rel=0.2)


@pytest.mark.parametrize(("value", "severity"), [(0.3, 1.0), (0.15, 0.5), (0.6, 2.0)])
def test_severity_is_the_value_over_its_limit(value: float, severity: float) -> None:
    assert Finding("line", "kink", value, 0.0).severity == pytest.approx(severity)


def test_a_random_sea_is_judged_after_ten_waves_and_a_harmonic_case_after_one_period() -> None:
    sea = [{"spectrum": "jonswap", "hs": 3, "tp": 9, "gamma": 2, "direction": "0 deg"}]
    data = example("hanging-riser-case2")
    data["environment"]["seastates"] = sea
    random = block_of(timed(data, step=0.1, build_up=20.0, duration=900.0, output_step=0.1))
    assert 0.1 * np.array(periods_watched(random.run)) == pytest.approx([90.0, 27.0], rel=0.01)
    harmonic = block_of(_riser(10.0, 27.0, 0.1))
    assert periods_watched(harmonic.run) == (270, 270)
    regular = block_of(_buoy(0.1, 2.0))
    assert periods_watched(regular.run) == (90, 90)


def test_a_refused_run_keeps_what_it_computed_apart() -> None:
    case = parse_case(_riser(10.0, 8.0, 0.1) | {"analyses": _only_time(_riser(10.0, 8.0, 0.1))})
    summary = run(case, None, threads=1)
    assert summary.channels == ()
    assert "time_domain" not in summary.summary
    doubtful, failure = summary.summary["time_domain_doubtful"], summary.failures["time_domain"]
    assert doubtful["converged"] is False
    assert doubtful["seeds"] == [1]
    assert doubtful["duration"] == pytest.approx(32.0)
    assert failure.startswith(doubtful["doubt"])
    assert failure.endswith(
        "What was computed (1 seed, 32 s after the build-up) is in the summary under time_domain_doubtful; do not use it "
        "as a result."
    )
    assert max(doubtful["lines"]["riser"]["tension_max"]) > 1e5


def _only_time(data: dict[str, Any]) -> dict[str, Any]:
    return {"time_domain": data["analyses"]["time_domain"]}


def _parts(kept: tuple[int, ...], refused: tuple[bool, ...]) -> tuple[Any, list[Part]]:
    """Chunks of one seed each; the time domain of a refused one ended after `kept` outputs."""
    data = _riser(10.0, 27.0, 0.2)
    data["analyses"] = {"time_domain": {**data["analyses"]["time_domain"], "seeds": len(kept)}}
    case = parse_case(data)
    whole = run_chunk(case, None, Chunk("time", (1, 2)))
    parts = []
    for seed, (rows, bad) in enumerate(zip(kept, refused, strict=True), start=1):
        head = {**whole.summary["time_domain_part"], "seeds": [seed], "kept": rows}
        cut = {"vessel", "top", "ends"}
        arrays = {name: values[:rows] if name in cut else values for name, values in whole.arrays.items()}
        failures = {"failures": {"time_domain": "the step is too long."}} if bad else {}
        parts.append(Part({**whole.summary, "time_domain_part": head, **failures}, (), arrays))
    return case, [Part.from_bytes(part.to_bytes()) for part in parts]


@pytest.mark.parametrize(("kept", "refused", "seeds"), [
    ((540, 40, 540), (False, True, False), [1, 3]),  # one early, the others whole
    ((40, 60, 60), (True, True, True), [2, 3]),  # all, those that went farthest
    ((540, 540, 540), (False, False, True), [1, 2, 3]),  # one at its end
])  # fmt: skip
def test_one_refused_chunk_of_several_makes_the_time_domain_doubtful(
    kept: tuple[int, ...], refused: tuple[bool, ...], seeds: list[int]
) -> None:
    case, parts = _parts(kept, refused)
    result = merge(case, parts)
    assert "time_domain" not in result.summary
    assert result.summary["time_domain_doubtful"]["seeds"] == seeds
    assert result.summary["time_domain_doubtful"]["duration"] == pytest.approx(0.2 * max(kept))
    assert result.channels == ()
    good = merge(case, _parts((540, 540), (False, False))[1])
    assert good.failures == {}
    assert good.summary["time_domain"]["realisations"] == 2
    assert "time_domain_doubtful" not in good.summary


def test_a_few_outputs_are_not_kept() -> None:
    """A limit on the number of outputs: statistics of less say nothing."""
    data = _riser(10.0, 8.0, 0.1)
    data["analyses"]["time_domain"]["output_step"] = 32.0 / (FEWEST_OUTPUTS - 2)
    assert _refused(data).partial is None


def test_the_worker_takes_a_doubtful_time_domain_for_failed() -> None:
    case, parts = _parts((540, 40), (False, True))
    job = SimpleNamespace(analyses=("statics", "time_domain"))
    outcome = conclude(merge(case, parts), job)  # type: ignore[arg-type]
    assert outcome.state == "failed"
    assert outcome.outcomes["time_domain"] == "failed"
    assert outcome.reason is not None
    assert outcome.reason.startswith("time_domain: the step is too long. What was computed (1 seed, 108 s after")
    assert "time_domain_doubtful" in json.loads(outcome.summary)
