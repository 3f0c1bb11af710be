"""The coupled frequency-domain analysis: wave and low frequencies together, drag linearised by iteration (F14-F17)."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..case.analysis import FrequencyDomain
from ..forces import axial
from ..model.build import Model
from ..model.line import has_current
from ..model.linear import LineGeometry, line_geometry
from ..model.slack import slack_elements
from ..outcome import NotConverged
from ..statics.newton import vessel_coupling
from ..statics.solve import StaticState, settle
from ..vessel.rigid import turning
from .drivers import Driver, driver
from .linearise import DragState, Linearised, linearise, moment_response, sigmas
from .mixing import Mixing
from .response import Response, respond

Array = np.ndarray
OnIteration = Callable[[int, float], None]


@dataclass(frozen=True)
class FrequencyResult:
    """The converged linear system and its responses.

    wave : responses per unit elevation of each wave system, or the amplitudes of a harmonic case;
    low : responses to the factors of the drift force spectrum, None without slow drift.
    """

    spec: FrequencyDomain
    static: StaticState
    geometries: list[LineGeometry]
    linear: Linearised
    driver: Driver
    wave: Response
    low: Response | None
    couplings: list[Array]
    iterations: int
    last_change: float
    wall_time: float
    warnings: tuple[str, ...]


def solve_frequency_domain(
    model: Model, static: StaticState, spec: FrequencyDomain, on_iteration: OnIteration | None = None
) -> FrequencyResult:
    """Iterate drag linearisation, static position and both bands until every σ of relative velocity settles.

    Raises NotConverged with the last change when it does not, and for a line that is slack all over.
    """
    started = time.perf_counter()
    _refuse_slack(static)
    drive = driver(model, static, spec)
    position = _Position(model, static, drive)
    quadratic = model.vessel.quadratic if model.vessel is not None else np.zeros(6)
    state = _first_state(position.geometries, model, drive)
    mixing, change, moved = Mixing(), np.inf, 0.0
    for iteration in range(1, spec.max_iterations + 1):
        linear = linearise(position.geometries, state, quadratic, drive.is_random, spec.linearisation == "vector")
        moved = position.follow(linear)
        wave, low = position.respond(linear)
        image = _drag_state(wave, low, position.drive, spec)
        old, new = sigmas(position.geometries, state), sigmas(position.geometries, image)
        floor = 0.01 * float(new.max(initial=0.0)) + 1e-12
        change = float(np.max(np.abs(new - old) / np.maximum(new, floor), initial=0.0))
        if on_iteration:
            on_iteration(iteration, change)
        if not np.isfinite(change):
            break
        if change < spec.tolerance and moved < spec.tolerance:
            wave, low = position.respond(linear, full=True)
            wall = time.perf_counter() - started
            return FrequencyResult(
                spec, position.static, position.geometries, linear, position.drive, wave, low, position.couplings,
                iteration, change, wall, _warnings(model, spec),
            )  # fmt: skip
        state = image.mixed(mixing.next(state.pack(), image.pack(), image.weight()))
    raise NotConverged(
        "frequency_domain",
        f"drag linearisation did not settle in {spec.max_iterations} iterations: the last change is {change:.2e} of σ and "
        f"{moved:.2e} in position (wanted {spec.tolerance:.0e}).",
        "Raise max_iterations or the tolerance; look for slack lines or a line at resonance without drag.",
    )


def _refuse_slack(static: StaticState) -> None:
    """Raise NotConverged for a line none of whose elements carries tension: there is nothing to linearise about."""
    for line, shape in zip(static.lines, static.state.shapes, strict=True):
        if slack_elements(line.arrays, axial.tension(line.arrays, shape)).all():
            raise NotConverged(
                "frequency_domain", f"line {line.name!r} is slack over its whole length in static equilibrium, and a slack "
                "line has no linear answer.", "Use the time domain, or shorten the line.",
            )  # fmt: skip


class _Position:
    """The static position the system is linearised about, and all that depends on it."""

    def __init__(self, model: Model, static: StaticState, drive: Driver):
        self.model, self.drive = model, drive
        self.drags = [has_current(line.arrays) for line in static.lines]
        self._place(static)

    def _place(self, static: StaticState) -> None:
        self.static = static
        self.geometries = [
            line_geometry(line, shape) for line, shape in zip(static.lines, static.state.shapes, strict=True)
        ]
        body = static.body
        self.couplings = [
            vessel_coupling(line, body, static.position) if body is not None else np.zeros((6, 6))
            for line in static.lines
        ]
        self.drive = self.drive.at(self.model, self.static, self.geometries)

    def follow(self, linear: Linearised) -> float:
        """Follow the mean drag of a current; returns 100 × the largest move over its line's length (F17)."""
        if not any(self.drags):
            return 0.0
        settled = settle(self.model, self.static, linear.mean)
        moved = 0.0
        for old, new, line in zip(self.static.state.shapes, settled.state.shapes, settled.lines, strict=True):
            moved = max(moved, 100.0 * float(np.abs(new - old).max()) / line.length)
        self._place(replace(settled, warnings=self.static.warnings))
        return moved

    def respond(self, linear: Linearised, full: bool = False) -> tuple[Response, Response | None]:
        moment = moment_response if full else None
        results: list[Response | None] = []
        for band in (self.drive.wave, self.drive.low):
            if band is None:
                results.append(None)
                continue
            own = self.drive.own(self.model, self.static, band.strips.omega, linear.vessel)
            results.append(respond(
                self.geometries, linear.damping, self.couplings, own, band.strips, band.loads, moment,
                self.static.state.end_forces,
            ))  # fmt: skip
        assert results[0] is not None
        return results[0], results[1]


def _first_state(geometries: list[LineGeometry], model: Model, drive: Driver) -> DragState:
    """Every node moves at a tenth of the surface's speed: too little damping at first settles sooner than too much."""
    speed = max(0.1 * drive.typical_speed, 1e-3)
    cover = [np.tile([speed**2] * 3 + [0.0] * 3, (g.x.shape[0], 1)) for g in geometries]
    return DragState(cover, np.full(6, (0.1 * speed) ** 2))


def _drag_state(wave: Response, low: Response | None, drive: Driver, spec: FrequencyDomain) -> DragState:
    """Covariances of relative velocity from both bands together (F14)."""
    covers, vessel = [part.copy() for part in wave.covariance], np.zeros(6)
    for response, band in ((wave, drive.wave), (low, drive.low)):
        if response is None or band is None or (response is low and not spec.include_low_velocities):
            continue
        if response is low:
            covers = [a + b for a, b in zip(covers, low.covariance, strict=True)]
        if response.vessel is not None:
            own_axes = np.einsum("ij,rjw->riw", turning(drive.yaw).T, response.vessel)
            squares = np.abs(own_axes) ** 2 * band.strips.omega**2
            vessel += np.einsum("rw,riw->i", band.loads.weight, squares)
    return DragState(covers, vessel)


def _warnings(model: Model, spec: FrequencyDomain) -> tuple[str, ...]:
    if spec.linearisation == "component" and any(has_current(line.arrays) for line in model.lines):
        return (
            "a current acts and drag is linearised by components, which loses damping and mean drag across an oblique "
            "current; set analyses.frequency_domain.linearisation to vector",
        )
    return ()
