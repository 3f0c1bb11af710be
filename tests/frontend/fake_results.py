"""Synthetic results in the exact shapes of the contract: smooth curves that nobody could take for an analysis."""

from __future__ import annotations

from typing import Any

import numpy as np

LF = np.arange(1, 161) * 0.00125
WF = 0.2 + np.arange(200) * 0.005  # its first strip stands on the border too, as the solver has it
OMEGA = np.concatenate([LF, WF])
DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
LF_SIGMA = {"surge": 6.0, "sway": 4.0, "heave": 0.01, "roll": 0.002, "pitch": 0.001, "yaw": 0.02}
WF_SIGMA = {"surge": 1.2, "sway": 0.8, "heave": 1.5, "roll": 0.03, "pitch": 0.02, "yaw": 0.008}
PEAK = {"surge": 0.024, "sway": 0.021, "heave": 0.05, "roll": 0.05, "pitch": 0.05, "yaw": 0.0209}
LINES = {"bow-port": 45.0, "stern-port": 135.0, "stern-starboard": 225.0, "bow-starboard": 315.0}
ARC = np.linspace(0.0, 3300.0, 51)
MIDDLE = 0.5 * (ARC[1:] + ARC[:-1])
RISER = np.linspace(0.0, 170.0, 69)


def _bell(omega: np.ndarray, peak: float, width: float, sigma: float) -> np.ndarray:
    shape = np.exp(-0.5 * ((omega - peak) / width) ** 2)
    return shape / np.trapezoid(shape, omega) * sigma**2


def spectrum(dof: str) -> np.ndarray:
    low = _bell(LF, PEAK[dof], 0.004, LF_SIGMA[dof])
    return np.concatenate([low, _bell(WF, 0.42, 0.07, WF_SIGMA[dof])])


def channel(name: str, values: Any, axes: dict[str, tuple[str, Any]], unit: str) -> dict[str, Any]:
    made = [{"name": axis, "unit": u, "values": np.asarray(v).tolist()} for axis, (u, v) in axes.items()]
    return {
        "name": name, "unit": unit, "description": name.rsplit("/", 1)[1].replace("_", " "), "band": "total",
        "axes": made, "values": np.asarray(values).tolist(),
    }  # fmt: skip


def fpso_channels() -> dict[str, dict[str, Any]]:
    made: list[dict[str, Any]] = []
    omega = {"omega": ("rad/s", OMEGA)}
    wave = {"omega": ("rad/s", WF)}
    for dof in DOFS:
        turn = "rad" if dof in DOFS[3:] else "m"
        made.append(channel(f"frequency/vessel/{dof}", spectrum(dof), omega, f"{turn}2 s/rad"))
        amplitude = WF_SIGMA[dof] / (1 + ((WF - 0.35) / 0.12) ** 2)
        made.append(channel(f"frequency/vessel/{dof}_rao_amplitude", amplitude, wave, f"{turn}/m"))
        made.append(channel(f"frequency/vessel/{dof}_rao_phase", np.angle(np.exp(-4j * WF)), wave, "rad"))
    made.append(channel("frequency/wave/elevation", _bell(WF, 0.38, 0.08, 3.9), wave, "m2 s/rad"))
    for index, (line, azimuth) in enumerate(LINES.items()):
        made += _line_channels(line, np.radians(azimuth), 1.0 + 0.1 * index)
    period = [mode["period"] for mode in FPSO_MODES]
    made.append(channel("modes/vessel/period", period, {"mode": ("", np.arange(len(period)))}, "s"))
    return {item["name"]: item for item in made}


def _line_channels(line: str, azimuth: float, scale: float) -> list[dict[str, Any]]:
    nodes, middle, omega = {"arc_length": ("m", ARC)}, {"arc_length": ("m", MIDDLE)}, {"omega": ("rad/s", OMEGA)}
    s = ARC / ARC[-1]
    reach, height = 2350.0 * (1 - s) + 83.0, -2000.0 + 1990.0 * np.clip((s - 0.05) / 0.95, 0, 1) ** 1.6
    position = np.stack([reach * np.cos(azimuth), reach * np.sin(azimuth), height], axis=1)
    wf, lf = scale * 1.1e5 * (1.4 - 0.5 * MIDDLE / 3300.0), scale * 0.5e5 * np.ones_like(MIDDLE)
    top = np.concatenate([_bell(LF, 0.024, 0.004, lf[-1]), _bell(WF, 0.42, 0.08, wf[-1])])
    axes = {"arc_length": ("m", ARC), "axis": ("", [0, 1, 2])}
    static, frequency = f"static/line/{line}", f"frequency/line/{line}"
    return [
        channel(f"{static}/position", position, axes, "m"),
        channel(f"{static}/tension", 2.6e6 + 1.75e6 * MIDDLE / 3300.0, middle, "N"),
        channel(f"{static}/bending_moment", 400.0 * np.sin(np.pi * s), nodes, "N m"),
        channel(f"{frequency}/top_tension", top, omega, "N2 s/rad"),
        channel(f"{frequency}/tension_std_wf", wf, middle, "N"),
        channel(f"{frequency}/tension_std_lf", lf, middle, "N"),
        channel(f"{frequency}/tension_std", np.hypot(wf, lf), middle, "N"),
        channel(f"{frequency}/bending_moment_std", 250.0 * np.sin(np.pi * s), nodes, "N m"),
        *_shapes(line, s, axes),
    ]


