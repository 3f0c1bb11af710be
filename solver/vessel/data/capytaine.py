"""Reader of Capytaine's own NetCDF layout, with the mean drift force as one variable more.

The file is in the time factor e^{-i omega t}; excitation is conjugated here, once, and nowhere else.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...outcome import DataError
from .hydrodynamics import HydrodynamicData
from .interpolate import TURN
from .layout import EXTRA, PROVENANCE, read_drift, read_qtf
from .netcdf import Dataset, dof_order, numbers, open_netcdf, require, scalar, take, vector3

Array = np.ndarray
MAX_OMEGA, MAX_HEADINGS = 5000, 721
MAX_TOLD = 1_000_000  # characters of provenance
VARIABLES = (  # all that is read of a file
    "omega", "wave_direction", "radiating_dof", "influenced_dof", "complex", "added_mass", "radiation_damping",
    "Froude_Krylov_force", "diffraction_force", "excitation_force", "hydrostatic_stiffness", *EXTRA, PROVENANCE,
    "rotation_center", "center_of_mass", "center_of_buoyancy", "disp_volume", "disp_mass", "rho", "g", "water_depth",
    "forward_speed",
)  # fmt: skip


@dataclass(frozen=True)
class _Layout:
    """Where things are in the file: the frequency axis, the order of frequencies, headings and DOFs."""

    name: str
    dim: str
    omega: Array
    order: Array  # rising, zero and infinity included
    headings: Array
    angle: Array  # of all directions of the file, in [0, 2π)
    turn: Array
    radiating: list[int]
    influenced: list[int]

    @property
    def finite(self) -> Array:
        return self.order[(self.omega[self.order] > 0) & np.isfinite(self.omega[self.order])]

    def at(self, omega: float) -> int | None:
        found = np.flatnonzero(self.omega == omega)
        return int(found[0]) if found.size else None


def read_capytaine(payload: bytes, name: str) -> HydrodynamicData:
    """Hydrodynamic data from the bytes of a dataset written by capytaine.export_dataset. Raises DataError."""
    dataset = open_netcdf(payload, name, VARIABLES)
    layout = _layout(dataset, name)
    speed = scalar(dataset, "forward_speed", name)
    if speed:
        raise DataError(f"{name}: forward_speed is {speed:g} m/s; compute the data at zero speed")
    warnings: list[str] = []
    layout = _computed(dataset, layout, warnings)
    added_mass, zero, infinite = _radiation(dataset, "added_mass", layout)
    damping, _, _ = _radiation(dataset, "radiation_damping", layout)
    excitation, excitation_zero = _excitation(dataset, layout)
    density, gravity, depth = _water(dataset, name, warnings)
    own, content_hash = read_drift(dataset, name), hashlib.sha256(payload).hexdigest()
    rotation_centre = vector3(dataset, "rotation_center", name)
    stiffness = take(dataset, "hydrostatic_stiffness", ("influenced_dof", "radiating_dof"), name)
    if stiffness is not None:
        stiffness = _finite(stiffness[np.ix_(layout.influenced, layout.radiating)], "hydrostatic_stiffness", name)
    if rotation_centre is None:
        warnings.append(
            f"{name}: the file does not say its rotation_center; vessel.hydrodynamics.reference_point is taken instead"
        )
    return HydrodynamicData(
        name=name,
        content_hash=content_hash,
        omega=layout.omega[layout.finite],
        headings=layout.headings,
        added_mass=added_mass,
        damping=damping,
        excitation=excitation,
        added_mass_zero=zero,
        added_mass_infinite=infinite,
        excitation_zero=excitation_zero,
        mean_drift=_mean_drift(dataset, layout)
        if own is None
        else _finite(own[2][..., layout.influenced], "mean_drift_force", name),
        mean_drift_omega=None if own is None else own[0],
        mean_drift_headings=None if own is None else own[1],
        motions=_motions(dataset, layout),
        qtf=read_qtf(dataset, layout.influenced, name),
        hydrostatic_stiffness=stiffness,
        displaced_volume=_volume(dataset, name, density),
        centre_of_buoyancy=vector3(dataset, "center_of_buoyancy", name),
        centre_of_mass=vector3(dataset, "center_of_mass", name),
        reference_point=np.zeros(3) if rotation_centre is None else rotation_centre,
        reference_known=rotation_centre is not None,
        density=density,
        gravity=gravity,
        depth=depth,
        warnings=tuple(warnings),
        provenance=_provenance(dataset, payload, content_hash, name),
    )


def _provenance(dataset: Dataset, payload: bytes, content_hash: str, name: str) -> dict[str, Any]:
    """Of the file, and `source`: what a file that this program wrote says of where its numbers came from."""
    told = (dataset[PROVENANCE].labels or ("",))[0] if PROVENANCE in dataset else ""
    try:
        source = json.loads(told) if told and len(told) < MAX_TOLD else None
    except (ValueError, RecursionError):
        source = None
    files = [{"name": name, "bytes": len(payload), "sha256": content_hash, "used": True}]
    made = {
        "format": "NetCDF",
        "files": files,
        "not_read": [],
        "conventions": {"time_factor": "e^{-iωt}"},
        "assumed": [],
    }
    return made | ({"source": source} if isinstance(source, dict) and source else {})


def _layout(dataset: Dataset, name: str) -> _Layout:
    for axis in ("omega", "wave_direction"):
        if axis not in dataset or len(dataset[axis].dims) != 1:
            raise DataError(
                f"{name}: there is no axis {axis}; export radiation and diffraction results together with "
                f"capytaine.export_dataset"
            )
    omega = numbers(dataset, "omega", name)
    if np.any(np.isnan(omega)) or np.any(omega < 0) or np.unique(omega).size != omega.size:
        raise DataError(f"{name}: omega must hold distinct frequencies from 0 up, in rad/s; check the test matrix")
    headings, angle, turn = _headings(dataset, name)
    layout = _Layout(
        name, dataset["omega"].dims[0], omega, np.argsort(omega), headings, angle, turn,
        dof_order(dataset, "radiating_dof", name), dof_order(dataset, "influenced_dof", name),
    )  # fmt: skip
    if layout.finite.size == 0:
        raise DataError(f"{name}: omega holds no finite frequency above 0; compute the band of the waves")
    if layout.finite.size > MAX_OMEGA:
        raise DataError(f"{name}: omega holds {layout.finite.size} frequencies; allowed: at most {MAX_OMEGA}")
    return layout


def _computed(dataset: Dataset, layout: _Layout, warnings: list[str]) -> _Layout:
    """The layout without the lowest frequencies where nothing was computed: all values of a variable are NaN.

    Capytaine leaves NaN where kh < 0.1. Raises DataError for such a frequency elsewhere.
    """
    finite = layout.finite
    lacking = np.zeros(finite.size, dtype=bool)
    parts = ("Froude_Krylov_force", "diffraction_force")
    forces = parts if all(part in dataset for part in parts) else ("excitation_force",)
    for variable in ("added_mass", "radiation_damping", *forces):
        item = dataset.get(variable)
        if item is not None and item.values is not None and layout.dim in item.dims:
            unknown = np.isnan(item.values)
            if "complex" in item.dims:  # NaN in the real part alone is one too
                unknown = unknown.any(axis=item.dims.index("complex"), keepdims=True)
            unknown = np.moveaxis(unknown, item.dims.index(layout.dim), 0)
            lacking |= unknown.reshape(layout.omega.size, -1).all(axis=1)[finite]
    if not lacking.any():
        return layout
    lowest = np.logical_and.accumulate(lacking)
    omega = layout.omega[finite]
    if np.any(lacking & ~lowest) or lowest.all():
        raise DataError(
            f"{layout.name}: nothing was computed at {_listed(omega[lacking])} (NaN); compute these frequencies "
            f"before exporting, or leave them out"
        )
    warnings.append(
        f"{layout.name}: the lowest frequencies, {_listed(omega[lowest])}, hold no values (NaN) and are left out; the data "
        f"begin at {omega[~lowest][0]:.4g} rad/s"
    )
    return replace(layout, order=layout.order[~np.isin(layout.order, finite[lowest])])


def _listed(omega: Array) -> str:
    return f"{', '.join(f'{value:.4g}' for value in omega[:8])}{', …' if omega.size > 8 else ''} rad/s"


def _headings(dataset: Dataset, name: str) -> tuple[Array, Array, Array]:
    """Headings in [0, 2π), rising; all angles in file order; and the positions of the headings in the file."""
    beta = numbers(dataset, "wave_direction", name)
    if beta.size == 0 or beta.size > MAX_HEADINGS or not np.all(np.isfinite(beta)):
        raise DataError(f"{name}: wave_direction holds {beta.size} values; expected 1 to {MAX_HEADINGS} finite ones")
    if dataset["wave_direction"].units.lower().startswith("deg") or np.abs(beta).max() > TURN + 1e-6:
        raise DataError(
            f"{name}: wave_direction goes up to {np.abs(beta).max():.4g}, which looks like degrees; give radians"
        )
    angle = beta % TURN
    angle = np.where(TURN - angle < 1e-9, 0.0, angle)
    order = np.argsort(angle, kind="stable")
    keep = order[np.concatenate([[True], np.diff(angle[order]) > 1e-9])]
    return angle[keep], angle, keep


def _radiation(dataset: Dataset, variable: str, layout: _Layout) -> tuple[Array, Array | None, Array | None]:
    """Finite frequencies (W, 6, 6), and the matrices at 0 and infinity when they are there."""
    name = layout.name
    values = require(
        dataset, variable, (layout.dim, "influenced_dof", "radiating_dof"), name,
        "solve the radiation problems of all six degrees of freedom",
    )  # fmt: skip
    values = values[:, layout.influenced][:, :, layout.radiating].real
    finite = _finite(values[layout.finite], variable, name, layout.omega[layout.finite])
    edges = []
    for edge in (0.0, math.inf):
        index = layout.at(edge)
        there = index is not None and bool(np.all(np.isfinite(values[index])))
        edges.append(values[index] if there else None)
    return finite, edges[0], edges[1]


def _excitation(dataset: Dataset, layout: _Layout) -> tuple[Array, Array | None]:
    """Complex (W, H, 6) in e^{+i omega t}, and the real limit (H, 6) at omega = 0 when the file has it."""
    dims, name = (layout.dim, "wave_direction", "influenced_dof"), layout.name
    parts = [take(dataset, variable, dims, name) for variable in ("Froude_Krylov_force", "diffraction_force")]
    if parts[0] is not None and parts[1] is not None:
        with np.errstate(invalid="ignore"):  # infinity less infinity: NaN, which is refused below
            total, variable = parts[0] + parts[1], "Froude_Krylov_force + diffraction_force"
    else:
        variable = "excitation_force"
        remedy = "give it, or both Froude_Krylov_force and diffraction_force"
        total = require(dataset, variable, dims, name, remedy)
    if not np.iscomplexobj(total):
        raise DataError(f"{name}: {variable} has no imaginary part; export it with capytaine.export_dataset")
    _twins_agree(total, layout)
    total = np.conj(total[:, layout.turn][:, :, layout.influenced])
    zero = layout.at(0.0)
    limit = None if zero is None or not np.all(np.isfinite(total[zero])) else total[zero].real
    return _finite(total[layout.finite], variable, name, layout.omega[layout.finite]), limit


def _twins_agree(force: Array, layout: _Layout) -> None:
    """Raises DataError where one direction is there twice, as -180 and 180 deg, with different forces (W, H, 6)."""
    left_out = np.setdiff1d(np.arange(force.shape[1]), layout.turn)
    size = np.nan_to_num(np.abs(force)).max(axis=(0, 1))
    for other in left_out:
        twin = layout.turn[np.abs((layout.angle[layout.turn] - layout.angle[other] + np.pi) % TURN - np.pi).argmin()]
        gap = np.nan_to_num(np.abs(force[:, other] - force[:, twin])).max(axis=0)
        if np.any(gap > 1e-3 * size):
            raise DataError(
                f"{layout.name}: wave_direction holds {np.degrees(layout.angle[other]):.5g} deg twice, with different forces; "
                f"give each direction once"
            )


def _mean_drift(dataset: Dataset, layout: _Layout) -> Array | None:
    dims = (layout.dim, "wave_direction", "influenced_dof")
    values = take(dataset, "mean_drift_force", dims, layout.name)
    if values is None:
        return None
    values = values[layout.finite][:, layout.turn][:, :, layout.influenced].real
    return _finite(values, "mean_drift_force", layout.name, layout.omega[layout.finite])


def _motions(dataset: Dataset, layout: _Layout) -> Array | None:
    values = take(dataset, "RAO", (layout.dim, "wave_direction", "radiating_dof"), layout.name)
    if values is None or not np.iscomplexobj(values):
        return None
    values = np.conj(values[layout.finite][:, layout.turn][:, :, layout.radiating])
    return values if np.all(np.isfinite(values)) else None


def _water(dataset: Dataset, name: str, warnings: list[str]) -> tuple[float, float, float]:
    """Density, gravity and depth the data were computed with; a missing one is assumed, with a warning."""
    found = []
    for variable, assumed, unit in (("rho", 1025.0, "kg/m3"), ("g", 9.81, "m/s2"), ("water_depth", math.inf, "m")):
        value = scalar(dataset, variable, name)
        if value is None:
            warnings.append(f"{name}: the file does not say {variable}; {assumed:g} {unit} is taken")
            value = assumed
        if value <= 0:
            raise DataError(f"{name}: {variable} is {value:g} {unit}; allowed: above 0")
        found.append(value)
    return found[0], found[1], found[2]


def _volume(dataset: Dataset, name: str, density: float) -> float | None:
    volume = scalar(dataset, "disp_volume", name)
    if volume is None:
        mass = scalar(dataset, "disp_mass", name)
        volume = None if mass is None else mass / density
    return volume if volume is None or volume > 0 else None


def _finite(values: Array, variable: str, name: str, omega: Array | None = None) -> Array:
    """The values; raises DataError where some are not finite, with the frequencies of the first axis if given."""
    bad = ~np.isfinite(values)
    if bad.any():
        at = "" if omega is None else f" at {_listed(omega[bad.reshape(omega.size, -1).any(axis=1)])}"
        raise DataError(
            f"{name}: {variable} holds {int(np.count_nonzero(bad))} values that are not finite (NaN){at}; "
            f"compute the missing problems before exporting"
        )
    return np.ascontiguousarray(values)
