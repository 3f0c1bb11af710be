"""Checks of the bytes of a NetCDF file before a library opens it: what the formats state twice must agree.

HDF5 has checksums over most of its structure but none over global heaps (File Format Specification, III.E), and
the library may loop for ever in a damaged one. NetCDF 3 has none at all, and a wrong offset in its header would give shifted
numbers (The NetCDF Classic Format Specification).
"""

from __future__ import annotations

import struct
from math import prod

HEAP, HEAP_HEAD, OBJECT_HEAD = b"GCOL", 16, 16
_BYTES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 4, 6: 8, 7: 1, 8: 2, 9: 4, 10: 8, 11: 8}  # of NetCDF 3's types
_DIMENSIONS, _VARIABLES, _ATTRIBUTES = 10, 11, 12
MOST = 100_000  # entries of a list


class Damaged(Exception):
    """What does not fit, as part of a sentence."""


def check_heaps(payload: bytes) -> None:
    """Every global heap of an HDF5 file: its objects follow each other to its end. Raises Damaged.

    Offsets and lengths of eight bytes, as every library of today writes them; other files are left alone.
    """
    if len(payload) < 16 or payload[9 if payload[8] >= 2 else 13 : 11 if payload[8] >= 2 else 15] != b"\x08\x08":
        return
    at = payload.find(HEAP)
    while at >= 0:
        if payload[at + 4 : at + 8] == b"\x01\0\0\0":
            _walk_heap(payload, at)
        at = payload.find(HEAP, at + 4)


def _walk_heap(payload: bytes, start: int) -> None:
    if start + HEAP_HEAD > len(payload):
        return
    (size,) = struct.unpack_from("<Q", payload, start + 8)
    end, at, seen = start + size, start + HEAP_HEAD, set()
    if not HEAP_HEAD <= size <= len(payload) - start:
        raise Damaged(f"the global heap at byte {start} claims {size} bytes")
    while at + OBJECT_HEAD <= end:
        index, _, length = struct.unpack_from("<HH4xQ", payload, at)
        if index == 0:  # free space to the end, its head counted in its length
            if length != end - at:
                raise Damaged(f"the free space of the global heap at byte {start} does not reach to its end")
            return
        if index in seen:
            raise Damaged(f"the global heap at byte {start} holds object {index} twice")
        seen.add(index)
        at += OBJECT_HEAD + -(-length // 8) * 8
        if at > end:
            raise Damaged(f"object {index} of the global heap at byte {start} is longer than the heap")


def check_netcdf3(payload: bytes) -> None:
    """The header of a NetCDF 3 file: sizes fit shapes, and variables lie one after the other. Raises Damaged."""
    header = _Header(payload)
    header.read()


class _Header:
    """A reader of the header, field after field. wide : 8 bytes for offsets (version 2) and for counts (version 5)."""

    def __init__(self, payload: bytes):
        self.payload, self.at = payload, 4
        self.version = payload[3] if len(payload) > 3 else 0
        if self.version not in (1, 2, 5):
            raise Damaged(f"version {self.version} of NetCDF 3 is not known")

    def read(self) -> None:
        records = self._number(self.version == 5)
        lengths = [self._dimension() for _ in range(self._list(_DIMENSIONS))]
        self._attributes()
        places = [self._variable(lengths) for _ in range(self._list(_VARIABLES))]
        if 0 in lengths and any(record for _, _, record in places):
            self._check_records(places, records)
        self._check_order([(begin, size) for begin, size, record in places if not record])

    def _check_order(self, places: list[tuple[int, int]]) -> None:
        end = self.at
        for begin, size in sorted(places):
            if begin < end or begin + size > len(self.payload) + 3:
                raise Damaged("the variables overlap, or lie outside the file")
            if begin - end > 3 and end != self.at:
                raise Damaged("there is a gap between the variables")
            end = begin + size

    def _check_records(self, places: list[tuple[int, int, bool]], records: int) -> None:
        begins = [begin for begin, _, record in places if record]
        size = sum(size for _, size, record in places if record)
        if min(begins) < self.at or (records < 2**32 - 1 and min(begins) + records * size > len(self.payload) + 3):
            raise Damaged(f"{records} records lie outside the file")

    def _dimension(self) -> int:
        self._name()
        return self._number(self.version == 5)

    def _variable(self, lengths: list[int]) -> tuple[int, int, bool]:
        """Offset, padded size, and whether it has records."""
        name = self._name()
        dims = [self._number(self.version == 5) for _ in range(self._count())]
        self._attributes()
        kind, size = self._number(False), self._number(self.version == 5)
        begin = self._number(self.version != 1)
        if kind not in _BYTES or any(dim >= len(lengths) for dim in dims):
            raise Damaged(f"the type or the axes of variable {name[:40]!r} are not known")
        shape = [lengths[dim] for dim in dims]
        record = bool(shape) and shape[0] == 0
        wanted = -(-prod(shape[record:]) * _BYTES[kind] // 4) * 4
        if size not in (wanted, prod(shape[record:]) * _BYTES[kind]) and size != 2**32 - 1:
            raise Damaged(f"variable {name[:40]!r} states {size} bytes, its axes give {wanted}")
        return begin, wanted, record

    def _attributes(self) -> None:
        for _ in range(self._list(_ATTRIBUTES)):
            name, kind = self._name(), self._number(False)
            if kind not in _BYTES:
                raise Damaged(f"the type of attribute {name[:40]!r} is not known")
            self._skip(self._count() * _BYTES[kind])

    def _list(self, tag: int) -> int:
        found, count = self._number(False), self._count()
        if found not in (0, tag) or (found == 0 and count):
            raise Damaged(f"a list begins with {found} where {tag} is expected")
        return count

    def _count(self) -> int:
        count = self._number(self.version == 5)
        if count > MOST and count > len(self.payload):
            raise Damaged(f"a list of {count} entries is longer than the file")
        return count

    def _name(self) -> str:
        length = self._count()
        start = self.at
        self._skip(length)
        return self.payload[start : start + length].decode("utf-8", "replace")

    def _skip(self, length: int) -> None:
        """Over so many bytes and their padding, which is zero."""
        padding = self.payload[self.at + length : self.at + -(-length // 4) * 4]
        self.at += -(-length // 4) * 4
        if self.at > len(self.payload) or any(padding):
            raise Damaged("the header is cut off, or its padding is not zero")

    def _number(self, wide: bool) -> int:
        size = 8 if wide else 4
        if self.at + size > len(self.payload):
            raise Damaged("the header is cut off")
        value = int.from_bytes(self.payload[self.at : self.at + size], "big")
        self.at += size
        return value
