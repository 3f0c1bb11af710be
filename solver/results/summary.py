"""The summary of a run (docs/summary.md): plain data, SI and radians."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from ..case.quantities import DOF
from ..case.section import line_weight_in_water
from ..forces import axial
from ..model.build import Model
from ..waves.spectra import hs_in_band, significant_height
from .line_types import line_types_summary
from .line_values import grounded_length, largest, utilisation
from .slack import linear_warnings
from .solved import END_FORCES, ORIGINS, Solved, Spectra
from .statistics import combined_maximum, most_probable_maximum, significant
from .strain import allowed_tension, strain_warnings

Array = np.ndarray
BANDS = ("wf", "lf")


def solver_version() -> str:
    """Version of the installed package."""
    try:
        return version("slowdrift")
    except PackageNotFoundError:
        return "0+unknown"


def make_summary(solved: Solved, analyses: tuple[str, ...], compile_time: float) -> dict[str, Any]:
    """The summary of what was solved, for the analyses asked for."""
    out: dict[str, Any] = {"case": solved.model.case.name, "analyses": list(analyses)}
    out["line_types"] = line_types_summary(solved.model.case)
    if "statics" in analyses:
        out["statics"] = _statics(solved)
    if solved.frequency is not None and "frequency_domain" in analyses:
        out["frequency_domain"] = _frequency(solved)
    if solved.modes is not None and "modes" in analyses:
        out["modes"] = _modes(solved)
        if solved.modes.equivalent is not None:
            out["line_coefficients"] = _coefficients(solved)
    found = [*solved.model.warnings, *solved.static.warnings]
    if solved.frequency is not None:
        found += solved.frequency.warnings
        if "frequency_domain" in out:
            found += linear_warnings(solved, out["frequency_domain"]["lines"])
    found += _strains(solved, out)
    out["warnings"] = list(dict.fromkeys(found))
    out["failures"] = dict(solved.failures)
    out["provenance"] = provenance(solved.model)
    out["compile_time"] = compile_time
    return out


def _strains(solved: Solved, summary: dict[str, Any]) -> list[str]:
    """What to say of strains in statics and at the largest tension of the frequency domain."""
    said: list[str] = []
    by_line = summary.get("frequency_domain", {}).get("lines", {})
    for line, shape in zip(solved.lines, solved.static.state.shapes, strict=True):
        static, allowed = axial.tension(line.arrays, shape), allowed_tension(line)
        said += strain_warnings(line.name, line.element_arc, static, allowed, "in static equilibrium")
        found = by_line.get(line.name, {})
        largest = found.get("tension_most_probable_max", static + np.array(found.get("tension_amplitude", 0.0)))
        if found:
            said += strain_warnings(line.name, line.element_arc, np.array(largest), allowed, "in the frequency domain")
    return said


def _list(values: Array) -> list[Any]:
    return [float(value) for value in np.asarray(values).ravel()]


def _by_dof(values: Array) -> dict[str, float]:
    return dict(zip(DOF, _list(values), strict=True))


def _statics(solved: Solved) -> dict[str, Any]:
    state = solved.static.state
    lines: dict[str, Any] = {}
    for line, shape, forces in zip(solved.lines, state.shapes, state.end_forces, strict=True):
        end_b, end_a = solved.earth(forces[:3]), solved.earth(forces[3:])
        tension = axial.tension(line.arrays, shape)
        lines[line.name] = {
            "end_a": {
                "tension": float(np.linalg.norm(end_a)),
                "force": _list(end_a),
                "position": _list(solved.earth(shape[0])),
            },
            "end_b": {
                "tension": float(np.linalg.norm(end_b)),
                "force": _list(end_b),
                "position": _list(solved.earth(shape[-1])),
            },
            "arc_length": _list(line.element_arc),
            "tension": _list(tension),
            "length": line.length,
            "weight_in_water": line_weight_in_water(solved.model.case, line.name, line.length),
            "grounded_length": grounded_length(line, shape),
            "multiplicity": line.multiplicity,
        }
        ends = float(np.linalg.norm(end_a)), float(np.linalg.norm(end_b))
        lines[line.name]["largest"] = largest(line, tension, *ends)
        lines[line.name].update(utilisation(solved.model.case, line, tension, *ends))
    out: dict[str, Any] = {"converged": True, "iterations": state.iterations, "residual": float(state.residual)}
    if solved.model.vessel is not None:
        out["vessel"] = {"position": _list(solved.static.position), "mean_drift": _list(solved.static.drift)}
    return {**out, "lines": lines}


def _frequency(solved: Solved) -> dict[str, Any]:
    result = solved.frequency
    assert result is not None
    out: dict[str, Any] = {
        "converged": True, "iterations": result.iterations, "last_change": result.last_change,
        "wall_time": result.wall_time, "linearisation": result.spec.linearisation,
    }  # fmt: skip
    if solved.is_random:
        return {**out, **_random(solved)}
    out["lines"] = {
        line.name: {
            "arc_length": _list(line.element_arc),
            "tension_amplitude": _list(np.abs(result.wave.tension[i][0, :, 0])),
            **_end_amplitudes(solved, i),
        }
        for i, line in enumerate(solved.lines)
    }
    if result.wave.vessel is not None:
        out["vessel_amplitude"] = _by_dof(np.abs(result.wave.vessel[0, :, 0]))
    return out


def _random(solved: Solved) -> dict[str, Any]:
    assert solved.frequency is not None
    duration = float(solved.frequency.spec.storm_duration)
    out: dict[str, Any] = {"storm_duration": duration}
    spectra = solved.vessel_spectra
    if spectra is not None:
        std, extreme = _extremes(solved, spectra, duration)
        out["vessel_std"] = {band: _by_dof(std[band]) for band in BANDS}
        out["origin_std"] = {origin: _by_dof(np.sqrt(solved.variance(spectra, origin))) for origin in ORIGINS}
        out["vessel_significant"] = {band: _by_dof(significant(std[band])) for band in BANDS}
        out["vessel_most_probable_max"] = {band: _by_dof(extreme[band]) for band in (*BANDS, "combined")}
    lines: dict[str, Any] = {}
    for i, line in enumerate(solved.lines):
        tension = solved.tension_spectra(i)
        std, extreme = _extremes(solved, tension, duration)
        mean = axial.tension(line.arrays, solved.static.state.shapes[i])
        lines[line.name] = {
            "arc_length": _list(line.element_arc),
            "tension_mean": _list(mean),
            "tension_std": {band: _list(std[band]) for band in BANDS},
            "tension_origin_std": {origin: _list(np.sqrt(solved.variance(tension, origin))) for origin in ORIGINS},
            "tension_significant": {band: _list(significant(std[band])) for band in BANDS},
            "tension_most_probable_max": _list(mean + extreme["combined"]),
            **_ends(solved, i, duration),
        }
        tops = [lines[line.name][f"{end}_tension"]["most_probable_max"] for end in ("end_a", "end_b")]
        lines[line.name]["largest"] = largest(line, mean + extreme["combined"], *tops)
        lines[line.name].update(utilisation(solved.model.case, line, mean + extreme["combined"], *tops))
    return {**out, "lines": lines}


def _end_amplitudes(solved: Solved, index: int) -> dict[str, float]:
    """Amplitudes of the forces at the ends of a line in harmonic motion (F19)."""
    assert solved.frequency is not None
    size = dict(zip(END_FORCES, np.abs(solved.frequency.wave.ends[index][0, :, 0]), strict=True))
    return {
        "end_a_tension_amplitude": float(size["end_a_tension"]),
        "end_b_tension_amplitude": float(size["end_b_tension"]),
        "anchor_vertical_amplitude": float(size[f"{solved.lines[index].anchor_end}_vertical"]),
    }


def _ends(solved: Solved, index: int, duration: float) -> dict[str, Any]:
    """Mean, σ per band and most probable maximum of the forces at the ends of a line (F19)."""
    std, extreme = _extremes(solved, solved.end_spectra(index), duration)
    mean = solved.end_means(index)
    found = {
        name: {
            "mean": float(mean[row]),
            "std": {band: float(std[band][row]) for band in BANDS},
            "most_probable_max": float(mean[row] + extreme["combined"][row]),
        }
        for row, name in enumerate(END_FORCES)
    }
    anchor = solved.lines[index].anchor_end
    return {
        "end_a_tension": found["end_a_tension"],
        "end_b_tension": found["end_b_tension"],
        "anchor_vertical": found[f"{anchor}_vertical"],
    }


def _extremes(solved: Solved, spectra: Spectra, duration: float) -> tuple[dict[str, Array], dict[str, Array]]:
    """σ per band, and most probable maxima per band and combined."""
    std = {band: np.sqrt(solved.moments(spectra, band)) for band in BANDS}
    top = {band: most_probable_maximum(std[band], solved.moments(spectra, band, 2), duration) for band in BANDS}
    top["combined"] = combined_maximum(std["wf"], top["wf"], std["lf"], top["lf"])
    return std, top


def _modes(solved: Solved) -> list[dict[str, Any]]:
    assert solved.modes is not None
    return [
        {
            "period": mode.period, "label": mode.label, "damping_vessel": mode.damping_vessel,
            "damping_lines": mode.damping_lines, "mass_lines": mode.mass_lines,
        }
        for mode in solved.modes.modes
    ]  # fmt: skip


def _coefficients(solved: Solved) -> dict[str, Any]:
    assert solved.modes is not None
    equivalent = solved.modes.equivalent
    assert equivalent is not None
    names = ("inertia", "damping", "stiffness", "geometric")
    return {
        **{name: np.asarray(getattr(equivalent, name)).tolist() for name in names},
        "asymmetry_dropped": solved.modes.asymmetry,
    }


def provenance(model: Model) -> dict[str, Any]:
    case, frequency = model.case, model.case.analyses.frequency_domain
    out: dict[str, Any] = {"case_hash": case.content_hash(), "solver_version": solver_version()}
    if model.data is not None:
        out["data_hash"] = model.data.content_hash
    time_domain = case.analyses.time_domain
    out["seeds"] = (
        list(range(time_domain.first_seed, time_domain.first_seed + time_domain.seeds)) if time_domain else []
    )
    seas = []
    for sea in case.environment.random:
        low, high = (frequency.wave.from_, frequency.wave.to) if frequency is not None else (0.2, 1.2)
        found = {"hs": significant_height(sea), "hs_in_band": hs_in_band(sea, float(low), float(high))}
        if hasattr(sea, "peak_period"):
            found["tp"] = sea.peak_period
        seas.append(found)
    if seas:
        out["seastates"] = seas
        out["hs_in_band"] = float(np.sqrt(sum(sea["hs_in_band"] ** 2 for sea in seas)))
        if "tp" in seas[0]:
            out["tp"] = seas[0]["tp"]
    return out
