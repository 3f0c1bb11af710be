"""Make the wave data of a box barge of 240 x 46 x 10 m in deep water with Capytaine.

    python examples/make_barge.py --out examples/barge-240x46x10.nc

needs the extra `bem` (Capytaine 3). The file has Capytaine's own NetCDF layout and time convention
e^{-i omega t}; SI units; wave direction = direction of travel, counter-clockwise from +x, in radians;
x forward, y to port, z up, origin midway in the water plane; rotations about the centre of gravity.
On top of that layout it holds `mean_drift_force`, see docs/barge.md.
"""

import argparse
import multiprocessing
import time
from pathlib import Path

import capytaine as cpt
import numpy as np
import xarray as xr

LENGTH, BREADTH, DRAFT = 240.0, 46.0, 10.0  # m
Z_CG = 5.0  # m above the water
MASS = 1.1e8  # kg
GYRATION = (26.0, 60.0, 60.0)  # m, about the axes through the centre of gravity
RHO, G = 1025.0, 9.807  # kg/m3, m/s2
DOFS = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
LINEAR_DAMPING = {"Surge": 2.6e5, "Sway": 3.5e5, "Roll": 2.7e9, "Yaw": 1.9e8}  # N s/m and N m s, about the CG
LID_PANEL = 2.9  # m
QUADRANT = np.arange(9) * np.pi / 16  # headings that are solved; the other quadrants are mirror images
N_THETA = 512  # points of the Kochin functions on the circle; a multiple of 32, so that all headings are on it
MIRROR_X = np.array([-1, 1, 1, 1, -1, -1])  # what x -> -x does to the six components of a force
MIRROR_Y = np.array([1, -1, 1, -1, 1, -1])  # and y -> -y


# --- the hull


def rectangle(p, q, place):
    """Mesh of the grid `p` x `q` [m]; `place(p, q)` gives x, y, z. The normal points along dp x dq."""
    pp, qq = (a.ravel() for a in np.meshgrid(p, q, indexing="ij"))
    first = (np.arange(len(p) - 1)[:, None] * len(q) + np.arange(len(q) - 1)).ravel()
    faces = np.stack([first, first + len(q), first + len(q) + 1, first + 1], axis=1)
    return cpt.Mesh(np.stack(np.broadcast_arrays(*place(pp, qq)), axis=1), faces)


def fourfold(quarter):
    """The quarter x > 0, y > 0 repeated by the two planes of symmetry."""
    return cpt.ReflectionSymmetricMesh(cpt.ReflectionSymmetricMesh(quarter, plane="yOz"), plane="xOz")


def even(length, panel):
    """Points from 0 to `length`, at most `panel` apart [m]."""
    return np.linspace(0.0, length, int(np.ceil(length / panel - 1e-9)) + 1)


def inertia_and_stiffness():
    """Mass and hydrostatic stiffness matrices about the CG, exact for the box, of the displaced volume.

    K33 = rho g A, K44 = rho g (V (z_B - z_G) + I_xx), K55 likewise: the weight is taken as rho g V.
    """
    area, volume = LENGTH * BREADTH, LENGTH * BREADTH * DRAFT
    lever = volume * (-DRAFT / 2 - Z_CG)
    stiffness = np.array([0, 0, area, lever + area * BREADTH**2 / 12, lever + area * LENGTH**2 / 12, 0]) * RHO * G
    inertia = MASS * np.array([1, 1, 1, *(r**2 for r in GYRATION)])
    dofs = list(DOFS)
    return tuple(
        xr.DataArray(np.diag(d), coords=[("influenced_dof", dofs), ("radiating_dof", dofs)], name=name)
        for d, name in ((inertia, "inertia_matrix"), (stiffness, "hydrostatic_stiffness"))
    )


def barge(panel, lid=LID_PANEL):
    """The barge as a Capytaine body: hull panels of at most `panel`, lid panels of at most `lid` [m] (None: no lid).

    The lid covers the whole inner water plane. (`generate_lid` of a quarter hull closes the open water line
    with a chord, which leaves a quarter of the plane bare; so the lid is meshed here.)
    """
    x, y, z = even(LENGTH / 2, panel), even(BREADTH / 2, panel), -even(DRAFT, panel)
    bottom = rectangle(y, x, lambda p, q: (q, p, -DRAFT))
    side = rectangle(x, z, lambda p, q: (p, BREADTH / 2, q))
    end = rectangle(z, y, lambda p, q: (LENGTH / 2, q, p))
    cover = None
    if lid:
        x, y = even(LENGTH / 2, lid), even(BREADTH / 2, lid)
        cover = fourfold(rectangle(y, x, lambda p, q: (q, p, 0.0)))
    body = cpt.FloatingBody(
        mesh=fourfold(bottom.join_meshes(side, end)),
        dofs=cpt.rigid_body_dofs(rotation_center=(0, 0, Z_CG)),
        lid_mesh=cover,
        center_of_mass=(0, 0, Z_CG),
        mass=MASS,
        name="barge",
    )
    body.inertia_matrix, body.hydrostatic_stiffness = inertia_and_stiffness()
    return body


