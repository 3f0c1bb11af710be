"""Opening a NetCDF file from bytes and taking labelled arrays out of it, every fault a DataError.

NetCDF 4 is read with h5py, NetCDF 3 with SciPy, both loaded when a file asks for them. Of the CF conventions: missing
values, scale and offset, and text as strings or as rows of characters.
"""

from __future__ import annotations

import io
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import islice, pairwise, product
from math import prod
from typing import Any

import numpy as np

from ...case.quantities import DOF
from ...outcome import DataError
from .container import Damaged, check_heaps, check_netcdf3

Array = np.ndarray
MAX_EXPANDED = 256 * 2**20  # bytes: a small compressed file cannot fill the memory
MAX_LABELS = 13  # entries of a variable of text that are read: one more than messages show
_NOT_COORDINATE = "_nc4_non_coord_"  # before the name of a variable named as a dimension that it is not along
_BARE = "This is a netCDF dimension but not a netCDF variable"


@dataclass(frozen=True)
class Variable:
    """One variable of a file.

    values : float64 or complex128, as many axes as `dims`; None for what is neither numbers nor text.
    labels : the first of its strings, stripped, for a variable of text; units : as the file says, "" without.
    """

    dims: tuple[str, ...]
    values: Array | None
    labels: tuple[str, ...] | None = None
    units: str = ""


Dataset = dict[str, Variable]


def open_netcdf(payload: bytes, name: str, wanted: Collection[str]) -> Dataset:
    """Those of the wanted variables that the file has, in memory (NetCDF 4 or 3). Raises DataError.

    An attribute of the file that is wanted stands there as a variable of one text.
    """
    try:
        classic = payload[:3] == b"CDF"
        (check_netcdf3 if classic else check_heaps)(payload)
        return (_read_netcdf3 if classic else _read_netcdf4)(payload, name, wanted)
    except DataError:
        raise
    except ImportError:
        raise DataError(f"{name}: NetCDF 4 cannot be read here because h5py is not installed; install h5py") from None
    except Exception as error:  # the libraries below raise anything at all on a damaged file
        reason = (str(error).splitlines() or [type(error).__name__])[0][:120]
        raise DataError(
            f"{name}: the NetCDF file is damaged or truncated ({reason}); write or upload it again"
        ) from None


def _read_netcdf4(payload: bytes, name: str, wanted: Collection[str]) -> Dataset:
    import h5py

    with h5py.File(io.BytesIO(payload), "r") as file:
        here, found = set(file), {}
        for variable in wanted:
            key = next((key for key in (_NOT_COORDINATE + variable, variable) if key in here), None)
            if key is None:
                continue
            # a link or a storage that leads out of the file could read any file of this machine
            inside = file.id.links.get_info(key.encode()).type == h5py.h5l.TYPE_HARD
            item = file[key] if inside else None
            if isinstance(item, h5py.Group):
                continue
            if not isinstance(item, h5py.Dataset) or item.external or item.is_virtual:
                raise DataError(f"{name}: {variable} does not hold its values in this file; write them into it")
            if not _text(item.attrs.get("NAME", "")).startswith(_BARE):
                found[variable] = item
        _check_size(sum(_expanded(item) for item in found.values()), name)
        _check_storage(found)
        told = _told({key: file.attrs[key] for key in wanted if key in file.attrs})
        return told | {variable: _variable4(item, variable) for variable, item in found.items()}


def _check_storage(found: Mapping[str, Any]) -> None:
    """Numbers in the usual types and one byte order, and their bytes apart from one another. Raises Damaged.

    HDF5's oldest layouts have no checksums: one byte of a header gives another exponent, byte order or place.
    """
    from h5py import h5t

    kinds = [
        *(f"IEEE_F{size}" for size in (16, 32, 64)),
        *(f"STD_{sign}{size}" for sign in "IU" for size in (8, 16, 32, 64)),
    ]
    usual = [getattr(h5t, kind + order) for kind, order in product(kinds, ("LE", "BE"))]
    orders, places = set(), []
    for variable, item in found.items():
        kind = item.id.get_type()
        if isinstance(kind, h5t.TypeFloatID | h5t.TypeIntegerID):
            if not any(kind.equal(other) for other in usual):
                raise Damaged(f"the numbers of {variable} are of an unusual type")
            if kind.get_size() > 1:
                orders.add(kind.get_order())
        offset = item.id.get_offset()
        if offset is not None and item.id.get_storage_size():
            places.append((offset, offset + item.id.get_storage_size(), variable))
    if len(orders) > 1:
        raise Damaged("the numbers are in two byte orders")
    places.sort()
    for (_, end, one), (begin, _, other) in pairwise(places):
        if begin < end:
            raise Damaged(f"{one} and {other} lie over one another")


