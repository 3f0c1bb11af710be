"""Hydrodynamic coefficients over frequency: added mass, damping, excitation, mean drift, QTF."""

from __future__ import annotations

from typing import Any

import numpy as np

from frontend.figures.base import FREQUENCY, Figure, axis, curve, figure, titled
from frontend.format import DOFS
from frontend.theme import CYCLE


def _scaled(values: np.ndarray) -> tuple[np.ndarray, str]:
    """Divided by the power of 1000 that leaves readable numbers, and that power in words."""
    largest = float(np.nanmax(np.abs(values), initial=0.0))
    power = 3 * int(max(np.floor(np.log10(largest) / 3), 0)) if largest > 0 else 0
    return values / 10.0**power, {0: "", 3: "10³ ", 6: "10⁶ ", 9: "10⁹ ", 12: "10¹² "}.get(power, f"10^{power} ")


def _unit(said: str, kind: int) -> str:
    """The unit of a force, a coupling or a moment out of the three that the service names."""
    parts = [part.strip() for part in said.replace(";", ",").split(",")]
    return parts[min(kind, len(parts) - 1)]


def _drawn(omega: Any, series: list[tuple[str, np.ndarray]], unit: str, title: str, height: int) -> Figure:
    _, power = _scaled(np.array([values for _, values in series]))
    factor = _scaled(np.array([values for _, values in series]))[0]
    data = [
        curve(omega, values, name, CYCLE[k % len(CYCLE)], unit, ("solid", "dash", "dot", "longdash")[k % 4])
        for k, ((name, _), values) in enumerate(zip(series, factor, strict=True))
    ]
    return figure(
        data, height, xaxis=axis(FREQUENCY, rangemode="tozero"), yaxis=axis(titled(title, f"{power}{unit}")),
    )  # fmt: skip


def coefficients(found: dict[str, Any], row: str, rotation: bool, height: int = 320) -> Figure | None:
    """Added mass or damping: the diagonal, or one motion with the others; translations and rotations apart."""
    chosen = []
    for one in found["series"]:
        i, j = one["i"], one["j"]
        wanted = i == j if row == "diagonal" else i == DOFS.index(row)
        if wanted and (j >= 3) == rotation:
            name = DOFS[j] if row == "diagonal" else f"{DOFS[i]}, {DOFS[j]}"
            chosen.append((name, np.array(one["values"], dtype=float), (i >= 3) + (j >= 3)))
    if not chosen:
        return None
    title = "A" if found["quantity"] == "added_mass" else "B"
    unit = _unit(found["unit"], chosen[0][2])
    return _drawn(found["omega"], [(name, values) for name, values, _ in chosen], unit, title, height)


def excitation(found: dict[str, Any], rotation: bool, height: int = 320) -> Figure:
    """The size of first-order loads per metre of wave amplitude."""
    series = [
        (DOFS[one["i"]], np.abs(np.array(one["values"]) + 1j * np.array(one["imaginary"])))
        for one in found["series"]
        if (one["i"] >= 3) == rotation
    ]
    return _drawn(found["omega"], series, _unit(found["unit"], 2 if rotation else 0), "size of F₁", height)


def drift(found: dict[str, Any], rotation: bool, height: int = 320) -> Figure | None:
    """Mean drift per amplitude squared."""
    series = [
        (DOFS[one["i"]], np.array([np.nan if v is None else v for v in one["values"]], dtype=float))
        for one in found["series"]
        if (one["i"] >= 3) == rotation
    ]
    series = [(name, values) for name, values in series if np.nanmax(np.abs(values), initial=0.0) > 0]
    if not series:
        return None
    return _drawn(found["omega"], series, _unit(found["unit"], 2 if rotation else 0), "F₂", height)


def qtf(found: dict[str, Any], height: int = 420) -> Figure | None:
    """The size of the difference-frequency QTF over both frequencies."""
    if not found["series"]:
        return None
    one = found["series"][0]
    real = np.array([[np.nan if v is None else v for v in row] for row in one["values"]], dtype=float)
    imaginary = np.array([[np.nan if v is None else v for v in row] for row in one["imaginary"]], dtype=float)
    size, power = _scaled(np.hypot(real, imaginary))
    unit = f"{power}{_unit(found['unit'], 2 if one['i'] >= 3 else 0)}"
    heat = {
        "type": "heatmap", "x": found["omega"], "y": found["omega"], "z": size, "colorscale": "Viridis",
        "colorbar": {"title": {"text": unit, "side": "right"}, "thickness": 14},
        "hovertemplate": "ω₁ %{y:.3f}, ω₂ %{x:.3f} rad/s: %{z:.4~g}<extra></extra>",
    }  # fmt: skip
    return figure(
        [heat], height, legend=False, hovermode="closest", xaxis=axis("ω₂ [rad/s]", constrain="domain"),
        yaxis=axis("ω₁ [rad/s]", scaleanchor="x", constrain="domain"),
    )  # fmt: skip
