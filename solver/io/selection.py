"""Which channels go into an exported file, and how to get one at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from ..case.quantities import DOF
from ..outcome import CaseError, FieldError
from ..results.channel import Axis, Channel

LABELS = {"axis": ("x", "y", "z"), "dof": DOF}  # axes that number things with names
WHOLE = ("seed", "mode")  # axes of whole numbers


@dataclass(frozen=True)
class Selection:
    """Channels in the order they are written; `get` loads one, so that no more than one need be in memory.

    dims : axes of each by its name. seed : the one realisation wanted, or None for all.
    """

    dims: Mapping[str, tuple[str, ...]]
    load: Callable[[str], Channel]
    seed: int | None = None

    @property
    def names(self) -> list[str]:
        return list(self.dims)

    def get(self, name: str) -> Channel:
        """One channel, of the wanted seed. Raises CaseError when it has no such seed."""
        channel = self.load(name)
        if self.seed is None or "seed" not in channel.dims:
            return channel
        at = channel.dims.index("seed")
        values = channel.axes[at].values
        index = np.flatnonzero(values == self.seed)
        if index.size == 0:
            allowed = f"{values[0]:g} to {values[-1]:g}"
            raise CaseError(
                [FieldError(("seed",), f"there is no seed {self.seed}; allowed: {allowed}", str(self.seed))]
            )
        axes = channel.axes[:at] + channel.axes[at + 1 :]
        return replace(channel, values=np.take(channel.values, index[0], axis=at), axes=axes)

    def __iter__(self) -> Iterator[Channel]:
        return (self.get(name) for name in self.names)

    def axes(self) -> list[str]:
        """Names of all axes that occur, in the order of their first appearance."""
        found = dict.fromkeys(dim for dims in self.dims.values() for dim in dims)
        return [dim for dim in found if dim != "seed" or self.seed is None]


def select_channels(
    dims: Mapping[str, tuple[str, ...]],
    load: Callable[[str], Channel],
    patterns: Sequence[str] = (),
    seed: int | None = None,
) -> Selection:
    """The channels that match a pattern (`*` stands for anything), all without patterns.

    Raises CaseError for a pattern that matches nothing, so that a misspelt name never gives a smaller file.
    """
    kept: dict[str, tuple[str, ...]] = {} if patterns else dict(dims)
    for pattern in patterns:
        matching = {name: axes for name, axes in dims.items() if fnmatchcase(name, pattern)}
        if not matching:
            some = ", ".join(list(dims)[:6]) + (" …" if len(dims) > 6 else "")
            message = f"no channel is called {pattern[:80]!r}; there are: {some or 'none'}"
            raise CaseError([FieldError(("channels",), message, pattern[:80])])
        kept |= matching
    return Selection({name: tuple(dims[name]) for name in dims if name in kept}, load, seed)


def coordinate(axis: Axis) -> Any:
    """Values of an axis as a reader wants them: names for numbered things, whole numbers for seeds and modes."""
    labels = LABELS.get(axis.name)
    if labels is not None and len(axis.values) and float(np.max(axis.values)) < len(labels):
        return np.array([labels[int(value)] for value in axis.values])
    if axis.name in WHOLE:
        return axis.values.astype(np.int64)
    return np.asarray(axis.values, dtype=np.float64)
