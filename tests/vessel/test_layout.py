"""Hydrodynamic data as NetCDF in Capytaine's layout and back: nothing is lost, and other programs read it."""

import contextlib
import dataclasses
import io
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.outcome import DataError
from solver.vessel.data import read_bytes
from solver.vessel.data.layout import dump_netcdf
from solver.vessel.data.wamit import read_wamit

from . import synthetic
from . import wamit_sets as sets

FIELDS = (
    "omega", "headings", "added_mass", "damping", "excitation", "added_mass_zero", "added_mass_infinite", "mean_drift",
    "hydrostatic_stiffness", "centre_of_mass", "reference_point", "motions", "density", "gravity", "depth",
    "drift_omega", "drift_headings", "excitation_zero", "displaced_volume", "reference_known",
)  # fmt: skip


WRITTEN = dump_netcdf(sets.whole())


def equal(a, b):
    for field in FIELDS:
        one, two = getattr(a, field), getattr(b, field)
        assert (one is None) == (two is None), field
        assert one is None or np.array_equal(one, two), field
    assert (a.qtf is None) == (b.qtf is None)
    if a.qtf is not None:
        assert np.array_equal(a.qtf.values, b.qtf.values, equal_nan=True)
        assert np.array_equal(a.qtf.omega, b.qtf.omega)
        assert a.qtf.cross.keys() == b.qtf.cross.keys()
        assert all(np.array_equal(a.qtf.cross[pair], b.qtf.cross[pair]) for pair in a.qtf.cross)


def test_everything_comes_back_bit_by_bit():
    data = read_wamit(sets.files(), sets.OPTIONS)
    back = read_bytes(dump_netcdf(data), "back.nc")
    equal(data, back)
    assert back.provenance["source"] == data.provenance
    assert back.warnings[0].startswith("back.nc: the file does not say its rotation_center")


@pytest.mark.parametrize("lacks", [("qtf", "motions"), ("mean_drift",), ("added_mass_zero",), ("added_mass_infinite",)])
def test_what_is_not_there_stays_away(lacks):
    data = sets.without(sets.whole(), *lacks)
    equal(data, read_bytes(dump_netcdf(data), "x.nc"))


def test_capytaines_own_file_comes_back(tmp_path):
    data = read_bytes(synthetic.to_bytes(synthetic.dataset(), tmp_path), "a.nc")
    equal(data, read_bytes(dump_netcdf(data), "b.nc"))


def test_xarray_reads_it_with_names_and_units():
    xarray = pytest.importorskip("xarray")
    data = sets.whole()
    dataset = xarray.open_dataset(io.BytesIO(dump_netcdf(data)), engine="scipy")
    assert dataset.added_mass.dims == ("omega", "influenced_dof", "radiating_dof")
    assert [str(name, "ascii").strip() for name in dataset.influenced_dof.values][:2] == ["Surge", "Sway"]
    assert dataset.omega.attrs["units"] == "rad/s"
    assert np.array_equal(dataset.excitation_force.values[1, 1:-1], -data.excitation.imag)


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_spoilt_files_are_refused_or_read(draw):
    spoilt = bytearray(WRITTEN)
    for _ in range(draw.draw(st.integers(1, 8))):
        spoilt[draw.draw(st.integers(0, len(spoilt) - 1))] = draw.draw(st.integers(0, 255))
    with contextlib.suppress(DataError):
        data = read_bytes(bytes(spoilt), "f.nc")
        json.dumps(data.describe(), allow_nan=False)


@pytest.mark.parametrize(
    ("name", "change", "text"),
    [
        ("qtf_omega", lambda values: values[::-1], "must rise"),
        ("qtf_direction", lambda values: values - 1.0, "from 0 to below 2π"),
        ("qtf_pair_headings", lambda values: values + 5, "two positions"),
        ("difference_qtf", lambda values: values * np.array([1, 0.5])[:, None, None, None, None] + 1.0, None),
        ("mean_drift_force", lambda values: values * np.nan, "not finite"),
    ],
)
def test_parts_that_do_not_fit_are_named(name, change, text, tmp_path):
    xarray = pytest.importorskip("xarray")
    dataset = xarray.open_dataset(io.BytesIO(WRITTEN), engine="scipy").load()
    item = dataset[name]
    dataset[name] = (item.dims, change(item.values))
    payload = bytes(dataset.to_netcdf(engine="scipy"))
    if text is None:
        assert not np.array_equal(read_bytes(payload, "f.nc").qtf.values, sets.whole().qtf.values)
    else:
        with pytest.raises(DataError, match=text):
            read_bytes(payload, "f.nc")


def test_whatever_variable_is_missing_the_file_is_refused_or_read():
    xarray = pytest.importorskip("xarray")
    data = sets.whole()
    own = {"mean_drift_omega": data.omega, "mean_drift": data.mean_drift, "mean_drift_headings": data.headings}
    payload = dump_netcdf(dataclasses.replace(data, **own))
    dataset = xarray.open_dataset(io.BytesIO(payload), engine="scipy").load()
    refused = {}
    for name in dataset.variables:
        try:
            read_bytes(bytes(dataset.drop_vars(name).to_netcdf(engine="scipy")), "f.nc")
        except DataError as error:
            refused[name] = str(error)
    for axis in ("qtf_omega", "qtf_direction", "mean_drift_direction"):
        assert refused[axis] == f"f.nc: {axis} is missing"
    assert "RAO" not in refused  # what is beside the coefficients may be absent


@pytest.mark.parametrize("turn", [-np.pi, np.pi, np.nan])
def test_headings_of_the_drift_beyond_the_turn_are_refused(turn):
    """Between -180 and 90 degrees at steps of 90 an interpolation round the circle would go astray."""
    data = sets.whole()
    own = {"mean_drift_omega": data.omega, "mean_drift": data.mean_drift[:, 1:]}
    held = dataclasses.replace(data, **own, mean_drift_headings=np.radians([0.0, 90.0, 180.0, 270.0]))
    equal(held, read_bytes(dump_netcdf(held), "f.nc"))
    spoilt = dataclasses.replace(held, mean_drift_headings=held.mean_drift_headings + turn)
    with pytest.raises(DataError, match=r"mean_drift_direction must rise.*from 0 to below 2π"):
        read_bytes(dump_netcdf(spoilt), "f.nc")
