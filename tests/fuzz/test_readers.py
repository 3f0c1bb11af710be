"""Every reader against files with flipped bytes: none hangs, dies, or reads other numbers without a word.

500 mutants of each reader; SLOWDRIFT_FUZZ_MUTANTS sets another number, such as 20000 for a long run.
"""

from __future__ import annotations

import os

import numpy as np
import pytest

from .harness import fuzz
from .mutants import difference, mutate, outcome, panels_differ
from .subjects import SUBJECTS, subject

MUTANTS = int(os.environ.get("SLOWDRIFT_FUZZ_MUTANTS", "500"))
SEED = int(os.environ.get("SLOWDRIFT_FUZZ_SEED", "20"))
GUARDED = (
    "hdf5",
    "hdf5-old",
)  # HDF5 itself may loop or abort in a damaged file; services open such files in a child process


@pytest.mark.slow
@pytest.mark.parametrize("reader", SUBJECTS)
def test_flipped_bytes(reader: str) -> None:
    tally = fuzz(reader, SEED, MUTANTS)
    stopped = (
        {number for number, said in tally.bad.items() if said.startswith(("hung", "died"))}
        if reader in GUARDED
        else set()
    )
    bad = {number: said for number, said in tally.bad.items() if number not in stopped}
    made = subject(reader)
    assert not bad, [(number, said, mutate(made, SEED, number)[2]) for number, said in list(bad.items())[:5]]
    assert sum(tally.counts.values()) == MUTANTS
    assert tally.counts["refused"] > 0
    assert len(stopped) <= 0.02 * MUTANTS
    print(reader, dict(tally.counts))  # noqa: T201


def test_a_child_that_hangs_dies_or_reads_wrongly_is_found_out() -> None:
    tally = fuzz("none", 0, 8, "tests.fuzz.faulty_child", limit=1.0)
    assert sorted(tally.bad) == [2, 4, 6]
    assert tally.bad[2].startswith("hung")
    assert tally.bad[4] == "died: exit status -6"
    assert tally.bad[6].startswith("other numbers")
    assert tally.counts["refused"] == 5


def test_a_child_that_never_starts_is_an_error() -> None:
    with pytest.raises(RuntimeError, match="before its first mutant"):
        fuzz("no such reader", 0, 3)


@pytest.mark.parametrize("reader", ["netcdf3-own", "wamit", "gdf", "deck"])
def test_mutants_are_the_same_for_the_same_number(reader: str) -> None:
    made = subject(reader)
    first, again = mutate(made, 3, 5), mutate(made, 3, 5)
    assert first == again
    assert first[0] != made.files
    assert outcome(made, made.read(made.files), made.files, 0) == "same"


def test_what_counts_as_other_numbers() -> None:
    whole = {"omega": np.array([1.0, 2.0, 3.0]), "added_mass": np.arange(12.0).reshape(3, 4)}
    assert difference(whole, whole, 2) == "same"
    one = {**whole, "added_mass": whole["added_mass"] + np.eye(3, 4)[[0, 0, 0]] * [[1], [0], [0]]}
    assert difference(whole, one, 2) == "entries"
    shifted = {**whole, "added_mass": np.roll(whole["added_mass"], 1)}
    assert difference(whole, shifted, 2).startswith("other numbers: 12 entries")
    fewer = {"omega": whole["omega"][:2], "added_mass": whole["added_mass"][:2]}
    assert difference(whole, fewer, 2).startswith("other numbers: omega has shape (2,)")
    moved = {"omega": np.array([1.0, 3.0, 9.0]), "added_mass": whole["added_mass"][[0, 2, 1]]}  # 2 became 9
    assert difference(whole, moved, 2) == "entries"


def test_what_counts_as_other_panels() -> None:
    panels = np.array(
        [[[x, y, 0.0], [x + 1, y, 0.0], [x + 1, y + 1, 0.0], [x, y + 1, 0.0]] for x in range(3) for y in range(2)]
    )
    assert panels_differ(panels, panels, 2, False) == "same"
    moved = panels.copy()
    moved[(panels == [1.0, 1.0, 0.0]).all(axis=2)] = [1.1, 1.0, 0.0]  # shared by four panels
    assert panels_differ(panels, moved, 2, False) == "entries"
    assert panels_differ(panels, np.delete(panels, 2, axis=0), 2, False).startswith("other numbers: 1 panels are lost")
    assert panels_differ(panels, panels * [2.0, 1.0, 1.0], 2, False).startswith("other numbers")
