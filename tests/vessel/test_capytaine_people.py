"""Capytaine's files as people have them: the lowest frequencies without values, as in shallow water."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from solver.outcome import DataError
from solver.vessel.data import HydrodynamicData, read_bytes

from .synthetic import dataset, to_bytes

COMPUTED = ("added_mass", "radiation_damping", "diffraction_force")  # what Capytaine leaves NaN where kh < 0.1


def without(folder: Path, places: list[int], variables: tuple[str, ...] = COMPUTED, edges: bool = False) -> bytes:
    """The synthetic file with NaN at some of its finite frequencies."""
    made = dataset(edges=edges)
    for name in variables:
        made[name].values[np.array(places, int) + edges] = np.nan
    made = made.drop_vars("mean_drift_force")
    return to_bytes(made, folder)


def read(payload: bytes) -> HydrodynamicData:
    return read_bytes(payload, "shallow.nc")


@pytest.mark.parametrize("edges", [False, True])
@pytest.mark.parametrize("count", [1, 3, 19])
def test_the_lowest_frequencies_without_values_are_left_out_and_named(tmp_path: Path, count: int, edges: bool) -> None:
    found, whole = read(without(tmp_path, list(range(count)), edges=edges)), read(without(tmp_path, [], edges=edges))
    assert np.array_equal(found.omega, whole.omega[count:])
    assert np.array_equal(found.added_mass, whole.added_mass[count:])
    assert np.array_equal(found.damping, whole.damping[count:])
    assert np.array_equal(found.excitation, whole.excitation[count:])
    assert (found.added_mass_zero is not None) == edges
    named = ", ".join(f"{value:.4g}" for value in whole.omega[:count][:8])
    assert f"the lowest frequencies, {named}" in found.warnings[0]
    assert f"the data begin at {whole.omega[count]:.4g} rad/s" in found.warnings[0]
    assert len(found.warnings) == len(whole.warnings) + 1


@pytest.mark.parametrize("variables", [("diffraction_force",), ("added_mass", "radiation_damping")])
def test_one_kind_of_problem_that_was_not_computed_is_enough(tmp_path: Path, variables: tuple[str, ...]) -> None:
    assert read(without(tmp_path, [0, 1], variables)).omega[0] == pytest.approx(0.3)


@pytest.mark.parametrize("places", [[5], [0, 5], [19], list(range(20))])
def test_frequencies_without_values_elsewhere_are_refused_by_name(tmp_path: Path, places: list[int]) -> None:
    with pytest.raises(DataError, match=r"shallow\.nc: nothing was computed at ") as caught:
        read(without(tmp_path, places))
    assert f"{0.1 * (places[-1 if len(places) < 9 else 7] + 1):.4g}" in str(caught.value)
    assert "(NaN)" in str(caught.value)


def test_single_values_that_are_missing_are_refused_with_their_frequency(tmp_path: Path) -> None:
    made = dataset(edges=False)
    made["added_mass"].values[0, 2, 2] = np.nan
    with pytest.raises(DataError, match=r"added_mass holds 1 values that are not finite \(NaN\) at 0\.1 rad/s"):
        read(to_bytes(made, tmp_path))
    made = dataset(edges=False)
    made["diffraction_force"].values[3, 1] = np.nan  # one heading of one frequency
    with pytest.raises(DataError, match=r"holds 6 values that are not finite \(NaN\) at 0\.4 rad/s"):
        read(to_bytes(made, tmp_path))


def test_an_excitation_that_nothing_uses_may_be_without_values(tmp_path: Path) -> None:
    made = dataset(edges=False)
    made["excitation_force"] = made["diffraction_force"] * np.nan
    assert read(to_bytes(made, tmp_path)).omega.size == 20
