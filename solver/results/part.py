"""What one chunk of a plan gives back, as bytes that any worker can store and any other can merge."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from .channel import Axis, Channel


@dataclass(frozen=True)
class Chunk:
    """One piece of a run that a worker can do alone. `weight` is its share of the work, `seeds` its first and last + 1."""

    kind: str
    seeds: tuple[int, int] | None = None
    weight: float = 1.0

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Chunk:
        seeds = data.get("seeds")
        return cls(data["kind"], tuple(seeds) if seeds else None, data.get("weight", 1.0))


@dataclass(frozen=True)
class Progress:
    """How far a chunk is: 0 to 1, a few words, and (when it can be resumed) a way to get its checkpoint."""

    fraction: float
    message: str = ""
    checkpoint: Callable[[], bytes] | None = None


OnProgress = Callable[[Progress], None]


@dataclass(frozen=True)
class Part:
    """The outcome of one chunk: plain data for the summary, channels, and arrays that only `merge` reads."""

    summary: dict[str, Any]
    channels: tuple[Channel, ...] = ()
    arrays: dict[str, np.ndarray] = field(default_factory=dict)

    def to_bytes(self) -> bytes:
        """An .npz with one JSON header; never pickle."""
        arrays = {f"array/{name}": value for name, value in self.arrays.items()}
        header: dict[str, Any] = {"summary": self.summary, "channels": []}
        for index, channel in enumerate(self.channels):
            arrays[f"channel/{index}"] = channel.values
            axes = []
            for dim, axis in enumerate(channel.axes):
                arrays[f"channel/{index}/{dim}"] = axis.values
                axes.append([axis.name, axis.unit])
            header["channels"].append([channel.name, channel.unit, channel.description, channel.band, axes])
        arrays["header"] = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)
        buffer = io.BytesIO()
        np.savez_compressed(buffer, allow_pickle=False, **arrays)  # type: ignore[arg-type]
        return buffer.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> Part:
        with np.load(io.BytesIO(data), allow_pickle=False) as stored:
            header = json.loads(stored["header"].tobytes())
            channels = []
            for index, (name, unit, description, band, axes) in enumerate(header["channels"]):
                made = tuple(Axis(n, u, stored[f"channel/{index}/{dim}"]) for dim, (n, u) in enumerate(axes))
                channels.append(Channel(name, stored[f"channel/{index}"], made, unit, description, band))
            arrays = {key.removeprefix("array/"): stored[key] for key in stored.files if key.startswith("array/")}
        return cls(header["summary"], tuple(channels), arrays)


@dataclass(frozen=True)
class Result:
    """A finished run: the summary (docs/summary.md) and its channels."""

    summary: dict[str, Any]
    channels: tuple[Channel, ...]

    @property
    def failures(self) -> dict[str, str]:
        failures: dict[str, str] = self.summary.get("failures", {})
        return failures
