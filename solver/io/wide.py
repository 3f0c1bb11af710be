"""Channels as tables with a column for each channel and seed, one table for each set of axes (docs/export.md)."""

from __future__ import annotations

import csv
from collections import Counter
from dataclasses import dataclass, field
from io import TextIOWrapper
from itertools import product
from typing import IO, Any

import numpy as np

from ..results.channel import Axis, Channel
from .selection import Selection, coordinate
from .table import BLOCK, same_axes, text_of

ACROSS = ("seed", "axis", "dof")  # axes whose values are columns, unless they are a channel's first axis


@dataclass
class WideTable:
    """rows : axes whose points are the rows. columns : headers and their values, in the order of the points."""

    rows: tuple[Axis, ...]
    channels: list[str] = field(default_factory=list)
    columns: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return "-".join(axis.name for axis in self.rows) or "values"

    @property
    def line(self) -> str:
        """The line all columns belong to; '' where they are of several, or of none."""
        owners = {name.split("/")[2] if name.split("/")[1] == "line" else "" for name in self.channels}
        return owners.pop() if len(owners) == 1 else ""

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(axis.values) for axis in self.rows)


def wide_tables(selection: Selection) -> dict[str, WideTable]:
    """Tables by the ending of their files' names: '' for the only one."""
    tables: list[WideTable] = []
    for channel in selection:
        across = [place for place, axis in enumerate(channel.axes) if place and axis.name in ACROSS]
        rows = tuple(axis for place, axis in enumerate(channel.axes) if place not in across)
        table = next((one for one in tables if same_axes(one.rows, rows)), None)
        if table is None:
            table = WideTable(rows)
            tables.append(table)
        table.channels.append(channel.name)
        _add(table, channel, across)
    return {"": tables[0]} if len(tables) == 1 else _named(tables)


def _add(table: WideTable, channel: Channel, across: list[int]) -> None:
    axes = [channel.axes[place] for place in across]
    values: Any = np.moveaxis(channel.values, across, range(-len(across), 0)) if across else channel.values
    values = values.reshape(-1, *(len(axis.values) for axis in axes))
    labels = [[_label(axis.name, value) for value in coordinate(axis)] for axis in axes]
    for index in product(*(range(len(axis.values)) for axis in axes)):
        said = [of_axis[place] for of_axis, place in zip(labels, index, strict=True)]
        table.columns[", ".join([channel.name, *said]) + f" [{channel.unit}]"] = values[:, *index]


def _label(axis: str, value: object) -> str:
    return f"seed {value}" if axis == "seed" else str(value)


def _named(tables: list[WideTable]) -> dict[str, WideTable]:
    """By axes; where several have these, with the line they are of; then with their sizes; then numbered."""
    names = [table.name for table in tables]
    for more in (lambda table: table.line and f"-{table.line}", lambda table: "_" + "x".join(map(str, table.shape))):
        times = Counter(names)
        names = [
            name + more(table) if times[name] > 1 else name for name, table in zip(names, tables, strict=True)
        ]  # fmt: skip
    named: dict[str, WideTable] = {}
    for name, table in zip(names, tables, strict=True):
        count, own = 1, name
        while own in named:
            count += 1
            own = f"{name}_{count}"
        named[own] = table
    return named


def write_table(target: IO[bytes], table: WideTable) -> None:
    """Write one table as CSV into an open binary file, UTF-8, some rows at a time."""
    text = TextIOWrapper(target, encoding="utf-8", newline="", write_through=False)
    try:
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([*(f"{a.name} [{a.unit}]" if a.unit else a.name for a in table.rows), *table.columns])
        points = [coordinate(axis) for axis in table.rows]
        count = int(np.prod(table.shape))
        step = max(BLOCK // max(len(table.columns), 1), 1)
        for start in range(0, count, step):
            stop = min(start + step, count)
            at = np.unravel_index(np.arange(start, stop), table.shape) if points else ()
            axes = [values[place].tolist() for values, place in zip(points, at, strict=True)]
            writer.writerows(zip(*axes, *(text_of(v[start:stop]) for v in table.columns.values()), strict=True))
        text.flush()
    finally:
        text.detach()
