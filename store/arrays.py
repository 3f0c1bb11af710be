"""Arrays to bytes and back, and the one interface behind which they are kept.

Values are float32, byte-shuffled (all first bytes, then all second bytes, …) and compressed with zstd at level 3;
values beyond float32's range stay float64. Axes keep float64: an evenly spaced one as start, step and size when that
gives back its exact values, any other compressed beside the values.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import zstandard

from solver.results.channel import Axis, Channel

LEVEL = 3
FLOAT32, FLOAT64 = "f4-shuffle-zstd", "f8-shuffle-zstd"
_DTYPES: dict[str, np.dtype[Any]] = {FLOAT32: np.dtype("<f4"), FLOAT64: np.dtype("<f8")}


@dataclass(frozen=True)
class ChannelInfo:
    """What is known of a channel without decoding it. `axes`: name, unit, size, first and last value of each."""

    name: str
    unit: str
    description: str
    band: str
    shape: tuple[int, ...]
    axes: tuple[dict[str, Any], ...]

    @property
    def dims(self) -> tuple[str, ...]:
        return tuple(str(axis["name"]) for axis in self.axes)


class ArrayStore(Protocol):
    """Where the channels of runs are kept; an object store can take the database's place."""

    def put(self, run_id: str, channels: Iterable[Channel]) -> None: ...

    def names(self, run_id: str) -> list[ChannelInfo]: ...

    def get(self, run_id: str, name: str) -> Channel:
        """Raises NotFoundError where the run has no such channel."""
        ...


@dataclass(frozen=True)
class Encoded:
    codec: str
    shape: tuple[int, ...]
    axes: list[dict[str, Any]]
    payload: bytes
    axes_payload: bytes


def pick_codec(values: np.ndarray) -> str:
    """float32 unless a value would overflow in it or all would vanish."""
    largest = float(np.max(np.abs(values), initial=0.0))
    return FLOAT32 if largest == 0.0 or 1e-30 < largest < 1e38 else FLOAT64


def encode_values(values: np.ndarray, codec: str) -> bytes:
    flat = np.ascontiguousarray(values, dtype=_DTYPES[codec]).reshape(-1)
    shuffled = np.ascontiguousarray(flat.view(np.uint8).reshape(flat.size, -1).T) if flat.size else flat
    return zstandard.ZstdCompressor(level=LEVEL).compress(shuffled.tobytes())


def decode_values(payload: bytes, codec: str, shape: tuple[int, ...]) -> np.ndarray:
    dtype, size = _DTYPES[codec], math.prod(shape)
    stated = zstandard.frame_content_size(payload)
    if stated not in (-1, size * dtype.itemsize):  # -1: not stated; a stated size is what would be allocated
        raise ValueError(f"a channel of shape {shape} unpacks to {stated} bytes; expected {size * dtype.itemsize}")
    raw = zstandard.ZstdDecompressor().decompress(payload, max_output_size=size * dtype.itemsize)
    if len(raw) != size * dtype.itemsize:
        raise ValueError(f"a channel of shape {shape} has {len(raw)} bytes; expected {size * dtype.itemsize}")
    planes = np.frombuffer(raw, np.uint8).reshape(dtype.itemsize, size)
    return np.ascontiguousarray(planes.T).view(dtype).reshape(shape)


def encode(channel: Channel) -> Encoded:
    codec = pick_codec(channel.values)
    axes, loose = [], []
    for axis in channel.axes:
        described, values = _encode_axis(axis)
        axes.append(described)
        loose.append(values)
    axes_payload = encode_values(np.concatenate(loose) if loose else np.empty(0), FLOAT64)
    payload = encode_values(channel.values, codec)
    return Encoded(codec, tuple(channel.values.shape), axes, payload, axes_payload)


def _encode_axis(axis: Axis) -> tuple[dict[str, Any], np.ndarray]:
    values = np.asarray(axis.values, dtype=np.float64)
    described: dict[str, Any] = {"name": axis.name, "unit": axis.unit, "size": values.size}
    if values.size:
        described |= {"first": float(values[0]), "last": float(values[-1])}
    if values.size > 1:
        for step in ((values[-1] - values[0]) / (values.size - 1), values[1] - values[0]):
            if np.array_equal(values[0] + float(step) * np.arange(values.size), values):
                return described | {"step": float(step)}, np.empty(0)
    return described, values


def decode(encoded: Encoded, name: str, unit: str, description: str, band: str) -> Channel:
    loose_size = sum(axis["size"] for axis in encoded.axes if "step" not in axis)
    loose = decode_values(encoded.axes_payload, FLOAT64, (loose_size,))
    axes = []
    for axis in encoded.axes:
        if "step" in axis:
            values = axis["first"] + axis["step"] * np.arange(axis["size"])
        else:
            values, loose = loose[: axis["size"]], loose[axis["size"] :]
        axes.append(Axis(axis["name"], axis["unit"], values))
    values = decode_values(encoded.payload, encoded.codec, encoded.shape)
    return Channel(name, values, tuple(axes), unit, description, band)
