"""What the bytes of a NetCDF file must agree in before a library opens it."""

from __future__ import annotations

import io
import struct
from pathlib import Path

import numpy as np
import pytest
from scipy.io import netcdf_file

from solver.outcome import DataError
from solver.vessel.data import read_bytes
from solver.vessel.data.container import Damaged, check_heaps, check_netcdf3
from solver.vessel.data.layout import dump_netcdf

from .synthetic import dataset, to_bytes
from .wamit_sets import whole

OWN = dump_netcdf(whole())


@pytest.fixture(scope="module")
def heaped(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return to_bytes(dataset(omega=[0.3, 0.5, 0.9]), tmp_path_factory.mktemp("data"))


def heap(payload: bytes) -> tuple[int, list[int]]:
    """Where the first global heap begins, and the heads of its objects."""
    start = payload.index(b"GCOL")
    end = start + struct.unpack_from("<Q", payload, start + 8)[0]
    at, heads = start + 16, []
    while at + 16 <= end and payload[at : at + 2] != b"\0\0":
        heads.append(at)
        at += 16 + -(-struct.unpack_from("<Q", payload, at + 8)[0] // 8) * 8
    return start, heads


def test_whole_files_pass(heaped: bytes, tmp_path: Path) -> None:
    start, heads = heap(heaped)
    assert start > 0
    assert len(heads) > 5
    check_heaps(heaped)
    check_netcdf3(OWN)
    check_netcdf3(to_bytes(dataset(omega=[0.3, 0.5]), tmp_path, "scipy"))


def small_heap(*lengths: int) -> bytearray:
    """A superblock of version 2 and one heap of 4 objects of 8 bytes, the first with the lengths given in its place."""
    stated = [*lengths, 8, 8, 8, 8][:4]
    objects = b"".join(struct.pack("<HH4xQ8x", k + 1, 0, length) for k, length in enumerate(stated))
    free = struct.pack("<HH4xQ16x", 0, 0, 32)
    body = objects + free
    return bytearray(
        b"\x89HDF\r\n\x1a\n\x02\x08\x08\x00" + b"GCOL\x01\0\0\0" + struct.pack("<Q", 16 + len(body)) + body
    )


def test_the_objects_of_a_heap_follow_each_other_to_its_end() -> None:
    check_heaps(bytes(small_heap()))
    check_heaps(bytes(small_heap(5, 1)))  # padded to eight bytes
    for lengths in ((24,), (127,), (0,), (8, 2**32), (2**63,), (8, 8, 8, 80)):
        with pytest.raises(Damaged):
            check_heaps(bytes(small_heap(*lengths)))
    short = small_heap()
    short[-32 + 8] = 24  # the free space ends before the heap does
    with pytest.raises(Damaged, match="free space"):
        check_heaps(bytes(short))
    other = small_heap()
    other[10] = 4  # lengths of four bytes: not of any library of today, left alone
    struct.pack_into("<Q", other, 20 + 16, 127)
    check_heaps(bytes(other))


@pytest.mark.parametrize("value", [2**16, 2**32, 2**63])
def test_an_object_of_a_heap_with_a_wrong_length_is_refused(heaped: bytes, value: int) -> None:
    """In such a file HDF5 2.0 may loop for ever."""
    _, heads = heap(heaped)
    damaged = bytearray(heaped)
    struct.pack_into("<Q", damaged, heads[3] + 8, value)
    with pytest.raises(
        DataError, match=r"a\.nc: the NetCDF file is damaged or truncated \(object \d+ of the global heap"
    ):
        read_bytes(bytes(damaged), "a.nc")


@pytest.mark.parametrize(("place", "value"), [(8, 2**40), (8, 8), (16, 2)])
def test_a_heap_that_does_not_close_is_refused(heaped: bytes, place: int, value: int) -> None:
    start, heads = heap(heaped)
    damaged = bytearray(heaped)
    if place == 16:
        damaged[heads[4] : heads[4] + 2] = damaged[heads[2] : heads[2] + 2]  # a number twice
    else:
        struct.pack_into("<Q", damaged, start + place, value)
    with pytest.raises(Damaged):
        check_heaps(bytes(damaged))


def test_every_byte_of_the_header_of_netcdf3_counts() -> None:
    """Wherever one is changed, the file is refused or the numbers are the same."""
    plain = read_bytes(OWN, "a.nc")
    end = OWN.index(b"omega") + 400
    for place in range(4, end):
        damaged = bytearray(OWN)
        damaged[place] ^= 4
        try:
            found = read_bytes(bytes(damaged), "a.nc")
        except DataError:
            continue
        assert np.array_equal(found.added_mass, plain.added_mass), place


@pytest.mark.parametrize("shift", [-8, -4, 4, 8])
def test_a_variable_of_netcdf3_that_begins_elsewhere_is_refused(shift: int) -> None:
    at = OWN.index(b"added_mass") + 12
    begin = OWN.index(struct.pack(">i", 6), at) + 8  # type 6, double; then bytes and offset (8 bytes)
    (offset,) = struct.unpack_from(">q", OWN, begin)
    damaged = bytearray(OWN)
    struct.pack_into(">q", damaged, begin, offset + shift)
    with pytest.raises(DataError, match=r"overlap|gap"):
        read_bytes(bytes(damaged), "a.nc")


def test_a_record_axis_is_read() -> None:
    target = io.BytesIO()
    with netcdf_file(target, "w") as file:
        file.createDimension("t", None)
        file.createDimension("x", 3)
        file.createVariable("a", "f8", ("x",))[:] = [1, 2, 3]
        file.createVariable("b", "f8", ("t", "x"))[:] = np.ones((4, 3))
        file.flush()
        payload = target.getvalue()
    check_netcdf3(payload)
    with pytest.raises(Damaged, match="records lie outside"):
        check_netcdf3(payload[:-40])


def rewritten(payload: bytes, change) -> bytes:  # type: ignore[no-untyped-def]
    """The file with one variable written again by h5py in another type."""
    import h5py

    target = io.BytesIO(payload)
    with h5py.File(target, "r+") as file:
        values, scales = file["radiation_damping"][()], [axis[0] for axis in file["radiation_damping"].dims]
        del file["radiation_damping"]
        made = change(file, values)
        for axis, scale in enumerate(scales):
            made.dims[axis].attach_scale(scale)
    return target.getvalue()


def test_two_byte_orders_in_one_file_are_refused(heaped: bytes) -> None:
    same = rewritten(heaped, lambda file, values: file.create_dataset("radiation_damping", data=values))
    assert np.array_equal(read_bytes(same, "a.nc").damping, read_bytes(heaped, "a.nc").damping)
    mixed = rewritten(heaped, lambda file, values: file.create_dataset("radiation_damping", data=values, dtype=">f8"))
    with pytest.raises(DataError, match="two byte orders"):
        read_bytes(mixed, "a.nc")


def test_an_unusual_exponent_is_refused(heaped: bytes) -> None:
    """A float64 whose exponents are counted from 767: every number would be 2^256 times too large."""
    import h5py

    def change(file, values):  # type: ignore[no-untyped-def]
        kind = h5py.h5t.IEEE_F64LE.copy()
        kind.set_ebias(767)
        space = h5py.h5s.create_simple(values.shape)
        made = h5py.h5d.create(file.id, b"radiation_damping", kind, space)
        return h5py.Dataset(made)

    with pytest.raises(DataError, match="the numbers of radiation_damping are of an unusual type"):
        read_bytes(rewritten(heaped, change), "a.nc")


def test_a_direction_that_is_there_twice_must_agree(tmp_path: Path) -> None:
    made = dataset(omega=[0.3, 0.5], headings=[0.0, 1.0, np.pi])
    twice = made.isel(wave_direction=[0, 1, 2, 2]).copy(deep=True)
    twice = twice.assign_coords(wave_direction=[0.0, 1.0, np.pi, -np.pi])
    assert read_bytes(to_bytes(twice, tmp_path), "a.nc").headings.size == 3
    twice["diffraction_force"].values[:, 3] *= 1.1
    with pytest.raises(DataError, match="wave_direction holds 180 deg twice, with different forces"):
        read_bytes(to_bytes(twice, tmp_path), "a.nc")
