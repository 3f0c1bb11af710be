"""Results as NetCDF 4, which is HDF5: a channel's name is its path (docs/export.md)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import IO, Any

import numpy as np

from ..results.channel import Axis, Channel
from .selection import Selection, coordinate

LONG_NAMES = {
    "time": "time since the end of the build-up",
    "seed": "seed of the realisation",
    "omega": "angular frequency",
    "arc_length": "unstretched arc length from end a",
    "axis": "earth axis",
    "dof": "degree of freedom of the vessel",
    "mode": "number of the mode, longest period first",
    "tension_range": "range of a rainflow cycle, middle of its bin",
}
TEXTS = ("case", "summary")  # whole documents: variables of the file, for attributes end at 64 kB


def write_netcdf(target: IO[bytes], selection: Selection, about: Mapping[str, Any]) -> None:
    """Write channels into an open binary file, one at a time.

    about : attributes of the file (docs/export.md); `case` and `summary` become variables of text.
    """
    import h5netcdf

    with h5netcdf.File(target, "w") as file:
        for key, value in about.items():
            if key in TEXTS:
                _text(file, key, str(value))
            elif value is not None:
                file.attrs[key] = value
        for channel in selection:
            _channel(file, channel)


def _text(file: Any, name: str, text: str) -> None:
    import h5py

    variable = file.create_variable(name, (), dtype=h5py.string_dtype())
    variable[...] = text
    variable.attrs["long_name"] = {"case": "the case, YAML", "summary": "the summary, JSON (docs/summary.md)"}[name]


def _channel(file: Any, channel: Channel) -> None:
    path, _, name = channel.name.rpartition("/")
    group = file[path] if path in file else file.create_group(path)
    dims = tuple(_dimension(group, axis) for axis in channel.axes)
    values = np.asarray(channel.values)
    packed = {"compression": "gzip", "compression_opts": 4, "shuffle": True} if values.size > 64 else {}
    variable = group.create_variable(name, dims, dtype=values.dtype, data=values, **packed)
    variable.attrs["units"] = channel.unit or "1"
    variable.attrs["long_name"] = channel.description
    variable.attrs["band"] = channel.band


def _dimension(group: Any, axis: Axis) -> str:
    """The group's dimension of these very coordinates; `NAME_SIZE` where NAME is taken by others."""
    values = coordinate(axis)
    name, count = axis.name, 1
    while name in group.variables:
        there = group.variables[name][...]
        if len(there) == len(values) and np.array_equal(np.asarray(there, dtype=values.dtype), values):
            return name
        name = f"{axis.name}_{len(values)}" + ("" if count == 1 else f"_{count}")
        count += 1
    group.dimensions[name] = len(values)
    if values.dtype.kind == "U":
        import h5py

        variable = group.create_variable(name, (name,), dtype=h5py.string_dtype())
        variable[...] = values.astype(object)
    else:
        variable = group.create_variable(name, (name,), dtype=values.dtype, data=values)
        variable.attrs["units"] = axis.unit or "1"
    variable.attrs["long_name"] = LONG_NAMES.get(axis.name, axis.name)
    return name