# --- radiation and diffraction


def kochin(results, theta):
    """Kochin functions H(theta) of several results at one frequency, as `capytaine.compute_kochin`, [result, theta]."""
    mesh, k = results[0].body.mesh_including_lid, results[0].wavenumber
    x, y, z = mesh.faces_centers.T
    phase = np.exp(-1j * k * (np.outer(np.cos(theta), x) + np.outer(np.sin(theta), y)))
    strength = np.stack([r.sources for r in results], axis=1) * (mesh.faces_areas * np.exp(k * z))[:, None]
    return (phase @ strength).T / (4 * np.pi)


def solve(task):
    """All problems of one frequency: results stripped of their details, and the Kochin functions (None at 0 and inf).

    `task`: panel and lid size [m], omega [rad/s], headings [rad], theta [rad].
    At 0 and infinity there are no irregular frequencies and a lid at z = 0 is singular: solved without it.
    """
    panel, lid, omega, headings, theta = task
    start = time.perf_counter()
    finite = 0 < omega < np.inf
    body, solver = barge(panel, lid if finite else None), cpt.BEMSolver(method="indirect")
    common = {"body": body, "omega": omega, "rho": RHO, "g": G, "water_depth": np.inf}
    problems = [cpt.RadiationProblem(radiating_dof=dof, **common) for dof in DOFS]
    if finite:
        problems += [cpt.DiffractionProblem(wave_direction=beta, **common) for beta in headings]
    results = [solver.solve(p, _check_wavelength=False) for p in problems]
    waves = kochin(results, theta) if finite else None
    for r in results:
        r.sources = r.potential = r.pressure = None
    print(f"omega {omega:6.3f} rad/s  {time.perf_counter() - start:5.1f} s", flush=True)
    return results, waves


def compute(panel, omegas, headings=QUADRANT, lid=LID_PANEL, n_theta=N_THETA):
    """Capytaine's dataset at `omegas` and `headings`, and a dataset of the Kochin functions of the same waves.

    One process solves a few frequencies and is replaced: Capytaine 3.0 does not give back the memory of its
    factorised matrices, about 1 GB per frequency at 1.92 m.
    """
    theta = np.arange(-1, n_theta + 2) * (2 * np.pi / n_theta)  # strictly brackets the headings, as Capytaine asks
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=3) as pool:
        solved = pool.map(solve, [(panel, lid, omega, headings, theta) for omega in omegas], chunksize=1)
    data = cpt.assemble_dataset([r for results, _ in solved for r in results], hydrostatics=True)
    finite = [omega for omega in omegas if 0 < omega < np.inf]
    h = np.array([waves for _, waves in solved if waves is not None])
    far = xr.Dataset(
        {
            "kochin_radiation": (("omega", "radiating_dof", "theta"), h[:, :6]),
            "kochin_diffraction": (("omega", "wave_direction", "theta"), h[:, 6:]),
            "wavenumber": ("omega", np.array(finite) ** 2 / G),
        },
        coords={"omega": finite, "radiating_dof": list(DOFS), "wave_direction": headings, "theta": theta},
    ).assign_coords(rho=RHO, g=G, water_depth=np.inf)
    return data, far


def motions(data, omegas):
    """Response per unit wave amplitude of the free barge with LINEAR_DAMPING, [omega, radiating_dof, wave_direction].

    (-omega^2 (M + A) - i omega (B + B_lin) + K) X = F
    """
    d = data.sel(omega=omegas, influenced_dof=list(DOFS), radiating_dof=list(DOFS))
    pair, w = ("omega", "influenced_dof", "radiating_dof"), np.asarray(omegas)[:, None, None]
    b_lin = np.diag([LINEAR_DAMPING.get(dof, 0.0) for dof in DOFS])
    inertia = d.inertia_matrix.values + d.added_mass.transpose(*pair).values
    damping = b_lin + d.radiation_damping.transpose(*pair).values
    force = (d.Froude_Krylov_force + d.diffraction_force).transpose("omega", "influenced_dof", "wave_direction")
    x = np.linalg.solve(-(w**2) * inertia - 1j * w * damping + d.hydrostatic_stiffness.values, force.values)
    dims = ("omega", "radiating_dof", "wave_direction")
    return xr.DataArray(x, coords=[omegas, list(DOFS), d.wave_direction.values], dims=dims)


# --- mean drift


def yaw_drift(far, x):
    """Mean yaw moment about the z axis through the CG, counter-clockwise positive [N m/m2], (omega, wave_direction).

    Balance of angular momentum in the far field (Newman 1967), deep water:
    M = -(2 pi rho omega / k) Im H'(beta) - 4 pi^2 rho k sum_m m |h_m|^2, with H = sum_m h_m e^{i m theta}
    the Kochin function of all waves the barge sends out. The Fourier sum gives H' without differencing.
    """
    h = (far.kochin_diffraction + (far.kochin_radiation * x).sum("radiating_dof")).transpose(..., "theta")
    h = h.values[..., 1:-2]  # one turn, from theta = 0
    n = h.shape[-1]
    order, modes = np.fft.fftfreq(n, 1 / n), np.fft.fft(h, axis=-1) / n
    beta = far.wave_direction.values
    slope = np.einsum("wbm,bm->wb", 1j * order * modes, np.exp(1j * np.outer(beta, order)))
    k, w = far.wavenumber.values[:, None], far.omega.values[:, None]
    spin = (order * np.abs(modes) ** 2).sum(-1)
    return -(2 * np.pi * RHO * w / k) * slope.imag - 4 * np.pi**2 * RHO * k * spin


