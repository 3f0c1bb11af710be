"""Hydrodynamic data as NetCDF: Capytaine's layout, with mean drift, QTF, motions and provenance beside it.

What Capytaine has no name for: `mean_drift_force` over (omega, wave_direction, influenced_dof), or over axes of its own,
`mean_drift_omega` and `mean_drift_direction`; `difference_qtf` over (complex, qtf_direction, qtf_omega, qtf_omega_2,
influenced_dof), of waves that differ in heading `difference_qtf_cross` over (complex, qtf_pair, …) with the positions
`qtf_pair_headings`; the attribute `slowdrift_provenance`. Complex values are in the time factor e^{-iωt} throughout.
"""

from __future__ import annotations

import io
import json
import math
from typing import Any

import numpy as np

from ...outcome import DataError
from .hydrodynamics import HydrodynamicData
from .interpolate import TURN
from .netcdf import Dataset, numbers, require, take
from .qtf import QTF

Array = np.ndarray
NAMES = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
PROVENANCE = "slowdrift_provenance"
EXTRA = (
    "mean_drift_force", "mean_drift_omega", "mean_drift_direction", "difference_qtf", "difference_qtf_cross",
    "qtf_direction", "qtf_omega", "qtf_pair_headings", "RAO",
)  # fmt: skip
UNITS = {
    "omega": "rad/s", "wave_direction": "rad", "added_mass": "kg", "radiation_damping": "kg/s", "excitation_force": "N/m",
    "mean_drift_force": "N/m2", "difference_qtf": "N/m2", "difference_qtf_cross": "N/m2", "hydrostatic_stiffness": "N/m",
    "disp_volume": "m3", "rho": "kg/m3", "g": "m/s2", "water_depth": "m", "RAO": "m/m", "mean_drift_omega": "rad/s",
    "mean_drift_direction": "rad", "qtf_omega": "rad/s", "qtf_direction": "rad",
}  # fmt: skip


def dump_netcdf(data: HydrodynamicData) -> bytes:
    """NetCDF 3 of the data, which read_bytes, Capytaine's users and xarray read: the numbers as they are, float64."""
    from scipy.io import netcdf_file

    target = io.BytesIO()
    file = netcdf_file(target, "w", version=2)
    file.Conventions = "capytaine"
    file.__setattr__(PROVENANCE, json.dumps(data.provenance).encode("ascii"))
    sizes: dict[str, int] = {}
    for name, (dims, values) in _variables(data).items():
        for dim, size in zip(dims, np.shape(values), strict=True):
            if dim not in sizes:
                file.createDimension(dim, size)
                sizes[dim] = size
        item = file.createVariable(name, np.asarray(values).dtype, dims)
        item[...] = values
        if name in UNITS:
            item.units = UNITS[name]
    file.flush()
    return target.getvalue()


def _variables(data: HydrodynamicData) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Each variable's axes and values."""
    edges = [
        omega
        for omega, matrix in ((0.0, data.added_mass_zero), (math.inf, data.added_mass_infinite))
        if matrix is not None
    ]
    low, high = 0.0 in edges or data.excitation_zero is not None, math.inf in edges
    pair, force = ("influenced_dof", "radiating_dof"), ("omega", "wave_direction", "influenced_dof")

    def full(inner: Array, zero: Array | None, infinite: Array | None) -> Array:
        void = np.full(inner.shape[1:], np.nan, dtype=inner.dtype)
        first = [void if zero is None else zero] if low else []
        last = [void if infinite is None else infinite] if high else []
        return np.stack([*first, *inner, *last])

    still = np.zeros((6, 6))
    scalars = {"rho": data.density, "g": data.gravity, "water_depth": data.depth, "forward_speed": 0.0}
    made: dict[str, Any] = {
        "omega": (("omega",), np.concatenate([[0.0] * low, data.omega, [math.inf] * high])),
        "wave_direction": (("wave_direction",), data.headings),
        "influenced_dof": (("influenced_dof", "name"), _characters(NAMES)),
        "radiating_dof": (("radiating_dof", "name"), _characters(NAMES)),
        "complex": (("complex", "part"), _characters(("re", "im"))),
        "added_mass": (("omega", *pair), full(data.added_mass, data.added_mass_zero, data.added_mass_infinite)),
        "radiation_damping": (("omega", *pair), full(data.damping, still, still)),
        "excitation_force": (("complex", *force), _split(full(data.excitation, data.excitation_zero, None))),
        **{name: ((), np.float64(value)) for name, value in scalars.items()},
    }
    if data.mean_drift is not None:
        if data.mean_drift_omega is None and data.mean_drift_headings is None:
            made["mean_drift_force"] = (force, full(data.mean_drift, None, None))
        else:
            own = ("mean_drift_omega", "mean_drift_direction")
            made[own[0]], made[own[1]] = ((own[0],), data.drift_omega), ((own[1],), data.drift_headings)
            made["mean_drift_force"] = ((*own, "influenced_dof"), data.mean_drift)
    if data.motions is not None:
        made["RAO"] = (("complex", "omega", "wave_direction", "radiating_dof"), _split(full(data.motions, None, None)))
    if data.hydrostatic_stiffness is not None:
        made["hydrostatic_stiffness"] = (pair, data.hydrostatic_stiffness)
    if data.displaced_volume is not None:
        made["disp_volume"] = ((), np.float64(data.displaced_volume))
    points = {"center_of_mass": data.centre_of_mass, "center_of_buoyancy": data.centre_of_buoyancy}
    points["rotation_center"] = data.reference_point if data.reference_known else None
    made |= {name: (("space_coordinate",), point) for name, point in points.items() if point is not None}
    return made | (_pairs(data.qtf) if data.qtf is not None else {})


