"""What drives the linear system: random wave systems with slow drift, or one harmonic frequency."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from ..case.analysis import FrequencyDomain
from ..model.build import Model
from ..model.line import harmonic_omega
from ..model.linear import LineGeometry
from ..statics.solve import StaticState
from ..waves.kinematics import velocity
from ..waves.spectra import spectrum
from .band import Strips, difference_strips, single, wave_strips
from .response import Loads
from .water import WaterMotion, water_motion

Array = np.ndarray


@dataclass(frozen=True)
class Band:
    """Strips of one band and the loads on them. spectra : (R, W) elevation spectra of the wave systems [m² s/rad]."""

    strips: Strips
    loads: Loads
    spectra: Array


@dataclass(frozen=True)
class Driver:
    """Loads of both bands about one static position.

    wave : first order; low : second order, at difference frequencies, which may reach into the wave band.
    typical_speed : of the water at the surface, for a start [m/s].
    """

    is_random: bool
    wave: Band
    low: Band | None
    typical_speed: float
    yaw: float = np.nan
    shapes: tuple[Array, ...] = ()

    def at(self, model: Model, static: StaticState, geometries: list[LineGeometry]) -> Driver:
        """The same sea about a new static position; recomputed only as far as the position changed."""
        moved = not self.shapes or any(
            float(np.abs(g.x - old).max()) > 0.01 for g, old in zip(geometries, self.shapes, strict=True)
        )
        yaw = float(static.position[5])
        turned = not abs(yaw - self.yaw) < 1e-6
        if not moved and not turned:
            return self
        wave, low = self.wave, self.low
        if moved:
            water = [water_of(model, g, wave.strips.omega, self.is_random) for g in geometries]
            wave = replace(wave, loads=replace(wave.loads, water=water))
            if low is not None:
                none = [water_motion([], g.x, low.strips.omega.size) for g in geometries]
                low = replace(low, loads=replace(low.loads, water=none))
        if turned and model.vessel is not None:
            wave = replace(wave, loads=replace(wave.loads, vessel=_excitation(model, wave, yaw, self.is_random)))
            if low is not None:
                low = _drift(model, low, yaw)
        return replace(
            self, wave=wave, low=low, yaw=yaw, shapes=tuple(g.x for g in geometries) if moved else self.shapes
        )

    def own(self, model: Model, static: StaticState, omega: Array, quadratic: Array) -> Array | None:
        """Dynamic stiffness of the vessel without its lines (W, 6, 6), K_g of its fairleads included (F12)."""
        if model.vessel is None or static.body is None:
            return None
        stiffness = static.body.stiffness(static.position)
        for line, force in zip(static.lines, static.state.end_forces, strict=True):
            for row, end in enumerate(line.ends):
                if end.kind == "fairlead" and end.arm is not None:
                    f = force[3 * row : 3 * row + 3]
                    stiffness = stiffness + line.multiplicity * static.body.geometric(static.position, end.arm, f)
        return model.vessel.dynamic(omega, float(static.position[5]), quadratic) + stiffness


def driver(model: Model, static: StaticState, spec: FrequencyDomain) -> Driver:
    """The driver of a case, still without a position (see `Driver.at`)."""
    omega = harmonic_omega(model.case)
    if omega is not None:
        return _harmonic(model, static, omega)
    strips = wave_strips(spec.wave, float(spec.low.to))
    spectra = np.stack([spectrum(strips.omega, sea) for sea in model.case.environment.random])
    weight = strips.pad(spectra[:, : strips.count] * strips.widths)
    nothing: list[Any] = [None] * len(static.lines)
    wave = Band(strips, Loads(None, [], nothing, weight), spectra)
    low = None
    if model.vessel is not None and model.vessel.has_drift:
        low_set = difference_strips(spec.low, model.vessel.difference_to, float(spec.difference.step))
        low = Band(low_set, Loads(None, [], nothing, np.zeros((0, low_set.omega.size))), spectra)
    speed = float(np.sqrt(np.sum(weight * strips.omega**2)))
    return Driver(True, wave, low, speed)


def _harmonic(model: Model, static: StaticState, omega: float) -> Driver:
    strips = single(omega)
    weight = strips.pad(np.full((1, 1), 0.5))
    ends: list[Array | None] = []
    speed = sum(0.5 * float(getattr(sea, "height", 0.0)) * omega for sea, _ in model.wave_systems)
    for line in static.lines:
        phasors = [end.phasor if end.phasor is not None else np.zeros(3, dtype=complex) for end in line.ends]
        both = np.concatenate(phasors)
        ends.append(np.repeat(both[None, :, None], strips.omega.size, axis=2) if np.any(both) else None)
        speed = max(speed, omega * float(np.abs(both).max()))
    wave = Band(strips, Loads(None, [], ends, weight), np.zeros((1, strips.omega.size)))
    return Driver(False, wave, None, speed)


def _regular(model: Model) -> list[tuple[complex, float]]:
    """Complex amplitude and direction of every regular wave."""
    return [(0.5 * sea.height * np.exp(1j * sea.phase), heading) for sea, heading in model.wave_systems]  # type: ignore[attr-defined]


def _airy(model: Model, omega: Array, heading: float, x: Array) -> Array:
    return velocity(omega, heading, x, model.case.environment.depth, model.case.environment.water.gravity)


def water_of(model: Model, g: LineGeometry, omega: Array, is_random: bool) -> WaterMotion:
    if is_random:
        return water_motion(
            [partial(_airy, model, omega, heading) for _, heading in model.wave_systems], g.x, omega.size
        )

    def together(x: Array) -> Array:
        total = np.zeros((omega.size, x.shape[0], 3), dtype=complex)
        for amplitude, heading in _regular(model):
            total += amplitude * _airy(model, omega, heading, x)
        return total

    return water_motion([together], g.x, omega.size)


def _excitation(model: Model, band: Band, yaw: float, is_random: bool) -> Array:
    """First-order load on the vessel, complex (R, 6, W)."""
    assert model.vessel is not None
    omega = band.strips.omega
    if is_random:
        rows = [model.vessel.excitation(omega, heading, yaw) for _, heading in model.wave_systems]
    else:
        total = np.zeros((omega.size, 6), dtype=complex)
        for amplitude, heading in _regular(model):
            total += amplitude * model.vessel.excitation(omega, heading, yaw)
        rows = [total]
    return np.ascontiguousarray(np.stack(rows).transpose(0, 2, 1))


def _drift(model: Model, low: Band, yaw: float) -> Band:
    """The drift force spectrum about a yaw, factored into independent responses (F16)."""
    assert model.vessel is not None
    strips = low.strips
    factor = model.vessel.drift_factor(strips.omega, model.wave_systems, yaw)  # (W, 6, r)
    forces = np.ascontiguousarray(factor.transpose(2, 1, 0)).astype(complex)
    weight = strips.pad(np.tile(strips.widths, (forces.shape[0], 1)))
    return replace(low, loads=replace(low.loads, vessel=forces, weight=weight))
