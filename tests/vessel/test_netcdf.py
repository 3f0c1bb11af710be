"""The bytes of a file as variables: what writers do differently, what is damaged, what would fill memory or lead out."""

import io

import h5py
import numpy as np
import pytest
import xarray as xr
from scipy.io import netcdf_file

from solver.outcome import DataError
from solver.vessel.data import netcdf, read_bytes
from solver.vessel.data.netcdf import dof_order, numbers, open_netcdf, scalar, take

from . import synthetic

FIELDS = ("omega", "headings", "added_mass", "damping", "excitation", "mean_drift", "hydrostatic_stiffness")


@pytest.fixture(scope="module")
def source():
    return synthetic.dataset()


@pytest.fixture(scope="module")
def data(source, tmp_path_factory):
    return read_bytes(synthetic.to_bytes(source, tmp_path_factory.mktemp("netcdf")), "synthetic.nc")


def written(dataset, folder, engine, encoding=None):
    if engine == "netcdf4":
        pytest.importorskip("netCDF4")
    path = folder / "file.nc"
    dataset.to_netcdf(path, engine=engine, encoding=encoding)
    return path.read_bytes()


def hdf5(fill):
    """Bytes of an HDF5 file that `fill(file)` writes."""
    payload = io.BytesIO()
    with h5py.File(payload, "w") as file:
        fill(file)
    return payload.getvalue()


def opened(fill, *wanted):
    return open_netcdf(hdf5(fill), "f.nc", wanted)


# --- what writers do differently


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4", "scipy"])
def test_every_writer_gives_the_same_data(engine, data, source, tmp_path):
    if engine == "netcdf4":
        pytest.importorskip("netCDF4")
    other = read_bytes(synthetic.to_bytes(source, tmp_path, engine), "other.nc")
    for field in FIELDS:
        assert np.array_equal(getattr(other, field), getattr(data, field)), field
    assert other.excitation.dtype == complex
    assert (other.depth, other.displaced_volume, other.warnings) == (data.depth, data.displaced_volume, ())


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4", "scipy"])
def test_names_may_be_strings_or_rows_of_characters(engine, source, tmp_path):
    names = source[["added_mass"]].isel(influenced_dof=[5, 4, 3, 2, 1, 0])
    kinds = [None] if engine == "scipy" else [None, "S1", "S5"]
    for kind in kinds:
        encoding = {axis: {"dtype": kind} for axis in ("influenced_dof", "radiating_dof")} if kind else None
        found = open_netcdf(
            written(names, tmp_path, engine, encoding), "f.nc", ("added_mass", "influenced_dof", "radiating_dof")
        )
        assert found["influenced_dof"].labels == tuple(reversed(synthetic.NAMES))
        assert dof_order(found, "influenced_dof", "f.nc") == [5, 4, 3, 2, 1, 0]
        assert dof_order(found, "radiating_dof", "f.nc") == [0, 1, 2, 3, 4, 5]
        assert found["added_mass"].dims == ("omega", "influenced_dof", "radiating_dof")


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4", "scipy"])
def test_packed_and_missing_values_are_unpacked(engine, tmp_path):
    values = np.array([0.5, np.nan, 2.0])
    packed = xr.Dataset(
        {"x": ("n", values, {"units": "rad"}), "y": ("n", np.array([1, 2, 3], np.float32))}, {"n": [3, 1, 2]}
    )
    encoding = {"x": {"dtype": "int16", "scale_factor": 0.25, "add_offset": 1.0, "_FillValue": -99}}
    found = open_netcdf(written(packed, tmp_path, engine, encoding), "f.nc", ("x", "y", "n"))
    assert np.array_equal(numbers(found, "x", "f.nc"), values, equal_nan=True)
    assert (found["x"].dims, found["x"].units) == (("n",), "rad")
    assert [numbers(found, name, "f.nc").dtype for name in ("x", "y", "n")] == [np.float64] * 3


def test_a_variable_of_complex_numbers_and_an_axis_of_length_one():
    values = np.arange(6.0).reshape(2, 1, 3) * (1 - 2j)

    def fill(file):
        for name, size in (("a", 2), ("one", 1), ("b", 3)):
            file[name] = np.arange(size)
            file[name].make_scale(name)
        file["force"] = values
        for axis, name in enumerate(("a", "one", "b")):
            file["force"].dims[axis].attach_scale(file[name])

    found = take(opened(fill, "force"), "force", ("b", "a"), "f.nc")
    assert found is not None
    assert np.array_equal(found, values[:, 0].T)


def test_only_what_is_wanted_and_there_is_read():
    def fill(file):
        file["g"], file["other"] = 9.8, 1.0
        file.create_group("rho")
        file["empty"] = h5py.Empty("f")
        file.create_dataset("bare", data=np.zeros(3)).make_scale("This is a netCDF dimension but not a netCDF variable")

    found = opened(fill, "g", "rho", "bare", "absent", "empty")
    assert set(found) == {"g", "empty"}
    assert scalar(found, "g", "f.nc") == 9.8
    with pytest.raises(DataError, match="not a number"):
        scalar(found, "empty", "f.nc")