def _pairs(qtf: QTF) -> dict[str, tuple[tuple[str, ...], Array]]:
    axes = ("qtf_omega", "qtf_omega_2", "influenced_dof")
    made = {
        "qtf_omega": (("qtf_omega",), qtf.omega),
        "qtf_direction": (("qtf_direction",), qtf.headings),
        "difference_qtf": (("complex", "qtf_direction", *axes), _split(qtf.values)),
    }
    if qtf.cross:
        made["qtf_pair_headings"] = (("qtf_pair", "two"), np.array(list(qtf.cross), dtype=float))
        made["difference_qtf_cross"] = (("complex", "qtf_pair", *axes), _split(np.array(list(qtf.cross.values()))))
    return made


def _split(values: Array) -> Array:
    """Real and imaginary part of the conjugate: e^{+iωt} to e^{-iωt}."""
    values = values.astype(complex)
    return np.stack([values.real, -values.imag])


def _characters(words: tuple[str, ...]) -> Array:
    width = max(len(word) for word in words)
    return np.array([list(word.ljust(width)) for word in words], dtype="S1")


# --- reading what is beside Capytaine's own


def read_drift(dataset: Dataset, name: str) -> tuple[Array, Array, Array] | None:
    """Mean drift over axes of its own: omega, headings and values in file order, or None. Raises DataError."""
    if "mean_drift_omega" not in dataset:
        return None
    omega, headings = (numbers(dataset, axis, name) for axis in ("mean_drift_omega", "mean_drift_direction"))
    dims = ("mean_drift_omega", "mean_drift_direction", "influenced_dof")
    values = require(dataset, "mean_drift_force", dims, name, "give it, or leave mean_drift_omega out").real
    _rising(omega, headings, "mean_drift_omega", "mean_drift_direction", name)
    return omega, headings, values


def _rising(omega: Array, headings: Array, first: str, second: str, name: str) -> None:
    """Refuse axes between whose points nothing could be found. Raises DataError."""
    within = bool(np.all((headings >= 0) & (headings < TURN)))  # false for what is not a number
    finite = bool(np.all(np.isfinite(omega) & (omega > 0)))
    if not (within and finite and np.all(np.diff(omega) > 0) and np.all(np.diff(headings) > 0)):
        raise DataError(
            f"{name}: {first} and {second} must rise, omega from above 0 rad/s, directions from 0 to below 2π rad"
        )


def read_qtf(dataset: Dataset, order: list[int], name: str) -> QTF | None:
    """The QTF, its degrees of freedom put in order, or None. Raises DataError."""
    if "difference_qtf" not in dataset:
        return None
    axes = ("qtf_omega", "qtf_omega_2", "influenced_dof")
    remedy = "give it, or leave difference_qtf out"
    omega, headings = (numbers(dataset, axis, name) for axis in ("qtf_omega", "qtf_direction"))
    _rising(omega, headings, "qtf_omega", "qtf_direction", name)
    values = np.conj(require(dataset, "difference_qtf", ("qtf_direction", *axes), name, remedy)[..., order])
    cross = {}
    if "difference_qtf_cross" in dataset:
        table = np.conj(require(dataset, "difference_qtf_cross", ("qtf_pair", *axes), name, remedy)[..., order])
        pairs = take(dataset, "qtf_pair_headings", ("qtf_pair", "two"), name)
        if pairs is None or pairs.shape != (len(table), 2) or not np.all((pairs >= 0) & (pairs < headings.size)):
            raise DataError(f"{name}: qtf_pair_headings must hold two positions in qtf_direction for each pair")
        cross = {(int(a), int(b)): part for (a, b), part in zip(pairs.real, table, strict=True)}
    return QTF(omega, headings, values, name, cross)
