"""Values to bytes and back without pickle: JSON for the structure, raw bytes for arrays.

A child process that reads a hostile file may be taken over by it, so its answer is read as data only: JSON, bytes,
arrays of plain numbers, and the few classes of TYPES, which check their own fields.
"""

from __future__ import annotations

import dataclasses
import json
import math
import struct
from collections.abc import Mapping
from importlib import import_module
from typing import IO, Any

import numpy as np

TYPES = {
    "FieldError": "solver.outcome",
    "HydrodynamicData": "solver.vessel.data.hydrodynamics",
    "QTF": "solver.vessel.data.qtf",
    "WamitFiles": "solver.case.vessel",
    "HydrodynamicJob": "solver.bem.spec",
    "Hull": "solver.bem.geometry",
    "Panels": "solver.bem.panels",
}
"""Classes that may travel (dataclasses and pydantic models), with their modules."""

MAX_HEADER = 256 * 2**20
_HEAD = struct.Struct("<QQ")
_MARK = "$"
_KINDS = "biufc"


class PlainError(ValueError):
    """Bytes that are no encoded value."""


def write(target: IO[bytes], value: Any) -> None:
    """One value at the end of the file. Raises TypeError for what has no plain form."""
    blobs: list[Any] = []
    header = json.dumps(_packed(value, blobs)).encode()
    target.write(_HEAD.pack(len(header), len(blobs)))
    target.write(header)
    for blob in blobs:
        target.write(struct.pack("<Q", blob.nbytes))
        target.write(blob)


def read(source: IO[bytes], limit: int) -> Any:
    """The next value, of `limit` bytes at most; raises EOFError at the end of the file and PlainError for other bytes."""
    head = source.read(_HEAD.size)
    if not head:
        raise EOFError
    try:
        size, count = _HEAD.unpack(head)
        header = json.loads(_exactly(source, size, min(limit, MAX_HEADER)))
        blobs = []
        for _ in range(count):
            (size,) = struct.unpack("<Q", _exactly(source, 8, 8))
            blobs.append(_exactly(source, size, limit))
            limit -= size
        return _unpacked(header, blobs)
    except PlainError:
        raise
    except Exception as error:  # whatever bytes of anybody bring, from json, NumPy or the classes of TYPES
        raise PlainError(f"{type(error).__name__}: {error}"[:300]) from None


def _exactly(source: IO[bytes], size: int, limit: int) -> bytes:
    if size > limit:
        raise PlainError(f"{size} bytes; allowed: at most {limit}")
    content = source.read(size)
    if len(content) != size:
        raise PlainError("the bytes end too early")
    return content


def _packed(value: Any, blobs: list[Any]) -> Any:
    if value is None or isinstance(value, bool | int | float | str):
        return value if not isinstance(value, np.generic) else value.item()
    if isinstance(value, np.generic):
        return _packed(value.item(), blobs)
    if isinstance(value, bytes | bytearray | memoryview):
        blobs.append(memoryview(value).cast("B"))
        return {_MARK: "bytes", "at": len(blobs) - 1}
    if isinstance(value, np.ndarray):
        return _packed_array(value, blobs)
    if isinstance(value, list):
        return [_packed(item, blobs) for item in value]
    if isinstance(value, tuple):
        return {_MARK: "tuple", "items": [_packed(item, blobs) for item in value]}
    if isinstance(value, Mapping):
        if all(isinstance(key, str) for key in value) and _MARK not in value:
            return {key: _packed(item, blobs) for key, item in value.items()}
        return {_MARK: "map", "items": [[_packed(key, blobs), _packed(item, blobs)] for key, item in value.items()]}
    return {_MARK: type(value).__name__, "fields": _packed(_fields(value), blobs)}


def _packed_array(value: np.ndarray, blobs: list[Any]) -> Any:
    if value.dtype.kind not in _KINDS:
        raise TypeError(f"an array of {value.dtype} has no plain form")
    flat = np.ascontiguousarray(value)
    blobs.append(flat.reshape(-1).view(np.uint8).data)
    return {_MARK: "array", "at": len(blobs) - 1, "dtype": value.dtype.str, "shape": list(value.shape)}


def _fields(value: Any) -> dict[str, Any]:
    if TYPES.get(type(value).__name__) != type(value).__module__:
        raise TypeError(f"{type(value).__name__} has no plain form (store/isolation/plain.py)")
    if dataclasses.is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value) if field.init}
    made: dict[str, Any] = value.model_dump(mode="json", exclude_unset=True)
    return made


def _unpacked(value: Any, blobs: list[bytes]) -> Any:
    if isinstance(value, list):
        return [_unpacked(item, blobs) for item in value]
    if not isinstance(value, dict):
        return value
    kind = value.get(_MARK)
    if kind is None:
        return {key: _unpacked(item, blobs) for key, item in value.items()}
    if kind == "bytes":
        return blobs[value["at"]]
    if kind == "array":
        return _unpacked_array(value, blobs)
    if kind == "tuple":
        return tuple(_unpacked(item, blobs) for item in value["items"])
    if kind == "map":
        return {_unpacked(key, blobs): _unpacked(item, blobs) for key, item in value["items"]}
    if kind not in TYPES:
        raise PlainError(f"no such type: {str(kind)[:50]}")
    made: Any = getattr(import_module(TYPES[kind]), kind)
    fields = _unpacked(value["fields"], blobs)
    return made.model_validate(fields) if hasattr(made, "model_validate") else made(**fields)


def _unpacked_array(value: Any, blobs: list[bytes]) -> np.ndarray:
    dtype = np.dtype(str(value["dtype"]))
    shape = [int(size) for size in value["shape"]]
    content = blobs[value["at"]]
    if dtype.kind not in _KINDS or min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != len(content):
        raise PlainError("an array whose bytes are not those of its type and shape")
    return np.frombuffer(content, dtype).reshape(shape).copy()