def test_text_where_numbers_should_be():
    def fill(file):
        file["rho"], file["g"], file["depth"] = "heavy", ["9.8", "9.9"], "inf"

    found = opened(fill, "rho", "g", "depth")
    assert scalar(found, "depth", "f.nc") == np.inf
    with pytest.raises(DataError, match="rho is not a number"):
        scalar(found, "rho", "f.nc")
    with pytest.raises(DataError, match="g has 2 values"):
        scalar(found, "g", "f.nc")


# --- what is refused


def test_a_file_that_would_fill_the_memory_is_refused_before_it_is_read(monkeypatch):
    def wide(file):
        file.create_dataset("omega", (2**17, 2**10), "f8", chunks=(256, 256), compression="gzip")

    def one_chunk(file):
        file.create_dataset("omega", (1,), "f8", maxshape=(None,), chunks=(2**27,), compression="gzip")

    for bomb in (wide, one_chunk):
        with pytest.raises(DataError, match=r"f\.nc: the file expands to 1024 MB; allowed: at most 256 MB"):
            opened(bomb, "omega")
    old = io.BytesIO()
    with netcdf_file(old, "w") as file:
        file.createDimension("n", 1000)
        file.createVariable("omega", "d", ("n",))[:] = 0.0
        file.flush()
        payload = old.getvalue()
    monkeypatch.setattr(netcdf, "MAX_EXPANDED", 7999)
    with pytest.raises(DataError, match="expands"):
        open_netcdf(payload, "f.nc", ("omega",))


def test_long_texts_are_cut_short():
    def fill(file):
        file.create_dataset("radiating_dof", (2_000_000,), h5py.string_dtype(), chunks=(1000,), fillvalue="Surge")

    found = opened(fill, "radiating_dof")
    assert found["radiating_dof"].labels == ("Surge",) * netcdf.MAX_LABELS
    with pytest.raises(DataError, match="expected one body"):
        dof_order(found, "radiating_dof", "f.nc")


def test_nothing_outside_the_file_is_opened(tmp_path):
    secret = tmp_path / "secret.h5"
    with h5py.File(secret, "w") as file:
        file["omega"] = np.arange(3.0)

    def external_link(file):
        file["omega"] = h5py.ExternalLink(str(secret), "omega")

    def soft_link(file):
        file["omega"] = h5py.SoftLink("/nowhere")

    def external_storage(file):
        file.create_dataset("omega", (4,), "u1", external=[(str(secret), 0, 4)])

    def virtual(file):
        layout = h5py.VirtualLayout((3,), "f8")
        layout[:] = h5py.VirtualSource(str(secret), "omega", (3,))
        file.create_virtual_dataset("omega", layout)

    for trick in (external_link, soft_link, external_storage, virtual):
        with pytest.raises(DataError, match=r"^f\.nc: omega does not hold its values in this file"):
            opened(trick, "omega")


def test_plain_hdf5_without_axes_is_refused_with_what_it_lacks(source):
    def fill(file):
        for name in ("omega", "wave_direction", "added_mass", "radiation_damping"):
            file[name] = source[name].values
        for name in ("influenced_dof", "radiating_dof"):
            file[name] = synthetic.NAMES

    with pytest.raises(DataError, match=r"added_mass has the axes \(axis 0, axis 1, axis 2\)"):
        read_bytes(hdf5(fill), "f.nc")


def test_the_axis_of_real_and_imaginary_parts_is_checked(source, tmp_path):
    parts = source[["added_mass"]].expand_dims(complex=["re", "im"])
    wanted = ("added_mass", "complex")
    dims = ("omega", "influenced_dof", "radiating_dof")
    turned = open_netcdf(written(parts.isel(complex=[1, 0]), tmp_path, "h5netcdf"), "f.nc", wanted)
    values = take(turned, "added_mass", dims, "f.nc")
    assert values is not None
    assert np.array_equal(values, source.added_mass.values * (1 + 1j))
    for spoilt, word in (
        (parts.assign_coords(complex=["re", "re"]), "labelled"),
        (parts.isel(complex=[0]), "1 entries"),
    ):
        found = open_netcdf(written(spoilt, tmp_path, "h5netcdf"), "f.nc", wanted)
        with pytest.raises(DataError, match=word):
            take(found, "added_mass", dims, "f.nc")


def test_damaged_bytes_of_either_kind_never_give_another_error(source, tmp_path):
    rng = np.random.default_rng(11)
    for engine in ("h5netcdf", "scipy"):
        payload = synthetic.to_bytes(source, tmp_path, engine)
        for place in rng.integers(4, len(payload), 40):
            for spoilt in (payload[:place], payload[:place] + rng.bytes(64) + payload[place + 64 :]):
                said = "f.nc: "
                try:
                    read_bytes(spoilt, "f.nc")
                except DataError as error:
                    said = str(error)
                assert said.startswith("f.nc: ")
                assert "\n" not in said
