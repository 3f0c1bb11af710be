"""A view of a channel: picked, sliced and decimated on the server, so that a page never gets a whole history."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from tsdownsample import M4Downsampler

from solver.outcome import CaseError, FieldError
from solver.results.channel import Axis, Channel
from store.arrays import ChannelInfo

MAX_VALUES = 2_000_000


@dataclass(frozen=True)
class View:
    """What of a channel is wanted. `start` and `stop` are coordinates on the first axis, both included."""

    start: float | None = None
    stop: float | None = None
    points: int | None = None
    seed: int | None = None
    arc_length: float | None = None


def look(channel: Channel, view: View) -> dict[str, Any]:
    """The channel through the view, as plain data for JSON."""
    channel = _pick(channel, "seed", view.seed, exact=True)
    channel = _pick(channel, "arc_length", view.arc_length, exact=False)
    channel = _slice(channel, view.start, view.stop)
    full_size = len(channel.axes[0].values) if channel.axes else None
    channel, decimation = _decimate(channel, view.points)
    if channel.values.size > MAX_VALUES:
        message = f"{channel.values.size} values at once; allowed: {MAX_VALUES}. Give `points`, `from` and `to`"
        raise CaseError([FieldError(("points",), message)])
    return {
        "name": channel.name,
        "unit": channel.unit,
        "description": channel.description,
        "band": channel.band,
        "axes": [{"name": axis.name, "unit": axis.unit, "values": axis.values.tolist()} for axis in channel.axes],
        "values": channel.values.tolist(),
        "decimation": decimation,
        "full_size": full_size,
    }


def listing(info: ChannelInfo) -> dict[str, Any]:
    return {
        "name": info.name,
        "dims": info.dims,
        "shape": info.shape,
        "unit": info.unit,
        "axes": info.axes,
        "description": info.description,
        "band": info.band,
    }


def _pick(channel: Channel, name: str, value: float | None, exact: bool) -> Channel:
    """One position along an axis, which then is gone: the one equal or nearest to `value`."""
    if value is None:
        return channel
    if name not in channel.dims:
        raise CaseError([FieldError((name,), f"the channel has no axis {name}; it has: {', '.join(channel.dims)}")])
    dim = channel.dims.index(name)
    axis = channel.axes[dim]
    index = int(np.argmin(np.abs(axis.values - value)))
    if exact and axis.values[index] != value:
        allowed = f"{axis.values[0]:g} to {axis.values[-1]:g}"
        raise CaseError([FieldError((name,), f"there is no {name} {value:g}; allowed: {allowed}", f"{value:g}")])
    axes = channel.axes[:dim] + channel.axes[dim + 1 :]
    return replace(channel, values=np.take(channel.values, index, axis=dim), axes=axes)


def _slice(channel: Channel, start: float | None, stop: float | None) -> Channel:
    if not channel.axes or (start is None and stop is None):
        return channel
    at = channel.axes[0].values
    keep = np.ones(len(at), dtype=bool)
    if start is not None:
        keep &= at >= start
    if stop is not None:
        keep &= at <= stop
    return _take(channel, np.flatnonzero(keep))


def _take(channel: Channel, index: np.ndarray) -> Channel:
    first = channel.axes[0]
    axes = (Axis(first.name, first.unit, first.values[index]), *channel.axes[1:])
    return replace(channel, values=channel.values[index], axes=axes)


def _decimate(channel: Channel, points: int | None) -> tuple[Channel, str | None]:
    """M4 for one axis: it keeps each bin's first, last, smallest and largest, so no peak is lost. Else every n-th."""
    if points is None or not channel.axes or len(channel.axes[0].values) <= points:
        return channel, None
    size = len(channel.axes[0].values)
    if channel.values.ndim == 1:
        at = np.ascontiguousarray(channel.axes[0].values, dtype=np.float64)
        index = M4Downsampler().downsample(at, np.ascontiguousarray(channel.values), n_out=max(4, points // 4 * 4))
        return _take(channel, np.unique(index.astype(np.int64))), "m4"
    return _take(channel, np.arange(0, size, -(-size // points))), "stride"
