"""Short records are warned of: cycles of the longest natural period, and the error of a slow σ."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.analyses import natural_modes
from solver.case import parse_case
from solver.modes.natural import longest_period
from solver.results.sampling import sampling_summary, sampling_warnings, slow_errors
from solver.results.time import TimeResult
from solver.run import run
from solver.time_domain.statistics import band_variances, over_seeds, record_error
from solver.vessel.data import FileSource
from tests.systems import EXAMPLES, example, moored_box, solved
from tests.time_domain.systems import timed

Array = np.ndarray
BORDER = 0.2


def _resonance(period: float, ratio: float, duration: float, step: float, seeds: int, first: int = 1) -> Array:
    """Histories (n, seeds) of a lightly damped oscillator under white noise, from its exact spectrum, σ = 1."""
    n = round(duration / step)
    many = 4 * n  # a long record, of which a part is cut: it is no whole period
    omega = 2 * np.pi * np.fft.rfftfreq(many, step)
    natural = 2 * np.pi / period
    density = 1.0 / ((natural**2 - omega**2) ** 2 + (2 * ratio * natural * omega) ** 2)
    density[0] = 0.0
    random = np.random.default_rng(first)
    lines = np.sqrt(density)[:, None] * (
        random.standard_normal((omega.size, seeds)) + 1j * random.standard_normal((omega.size, seeds))
    )
    history = np.fft.irfft(lines, many, axis=0)
    return history[:n] / np.sqrt(2 * density.sum() / many**2 * 2)


@pytest.mark.parametrize(
    ("period", "ratio", "duration"), [(200.0, 0.1, 5000.0), (100.0, 0.05, 5000.0), (200.0, 0.2, 10000.0)]
)
def test_the_error_from_one_record_is_that_of_many(period: float, ratio: float, duration: float) -> None:
    """400 records: the mean of (R9) is the scatter of their σ, and what the spectrum gives, about ½(ζωT)^-½."""
    history = _resonance(period, ratio, duration, 2.0, 400)
    low, _, _ = band_variances(history, 2.0, BORDER, False)
    sigma = np.sqrt(low)
    scatter = sigma.std(ddof=1) / sigma.mean()
    single = np.array([float(record_error(history[:, [k]], 2.0, BORDER, False)) for k in range(400)])
    exact = _from_spectrum(period, ratio, duration)
    assert exact == pytest.approx(0.5 / np.sqrt(ratio * 2 * np.pi / period * duration), rel=0.2)
    assert scatter == pytest.approx(exact, rel=0.1)
    assert single.mean() == pytest.approx(exact, rel=0.12)
    assert single.std() < 0.35 * exact


def _from_spectrum(period: float, ratio: float, duration: float) -> float:
    """½ √(2π ∫S²/T)/∫S of the oscillator below the border, the record shortened by its taper (0.855/0.875² of it is lost)."""
    omega, natural = np.linspace(1e-4, BORDER, 20_000), 2 * np.pi / period
    density = 1.0 / ((natural**2 - omega**2) ** 2 + (2 * ratio * natural * omega) ** 2)
    shorter = (0.8 + 0.2 * 35 / 128) / (0.8 + 0.2 * 3 / 8) ** 2
    squares, area = np.trapezoid(density**2, omega), np.trapezoid(density, omega)
    return float(0.5 * np.sqrt(2 * np.pi * shorter * squares / duration) / area)


def test_seeds_together_have_an_error_less_by_the_root_of_their_number() -> None:
    history = _resonance(200.0, 0.1, 5000.0, 2.0, 160)
    single = np.mean([float(record_error(history[:, [k]], 2.0, BORDER, False)) for k in range(160)])
    ten = np.mean([float(record_error(history[:, k : k + 10], 2.0, BORDER, False)) for k in range(0, 160, 10)])
    assert ten == pytest.approx(single / np.sqrt(10), rel=0.1)
    scattered = [over_seeds(*band_variances(history[:, k : k + 10], 2.0, BORDER, False)) for k in range(0, 160, 10)]
    assert np.mean([s["lf_error"] / s["lf"] for s in scattered]) == pytest.approx(ten, rel=0.15)


def _result(
    sizes: dict[str, float], duration: float, seeds: int = 1, period: float | None = 200.0, **head: Any
) -> TimeResult:
    """Slow motions of the given σ, each a resonance of 200 s damped by 10 %."""
    names = ("surge", "sway", "heave", "roll", "pitch", "yaw")
    vessel = np.zeros((round(duration / 2.0), seeds, 6))
    for index, name in enumerate(names):
        if name in sizes:
            vessel[:, :, index] = sizes[name] * _resonance(200.0, 0.1, duration, 2.0, seeds, 10 + index)
    longest = None if period is None else {"period": period, "motion": "surge"}
    fields = {"h": 1.0, "every": 2, "kept": round(duration), "periodic": False, "random": True, "border": BORDER}
    return TimeResult({**fields, "longest_period": longest, **head}, list(range(seeds)), {"vessel": vessel})


@pytest.mark.parametrize(("duration", "said"), [(1998.0, True), (2000.0, False), (192.0, True)])
def test_ten_of_the_longest_natural_period(duration: float, said: bool) -> None:
    found = [text for text in sampling_warnings(_result({"surge": 1.0}, duration)) if "natural period" in text]
    assert len(found) == said
    if said:
        assert f"{duration / 200:.3g} times the longest natural period, 200 s (surge)" in found[0]
        assert "use a duration of 2000 s or more" in found[0]


@pytest.mark.parametrize(("duration", "seeds", "said"), [(5000.0, 1, True), (5000.0, 10, False), (30000.0, 1, False)])
def test_a_slow_sigma_that_is_not_known_within_a_tenth(duration: float, seeds: int, said: bool) -> None:
    """13 % for one record of 5000 s, 4 % for ten, 5 % for one of 30 000 s."""
    result = _result({"surge": 5.0}, duration, seeds)
    found = [text for text in sampling_warnings(result) if "standard error" in text]
    assert len(found) == said
    (error,) = slow_errors(result).values()
    assert (error > 0.1) == said
    if said:
        assert f"above 10 %: surge {100 * error:.3g} %; use more seeds" in found[0]
    assert sampling_summary(result)["sampling"]["lf_std_error"] == {"surge": error}


def test_small_motions_do_not_count_and_rotations_count_at_a_hundred_metres() -> None:
    sizes = {"surge": 5.0, "sway": 0.4, "yaw": 0.01, "pitch": 0.004}  # 1 m and 0.4 m at 100 m
    assert set(slow_errors(_result(sizes, 5000.0))) == {"surge", "yaw"}


def test_slow_motions_beside_much_larger_fast_ones_do_not_count() -> None:
    result = _result({"surge": 0.1}, 5000.0)
    result.arrays["vessel"][:, :, 2] = 3.0 * np.sin(0.5 * 2.0 * np.arange(2500))[:, None]
    assert slow_errors(result) == {}


def test_nothing_is_said_without_random_waves_or_without_a_vessel() -> None:
    assert sampling_warnings(_result({"surge": 1.0}, 300.0, random=False, period=None)) == []
    assert sampling_summary(_result({}, 300.0, period=None)) == {}


@pytest.mark.slow
def test_the_longest_period_of_the_example_is_that_of_its_modes() -> None:
    model, static = solved(example("fpso-2000m"), FileSource(EXAMPLES))
    longest, mode = longest_period(model, static), natural_modes(model, static, None, 1).modes[0]
    assert longest is not None
    assert longest["motion"] == mode.label == "sway"
    assert longest["period"] == pytest.approx(312.8, abs=0.5)
    assert longest["period"] == pytest.approx(mode.period, rel=1e-3)


def test_the_longest_period_of_a_box_is_that_of_its_modes() -> None:
    model, static = solved(moored_box(20))
    longest, mode = longest_period(model, static), natural_modes(model, static, None, 1).modes[0]
    assert longest is not None
    assert longest["motion"] == mode.label
    assert longest["period"] == pytest.approx(mode.period, rel=0.01)


def test_lines_alone_have_no_longest_period() -> None:
    assert longest_period(*solved(example("hanging-riser-case1"))) is None


@pytest.mark.slow
def test_the_example_for_300_seconds_is_warned_of() -> None:
    """Beside a period of 313 s, 307 s with lines of 20 elements."""
    data = timed(example("fpso-2000m"), step=0.2, build_up=300.0, duration=300.0, output_step=0.4)
    data["analyses"] = {"time_domain": data["analyses"]["time_domain"]}
    for line in data["lines"].values():
        line["segments"][0]["elements"] = 20
    summary = run(parse_case(data), FileSource(EXAMPLES)).summary
    assert summary["failures"] == {}
    said = next(text for text in summary["warnings"] if "natural period" in text)
    assert "the duration of 300 s is 0.978 times the longest natural period, 306.8 s (sway)" in said
    assert any("the standard error of the low-frequency σ is above 10 %" in text for text in summary["warnings"])
    assert summary["time_domain"]["sampling"]["longest_natural_period"] == pytest.approx(306.8, abs=0.5)
