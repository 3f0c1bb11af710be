"""A small body with known hydrodynamics, and the file Capytaine would write of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RHO, G, LENGTH, BREADTH, DRAFT = 1025.0, 9.807, 60.0, 20.0, 6.0
NAMES = ["Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw"]
SIZE = np.diag([0.3, 0.8, 1.5, 8.0, 15.0, 12.0])
MASS = RHO * LENGTH * BREADTH * DRAFT


def damping(omega):
    """(W, 6, 6): symmetric, positive semi-definite, B = C omega^4 / (omega^6 + 0.5): zero at 0, cubic tail-like."""
    omega = np.atleast_1d(omega)
    mix = np.eye(6)
    mix[0, 4], mix[1, 3] = 0.4, -0.3
    base = MASS * mix.T @ SIZE @ mix
    return (omega**4 / (omega**6 + 0.5))[:, None, None] * 0.3 * base


def dataset(omega=None, headings=None, centre=(0.0, 0.0, 2.0), seed=0, edges=True):
    """An xarray Dataset in Capytaine's layout, before its complex values are separated; e^{-i omega t}."""
    import xarray as xr

    rng = np.random.default_rng(seed)
    omega = np.arange(0.1, 2.05, 0.1) if omega is None else np.asarray(omega, float)
    headings = np.arange(16) * np.pi / 8 if headings is None else np.asarray(headings, float)
    full = np.concatenate([[0.0], omega, [np.inf]]) if edges else omega
    inside = np.isfinite(full) & (full > 0)
    added = MASS * (1 + 0.5 / (1 + np.where(np.isfinite(full), full, 1e9) ** 2))[:, None, None] * SIZE
    damp = np.zeros((full.size, 6, 6))
    damp[inside] = damping(full[inside])
    force = np.full((full.size, headings.size, 6), np.nan, complex)
    coefficients = rng.normal(size=(3, 6))
    w = full[inside][:, None, None]
    beta = headings[None, :, None]
    force[inside] = 1e6 * np.exp(1j * w) * (
        coefficients[0] * np.cos(beta) + coefficients[1] * np.sin(beta) + 1j * coefficients[2]
    )  # fmt: skip
    drift = np.full((full.size, headings.size, 6), np.nan)
    drift[inside] = 0.0
    drift[inside, :, 0] = 2e4 * (w * np.cos(beta))[..., 0]
    drift[inside, :, 1] = 5e4 * (w * np.sin(beta))[..., 0]
    drift[inside, :, 5] = 3e5 * (w * np.sin(2 * beta))[..., 0]
    k33 = RHO * G * LENGTH * BREADTH
    lever = -DRAFT / 2 - centre[2]
    volume = LENGTH * BREADTH * DRAFT
    stiffness = np.diag([
        0, 0, k33, k33 * BREADTH**2 / 12 + RHO * G * volume * lever, k33 * LENGTH**2 / 12 + RHO * G * volume * lever, 0,
    ])  # fmt: skip
    waves, pair = ("omega", "wave_direction", "influenced_dof"), ("influenced_dof", "radiating_dof")
    space = "space_coordinate"
    return xr.Dataset(
        {
            "added_mass": (("omega", *pair), added),
            "radiation_damping": (("omega", *pair), damp),
            "Froude_Krylov_force": (waves, 0.25 * force),
            "diffraction_force": (waves, 0.75 * force),
            "mean_drift_force": (waves, drift),
            "hydrostatic_stiffness": (pair, stiffness),
            "disp_mass": ((), MASS),
            "center_of_buoyancy": (space, [0.0, 0.0, -DRAFT / 2]),
        },
        coords={
            "omega": full, "wave_direction": headings, "influenced_dof": NAMES, "radiating_dof": NAMES, "rho": RHO,
            "g": G, "water_depth": np.inf, "forward_speed": 0.0, space: ["x", "y", "z"],
            "rotation_center": (space, list(centre)), "center_of_mass": (space, list(centre)),
        },
    )  # fmt: skip


def to_bytes(data, folder: Path, engine: str = "h5netcdf") -> bytes:
    """The bytes that capytaine.export_dataset would write: complex values as one axis more."""
    out = data.copy()
    for name in list(out.data_vars):
        if np.iscomplexobj(out[name].values):
            item = out[name]
            out[name] = (("complex", *item.dims), np.stack([item.values.real, item.values.imag]))
            out = out.assign_coords(complex=["re", "im"])
    path = Path(folder) / "synthetic.nc"
    path.unlink(missing_ok=True)
    out.to_netcdf(path, engine=engine)
    return path.read_bytes()
