"""Wrong formulas, planted one at a time in the results: the value tests of this folder notice each, where it shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from solver.results import channels as product_channels
from solver.results import line_values, solved, statistics, strain
from solver.results import summary as product_summary
from solver.results import time as product_time
from solver.results.channels import Definition
from solver.results.time import TimeResult

from .compare import differences
from .linear_channels import as_dict
from .scenes import Linear, Timed
from .test_linear_values import channel_differences
from .timed import channels as time_channels
from .timed import summary as time_summary
from .whole import summary

Array = np.ndarray
Patch = pytest.MonkeyPatch


def _channel(patch: Patch, name: str, change: Callable[[Any], Any]) -> None:
    """Change what the function of one channel gives; name : domain/owner/quantity."""
    items = product_channels.CHANNELS
    index = next(k for k, one in enumerate(items) if f"{one.domain}/{one.owner}/{one.quantity}" == name)
    old = items[index]

    def make(source: Any, which: str) -> Any:
        made = old.make(source, which)
        return None if made is None else change(made)

    changed = Definition(old.domain, old.owner, old.quantity, old.unit, old.band, old.description, make)
    patch.setattr(product_channels, "CHANNELS", [changed if one is old else one for one in items])


def _times(factor: float) -> Callable[[Any], Any]:
    return lambda made: (factor * made[0], made[1])


def _one_sigma(patch: Patch) -> None:
    patch.setattr(product_summary, "significant", lambda sigma: np.asarray(sigma))


def _maximum_without_two(patch: Patch) -> None:
    def wrong(sigma: Array, m2: Array, duration: float) -> Array:
        waves = duration / (2 * np.pi) * np.sqrt(m2) / np.where(sigma > 0, sigma, 1.0)
        return np.where(sigma > 0, sigma * np.sqrt(np.log(np.maximum(waves, np.e**0.5))), 0.0)

    patch.setattr(product_summary, "most_probable_maximum", wrong)


def _both_maxima(patch: Patch) -> None:
    patch.setattr(product_summary, "combined_maximum", lambda wf, wf_max, lf, lf_max: wf_max + lf_max)


def _m2_of_first_order(patch: Patch) -> None:
    plain = solved.Solved.moments
    patch.setattr(
        solved.Solved, "moments", lambda self, spectra, band, order=0: plain(self, spectra, band, min(order, 1))
    )


def _lowest_tension(patch: Patch) -> None:
    def wrong(case: Any, line: Any, elements: Array, end_a: float, end_b: float) -> dict[str, Any]:
        loads = line_values.breaking_loads(case, line)
        if np.all(np.isnan(loads)):
            return {}
        return {"utilisation": float(np.nanmin(np.array([end_a, *elements, end_b]) / loads))}

    patch.setattr(product_summary, "utilisation", wrong)


def _largest_breaking_load(patch: Patch) -> None:
    plain = line_values.breaking_loads
    patch.setattr(
        line_values,
        "breaking_loads",
        lambda *which: np.full_like(plain(*which), np.nan_to_num(plain(*which), nan=1.0).max()),
    )


def _utilisation_without_ends(patch: Patch) -> None:
    plain = line_values.utilisation
    patch.setattr(
        product_summary, "utilisation", lambda case, line, elements, a, b: plain(case, line, elements, 0.0, 0.0)
    )


def _grounded_by_touch(patch: Patch) -> None:
    patch.setattr(line_values, "LIES", 0.02)


def _not_turned(patch: Patch) -> None:
    patch.setattr(solved.Solved, "earth", lambda self, vectors: np.asarray(vectors))


def _end_forces_swapped(patch: Patch) -> None:
    patch.setattr(product_summary, "END_FORCES", ("end_a_tension", "end_b_tension", "end_a_vertical", "end_b_vertical"))


def _border_left_out(patch: Patch) -> None:
    plain = solved.Solved._moment
    patch.setattr(solved.Solved, "_moment", lambda self, spectra, origin, band, order: plain(
        self, spectra, origin, "total" if band == "wf" else band, order))  # fmt: skip


def _second_order_lost(patch: Patch) -> None:
    plain = solved.Solved.spectra
    patch.setattr(
        solved.Solved, "spectra", lambda self, wave, low: plain(self, wave, None if low is None else 0.0 * low)
    )


LINEAR: dict[str, tuple[Callable[[Patch], None], str, str]] = {
    "significant value 1σ": (_one_sigma, "storm", "vessel_significant"),
    "most probable maximum without its 2": (_maximum_without_two, "storm", "most_probable_max"),
    "maxima of both bands added": (_both_maxima, "storm", "combined"),
    "mean period by the first moment": (_m2_of_first_order, "storm", "most_probable_max"),
    "utilisation of the lowest tension": (_lowest_tension, "calm", "utilisation"),
    "utilisation of the largest breaking load": (_largest_breaking_load, "calm", "utilisation"),
    "utilisation without the ends": (_utilisation_without_ends, "calm", "utilisation"),
    "grounded where it only touches": (_grounded_by_touch, "storm", "grounded_length"),
    "vectors in the vessel's axes": (_not_turned, "regular", "force"),
    "ends exchanged": (_end_forces_swapped, "calm", "end_a_tension"),
    "wave band from zero": (_border_left_out, "storm", "std.wf"),
    "slow drift lost": (_second_order_lost, "storm", "std.lf"),
}


@pytest.mark.parametrize("fault", LINEAR)
def test_a_wrong_value_of_the_summary_is_noticed(linear: dict[str, Linear], monkeypatch: Patch, fault: str) -> None:
    plant, scene, shows = LINEAR[fault]
    expected = summary(linear[scene].fresh())
    plant(monkeypatch)
    assert any(shows in one for one in differences(expected, linear[scene].fresh().summary()))


CHANNEL: dict[str, tuple[str, Callable[[Any], Any], str]] = {
    "tension RAO doubled": ("frequency/line/tension_rao_amplitude", _times(2.0), "storm"),
    "curvature of the stiffer side": ("frequency/line/curvature_std", lambda made: (made[0] / 3.0, made[1]), "shaken"),
    "phase of the other sign": ("frequency/vessel/{dof}_rao_phase", _times(-1.0), "storm"),
    "spectrum per hertz": ("frequency/wave/elevation", _times(2 * np.pi), "storm"),
    "mode shape not scaled": ("modes/vessel/shape", _times(1.01), "storm"),
    "moment in degrees": ("static/line/bending_moment", _times(180 / np.pi), "shaken"),
    "arc length from end b": ("static/line/tension", lambda made: (made[0][::-1], made[1]), "calm"),
    "motion of the next frequency": ("frequency/line/motion_rao_amplitude", lambda made: (np.roll(made[0], 1, 0), made[1]),
                                     "storm"),
}  # fmt: skip


@pytest.mark.parametrize("fault", CHANNEL)
def test_a_wrong_channel_is_noticed(linear: dict[str, Linear], monkeypatch: Patch, fault: str) -> None:
    name, change, scene = CHANNEL[fault]
    _channel(monkeypatch, name, change)
    found = channel_differences(linear[scene])
    assert found
    quantity = name.rsplit("/", 1)[1].removeprefix("{dof}")
    assert all(quantity in one for one in found)


def test_curvature_with_the_stiffer_side_is_noticed(linear: dict[str, Linear], monkeypatch: Patch) -> None:
    monkeypatch.setattr(product_channels.np, "minimum", np.maximum)
    assert any("curvature_std" in one for one in channel_differences(linear["shaken"]))


def _rainflow_per_seed(patch: Patch) -> None:
    _channel(patch, "time/line/rainflow", _times(3.0))


def _shifted(patch: Patch) -> None:
    patch.setattr(TimeResult, "time", property(lambda self: self.step * np.arange(self.arrays["vessel"].shape[0])))


def _sigma_of_means(patch: Patch) -> None:
    plain = product_time.over_seeds
    patch.setattr(product_time, "over_seeds", lambda low, high, mean: plain(low, high, np.zeros_like(mean)))


def _error_of_one(patch: Patch) -> None:
    plain = product_time.over_seeds

    def wrong(low: Array, high: Array, mean: Array) -> dict[str, Array]:
        found = plain(low, high, mean)
        return {key: value * (np.sqrt(3) if key.endswith("error") else 1.0) for key, value in found.items()}

    patch.setattr(product_time, "over_seeds", wrong)


def _first_seed_only(patch: Patch) -> None:
    plain = TimeResult.end_range
    patch.setattr(TimeResult, "end_range", lambda self, *which: tuple(part[:1] for part in plain(self, *which)))


def _anchor_at_a(patch: Patch) -> None:
    patch.setattr(TimeResult, "row", lambda self, name, what: product_time.END_VALUES[what])


def _step_not_output(patch: Patch) -> None:
    patch.setattr(TimeResult, "step", property(lambda self: float(self.head["h"])))


TIME: dict[str, tuple[Callable[[Patch], None], str]] = {
    "rainflow times the seeds": (_rainflow_per_seed, "rainflow"),
    "time axis shifted": (_shifted, "time/vessel/surge.axes.0"),
    "means of the seeds left out": (_sigma_of_means, "std.lf"),
    "error of one seed": (_error_of_one, "std_error"),
    "extremes of the first seed": (_first_seed_only, "end_b_max_per_seed"),
    "anchor always at end a": (_anchor_at_a, "anchor_vertical"),
    "step for output step": (_step_not_output, "std.wf"),
}


@pytest.mark.parametrize("fault", TIME)
def test_a_wrong_value_of_the_time_domain_is_noticed(
    timed_scenes: dict[str, Timed], monkeypatch: Patch, fault: str
) -> None:
    plant, shows = TIME[fault]
    scene = timed_scenes["storm"]
    plant(monkeypatch)
    made = scene.result()
    found = differences(time_summary(scene), made.summary["time_domain"])
    found += differences(time_channels(scene), {one.name: as_dict(one) for one in made.channels})
    assert any(shows in one for one in found)


def test_nothing_is_noticed_without_a_fault(linear: dict[str, Linear], timed_scenes: dict[str, Timed]) -> None:
    for scene in linear.values():
        assert differences(summary(scene.fresh()), scene.fresh().summary()) == []
        assert channel_differences(scene) == []
    assert statistics.significant(np.array(1.0)) == 2.0
    assert strain.STRAIN == 0.1
    made = timed_scenes["storm"].result()
    assert differences(time_summary(timed_scenes["storm"]), made.summary["time_domain"]) == []