def _shapes(line: str, s: np.ndarray, axes: dict[str, tuple[str, Any]]) -> list[dict[str, Any]]:
    """Motion of all nodes: growing towards the vessel, in a mode and in waves."""
    lean = s[:, None] * np.array([1.0, 0.5, 0.1])
    modes = {"mode": ("", np.arange(1.0, len(FPSO_MODES) + 1))} | axes
    waves = {"omega": ("rad/s", WF[::20])} | axes
    shape = np.stack([lean * (-1) ** k for k in range(len(FPSO_MODES))])
    rao = f"frequency/line/{line}/motion_rao"
    return [
        channel(f"modes/line/{line}/shape", shape, modes, "1"),
        channel(f"{rao}_amplitude", np.stack([lean / (1 + w) for w in WF[::20]]), waves, "m/m"),
        channel(f"{rao}_phase", np.stack([0 * lean - w for w in WF[::20]]), waves, "rad"),
    ]


def _mode(period: float, label: str, vessel: float, lines: float, mass: float) -> dict[str, Any]:
    return {
        "period": period, "label": label, "damping_vessel": vessel, "damping_lines": lines, "mass_lines": mass,
    }  # fmt: skip


FPSO_MODES = [
    _mode(300.0, "yaw", 0.05, 0.45, 0.11), _mode(290.0, "sway", 0.06, 0.30, 0.12),
    _mode(262.0, "surge", 0.05, 0.36, 0.15), _mode(52.4, "line", 0.001, 0.6, 0.97),
    _mode(21.0, "roll", 0.02, 0.001, 0.002),
]  # fmt: skip


def _end(force: float) -> dict[str, Any]:
    return {"tension": force, "force": [-0.6 * force, 0.0, -0.8 * force]}


def fpso_summary(name: str) -> dict[str, Any]:
    static = {
        line: {
            "end_a": _end(2.6e6), "end_b": _end(4.37e6), "arc_length": MIDDLE.tolist(),
            "tension": (2.6e6 + 1.75e6 * MIDDLE / 3300.0).tolist(),
        }
        for line in LINES
    }  # fmt: skip
    channels = fpso_channels()
    spread = {
        line: {
            "arc_length": MIDDLE.tolist(),
            "tension_std": {b: channels[f"frequency/line/{line}/tension_std_{b}"]["values"] for b in ("wf", "lf")},
        }
        for line in LINES
    }
    return {
        "case": name,
        "analyses": ["statics", "frequency_domain", "modes"],
        "statics": {
            "converged": True, "iterations": 11, "residual": 3.1e-5,
            "vessel": {"position": [-1.2, 0.4, -0.02, 0.0, 0.001, 0.002]}, "lines": static,
        },
        "frequency_domain": {
            "converged": True, "iterations": 6, "last_change": 4.2e-5, "wall_time": 0.82,
            "storm_duration": 10800.0, "vessel_std": {"wf": WF_SIGMA, "lf": LF_SIGMA},
            "vessel_most_probable_max": {"combined": {d: 4 * WF_SIGMA[d] + 2 * LF_SIGMA[d] for d in DOFS}},
            "lines": spread,
        },
        "modes": FPSO_MODES,
        "warnings": ["Synthetic results of the fake service: for the pages' tests only."],
        "failures": {},
        "provenance": {
            "case_hash": "fake", "solver_version": "0.0-fake", "seeds": [], "data_hash": "fake", "tp": 16.9,
            "hs_in_band": 15.4,
        },
    }  # fmt: skip


def riser_channels() -> dict[str, dict[str, Any]]:
    s = RISER / 170.0
    middle = 0.5 * (RISER[1:] + RISER[:-1])
    position = np.stack([100.0 * s, 0.0 * s, -55.0 + 50.0 * s - 110.0 * s * (1 - s)], axis=1)
    nodes, elements = {"arc_length": ("m", RISER)}, {"arc_length": ("m", middle)}
    axes = {"arc_length": ("m", RISER), "axis": ("", [0, 1, 2])}
    made = [
        channel("static/line/riser/position", position, axes, "m"),
        channel("static/line/riser/tension", 4.0e4 + 200.0 * np.abs(middle - 60.0), elements, "N"),
        channel("static/line/riser/bending_moment", 3.0e3 * np.sin(np.pi * s), nodes, "N m"),
        channel("frequency/line/riser/tension_amplitude", 1.2e4 + 50.0 * middle, elements, "N"),
    ]
    return {item["name"]: item for item in made}


def riser_summary(name: str) -> dict[str, Any]:
    channels = riser_channels()
    tension = channels["static/line/riser/tension"]
    arc = tension["axes"][0]["values"]
    amplitude = channels["frequency/line/riser/tension_amplitude"]["values"]
    line = {"end_a": _end(5.2e4), "end_b": _end(6.2e4), "arc_length": arc, "tension": tension["values"]}
    return {
        "case": name,
        "analyses": ["statics", "frequency_domain"],
        "statics": {"converged": True, "iterations": 9, "residual": 1e-6, "lines": {"riser": line}},
        "frequency_domain": {
            "converged": True, "iterations": 14, "last_change": 6e-5, "wall_time": 0.05,
            "lines": {"riser": {"arc_length": arc, "tension_amplitude": amplitude}},
        },
        "warnings": [], "failures": {},
        "provenance": {"case_hash": "fake", "solver_version": "0.0-fake", "seeds": [], "data_hash": None},
    }  # fmt: skip
