"""Small sets of WAMIT's files with known content, and the public one of the VolturnUS-S where it is there."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest

from solver.case.vessel import WamitFiles
from solver.vessel.data import QTF, HydrodynamicData
from solver.vessel.data.wamit import write_wamit

OPTIONS = WamitFiles(length=10.0, density=1025.0, gravity=9.807, centre_of_mass=(0.0, 0.0, 2.0))


def qtf(omega, headings, seed=3, cross=((0, 1),), reach=np.inf) -> QTF:
    """A random Hermitian T2, smooth enough to be one of several degrees of freedom."""
    rng = np.random.default_rng(seed)
    n, h = len(omega), len(headings)

    def table():
        return 1e4 * (rng.normal(size=(n, n, 6)) + 1j * rng.normal(size=(n, n, 6)))

    values = np.array([part + np.conj(part.transpose(1, 0, 2)) for part in (table() for _ in range(h))])
    far = np.abs(np.subtract.outer(omega, omega)) > reach
    values[:, far] = np.nan
    pairs = {pair: table() for pair in cross}
    return QTF(np.asarray(omega, float), np.asarray(headings, float), values, "t.12d", pairs)


def whole(seed=0, drift="all") -> HydrodynamicData:
    """Data with everything that WAMIT's files can say, of random numbers: no body has them."""
    rng = np.random.default_rng(seed)
    omega, headings = np.array([0.3, 0.5, 0.8, 1.1, 1.5]), np.radians([0.0, 45.0, 90.0, 180.0, 270.0])
    w, h = omega.size, headings.size
    size = 10.0 ** np.array([6, 6, 6, 8, 8, 8])
    stiffness = np.zeros((6, 6))
    stiffness[2:5, 2:5] = [[1e6, 1e5, 2e5], [1e5, 3e8, 1e6], [2e5, 1e6, 5e8]]
    mean = rng.normal(size=(w, h, 6)) * 1e3
    if drift == "plane":
        mean[..., 2:5] = 0.0

    def matrices(*shape):
        return rng.normal(size=(*shape, 6, 6)) * np.sqrt(np.outer(size, size))

    def long_waves(values):  # the heave force is largest in long waves
        values[:, :, 2] = (1e6 / (1 + (3 * omega) ** 4))[:, None] * np.exp(1j * rng.normal(size=(w, h)))
        return values

    return HydrodynamicData(
        name="t", content_hash="", omega=omega, headings=headings, added_mass=matrices(w), damping=matrices(w),
        excitation=long_waves((rng.normal(size=(w, h, 6)) + 1j * rng.normal(size=(w, h, 6))) * size),
        added_mass_zero=matrices(), added_mass_infinite=matrices(), excitation_zero=None, mean_drift=mean,
        hydrostatic_stiffness=stiffness, displaced_volume=None, centre_of_buoyancy=None,
        centre_of_mass=np.array([0.0, 0.0, 2.0]), reference_point=np.zeros(3), density=1025.0, gravity=9.807,
        depth=np.inf, qtf=qtf(omega[1:], headings[:2]),
        motions=rng.normal(size=(w, h, 6)) + 1j * rng.normal(size=(w, h, 6)),
    )  # fmt: skip


def files(data: HydrodynamicData | None = None, length: float = 10.0) -> dict[str, bytes]:
    return write_wamit(data or whole(), "t", length)


def without(data: HydrodynamicData, *names: str) -> HydrodynamicData:
    return dataclasses.replace(data, **dict.fromkeys(names))


def volturnus() -> dict[str, bytes]:
    """The public files by name; skips, saying why, where they are not."""
    beside = Path(__file__).resolve().parents[3] / "shared" / "data" / "volturnus-s"
    folder = Path(os.environ.get("SLOWDRIFT_VOLTURNUS") or beside)
    if not (folder / "umainesemi.1").is_file():
        pytest.skip("the public WAMIT files of the VolturnUS-S are not here; SLOWDRIFT_VOLTURNUS may name their folder")
    return {
        name: (folder / name).read_bytes()
        for name in ("umainesemi.1", "umainesemi.3", "umainesemi.12d", "umainesemi.hst")
    }


VOLTURNUS = WamitFiles(length=1.0, density=1025.0, gravity=9.80665, depth=200.0, centre_of_mass=(0.0, 0.0, 0.0))
