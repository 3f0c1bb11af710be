"""Labelled arrays with units: what an analysis gives, what the store keeps, what the API serves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Axis:
    """One dimension of a channel: `time` [s], `omega` [rad/s], `arc_length` [m], `seed`, `mode`, `axis` (x, y, z)."""

    name: str
    unit: str
    values: Array


@dataclass(frozen=True)
class Channel:
    """One labelled array.

    name : ``{domain}/vessel/{quantity}`` or ``{domain}/line/{NAME}/{quantity}``; domain = static, frequency, time, modes.
    axes : one per dimension of `values`, outermost first.
    unit : SI text, e.g. ``m2 s/rad``.
    band : ``wf``, ``lf`` or ``total``.
    """

    name: str
    values: Array
    axes: tuple[Axis, ...]
    unit: str
    description: str
    band: str = "total"

    def __post_init__(self) -> None:
        shape = tuple(len(axis.values) for axis in self.axes)
        if self.values.shape != shape:
            raise ValueError(f"{self.name}: values have shape {self.values.shape}, axes {shape}")
        if not np.all(np.isfinite(self.values)):
            raise ValueError(f"{self.name}: not every value is finite")

    @property
    def dims(self) -> tuple[str, ...]:
        return tuple(axis.name for axis in self.axes)
