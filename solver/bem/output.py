"""Solved frequencies as a data set in Capytaine's own NetCDF layout, with the mean drift force as one variable more."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..waves.dispersion import wave_number
from .body import extra_damping, hydrostatic_stiffness, mass_matrix, motions, need_body
from .drift import absorbed, mean_drift
from .geometry import Hull
from .green import capytaine_version, load_capytaine
from .solve import Solved, Wet
from .spec import HydrodynamicJob

Array = np.ndarray
DOFS = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
SHARE = 0.02  # of the largest scattered power: below it a balance says nothing


def drift_and_balance(
    job: HydrodynamicJob, hull: Hull, shape: Wet, done: list[Solved], headings: Array
) -> tuple[Array | None, dict[str, list[float]]]:
    """Mean drift at the solved frequencies and headings (W, H, 6), None when not asked for; the fixed hull's energy.

    Energy: per finite frequency the difference of power taken and scattered, of the scattered one, the worst heading.
    """
    finite = [item for item in done if item.waves is not None]
    water = (shape.depth, shape.density, shape.gravity)
    drift = np.zeros((len(finite), headings.size, 6))
    taken, sent = np.zeros((2, len(finite), headings.size))
    for row, item in enumerate(finite):
        k = _wave_number(item.omega, shape)
        fixed = item.waves[:, 6:]  # type: ignore[index]
        args = (headings, item.omega, k, *water)
        gap, scattered = absorbed(fixed, *args)
        taken[row], sent[row] = np.abs(gap), scattered
        total = fixed
        if job.mean_drift == "free":
            total = fixed + item.waves[:, :6] @ _motions(job, hull, shape, item).T  # type: ignore[index]
        surge, sway, yaw = mean_drift(total, *args).T
        x, y = shape.centre[:2]
        drift[row, :, 0], drift[row, :, 1], drift[row, :, 5] = surge, sway, yaw - x * sway + y * surge
    counts = sent > SHARE * sent.max(initial=0.0)
    share = np.where(counts, taken / np.maximum(sent, 1e-300), 0.0).max(axis=1, initial=0.0)
    balance = {"omega": [item.omega for item in finite], "imbalance": [float(value) for value in share]}
    return (None if job.mean_drift == "none" else drift), balance


def _wave_number(omega: float, shape: Wet) -> float:
    return float(wave_number(omega, shape.depth, shape.gravity))


def _motions(job: HydrodynamicJob, hull: Hull, shape: Wet, item: Solved) -> Array:
    body = need_body(job)
    inertia = mass_matrix(body, hull.panels.volume * shape.density)
    stiffness = hydrostatic_stiffness(hull.panels, shape.centre, shape.density, shape.gravity)
    force = item.froude_krylov + item.diffraction  # type: ignore[operator]
    return motions(item.omega, item.added_mass, item.damping, force, inertia, stiffness, extra_damping(body))


def assemble(
    job: HydrodynamicJob,
    hull: Hull,
    shape: Wet,
    done: list[Solved],
    places: list[tuple[int, Array]],
    drift: Array | None,
) -> dict[str, tuple[tuple[str, ...], Any, dict[str, str]]]:
    """Variables by name: axes, values and attributes, as capytaine.export_dataset lays them out."""
    body, mesh = need_body(job), hull.panels
    pick, signs = np.array([i for i, _ in places]), np.array([s for _, s in places])
    pair, wave = ("omega", "influenced_dof", "radiating_dof"), ("complex", "omega", "wave_direction", "influenced_dof")
    stiffness = hydrostatic_stiffness(mesh, shape.centre, shape.density, shape.gravity)
    shape_of = (len(done), len(places), 6)
    forces = {name: np.full(shape_of, np.nan, complex) for name in ("Froude_Krylov_force", "diffraction_force")}
    drifts, row = np.full(shape_of, np.nan), 0
    for index, item in enumerate(done):
        if item.omega == 0:  # the limit of long waves: hydrostatics move with the elevation
            forces["Froude_Krylov_force"][index] = stiffness[:, 2]
            forces["diffraction_force"][index], drifts[index] = 0.0, 0.0
        elif item.waves is not None:
            forces["Froude_Krylov_force"][index] = item.froude_krylov[pick] * signs  # type: ignore[index]
            forces["diffraction_force"][index] = item.diffraction[pick] * signs  # type: ignore[index]
            if drift is not None:
                drifts[index] = drift[row][pick] * signs
            row += 1
    moment = {"units": "N/m, N m/m"}
    out: dict[str, Any] = {
        "omega": (("omega",), np.array([item.omega for item in done]), {"units": "rad/s"}),
        "wave_direction": (("wave_direction",), job.beta(), {"units": "rad"}),
        "added_mass": (pair, np.array([item.added_mass for item in done]), {"units": "kg, kg m, kg m^2"}),
        "radiation_damping": (pair, np.array([item.damping for item in done]), {"units": "N s/m, N s, N m s"}),
        **{name: (wave, np.array([value.real, value.imag]), moment) for name, value in forces.items()},
        "hydrostatic_stiffness": (pair[1:], stiffness, {"units": "N/m, N, N m"}),
        "rotation_center": (("xyz",), shape.centre, {"units": "m"}),
        "center_of_mass": (("xyz",), np.array(body.centre_of_gravity), {"units": "m"}),
        "center_of_buoyancy": (("xyz",), mesh.centre_of_buoyancy, {"units": "m"}),
        "disp_volume": ((), mesh.volume, {"units": "m^3"}),
        "disp_mass": ((), mesh.volume * shape.density, {"units": "kg"}),
        "waterplane_area": ((), mesh.water_plane()[0], {"units": "m^2"}),
        "rho": ((), shape.density, {"units": "kg/m^3"}),
        "g": ((), shape.gravity, {"units": "m/s^2"}),
        "water_depth": ((), shape.depth, {"units": "m"}),
    }
    if body.radii_of_gyration is not None:
        inertia = mass_matrix(body, mesh.volume * shape.density)
        out["inertia_matrix"] = (pair[1:], inertia, {"units": "kg, kg m, kg m^2"})
    if drift is not None:
        note = f"{job.mean_drift} body, far field; yaw about the centre of gravity; heave, roll, pitch zero"
        out["mean_drift_force"] = (wave[1:], drifts, {"units": "N/m^2, N m/m^2", "note": note})
    if job.mean_drift == "free":
        out["linear_damping"] = (pair[1:], np.diag(extra_damping(body)), {"units": "N s/m, N m s"})
    return out


def to_netcdf(variables: dict[str, Any], job: HydrodynamicJob) -> bytes:
    """The bytes of a NetCDF 3 file; equal for equal results: no dates, no settings of the machine."""
    load_capytaine()
    import xarray as xr

    dataset = xr.Dataset(
        variables,
        coords={
            "influenced_dof": ("influenced_dof", np.array(DOFS)),
            "radiating_dof": ("radiating_dof", np.array(DOFS)),
            "complex": ("complex", np.array(("re", "im"))),
        },
        attrs={
            "title": job.name,
            "source": f"Slowdrift, Green function of Capytaine {capytaine_version()}, indirect method",
            "job": job.canonical(),
        },
    )
    encoding = {name: {"_FillValue": None} for name in dataset.variables if dataset[name].dtype.kind == "f"}
    return bytes(dataset.to_netcdf(engine="scipy", format="NETCDF3_64BIT", encoding=encoding))