def mean_drift(far, x):
    """Mean drift force per wave amplitude squared [N/m2, N m/m2], (omega, wave_direction, six components).

    Surge and sway from Capytaine's far field (momentum) method, yaw from `yaw_drift`; heave, roll, pitch are zero.
    """
    pairs = cpt.post_pro.far_field_mean_drift_force(x, far)
    out = np.zeros((far.sizes["omega"], far.sizes["wave_direction"], 6))
    for column, name in ((0, "drift_force_surge"), (1, "drift_force_sway")):
        out[..., column] = np.diagonal(pairs[name].values, axis1=1, axis2=2).real
    out[..., 5] = yaw_drift(far, x)
    return out


# --- the file


def full_circle(quadrant):
    """Values of six components at the headings of QUADRANT (axis 1), mirrored to the 32 headings of the circle."""
    total, count = np.zeros((quadrant.shape[0], 32, 6), quadrant.dtype), np.zeros(32)
    for i in range(9):
        for j, sign in ((i, 1), (16 - i, MIRROR_X), (-i % 32, MIRROR_Y), (16 + i, MIRROR_X * MIRROR_Y)):
            total[:, j] += sign * quadrant[:, i]
            count[j] += 1
    return total / count[:, None]


def on_full_circle(data, far):
    """The dataset with all headings, the limit of long waves at omega = 0, and the mean drift force."""
    dims = ("omega", "wave_direction", "influenced_dof")
    omega = data.omega.values
    out = data.drop_dims("wave_direction").assign_coords(wave_direction=np.arange(32) * np.pi / 16)
    for name in ("Froude_Krylov_force", "diffraction_force"):
        force = full_circle(data[name].transpose(*dims).sel(influenced_dof=list(DOFS)).values)
        force[omega == 0] = 0.0
        if name == "Froude_Krylov_force":
            force[omega == 0, :, 2] = RHO * G * LENGTH * BREADTH
        out[name] = (dims, force, {**data[name].attrs, "units": "N/m, N m/m"})
    drift = np.full(force.shape, np.nan)
    drift[omega == 0] = 0.0
    drift[(omega > 0) & (omega < np.inf)] = full_circle(mean_drift(far, motions(data, far.omega.values)))
    note = "free barge with linear_damping, no mooring; yaw about the CG, counter-clockwise; other components zero"
    out["mean_drift_force"] = (dims, drift, {"long_name": "Mean drift force", "units": "N/m^2, N m/m^2", "note": note})
    same = (MIRROR_X[:, None] == MIRROR_X) & (MIRROR_Y[:, None] == MIRROR_Y)  # the other couplings are zero by symmetry
    for name in ("added_mass", "radiation_damping"):
        out[name] = out[name].where(xr.DataArray(same, dims=("influenced_dof", "radiating_dof")), 0.0)
    damping = np.diag([LINEAR_DAMPING.get(dof, 0.0) for dof in DOFS])
    out["linear_damping"] = (("influenced_dof", "radiating_dof"), damping, {"units": "N s/m, N m s"})
    out["disp_volume"] = ((), LENGTH * BREADTH * DRAFT, {"units": "m^3"})
    out["waterplane_area"] = ((), LENGTH * BREADTH, {"units": "m^2"})
    return out


def write(data, path):
    """Write Capytaine's layout, values rounded to 24 bits and compressed; no dates, no settings of the machine."""
    out = cpt.io.xarray.separate_complex_values(data)
    encoding = {}
    for name in ("radiating_dof", "influenced_dof"):
        out[name] = out[name].astype(str)
        encoding[name] = {"dtype": "U"}
    for name, values in out.data_vars.items():
        if values.ndim > 2:
            out[name] = values.astype(np.float32).astype(np.float64)
            encoding[name] = {"zlib": True, "complevel": 9, "shuffle": True}
    version = data.attrs["capytaine_version"]
    out.attrs = {"title": "Box barge 240 x 46 x 10 m in deep water", "source": f"Capytaine {version}, indirect method"}
    out.to_netcdf(path, encoding=encoding)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("barge-240x46x10.nc"))
    parser.add_argument("--panel", type=float, default=1.92, help="largest panel of the hull [m]; lambda/8 at 2 rad/s")
    parser.add_argument("--step", type=float, default=0.02, help="step of omega up to 2 rad/s")
    args = parser.parse_args()
    omegas = [0.0, *np.round(np.arange(args.step, 2.0 + args.step / 2, args.step), 6), np.inf]
    write(on_full_circle(*compute(args.panel, omegas)), args.out)


if __name__ == "__main__":
    main()
