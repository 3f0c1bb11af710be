"""CHANNELS: every labelled array an analysis gives. One function with its dimensions and unit is one more channel."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..case.quantities import DOF
from ..forces import axial, bending
from .channel import Axis, Channel
from .solved import Solved, Spectra

Array = np.ndarray
Made = tuple[Array, tuple[Axis, ...]] | None


@dataclass(frozen=True)
class Definition:
    """A kind of channel: where it belongs, what it is, and the function that makes it (None where there is nothing)."""

    domain: str
    owner: str  # "vessel" | "line" | "wave"
    quantity: str
    unit: str
    band: str
    description: str
    make: Callable[[Any, str], Made]


CHANNELS: list[Definition] = []


def channel(domain: str, owner: str, quantity: str, unit: str, description: str, band: str = "total"):  # type: ignore[no-untyped-def]
    """Register a function (solved, line name or DOF) -> (values, axes) or None; of domain `time` it takes a TimeResult."""

    def register(make: Callable[[Any, str], Made]) -> Callable[[Any, str], Made]:
        CHANNELS.append(Definition(domain, owner, quantity, unit, band, description, make))
        return make

    return register


def make_channels(solved: Solved) -> Iterator[Channel]:
    """All channels of statics, frequency domain and modes that this outcome has."""
    names = [line.name for line in solved.lines]
    yield from _all(
        solved, [item for item in CHANNELS if item.domain != "time"], names, solved.model.vessel is not None
    )


def make_time_channels(result: Any, names: list[str]) -> Iterator[Channel]:
    """All channels of the time domain (results/time.py)."""
    yield from _all(result, [item for item in CHANNELS if item.domain == "time"], names, True)


def _all(source: Any, items: list[Definition], lines: list[str], vessel: bool) -> Iterator[Channel]:
    for item in items:
        if item.owner == "line":
            for name in lines:
                yield from _one(item, f"{item.domain}/line/{name}/{item.quantity}", source, name)
        elif "{dof}" in item.quantity:
            for dof in DOF if vessel else ():
                yield from _one(item, f"{item.domain}/{item.owner}/{item.quantity.format(dof=dof)}", source, dof)
        else:
            yield from _one(item, f"{item.domain}/{item.owner}/{item.quantity}", source, "")


def _one(item: Definition, name: str, solved: Any, which: str) -> Iterator[Channel]:
    made = item.make(solved, which)
    if made is not None:
        values, axes = made
        rotation = which in DOF[3:]
        unit = item.unit.replace("[x]", "rad" if rotation else "m")
        yield Channel(name, np.ascontiguousarray(values), axes, unit, item.description.format(which=which), item.band)


def _omega(solved: Solved) -> Axis:
    return Axis("omega", "rad/s", solved.omega)


def _omega_wave(solved: Solved) -> Axis:
    return Axis("omega", "rad/s", solved.omega_wave)


def _nodes(solved: Solved, name: str) -> Axis:
    return Axis("arc_length", "m", solved.lines[solved.index(name)].node_arc)


def _elements(solved: Solved, name: str) -> Axis:
    return Axis("arc_length", "m", solved.lines[solved.index(name)].element_arc)


XYZ = Axis("axis", "", np.arange(3.0))


@channel("static", "line", "position", "m", "Static position of the nodes in earth axes, end a to end b")
def _position(solved: Solved, name: str) -> Made:
    return solved.earth(solved.static.state.shapes[solved.index(name)]), (_nodes(solved, name), XYZ)


@channel("static", "line", "tension", "N", "Static axial force of the elements, at their midpoints")
def _static_tension(solved: Solved, name: str) -> Made:
    i = solved.index(name)
    return axial.tension(solved.lines[i].arrays, solved.static.state.shapes[i]), (_elements(solved, name),)


@channel("static", "line", "bending_moment", "N m", "Static bending moment at the nodes")
def _static_moment(solved: Solved, name: str) -> Made:
    i = solved.index(name)
    return bending.moment(solved.lines[i].arrays, solved.static.state.shapes[i]), (_nodes(solved, name),)


@channel("frequency", "wave", "elevation", "m2 s/rad", "Spectrum of the surface elevation, all wave systems together")
def _elevation(solved: Solved, _: str) -> Made:
    if solved.frequency is None or not solved.is_random:
        return None
    S = solved.frequency.driver.wave.spectra[:, : solved.omega_wave.size].sum(axis=0)
    return solved.total(Spectra(S, np.zeros(solved.omega_low.size))), (_omega(solved),)


@channel("frequency", "vessel", "{dof}", "[x]2 s/rad", "Spectrum of {which} about the static position")
def _motion(solved: Solved, dof: str) -> Made:
    if solved.vessel_spectra is None:
        return None
    return solved.total(solved.vessel_spectra[DOF.index(dof)]), (_omega(solved),)


def _of_origin(solved: Solved, spectra: Spectra | None, origin: str) -> Made:
    """The first- or the second-order part of a spectrum on its own frequencies; None without slow drift."""
    if spectra is None or not solved.has_slow_drift:
        return None
    if origin == "first_order":
        return spectra.first, (_omega_wave(solved),)
    return spectra.second, (Axis("omega", "rad/s", solved.omega_low),)


def _top_spectra(solved: Solved, name: str) -> Spectra:
    """Spectra of tension of the element at end b."""
    return solved.tension_spectra(solved.index(name), slice(-1, None))[-1]


def _by_origin(origin: str, words: str) -> None:
    @channel("frequency", "vessel", f"{{dof}}_{origin}", "[x]2 s/rad", f"Spectrum of {{which}}, {words}")
    def _vessel(solved: Solved, dof: str) -> Made:
        spectra = solved.vessel_spectra
        return None if spectra is None else _of_origin(solved, spectra[DOF.index(dof)], origin)

    @channel("frequency", "line", f"top_tension_{origin}", "N2 s/rad", f"Spectrum of tension at end b, {words}")
    def _line(solved: Solved, name: str) -> Made:
        return _of_origin(solved, _top_spectra(solved, name), origin) if solved.is_random else None


_by_origin("first_order", "first-order response to the waves")
_by_origin("second_order", "response to the slow drift force")


def _rao(solved: Solved, dof: str) -> Array | None:
    """Response of a DOF per unit elevation of the first wave system, complex (W,)."""
    if solved.frequency is None or solved.frequency.wave.vessel is None or not solved.is_random:
        return None
    return np.asarray(solved.frequency.wave.vessel[0, DOF.index(dof), : solved.omega_wave.size])


@channel("frequency", "vessel", "{dof}_rao_amplitude", "[x]/m", "RAO of {which} in the first wave system", "wf")
def _rao_amplitude(solved: Solved, dof: str) -> Made:
    rao = _rao(solved, dof)
    return None if rao is None else (np.abs(rao), (_omega_wave(solved),))


@channel("frequency", "vessel", "{dof}_rao_phase", "rad", "Phase lead of {which} on the elevation at (0, 0)", "wf")
def _rao_phase(solved: Solved, dof: str) -> Made:
    rao = _rao(solved, dof)
    return None if rao is None else (np.angle(rao), (_omega_wave(solved),))


@channel("frequency", "vessel", "{dof}_amplitude", "[x]", "Amplitude of {which} in the regular wave", "wf")
def _harmonic_motion(solved: Solved, dof: str) -> Made:
    if solved.frequency is None or solved.frequency.wave.vessel is None or solved.is_random:
        return None
    return np.abs(solved.frequency.wave.vessel[0, DOF.index(dof), :1]), (_omega_wave(solved),)


@channel("frequency", "line", "tension", "N2 s/rad", "Spectrum of tension of the elements of one line")
def _tension_spectrum(solved: Solved, name: str) -> Made:
    if not solved.is_random:
        return None
    return solved.total(solved.tension_spectra(solved.index(name))).T, (_omega(solved), _elements(solved, name))


@channel("frequency", "line", "top_tension", "N2 s/rad", "Spectrum of tension of the element at end b")
def _top_tension(solved: Solved, name: str) -> Made:
    if not solved.is_random:
        return None
    return solved.total(_top_spectra(solved, name)), (_omega(solved),)


def _tension_std(band: str, quantity: str, text: str) -> None:
    @channel("frequency", "line", quantity, "N", text, band)
    def _std(solved: Solved, name: str) -> Made:
        if not solved.is_random:
            return None
        spectra = solved.tension_spectra(solved.index(name))
        return np.sqrt(solved.moments(spectra, band)), (_elements(solved, name),)


_tension_std("wf", "tension_std_wf", "Standard deviation of tension at wave frequencies")
_tension_std("lf", "tension_std_lf", "Standard deviation of tension at low frequencies")
_tension_std("total", "tension_std", "Standard deviation of tension")


@channel("frequency", "line", "tension_rao_amplitude", "N/m", "RAO of tension in the first wave system", "wf")
def _tension_rao(solved: Solved, name: str) -> Made:
    if solved.frequency is None or not solved.is_random:
        return None
    response = solved.frequency.wave.tension[solved.index(name)][0, :, : solved.omega_wave.size]
    return np.abs(response).T, (_omega_wave(solved), _elements(solved, name))


@channel("frequency", "line", "tension_amplitude", "N", "Amplitude of tension in harmonic motion", "wf")
def _tension_amplitude(solved: Solved, name: str) -> Made:
    if solved.frequency is None or solved.is_random:
        return None
    return np.abs(solved.frequency.wave.tension[solved.index(name)][0, :, 0]), (_elements(solved, name),)


def _moment_scale(solved: Solved, name: str) -> Array:
    """Standard deviation (random) or amplitude (harmonic) of bending moment, in plane and out of plane, (2, N+1)."""
    assert solved.frequency is not None
    i = solved.index(name)
    if solved.is_random:
        return np.sqrt(solved.moments(solved.moment_spectra(i), "total"))
    return np.abs(solved.frequency.wave.moment[i][0, :, :, 0])


def _moment(row: int, quantity: str, text: str) -> None:
    @channel("frequency", "line", quantity, "N m", text)
    def _value(solved: Solved, name: str) -> Made:
        if solved.frequency is None:
            return None
        return _moment_scale(solved, name)[row], (_nodes(solved, name),)


_moment(
    0, "bending_moment_std", "Standard deviation (harmonic motion: amplitude) of bending moment in the line's plane"
)
_moment(
    1, "bending_moment_out_std", "Standard deviation (harmonic: amplitude) of bending moment out of the line's plane"
)


@channel("frequency", "line", "curvature_std", "1/m", "Standard deviation (harmonic: amplitude) of curvature, in plane")
def _curvature(solved: Solved, name: str) -> Made:
    if solved.frequency is None:
        return None
    EI = solved.lines[solved.index(name)].arrays.EI
    stiffest = np.concatenate([EI[:1], np.minimum(EI[:-1], EI[1:]), EI[-1:]])
    moment = _moment_scale(solved, name)[0]
    curvature = np.divide(moment, stiffest, out=np.zeros_like(moment), where=stiffest > 0)
    return curvature, (_nodes(solved, name),)


MOST_SHAPES = 32  # frequencies at which the motion of a whole line is kept


def _shape_picks(solved: Solved) -> Array:
    """Indices of evenly spaced wave frequencies, the first and the last among them."""
    count = solved.omega_wave.size
    return np.unique(np.linspace(0, count - 1, min(count, MOST_SHAPES)).round().astype(int))


def _line_motion(quantity: str, random: bool, unit: str, part: Callable[[Array], Array], text: str) -> None:
    @channel("frequency", "line", quantity, unit, text, "wf")
    def _value(solved: Solved, name: str) -> Made:
        if solved.frequency is None or solved.is_random is not random:
            return None
        picks = _shape_picks(solved) if random else np.zeros(1, int)
        motion = np.moveaxis(solved.frequency.wave.motion[solved.index(name)][:, :, picks], -1, 0)
        axis = Axis("omega", "rad/s", solved.omega_wave[picks])
        turned = solved.earth(motion.real) + 1j * solved.earth(motion.imag)
        return part(turned), (axis, _nodes(solved, name), XYZ)


_MOTION = "of the motion of the nodes, earth axes, "
_line_motion("motion_rao_amplitude", True, "m/m", np.abs, "RAO " + _MOTION + "first wave system, some frequencies")
_line_motion("motion_rao_phase", True, "rad", np.angle, "Phase lead " + _MOTION + "on the elevation at (0, 0)")
_line_motion("motion_amplitude", False, "m", np.abs, "Amplitude " + _MOTION + "in harmonic motion")
_line_motion("motion_phase", False, "rad", np.angle, "Phase lead " + _MOTION + "in harmonic motion")


def _mode_axis(solved: Solved) -> Axis:
    assert solved.modes is not None
    return Axis("mode", "", np.arange(1.0, len(solved.modes.modes) + 1))


@channel("modes", "vessel", "period", "s", "Natural periods")
def _periods(solved: Solved, _: str) -> Made:
    if solved.modes is None:
        return None
    return np.array([mode.period for mode in solved.modes.modes]), (_mode_axis(solved),)


@channel(
    "modes", "vessel", "shape", "1", "Motion of the vessel in each mode, largest translation or rotation × 100 m = 1"
)
def _vessel_shape(solved: Solved, _: str) -> Made:
    if solved.modes is None or solved.model.vessel is None:
        return None
    shapes = np.array([mode.shape[-6:] / _mode_size(solved, k) for k, mode in enumerate(solved.modes.modes)])
    return shapes, (_mode_axis(solved), Axis("dof", "", np.arange(6.0)))


@channel("modes", "line", "shape", "1", "Displacement of the nodes in each mode, earth axes, largest of all lines = 1")
def _line_shape(solved: Solved, name: str) -> Made:
    if solved.modes is None:
        return None
    shapes = solved.modes.shapes[solved.index(name)]
    sizes = np.array([_mode_size(solved, k) for k in range(shapes.shape[0])])
    return solved.earth(shapes / sizes[:, None, None]), (_mode_axis(solved), _nodes(solved, name), XYZ)


def _mode_size(solved: Solved, k: int) -> float:
    assert solved.modes is not None
    sizes = [float(np.abs(shapes[k]).max()) for shapes in solved.modes.shapes]
    if solved.model.vessel is not None:
        s = solved.modes.modes[k].shape[-6:]
        sizes.append(float(max(np.abs(s[:3]).max(), 100.0 * np.abs(s[3:]).max())))
    return max([*sizes, 1e-300])
