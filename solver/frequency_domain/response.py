"""Coupled linear response over one band: lines condensed to their ends, vessel solved, lines recovered (F7-F13)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from ..kernels.band import LANES
from ..model.linear import LineGeometry
from ..outcome import NotConverged
from .band import Strips
from .ends import end_forces
from .transfer import displacements, solve_line, tension_response, velocity_covariance
from .water import WaterMotion

Array = np.ndarray
MEMORY = 96e6  # bytes of line responses held at once


@dataclass(frozen=True)
class Loads:
    """What drives a band, as R responses whose squares add.

    vessel : complex (R, 6, W) load on the vessel, None without one; water : of each line, R or 0 responses;
    ends : complex (R, 6, W) prescribed motion of end b and end a of each line, None where nothing is prescribed;
    weight : (R, W) variance per unit response squared.
    """

    vessel: Array | None
    water: list[WaterMotion]
    ends: list[Array | None]
    weight: Array


@dataclass
class Response:
    """Responses of one band. vessel : complex (R, 6, W); covariance : per line (N+1, 6) of relative velocity [m²/s²].

    tension : complex (R, N, W) per line and moment : complex (R, 2, N+1, W), in and out of plane, and
    motion : complex (N+1, 3, W) under the first load, and ends : complex (R, 4, W) forces on the supports (F19), when
    asked for.
    """

    vessel: Array | None
    covariance: list[Array]
    tension: list[Array] = field(default_factory=list)
    moment: list[Array] = field(default_factory=list)
    motion: list[Array] = field(default_factory=list)
    ends: list[Array] = field(default_factory=list)
    condensed: Array | None = None


Moment = Callable[[LineGeometry, Array, Array], Array]


def respond(
    geometries: list[LineGeometry], damping: list[Array], couplings: list[Array], own: Array | None, strips: Strips,
    loads: Loads, moment: Moment | None = None, at_rest: list[Array] | None = None,
) -> Response:  # fmt: skip
    """Solve one band.

    damping : (N+1, 3, 3) per line; couplings : ∂(end b, end a)/∂(vessel) (6, 6) per line.
    own : complex (W, 6, 6) dynamic stiffness of the vessel without its lines, None without a vessel.
    moment : given, tension and bending moment are returned too; at_rest : then also, forces of the lines on their
    supports in the static position, (6,) per line.
    """
    R, W = loads.weight.shape
    full = moment is not None
    result = Response(None, [np.zeros((g.x.shape[0], 6)) for g in geometries])
    vessel_parts: list[Array] = []
    tensions: list[list[Array]] = [[] for _ in geometries]
    moments: list[list[Array]] = [[] for _ in geometries]
    motions: list[list[Array]] = [[] for _ in geometries]
    ends_parts: list[list[Array]] = [[] for _ in geometries]
    condensed_parts: list[Array] = []
    for window in _windows(geometries, R, W):
        solved = [
            _solve(g, b, strips, water, window) for g, b, water in zip(geometries, damping, loads.water, strict=True)
        ]
        s = None
        if own is not None and loads.vessel is not None:
            s, condensed = _vessel(geometries, solved, couplings, own[window], loads, window)
            vessel_parts.append(s)
            condensed_parts.append(condensed)
        for index, (g, parts) in enumerate(zip(geometries, solved, strict=True)):
            ends = _end_motion(g, couplings[index], s, loads.ends[index], R, window)
            Yr, Yi = displacements(
                parts[0], parts[1], ends.real.copy(), ends.imag.copy(), g.ends, loads.water[index].real.shape[0] > 0
            )
            water = loads.water[index]
            velocity_covariance(
                Yr, Yi, _cut(water.real, window), _cut(water.imag, window), strips.omega[window],
                np.ascontiguousarray(loads.weight[:, window]), result.covariance[index],
            )  # fmt: skip
            if moment is not None:
                Tr, Ti = tension_response(g.line.arrays, g.x, Yr, Yi)
                tensions[index].append(Tr + 1j * Ti)
                moments[index].append(moment(g, Yr, Yi))
                motions[index].append(Yr[0] + 1j * Yi[0])
                if at_rest is not None:
                    part = WaterMotion(water.real[..., window], water.imag[..., window])
                    ends_parts[index].append(
                        end_forces(g, damping[index], strips.omega[window], Yr + 1j * Yi, part, at_rest[index])
                    )
    if vessel_parts:
        result.vessel = np.concatenate(vessel_parts, axis=-1)
        result.condensed = np.concatenate(condensed_parts, axis=0)
    if full:
        result.tension = [np.concatenate(parts, axis=-1) for parts in tensions]
        result.moment = [np.concatenate(parts, axis=-1) for parts in moments]
        result.motion = [np.concatenate(parts, axis=-1) for parts in motions]
        result.ends = [np.concatenate(parts, axis=-1) for parts in ends_parts if parts]
    _check(result)
    return result


def _windows(geometries: list[LineGeometry], R: int, W: int) -> Iterator[slice]:
    """Cuts of the frequencies such that the responses of all lines fit in MEMORY."""
    per_frequency = sum(3 * g.x.shape[0] * (g.ends + 3 * R) * 16 for g in geometries) + 1
    size = max(int(MEMORY / per_frequency) // LANES, 1) * LANES
    for start in range(0, W, size):
        yield slice(start, min(start + size, W))


def _cut(values: Array, window: slice) -> Array:
    return np.ascontiguousarray(values[..., window])


def _solve(g: LineGeometry, damping: Array, strips: Strips, water: WaterMotion, window: slice) -> tuple[Array, ...]:
    result: tuple[Array, ...] = solve_line(
        g.K, g.M, damping, g.C, strips.omega[window], _cut(water.real, window), _cut(water.imag, window), g.ends, g.half
    )
    return result


def _vessel(geometries, solved, couplings, own, loads, window):  # type: ignore[no-untyped-def]
    """Motion of the vessel (R, 6, W) under its loads and those the lines pass on; the lines' share (W, 6, 6) (F12)."""
    force = np.moveaxis(loads.vessel[:, :, window], -1, 0).copy()  # (W, R, 6)
    lines = np.zeros_like(own)
    for g, parts, G, prescribed in zip(geometries, solved, couplings, loads.ends, strict=True):
        if g.ends == 0:
            continue
        _Xr, _Xi, Zr, Zi, Lr, Li = parts
        Z = np.moveaxis(Zr + 1j * Zi, -1, 0)
        E = G[: g.ends]
        n = g.line.multiplicity
        lines += n * (E.T @ Z @ E)
        if Lr.shape[1]:
            force += n * np.moveaxis(Lr + 1j * Li, -1, 0)[:, : g.ends].transpose(0, 2, 1) @ E
        if prescribed is not None:
            moved = np.moveaxis(prescribed[:, : g.ends, window], -1, 0)  # (W, R, ends)
            force -= n * (moved @ Z.transpose(0, 2, 1)) @ E
    s = np.linalg.solve(own + lines, force.transpose(0, 2, 1))  # (W, 6, R)
    return np.ascontiguousarray(s.transpose(2, 1, 0)), lines


def _end_motion(g: LineGeometry, G: Array, s: Array | None, prescribed: Array | None, R: int, window: slice) -> Array:
    """Motion of end b and end a in each response, complex (R, 6, W)."""
    width = window.stop - window.start
    ends = np.zeros((R, 6, width), dtype=complex)
    if s is not None:
        ends += np.einsum("ij,rjw->riw", G, s)
    if prescribed is not None:
        ends += prescribed[:, :, window]
    return ends


def _check(result: Response) -> None:
    parts = [*result.covariance] + ([result.vessel] if result.vessel is not None else [])
    if not all(np.all(np.isfinite(part)) for part in parts):
        raise NotConverged(
            "frequency_domain", "the linear equations of motion have no finite answer at some frequency.",
            "Look for slack elements in the static shape, or lines without weight and tension.",
        )  # fmt: skip
