"""WAMIT sets as people have them: rows in any order, one direction listed twice, empty files, wave numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solver.case.vessel import WamitFiles
from solver.outcome import DataError
from solver.vessel.data.wamit import read_wamit, write_wamit
from solver.waves.dispersion import wave_number

from . import wamit_sets as sets
from .test_quality import consistent

PARTS = sets.files()


def rows_of(name: str) -> list[str]:
    return PARTS[name].decode().splitlines()


def turned(row: str, columns: tuple[int, ...], old: float, new: float) -> str:
    """The row with angles `old` written as `new`."""
    words = row.split()
    for column in columns:
        if float(words[column]) == old:
            words[column] = f"{new:g}"
    return " ".join(words)


def also_as(name: str, columns: tuple[int, ...], old: float, new: float) -> list[str]:
    """Rows of an angle once more under another name of it."""
    return [turned(row, columns, old, new) for row in rows_of(name) if float(row.split()[columns[0]]) == old]


def read(**files: str | bytes):
    texts = {f"t.{kind[1:]}": text.encode() if isinstance(text, str) else text for kind, text in files.items()}
    return read_wamit(PARTS | texts, sets.OPTIONS)


@pytest.mark.parametrize("seed", range(3))
def test_rows_may_stand_in_any_order_with_180_listed_twice(seed: int) -> None:
    whole = read()
    rows = rows_of("t.3") + also_as("t.3", (1,), 180.0, -180.0)
    mixed = [rows[k] for k in np.random.default_rng(seed).permutation(len(rows))]
    found = read(_3="\n".join(mixed))
    assert np.array_equal(found.headings, whole.headings)
    assert np.array_equal(found.excitation, whole.excitation)


def test_only_the_periods_of_one_name_in_another_order() -> None:
    again = also_as("t.3", (1,), 180.0, -180.0)
    assert np.array_equal(read(_3="\n".join(rows_of("t.3") + again[::-1])).excitation, read().excitation)


@pytest.mark.parametrize(
    ("kind", "columns", "changed"), [("3", (1,), 5), ("8", (1, 2), 6), ("9", (1, 2), 6), ("12d", (2, 3), 7)]
)
def test_a_direction_listed_twice_must_agree(kind: str, columns: tuple[int, ...], changed: int) -> None:
    name = "t.9" if kind in ("8", "9") else f"t.{kind}"
    again = also_as(name, columns, 0.0, 360.0)
    parts = {key: value for key, value in PARTS.items() if key != "t.9"} | {f"t.{kind}": PARTS[name]}
    text = "\n".join(rows_of(name) + again[::-1])
    same = read_wamit(parts | {f"t.{kind}": text.encode()}, sets.OPTIONS)
    plain = read_wamit(parts, sets.OPTIONS)
    assert np.array_equal(same.excitation, plain.excitation)
    assert np.array_equal(same.qtf.values, plain.qtf.values, equal_nan=True)
    assert np.array_equal(same.mean_drift, plain.mean_drift)
    words = again[-1].split()
    words[changed] = f"{1.01 * float(words[changed]):.9g}"
    words[changed - 2] = f"{math.hypot(float(words[changed]), float(words[changed + 1])):.9g}"
    text = "\n".join([*rows_of(name), *again[:-1], " ".join(words)])
    with pytest.raises(DataError, match=r"headings 360.* are one direction but their values differ \(line \d+\)"):
        read_wamit(parts | {f"t.{kind}": text.encode()}, sets.OPTIONS)


def test_an_entry_that_the_other_name_lacks_is_refused() -> None:
    rows = rows_of("t.3")
    at = next(k for k, row in enumerate(rows) if float(row.split()[1]) == 180.0)
    only = turned(rows[at], (1,), 180.0, -180.0)
    rest = rows[:at] + rows[at + 1 :]
    with pytest.raises(DataError, match="heading -180 has an entry that the same direction lacks elsewhere"):
        read(_3="\n".join([*rest, only, ""]))


@pytest.mark.parametrize("kind", [".2", ".4", ".8", ".9", ".12d", ".hst"])
@pytest.mark.parametrize("content", [b"", b" \n\n"])
def test_an_optional_file_may_be_empty(kind: str, content: bytes) -> None:
    whole = read()
    found = read_wamit(PARTS | {f"t{kind}": content}, sets.OPTIONS)
    assert found.warnings[0] == f"t{kind}: the file is empty and is left out"
    assert np.array_equal(found.excitation, whole.excitation)
    assert (found.motions is None) == (kind == ".4")
    assert (found.qtf is None) == (kind == ".12d")
    assert (found.hydrostatic_stiffness is None) == (kind == ".hst")
    assert (found.mean_drift is None) == (kind == ".9")
    used = {item["name"]: item["used"] for item in found.provenance["files"]}
    assert used[f"t{kind}"] is False


def test_the_stiffness_of_an_empty_file_needs_no_centre_of_mass() -> None:
    options = sets.OPTIONS.model_copy(update={"centre_of_mass": None})
    assert read_wamit(PARTS | {"t.hst": b""}, options).hydrostatic_stiffness is None
    with pytest.raises(DataError, match="centre_of_mass"):
        read_wamit(PARTS, options)


def test_files_that_are_needed_may_not_be_empty() -> None:
    for parts, name in ((PARTS | {"t.1": b""}, "t.1"), (PARTS | {"t.3": b"\n"}, "t.3")):
        with pytest.raises(DataError, match=f"{name}: the file is empty"):
            read_wamit(parts, sets.OPTIONS)
    with pytest.raises(DataError, match=r"t\.9: the file is empty"):
        read_wamit(PARTS | {"t.9": b""}, sets.OPTIONS.model_copy(update={"drift": ".9"}))
    haskind = PARTS | {"t.2": PARTS["t.3"], "t.3": b""}
    assert np.array_equal(read_wamit(haskind, sets.OPTIONS).excitation, read().excitation)


# --- the first column


def listed(column: str, depth: float) -> tuple[dict[str, bytes], WamitFiles]:
    """A consistent body in deep or shallow water, its first column as asked."""
    data = consistent(depth, omega=np.arange(0.05, 3.01, 0.05))
    options = WamitFiles(
        length=1.0, density=data.density, gravity=data.gravity, depth=None if math.isinf(depth) else depth
    )
    texts = {name: text.decode() for name, text in write_wamit(data, "t").items() if name != "t.hst"}
    k = np.asarray(wave_number(data.omega, depth, data.gravity))
    values = {"periods": 2 * np.pi / data.omega, "frequencies": data.omega, "wave numbers": k}[column]
    if column == "periods":
        return {name: text.encode() for name, text in texts.items()}, options
    result = {}
    for name, text in texts.items():
        rows = [row.split(maxsplit=1) for row in text.splitlines()]
        inner = [(value, rest) for value, rest in rows if float(value) > 0]
        order = np.unique([float(value) for value, _ in inner])[::-1]
        place = {value: float(values[k]) for k, value in enumerate(order)}
        result[name] = "\n".join(f"{place[float(value)]:.8e} {rest}" for value, rest in inner).encode()
    return result, options


@pytest.mark.parametrize("depth", [math.inf, 60.0])
def test_wave_numbers_in_the_first_column_are_named_and_refused(depth: float) -> None:
    files, options = listed("wave numbers", depth)
    if math.isinf(depth):
        with pytest.raises(DataError, match=r"t\.3: the first column looks like wave numbers.*\(IPEROUT 3 and 4\)"):
            read_wamit(files, options)
    told = options.model_copy(update={"first_column": "frequencies"})
    insisted = read_wamit(files, told)
    assert insisted.omega.size == 60
    assert any("looks like wave numbers" in text for text in insisted.warnings) == math.isinf(depth)
    files, options = listed("frequencies", depth)
    assert np.allclose(read_wamit(files, options).omega, np.arange(0.05, 3.01, 0.05), rtol=1e-6)
    files, options = listed("periods", depth)
    assert np.allclose(read_wamit(files, options).omega, np.arange(0.05, 3.01, 0.05), rtol=1e-6)


def test_an_unclear_first_column_names_wave_numbers_too() -> None:
    files, options = listed("periods", math.inf)
    few = {name: b"\n".join(text.splitlines()[-36 * 6 :]) for name, text in files.items()}
    rows = [row for row in few["t.3"].decode().splitlines() if row]
    last = rows[-1].split()[0]
    one = {"t.3": "\n".join(row for row in rows if row.split()[0] == last).encode()}
    one["t.1"] = "\n".join(row for row in files["t.1"].decode().splitlines() if row.split()[0] == last).encode()
    with pytest.raises(DataError, match=r"give first_column: periods or frequencies; wave numbers \(IPEROUT 3 and 4\)"):
        read_wamit(one, options)
