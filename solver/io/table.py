"""Results as one table, for spreadsheets and data frames: CSV and Parquet (docs/export.md).

Long: a row per value with `channel`, `unit`, a column per axis (empty where a channel has no such axis) and `value`.
Wide: a row per point of the axes and a column per channel, for channels on the same axes.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping
from io import TextIOWrapper
from typing import IO, Any

import numpy as np

from ..outcome import CaseError, FieldError
from ..results.channel import Axis, Channel
from .selection import LABELS, WHOLE, Selection, coordinate

BLOCK = 100_000  # rows made at once
MAX_WIDE = 20_000_000  # values of a wide table, which is in memory as a whole
NO_PARQUET = "Parquet needs pyarrow, which is not installed here (pip install 'slowdrift[parquet]'); use netcdf or csv"


def write_csv(target: IO[bytes], selection: Selection, wide: bool = False) -> None:
    """Write channels into an open binary file, UTF-8. Raises CaseError when they do not fit one wide table."""
    text = TextIOWrapper(target, encoding="utf-8", newline="", write_through=False)
    try:
        (_wide if wide else _long)(csv.writer(text, lineterminator="\n"), selection)
        text.flush()
    finally:
        text.detach()


def _long(writer: Any, selection: Selection) -> None:
    axes = selection.axes()
    writer.writerow(["channel", "unit", *axes, "value"])
    for channel in selection:
        for columns, values in _blocks(channel):
            shown = [columns[axis] if axis in columns else [""] * len(values) for axis in axes]
            name, unit = [channel.name] * len(values), [channel.unit] * len(values)
            writer.writerows(zip(name, unit, *shown, text_of(values), strict=True))


def _blocks(channel: Channel) -> Iterator[tuple[dict[str, list[Any]], np.ndarray]]:
    """Rows of the long table: columns of the axes by name, and the values."""
    flat, shape = channel.values.reshape(-1), channel.values.shape
    coordinates = [coordinate(axis) for axis in channel.axes]
    for start in range(0, flat.size, BLOCK):
        rows = np.arange(start, min(start + BLOCK, flat.size))
        places = np.unravel_index(rows, shape) if shape else ()
        columns = {
            axis.name: values[place].tolist()
            for axis, values, place in zip(channel.axes, coordinates, places, strict=True)
        }
        yield columns, flat[rows]


def text_of(values: np.ndarray) -> list[str]:
    """Shortest decimals that give back the same number."""
    return (
        [str(value) for value in values] if values.dtype == np.float32 else [repr(value) for value in values.tolist()]
    )


def _wide(writer: Any, selection: Selection) -> None:
    channels: list[Channel] = []
    size = 0
    for channel in selection:
        size += channel.values.size
        if size > MAX_WIDE:
            message = (
                f"more than {MAX_WIDE} values in one wide table; choose fewer channels or one seed, or take layout long"
            )
            raise CaseError([FieldError(("layout",), message, "wide")])
        if channels and not same_axes(channels[0].axes, channel.axes):
            message = (
                f"{channel.name} is not on the axes of {channels[0].name} ({', '.join(channels[0].dims)}); "
                "a wide table needs the same axes: choose other channels, or take layout long"
            )
            raise CaseError([FieldError(("layout",), message, "wide")])
        channels.append(channel)
    if not channels:
        raise CaseError([FieldError(("channels",), "there are no channels to write")])
    head = [f"{axis.name} [{axis.unit}]" if axis.unit else axis.name for axis in channels[0].axes]
    writer.writerow([*head, *(f"{channel.name} [{channel.unit}]" for channel in channels)])
    streams = [_blocks(channel) for channel in channels]
    for parts in zip(*streams, strict=True):
        writer.writerows(zip(*parts[0][0].values(), *(text_of(values) for _, values in parts), strict=True))


def same_axes(one: tuple[Axis, ...], two: tuple[Axis, ...]) -> bool:
    return len(one) == len(two) and all(
        a.name == b.name and np.array_equal(a.values, b.values) for a, b in zip(one, two, strict=True)
    )


def write_parquet(target: IO[bytes], selection: Selection, about: Mapping[str, Any]) -> None:
    """The long table as Parquet, a row group per block of a channel; `about` goes into the file's metadata."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise CaseError([FieldError(("format",), NO_PARQUET, "parquet")]) from None

    axes = selection.axes()
    kinds = {name: pa.string() for name in LABELS} | {name: pa.int64() for name in WHOLE}
    fields = [
        ("channel", pa.string()),
        ("unit", pa.string()),
        *((axis, kinds.get(axis, pa.float64())) for axis in axes),
    ]
    metadata = {key: value if isinstance(value, str) else json.dumps(value) for key, value in about.items()}
    schema = pa.schema([*fields, ("value", pa.float64())], metadata=metadata)
    with pq.ParquetWriter(target, schema, compression="zstd", use_dictionary=["channel", "unit", *axes]) as writer:
        for channel in selection:
            for columns, values in _blocks(channel):
                n = len(values)
                arrays = [pa.array([channel.name] * n), pa.array([channel.unit] * n)]
                arrays += [pa.array(columns.get(axis, [None] * n), type=schema.field(axis).type) for axis in axes]
                arrays.append(pa.array(values.astype(np.float64)))
                writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
