"""WAMIT's numeric files of hydrodynamic data, in WAMIT's columns and powers."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ....case.vessel import WamitFiles
from ....outcome import DataError
from ..hydrodynamics import HydrodynamicData
from ..qtf import QTF
from .first import Scale
from .text import Array


def write_wamit(data: HydrodynamicData, stem: str, length: float | None = None) -> dict[str, bytes]:
    """The files by name: .1 and .3, and .4, .8 or .9, .12d, .hst for what there is.

    length : ULEN [m]; by default that of the files the data came from, else 1. Columns hold periods, values are made
    dimensionless by `data.density`, `data.gravity` and ULEN about `data.reference_point`; conventions_of says them.
    Raises DataError when the data hold nothing that a file could.
    """
    options = conventions_of(data, length)
    assert options.length is not None
    scale = Scale(float(options.length), data.density, data.gravity)
    rows = {".1": _radiation(data, scale), ".3": _forces(data, data.excitation / scale.force())}
    if data.motions is not None:
        rows[".4"] = _forces(data, data.motions / scale.motion())
    if data.mean_drift is not None:
        rows[_drift_kind(data)] = _drift(data, scale)
    if data.qtf is not None:
        rows[".12d"] = _pairs(data.qtf, scale)
    if data.hydrostatic_stiffness is not None:
        rows[".hst"] = _stiffness(data.hydrostatic_stiffness / scale.stiffness())
    return {f"{stem}{kind}": "".join(lines).encode("ascii") for kind, lines in rows.items()}


def conventions_of(data: HydrodynamicData, length: float | None = None) -> WamitFiles:
    """What the files that write_wamit makes do not say. Raises DataError without a centre of gravity for the .hst."""
    told = data.provenance.get("conventions", {}) if data.provenance.get("format") == "WAMIT" else {}
    centre = data.centre_of_mass
    if data.hydrostatic_stiffness is not None and centre is None:
        raise DataError(
            f"{data.name}: the hydrostatic stiffness is there without the centre of gravity it contains; give both or none"
        )
    return WamitFiles(
        length=length or told.get("length") or 1.0,
        density=data.density,
        gravity=data.gravity,
        depth=None if math.isinf(data.depth) else data.depth,
        first_column="periods",
        pair_columns="periods",
        drift="auto" if data.mean_drift is None else _drift_kind(data),
        centre_of_mass=None if centre is None else (float(centre[0]), float(centre[1]), float(centre[2])),
    )


def _drift_kind(data: HydrodynamicData) -> str:
    """.8 for surge, sway and yaw alone, .9 for all six."""
    assert data.mean_drift is not None
    return ".9" if np.any(data.mean_drift[..., 2:5]) else ".8"


def _number(value: float) -> str:
    return f" {value + 0.0:13.6E}"


def _complex(value: complex) -> str:
    phase = math.degrees(math.atan2(value.imag, value.real))
    return f"{_number(abs(value))}{_number(phase)}{_number(value.real)}{_number(value.imag)}\n"


def _period(omega: float) -> str:
    if omega == 0.0:
        return _number(-1.0)
    return _number(0.0 if math.isinf(omega) else 2.0 * math.pi / omega)


def _degrees(angles: Array) -> list[str]:
    return [_number(round(math.degrees(angle), 9)) for angle in angles]


def _radiation(data: HydrodynamicData, scale: Scale) -> Iterator[str]:
    factor = scale.radiation()
    limits = [(0.0, data.added_mass_zero), (math.inf, data.added_mass_infinite)]
    there = [(omega, matrix) for omega, matrix in limits if matrix is not None]
    everything = [data.added_mass, data.damping, *(matrix[None] for _, matrix in there)]
    used = np.argwhere(np.concatenate(everything).any(axis=0)).tolist()  # the others vanish by symmetry
    for omega, matrix in there:
        for i, j in used:
            yield f"{_period(omega)}{i + 1:6d}{j + 1:6d}{_number(matrix[i, j] / factor[i, j])}\n"
    for w, omega in enumerate(data.omega):
        added, damping = data.added_mass[w] / factor, data.damping[w] / (factor * omega)
        for i, j in used:
            yield f"{_period(omega)}{i + 1:6d}{j + 1:6d}{_number(added[i, j])}{_number(damping[i, j])}\n"


def _forces(data: HydrodynamicData, values: Array) -> Iterator[str]:
    degrees = _degrees(data.headings)
    for w, omega in enumerate(data.omega):
        for h, degree in enumerate(degrees):
            for i in range(6):
                yield f"{_period(omega)}{degree}{i + 1:6d}{_complex(complex(values[w, h, i]))}"


def _drift(data: HydrodynamicData, scale: Scale) -> Iterator[str]:
    assert data.mean_drift is not None
    values = data.mean_drift / scale.drift()
    modes = (0, 1, 5) if _drift_kind(data) == ".8" else range(6)
    degrees = _degrees(data.drift_headings)
    for w, omega in enumerate(data.drift_omega):
        for h, degree in enumerate(degrees):
            for i in modes:
                yield f"{_period(omega)}{degree}{degree}{i + 1:6d}{_complex(complex(values[w, h, i]))}"


def _pairs(qtf: QTF, scale: Scale) -> Iterator[str]:
    degrees, factor = _degrees(qtf.headings), scale.drift()
    count = qtf.omega.size
    for h, degree in enumerate(degrees):
        values = qtf.values[h] / factor
        for n in range(count):
            for m in range(n, count):
                yield from _pair(qtf, values, m, n, degree, degree)
    for (a, b), table in qtf.cross.items():
        values = table / factor
        for n in range(count):
            for m in range(count):
                yield from _pair(qtf, values, m, n, degrees[a], degrees[b])


def _pair(qtf: QTF, values: Array, m: int, n: int, first: str, second: str) -> Iterator[str]:
    if np.isnan(values[m, n, 0]):
        return
    for i in range(6):
        head = f"{_period(qtf.omega[m])}{_period(qtf.omega[n])}{first}{second}"
        yield f"{head}{i + 1:6d}{_complex(complex(values[m, n, i]))}"


def _stiffness(values: Array) -> Iterator[str]:
    for i in range(6):
        for j in range(6):
            yield f"{i + 1:6d}{j + 1:6d}{_number(values[i, j])}\n"
