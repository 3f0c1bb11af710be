"""Quantities at the door: every unit of every dimension, and what is refused."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.case.units import UNITS, parse

PAIRS = [(dimension, suffix) for dimension, (_, table) in UNITS.items() for suffix in table]

# An independent statement of what one of each unit is in SI.
DEFINITIONS = {
    "m": 1, "mm": 0.001, "cm": 0.01, "km": 1000, "ft": 0.3048, "in": 0.0254, "N": 1, "kN": 1e3, "MN": 1e6, "GN": 1e9,
    "tf": 9806.65, "lbf": 4.4482216152605, "kip": 4448.2216152605, "N m": 1, "kN m": 1e3, "MN m": 1e6, "GN m": 1e9,
    "N m2": 1, "kN m2": 1e3, "MN m2": 1e6, "GN m2": 1e9, "kg": 1, "t": 1000, "te": 1000, "lb": 0.45359237, "kg/m": 1,
    "t/m": 1000, "lb/ft": 1.4881639435695537, "kg m2": 1, "t m2": 1000, "kg/m3": 1, "t/m3": 1000, "s": 1, "ms": 0.001,
    "min": 60, "h": 3600, "hr": 3600, "m/s": 1, "cm/s": 0.01, "km/h": 1 / 3.6, "kn": 0.5144444444444445,
    "knot": 0.5144444444444445, "ft/s": 0.3048, "m/s2": 1, "rad": 1, "deg": 0.017453292519943295,
    "°": 0.017453292519943295, "rad/s": 1, "Hz": 6.283185307179586, "deg/s": 0.017453292519943295, "N/m": 1,
    "kN/m": 1e3, "MN/m": 1e6, "N/m3": 1, "kN/m3": 1e3, "MN/m3": 1e6, "N s/m": 1, "kN s/m": 1e3, "MN s/m": 1e6, "m2": 1,
    "ft2": 0.09290304, "m3": 1, "L": 0.001, "m4": 1, "m2 s/rad": 1,
    "m3/m": 1, "L/m": 0.001, "kgf/m": 9.80665, "lbf/ft": 14.593902937206364,
}  # fmt: skip


@pytest.mark.parametrize(("dimension", "suffix"), PAIRS)
def test_one_of_each_unit_is_what_its_definition_says(dimension: str, suffix: str) -> None:
    assert parse(f"2.5 {suffix}", dimension) == pytest.approx(2.5 * DEFINITIONS[suffix], rel=1e-12)
    assert parse(f"-1e-3{suffix}" if suffix != "e" else "-1e-3", dimension) == pytest.approx(
        -1e-3 * DEFINITIONS[suffix], rel=1e-12
    )


@pytest.mark.parametrize("dimension", UNITS)
@given(value=st.floats(allow_nan=False, allow_infinity=False))
def test_si_text_comes_back_to_the_last_bit(dimension: str, value: float) -> None:
    assert parse(f"{value!r} {UNITS[dimension][0]}", dimension) == value


@pytest.mark.parametrize("dimension", [name for name in UNITS if name != "angle"])
def test_a_bare_number_is_si(dimension: str) -> None:
    assert parse(3, dimension) == parse(3.0, dimension) == parse("3", dimension) == 3.0


@pytest.mark.parametrize("value", [45, 45.0, "45", " 45 ", 0, "0"])
def test_a_bare_angle_is_refused_and_the_remedy_named(value: object) -> None:
    with pytest.raises(ValueError, match=r"bare number.*deg.*rad"):
        parse(value, "angle")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("30 kN/m", 3e4), ("30 kN / m", 3e4), ("30kN/m", 3e4), ("120.8 kN m2", 120.8e3), ("120.8 kN·m²", 120.8e3),
        ("120.8 kN*m^2", 120.8e3), ("120.8 kN m**2", 120.8e3), ("100 kN/m³", 1e5), ("100 kN/m^3", 1e5), ("+1. m", 1.0),
        (".5 m", 0.5), ("1E3 mm", 1.0),
    ],
)  # fmt: skip
def test_spellings_of_one_unit(text: str, value: float) -> None:
    dimension = next(d for d, (_, t) in UNITS.items() if any(_same(text, s) for s in t))
    assert parse(text, dimension) == pytest.approx(value, rel=1e-14)


def _same(text: str, suffix: str) -> bool:
    squeeze = str.maketrans({"²": "2", "³": "3", "·": " ", "*": " ", "^": ""})
    plain = "".join(text.replace("**", "").translate(squeeze).split())
    return plain.lstrip("+-.0123456789").removeprefix("E3") == suffix.replace(" ", "")


@pytest.mark.parametrize(("one", "other", "dimension"), [
    ("1570 cm", "15.7 m", "length"), ("0.0281 MN", "28.1 kN", "force"), ("28100 N", "28.1 kN", "force"),
    ("110000 t", "1.1e8 kg", "mass"), ("6 min", "0.1 h", "time"), ("12 in", "1 ft", "length"), ("396 mm", "0.396 m", "length"),
])  # fmt: skip
def test_equal_quantities_are_equal_to_the_last_bit(one: str, other: str, dimension: str) -> None:
    assert parse(one, dimension) == parse(other, dimension)


@pytest.mark.parametrize("dimension", UNITS)
@pytest.mark.parametrize(
    "value",
    [
        "1 furlong", "1 M", "one m", "", "m", "1 m m m", "1,5 m", "0x10 m", "1e", "--1 m", "1 2", "inf m", "nan", "1e999 m",
        "1" * 100, math.nan, math.inf, -math.inf, True, None, [], {}, pytest.param(10**400, id="huge"),
    ],
)  # fmt: skip
def test_what_is_no_quantity_is_refused_in_a_sentence(dimension: str, value: object) -> None:
    with pytest.raises(ValueError, match=r".{10}") as caught:
        parse(value, dimension)
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize("dimension", UNITS)
def test_a_unit_of_another_dimension_is_refused_and_the_right_ones_listed(dimension: str) -> None:
    own = UNITS[dimension][1]
    foreign = next(s for _, table in UNITS.values() for s in table if s not in own)
    with pytest.raises(ValueError, match="use one of") as caught:
        parse(f"1 {foreign}", dimension)
    assert all(suffix in str(caught.value) for suffix in own)
