"""VolturnUS-S: its public panel mesh through our boundary elements beside its public WAMIT data.

    python docs/bem_volturnus.py /path/to/OpenFAST/IEA-15-240-RWT-UMaineSemi/HydroData

The folder holds umainesemi.gdf, .1 and .3 (IEAWindTask37/IEA-15-240-RWT, Apache-2.0). Takes about ten minutes on one free
core and 0.8 GB; the table of docs/hydrodynamics-bem.md comes from it.
"""

import argparse
from pathlib import Path

import numpy as np

from solver.bem import parse_job, prepare
from solver.bem.job import compute
from solver.case.vessel import WamitFiles
from solver.vessel.data import FileSource, HydrodynamicData, read_bytes

DOF = ("surge", "sway", "heave", "roll", "pitch", "yaw")
PAIRS = ((0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (0, 4), (1, 3))
OMEGA = tuple(round(0.1 * step, 1) for step in range(2, 13))  # rad/s
JOB = {
    "name": "VolturnUS-S",
    "geometry": {"mesh": "umainesemi.gdf"},
    "water": {"depth": 200, "density": 1025, "gravity": 9.80665},
    "body": {"centre_of_gravity": [0, 0, 0], "mass": 2.0118e7, "radii_of_gyration": [47.03, 47.03, 34.5]},
    "frequencies": list(OMEGA),
    "headings": ["0 deg", "30 deg", "90 deg"],
    "limits": False,
}


def compare(ours: HydrodynamicData, theirs: HydrodynamicData) -> None:
    """Largest differences over the peak of each coefficient from 0.2 to 1.2 rad/s."""
    band = (theirs.omega >= OMEGA[0] - 1e-6) & (theirs.omega <= OMEGA[-1] + 1e-6)
    added_mass, damping = theirs.radiation_at(ours.omega)
    for i, j in PAIRS:
        row = [f"{DOF[i]}-{DOF[j]}:" if i != j else f"{DOF[i]}:"]
        for name, mine, other, all_of in (
            ("A", ours.added_mass, added_mass, theirs.added_mass),
            ("B", ours.damping, damping, theirs.damping),
        ):
            peak = np.abs(all_of[band][:, i, j]).max()
            row.append(f"{name} {100 * np.abs(mine[:, i, j] - other[:, i, j]).max() / peak:.1f} %")
        print(*row)
    for index, heading in enumerate(ours.headings):
        other = theirs.excitation_at(ours.omega, float(heading))
        here = int(np.argmin(np.abs(theirs.headings - heading)))
        peak = np.abs(theirs.excitation[band][:, here]).max(axis=0)
        floor = 1e-3 * np.abs(theirs.excitation[band]).max(axis=(0, 1))
        gap = 100 * np.abs(ours.excitation[:, index] - other).max(axis=0) / np.maximum(peak, floor)
        print(f"excitation, {np.degrees(heading):.0f} deg:", *(f"{d} {g:.1f} %" for d, g in zip(DOF, gap, strict=True)))
    if ours.mean_drift is not None:
        print("mean drift [kN/m2], surge, sway, by frequency and heading:")
        print(np.round(ours.mean_drift[:, :, :2] / 1e3, 1).tolist())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder of umainesemi.gdf, .1 and .3")
    folder = parser.parse_args().folder
    job = parse_job(JOB)
    hull = prepare(job, lambda name: ((folder / name).read_bytes(), name))
    made = compute(job, hull, None, lambda at: print(f"\r{100 * at.fraction:.0f} %  {at.message}      ", end=""))
    print(*made.warnings, sep="\n")
    conventions = WamitFiles(length=1.0, density=1025.0, gravity=9.80665, depth=200.0, centre_of_mass=(0.0, 0.0, 0.0))
    compare(read_bytes(made.payload, "volturnus.nc"), FileSource(folder).open("umainesemi.1", conventions))


if __name__ == "__main__":
    main()
