"""The channels of statics, frequency domain and modes of a scene, worked out again; each is (values, axes, unit, band)."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from .linear import DOFS, Bands, Raw
from .modes import mode_scales

Array = np.ndarray


def channels(raw: Raw) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for k, name in enumerate(raw.names):
        x, nodes, middles = raw.shapes[name], raw.nodes(name), raw.middles(name)
        line = f"line/{name}"
        out[f"static/{line}/position"] = _one(raw.earth(x), [nodes, [0, 1, 2]], "m")
        out[f"static/{line}/tension"] = _one(raw.tension(name), [middles], "N")
        out[f"static/{line}/bending_moment"] = _one(bending(raw, name), [nodes], "N m")
        if raw.frequency is not None:
            add = _random_line if raw.case.environment.random else _harmonic_line
            out |= {f"frequency/{line}/{key}": value for key, value in add(raw, k, name).items()}
        if raw.modes is not None:
            scale = mode_scales(raw)[:, None, None]
            shapes = raw.earth(raw.modes.shapes[k] / scale)
            out[f"modes/{line}/shape"] = _one(shapes, [_counted(raw), nodes, [0, 1, 2]], "1")
    if raw.frequency is not None and raw.case.environment.random:
        bands = Bands(raw)
        omega, elevation = bands.on_one_axis(bands.S.sum(axis=0), np.zeros(bands.low.size))
        out["frequency/wave/elevation"] = _one(elevation, [omega], "m2 s/rad")
        out |= _vessel(raw, bands)
    elif raw.frequency is not None and raw.frequency.wave.vessel is not None:
        response = raw.frequency.wave.vessel[0, :, :1]
        for k, dof in enumerate(DOFS):
            out[f"frequency/vessel/{dof}_amplitude"] = _one(
                np.hypot(response[k].real, response[k].imag), [[_single(raw)]], "rad" if k > 2 else "m", "wf"
            )
    if raw.modes is not None:
        omega = np.array([mode.omega for mode in raw.modes.modes])
        out["modes/vessel/period"] = _one(2 * np.pi / omega, [_counted(raw)], "s")
        if raw.case.vessel is not None:
            shapes = np.array([mode.shape[-6:] for mode in raw.modes.modes]) / mode_scales(raw)[:, None]
            out["modes/vessel/shape"] = _one(shapes, [_counted(raw), range(6)], "1")
    return out


def _one(values: Any, axes: list[Any], unit: str, band: str = "total") -> dict[str, Any]:
    return {"values": np.asarray(values), "axes": {str(k): np.asarray(one, float) for k, one in enumerate(axes)},
            "unit": unit, "band": band}  # fmt: skip


def as_dict(channel: Any) -> dict[str, Any]:
    """A channel in the form in which it is expected."""
    axes = {str(k): axis.values for k, axis in enumerate(channel.axes)}
    return {"values": channel.values, "axes": axes, "unit": channel.unit, "band": channel.band}


def _counted(raw: Raw) -> Array:
    return np.arange(1, len(raw.modes.modes) + 1)


def _single(raw: Raw) -> float:
    """The frequency of a harmonic case, from its periods."""
    waves = [2 * np.pi / sea.period for sea in raw.case.environment.regular]
    for line in raw.case.lines.values():
        for end in (line.end_a, line.end_b):
            if end.motion is not None:
                waves += [2 * np.pi / harmonic.period for harmonic in end.motion.harmonics().values()]
    return float(waves[0])


def stiffness_of_joints(raw: Raw, name: str) -> Array:
    """kb of the inner nodes: EI over the mean of the lengths, two halves in series (N-1,)."""
    L, EI = raw.lengths(name), raw.along(name, "EI")
    with np.errstate(divide="ignore"):
        return 1.0 / (0.5 * L[:-1] / EI[:-1] + 0.5 * L[1:] / EI[1:])


def bending(raw: Raw, name: str) -> Array:
    """kb times the angle between neighbours; nothing at the ends."""
    t = np.diff(raw.shapes[name], axis=0)
    t = t / np.linalg.norm(t, axis=1)[:, None]
    angle = 2 * np.arcsin(0.5 * np.linalg.norm(t[1:] - t[:-1], axis=1))
    return np.concatenate([[0.0], stiffness_of_joints(raw, name) * angle, [0.0]])


def _vessel(raw: Raw, bands: Bands) -> dict[str, Any]:
    wave, low = raw.frequency.wave, raw.frequency.low
    if wave.vessel is None:
        return {}
    one, two = bands.spectra(wave.vessel, low.vessel if low else None)
    omega, total = bands.on_one_axis(one, two)
    out = {}
    for k, dof in enumerate(DOFS):
        x = "rad" if k > 2 else "m"
        rao = wave.vessel[0, k, : bands.wave.size]
        name = f"frequency/vessel/{dof}"
        out[name] = _one(total[k], [omega], f"{x}2 s/rad")
        out[f"{name}_rao_amplitude"] = _one(np.hypot(rao.real, rao.imag), [bands.wave], f"{x}/m", "wf")
        out[f"{name}_rao_phase"] = _one(np.arctan2(rao.imag, rao.real), [bands.wave], "rad", "wf")
        if low is not None:
            out[f"{name}_first_order"] = _one(one[k], [bands.wave], f"{x}2 s/rad")
            out[f"{name}_second_order"] = _one(two[k], [bands.low], f"{x}2 s/rad")
    return out


def _random_line(raw: Raw, k: int, name: str) -> dict[str, Any]:
    bands, wave, low = Bands(raw), raw.frequency.wave, raw.frequency.low
    nodes, middles, n = raw.nodes(name), raw.middles(name), 0
    one, two = bands.spectra(wave.tension[k], low.tension[k] if low else None)
    omega, total = bands.on_one_axis(one, two)
    n = bands.wave.size
    out = {
        "tension": _one(total.T, [omega, middles], "N2 s/rad"), "top_tension": _one(total[-1], [omega], "N2 s/rad"),
        "tension_rao_amplitude": _one(np.abs(wave.tension[k][0, :, :n]).T, [bands.wave, middles], "N/m", "wf"),
    }  # fmt: skip
    for band, key in (("wf", "_wf"), ("lf", "_lf"), ("total", "")):
        out[f"tension_std{key}"] = _one(np.sqrt(bands.variance(one, two, band)), [middles], "N", band)
    if low is not None:
        out["top_tension_first_order"] = _one(one[-1], [bands.wave], "N2 s/rad")
        out["top_tension_second_order"] = _one(two[-1], [bands.low], "N2 s/rad")
    moment = bands.spectra(wave.moment[k], low.moment[k] if low else None)
    out |= _moments(raw, name, np.sqrt(bands.variance(*moment, "total")))
    picks = np.arange(n) if n <= 32 else np.unique(np.rint(np.linspace(0, n - 1, 32)).astype(int))
    response = np.moveaxis(wave.motion[k][..., picks], -1, 0)
    turned = raw.earth(response.real) + 1j * raw.earth(response.imag)
    axes = [bands.wave[picks], nodes, [0, 1, 2]]
    out["motion_rao_amplitude"] = _one(np.hypot(turned.real, turned.imag), axes, "m/m", "wf")
    out["motion_rao_phase"] = _one(np.arctan2(turned.imag, turned.real), axes, "rad", "wf")
    return out


def _harmonic_line(raw: Raw, k: int, name: str) -> dict[str, Any]:
    wave, axes = raw.frequency.wave, [[_single(raw)], raw.nodes(name), [0, 1, 2]]
    tension, moment = wave.tension[k][0, :, 0], wave.moment[k][0, :, :, 0]
    turned = raw.earth(wave.motion[k][None, ..., 0].real) + 1j * raw.earth(wave.motion[k][None, ..., 0].imag)
    return {
        "tension_amplitude": _one(np.hypot(tension.real, tension.imag), [raw.middles(name)], "N", "wf"),
        **_moments(raw, name, np.hypot(moment.real, moment.imag)),
        "motion_amplitude": _one(np.hypot(turned.real, turned.imag), axes, "m", "wf"),
        "motion_phase": _one(np.arctan2(turned.imag, turned.real), axes, "rad", "wf"),
    }


def _moments(raw: Raw, name: str, sizes: Array) -> dict[str, Any]:
    """Bending in and out of the plane, and curvature on the more flexible of the two sides."""
    EI = raw.along(name, "EI")
    softer = np.array([EI[0], *(min(a, b) for a, b in pairwise(EI)), EI[-1]])
    nodes = raw.nodes(name)
    return {
        "bending_moment_std": _one(sizes[0], [nodes], "N m"), "bending_moment_out_std": _one(sizes[1], [nodes], "N m"),
        "curvature_std": _one(sizes[0] / softer, [nodes], "1/m"),
    }  # fmt: skip
