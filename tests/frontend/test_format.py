from __future__ import annotations

import math

import pytest

from frontend.format import duration, moment, number, percent, seconds, shown


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"), (1.23456, "1.23"), (-1.2, "−1.20"), (1234.5, "1 234"), (52.44, "52.4"), (0.0123, "0.0123"),
        (4.2e-7, "4.20e-07"), (None, "–"), (math.nan, "–"), ("x", "–"), (9.999e5, "999 900"),
    ],
)  # fmt: skip
def test_number(value: object, text: str) -> None:
    assert number(value).replace("\u2009", " ") == text


def test_percent() -> None:
    assert percent(0.367) == "36.7 %"
    assert percent(0.00661) == "0.66 %"
    assert percent(6e-25) == "0 %"
    assert percent(9e-5) == "< 0.01 %"
    assert percent(None) == "–"


@pytest.mark.parametrize(("value", "text"), [(0.84, "0.8 s"), (42, "42 s"), (200, "3 min 20 s"), (7500, "2 h 05 min")])
def test_seconds(value: float, text: str) -> None:
    assert seconds(value) == text


def test_times_with_and_without_z() -> None:
    assert moment("2026-03-01T14:05:09.123Z") == "2026-03-01 14:05:09 UTC"
    run = {"started_at": "2026-03-01T14:05:09+00:00", "finished_at": "2026-03-01T14:05:21+00:00"}
    assert duration(run) == "12 s"


@pytest.mark.parametrize(
    ("unit", "people"),
    [("N", "kN"), ("N2 s/rad", "kN²·s/rad"), ("rad2 s/rad", "deg²·s/rad"), ("rad/m", "deg/m"), ("parsec", "parsec")],
)
def test_units_for_people(unit: str, people: str) -> None:
    assert shown(unit)[0] == people