def _expanded(item: Any) -> int:
    """Bytes of a dataset in memory, whole chunks counted."""
    shape = item.shape or ()
    chunks = item.chunks or (1,) * len(shape)
    whole = prod(-(-length // chunk) * chunk for length, chunk in zip(shape, chunks, strict=True))
    return whole * int(item.dtype.itemsize)


def _check_size(size: int, name: str) -> None:
    if size > MAX_EXPANDED:
        raise DataError(
            f"{name}: the file expands to {size / 2**20:.0f} MB; allowed: at most {MAX_EXPANDED // 2**20} MB"
        )


def _variable4(item: Any, variable: str) -> Variable:
    from h5py import check_string_dtype

    dims = tuple(_dimension(item, axis, variable) for axis in range(len(item.shape or ())))
    characters = item.dtype == "S1" and len(dims) > 0
    if check_string_dtype(item.dtype) is not None and not characters:
        places = islice(np.ndindex(item.shape or ()), MAX_LABELS)
        return Variable(dims, None, tuple(_text(item[place]) for place in places))
    if item.shape is None or item.dtype.kind not in "biufcS":
        return Variable(dims, None)
    return _decoded(dims, item[()], item.attrs)


def _dimension(item: Any, axis: int, variable: str) -> str:
    scales = item.dims[axis]
    if len(scales):
        return str(scales[0].name).split("/")[-1]
    return variable if axis == 0 and item.is_scale else f"axis {axis}"


def _read_netcdf3(payload: bytes, name: str, wanted: Collection[str]) -> Dataset:
    from scipy.io import netcdf_file

    with netcdf_file(io.BytesIO(payload), "r", mmap=False) as file:
        found = {variable: file.variables[variable] for variable in wanted if variable in file.variables}
        _check_size(sum(item.data.nbytes for item in found.values()), name)
        attributes = vars(file)["_attributes"]
        return _told({key: attributes[key] for key in wanted if key in attributes}) | {
            variable: _decoded(tuple(item.dimensions), np.asarray(item.data), vars(item)["_attributes"])
            for variable, item in found.items()
        }


def _told(attributes: Mapping[str, Any]) -> Dataset:
    return {
        key: Variable((), None, (_text(value),)) for key, value in attributes.items() if isinstance(value, str | bytes)
    }


def _decoded(dims: tuple[str, ...], raw: Array, attributes: Mapping[str, Any]) -> Variable:
    """Numbers with NaN for what is missing, scaled; rows of characters as strings."""
    units = _text(attributes.get("units", ""))
    if raw.dtype.kind == "S":
        rows = np.ascontiguousarray(raw).view(f"S{raw.shape[-1]}").ravel()[:MAX_LABELS]
        return Variable(dims[:-1], None, tuple(_text(row) for row in rows), units)
    values = np.array(raw, dtype=complex if raw.dtype.kind == "c" else float)
    for missing in ("_FillValue", "missing_value"):
        if missing in attributes:
            values[np.isin(raw, attributes[missing])] = np.nan
    if "scale_factor" in attributes or "add_offset" in attributes:
        values = values * np.ravel(attributes.get("scale_factor", 1.0))[0]
        values = values + np.ravel(attributes.get("add_offset", 0.0))[0]
    return Variable(dims, values, None, units)


def _text(label: Any) -> str:
    return (label.decode(errors="replace") if isinstance(label, bytes) else str(label)).strip()


# --- taking arrays out of it


def scalar(dataset: Dataset, variable: str, name: str) -> float | None:
    """A variable of one value as a float, None when absent. Raises DataError when it has several or is no number."""
    if variable not in dataset:
        return None
    item = dataset[variable]
    values = np.unique(np.asarray(item.labels or (), dtype=str) if item.values is None else item.values)
    if item.values is None and values.size == 0:
        raise DataError(f"{name}: {variable} is not a number")
    if values.size != 1:
        raise DataError(f"{name}: {variable} has {values.size} values; select one of them before exporting the dataset")
    try:
        number = float(values[0])
    except (TypeError, ValueError):
        raise DataError(f"{name}: {variable} is not a number") from None
    if np.isnan(number):
        raise DataError(f"{name}: {variable} is not a number (NaN); give its value")
    return number


def vector3(dataset: Dataset, variable: str, name: str) -> Array | None:
    """A point (3,) [m], None when absent or not given (NaN)."""
    if variable not in dataset:
        return None
    values = numbers(dataset, variable, name)
    if values.shape != (3,):
        raise DataError(f"{name}: {variable} has shape {values.shape}; expected three coordinates")
    return values if np.all(np.isfinite(values)) else None


def numbers(dataset: Dataset, variable: str, name: str) -> Array:
    """The real values of a variable. Raises DataError when it is not there or holds none."""
    if variable not in dataset:
        raise DataError(f"{name}: {variable} is missing")
    values = dataset[variable].values
    if values is None or np.iscomplexobj(values):
        raise DataError(f"{name}: {variable} does not hold numbers")
    return values


def take(dataset: Dataset, variable: str, dims: tuple[str, ...], name: str) -> Array | None:
    """A variable as an array with axes in the order `dims`; real, or complex from its `complex` axis; None when absent.

    Other axes of length one are dropped. Raises DataError naming the axes found and expected.
    """
    if variable not in dataset:
        return None
    found, values = dataset[variable].dims, dataset[variable].values
    if values is None:
        raise DataError(f"{name}: {variable} does not hold numbers")
    extra = [i for i, dim in enumerate(found) if dim not in (*dims, "complex") and values.shape[i] == 1]
    values, found = np.squeeze(values, tuple(extra)), tuple(dim for i, dim in enumerate(found) if i not in extra)
    if sorted(set(found) - {"complex"}) != sorted(dims) or len(set(found)) != len(found):
        raise DataError(
            f"{name}: {variable} has the axes ({', '.join(found)}); expected ({', '.join(dims)}), "
            f"as capytaine.export_dataset writes them"
        )
    if "complex" not in found:
        return np.transpose(values, [found.index(dim) for dim in dims])
    values = np.transpose(values, [found.index(dim) for dim in ("complex", *dims)])
    if values.shape[0] != 2:
        raise DataError(f"{name}: the axis `complex` of {variable} has {values.shape[0]} entries; expected re and im")
    labels = list(dataset["complex"].labels or ()) if "complex" in dataset else ["re", "im"]
    if sorted(labels) != ["im", "re"]:
        raise DataError(f"{name}: the axis `complex` of {variable} is labelled {labels}; expected re and im")
    result = np.empty(values.shape[1:], complex)
    result.real, result.imag = values[labels.index("re")].real, values[labels.index("im")].real
    return result


def require(dataset: Dataset, variable: str, dims: tuple[str, ...], name: str, remedy: str) -> Array:
    """As `take`, but absent is a DataError with the remedy."""
    values = take(dataset, variable, dims, name)
    if values is None:
        raise DataError(f"{name}: there is no variable {variable}; {remedy}")
    return values


def dof_order(dataset: Dataset, axis: str, name: str) -> list[int]:
    """Positions of surge … yaw along an axis of DOF names. Raises DataError unless each is there once, and no other."""
    item = dataset.get(axis)
    if item is None or len(item.dims) != 1:
        raise DataError(f"{name}: the axis {axis} has no names of degrees of freedom; export all six rigid-body ones")
    labels = item.labels or ()
    plain = [label.split("__")[-1].lower() for label in labels]
    missing = [dof for dof in DOF if plain.count(dof) != 1]
    if missing or len(plain) != 6:
        shown = ", ".join(label[:40] for label in labels[:12])
        raise DataError(
            f"{name}: {axis} holds {shown or 'no names'}; expected one body with Surge, Sway, Heave, Roll, Pitch and Yaw "
            f"once each (capytaine.rigid_body_dofs)"
        )
    return [plain.index(dof) for dof in DOF]
