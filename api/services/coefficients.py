"""Arrays of hydrodynamic data, to draw."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from solver.outcome import CaseError, DataError, FieldError
from solver.vessel.data import HydrodynamicData
from solver.vessel.data.interpolate import heading_weights
from solver.vessel.radiation import retardation

from ..schemas import Coefficients, Series

Array = np.ndarray
MOST = 1_000_000  # numbers in one answer
UNITS = {
    "added_mass": "kg, kg m, kg m2",
    "damping": "N s/m, N s, N m s",
    "retardation": "N/m, N, N m",
    "excitation": "N/m, N m/m",
    "motions": "m/m, rad/m",
    "mean_drift": "N/m2, N m/m2",
    "qtf": "N/m2, N m/m2",
}


def coefficients(
    data: HydrodynamicData, quantity: str, i: int | None, j: int | None, heading: float | None
) -> Coefficients:
    """Series of one quantity; heading [deg]. Raises CaseError for what the data do not hold."""
    found: Callable[..., Coefficients] = {
        "qtf": _qtf,
        "retardation": _pairs,
        "added_mass": _pairs,
        "damping": _pairs,
    }.get(quantity, _forces)
    answer = found(data, quantity, i, j, heading)
    size = sum(np.size(series.values) for series in answer.series)
    if size > MOST:
        raise _fault("i", f"{size} numbers; allowed: at most {MOST} in one answer; give i, or a heading")
    return answer


def _pairs(data: HydrodynamicData, quantity: str, i: int | None, j: int | None, _: float | None) -> Coefficients:
    zero = infinite = None
    if quantity == "retardation":
        kernel, _warnings = retardation(data.symmetric())
        axis, table = {"time": kernel.times.tolist()}, kernel.kernel
        infinite = kernel.added_mass_infinite
    else:
        axis, table = {"omega": data.omega.tolist()}, getattr(data, quantity)
        if quantity == "added_mass":
            zero, infinite = data.added_mass_zero, data.added_mass_infinite
        else:
            zero = np.zeros((6, 6))
    series = [
        Series(i=a, j=b, values=table[:, a, b].tolist(), zero=_entry(zero, a, b), infinite=_entry(infinite, a, b))
        for a in _chosen(i)
        for b in _chosen(j)
    ]
    return Coefficients(quantity=quantity, unit=UNITS[quantity], series=series, **axis)


def _forces(data: HydrodynamicData, quantity: str, i: int | None, _: int | None, heading: float | None) -> Coefficients:
    table: Array | None = getattr(data, quantity)
    if table is None:
        raise _fault("quantity", f"the data hold no {quantity}", quantity)
    drift = quantity == "mean_drift"
    omega, headings = (data.drift_omega, data.drift_headings) if drift else (data.omega, data.headings)
    if heading is None:
        chosen = [(math.degrees(angle), table[:, h]) for h, angle in enumerate(headings)]
    else:
        a, b, w = _weights(headings, heading, data.name)
        chosen = [(heading, (1 - w) * table[:, a] + w * table[:, b])]
    series = [_series(values[:, a], i=a, heading_deg=round(angle, 6)) for angle, values in chosen for a in _chosen(i)]
    return Coefficients(quantity=quantity, unit=UNITS[quantity], omega=omega.tolist(), series=series)


def _qtf(data: HydrodynamicData, quantity: str, i: int | None, _: int | None, heading: float | None) -> Coefficients:
    qtf = data.qtf
    if qtf is None:
        raise _fault("quantity", "the data hold no full QTF", quantity)
    if i is None:
        raise _fault("i", "is needed for the QTF: 0 (surge) to 5 (yaw)")
    angle = math.degrees(qtf.headings[0]) if heading is None else heading
    a, b, w = _weights(qtf.headings, angle, qtf.name)
    table = (1 - w) * qtf.values[a, ..., i] + w * qtf.values[b, ..., i]
    series = [_series(table, i=i, heading_deg=round(angle, 6))]
    return Coefficients(quantity=quantity, unit=UNITS[quantity], omega=qtf.omega.tolist(), series=series)


def _weights(headings: Array, heading: float, name: str) -> tuple[int, int, float]:
    try:
        return heading_weights(headings, math.radians(heading), name, reach=0.0)
    except DataError as error:
        raise _fault("heading", str(error), f"{heading:g}") from None


def _series(values: Array, **where: Any) -> Series:
    imaginary = _plain(values.imag) if np.iscomplexobj(values) else None
    return Series(values=_plain(values.real), imaginary=imaginary, **where)


def _plain(values: Array) -> list[Any]:
    if np.isfinite(values).all():
        return list(values.tolist())
    return list(np.where(np.isfinite(values), values, None).tolist())  # type: ignore[call-overload]


def _entry(matrix: Array | None, i: int, j: int) -> float | None:
    return None if matrix is None else float(matrix[i, j])


def _chosen(index: int | None) -> range:
    return range(6) if index is None else range(index, index + 1)


def _fault(field: str, message: str, value: str = "") -> CaseError:
    return CaseError([FieldError((field,), message, value)])
