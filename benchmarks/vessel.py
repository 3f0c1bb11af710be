"""Median times of the vessel's hydrodynamics: retardation functions, their transform, Newman's slow drift, the reader.

    python benchmarks/vessel.py [--repeat 15] [--data hull.nc]

Without --data: a made-up hull of 100 frequencies and 16 headings.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from solver.case.environment import Jonswap
from solver.vessel.data import HydrodynamicData, read_bytes
from solver.vessel.drift import Drift, drift_spectrum
from solver.vessel.radiation import retardation
from solver.waves.spectra import spectrum

SEA = Jonswap(spectrum="jonswap", hs=8.0, tp=11.0, gamma=2, direction="0 deg")


def made_up() -> HydrodynamicData:
    """Damping with a hump, added mass that falls, forces and drift that rise with frequency."""
    omega, headings = np.arange(1, 101) * 0.02, np.arange(16) * np.pi / 8
    size = 1e7 * np.diag([0.3, 0.8, 1.5, 8.0, 15.0, 12.0])
    size[0, 4] = size[4, 0] = 2e6
    w = omega[:, None, None]
    force = np.zeros((omega.size, headings.size, 6), complex)
    force[:] = 1e6 * np.exp(1j * w) * np.cos(headings)[:, None]
    drift = np.zeros(force.shape)
    drift[..., [0]] = 2e4 * w * np.cos(headings)[:, None]
    drift[..., [1]] = 5e4 * w * np.sin(headings)[:, None]
    drift[..., [5]] = 3e5 * w * np.sin(2 * headings)[:, None]
    return HydrodynamicData(
        name="made up", content_hash="", omega=omega, headings=headings, added_mass=(1 + 0.5 / (1 + w**2)) * size,
        damping=0.3 * w**4 / (w**6 + 0.5) * size, excitation=force, added_mass_zero=1.5 * size,
        added_mass_infinite=size, excitation_zero=None, mean_drift=drift, hydrostatic_stiffness=None,
        displaced_volume=None, centre_of_buoyancy=None, centre_of_mass=None, reference_point=np.zeros(3),
        density=1025.0, gravity=9.807, depth=np.inf,
    )  # fmt: skip


def median_ms(function: Callable[[], Any], repeat: int) -> float:
    """Median of `repeat` calls after a first one [ms]."""
    function()
    times = []
    for _ in range(repeat):
        started = time.perf_counter()
        function()
        times.append(time.perf_counter() - started)
    return 1e3 * statistics.median(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeat", type=int, default=15, help="calls of each; the median is shown")
    parser.add_argument("--data", type=Path, help="hydrodynamic data in NetCDF")
    given = parser.parse_args()
    payload = given.data.read_bytes() if given.data else b""
    data = read_bytes(payload, given.data.name) if given.data else made_up()
    kernel, _ = retardation(data)
    low = float(data.omega[0])
    high = min(1.2, float(data.omega[-1]))
    omega, slow = np.linspace(low, high, 400), np.arange(1, 161) * 0.00125
    seas = [(lambda w: spectrum(w, SEA), float(data.headings[0]))]
    measured: dict[str, Callable[[], Any]] = {
        "retardation functions": lambda: retardation(data),
        "transform at 400 frequencies": lambda: kernel.transform(omega),
        "radiation at 400 frequencies": lambda: data.radiation_at(omega),
    }
    if data.mean_drift is not None:
        measured["Newman's spectrum at 160 differences"] = lambda: drift_spectrum(
            slow, seas, Drift(data, "newman"), low, high
        )
    if payload:
        measured["reading the file"] = lambda: read_bytes(payload, given.data.name)
    for what, function in measured.items():
        print(f"{what:40s} {median_ms(function, given.repeat):9.2f} ms")


if __name__ == "__main__":
    main()
