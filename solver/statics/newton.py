"""Newton's iteration with a shrinking λI, for lines alone and for lines with their vessel (docs/theory.md, S5-S8)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from ..forces import axial
from ..model.line import LineModel
from ..model.system import newton_step
from ..outcome import NotConverged

Array = np.ndarray


class Body(Protocol):
    """What Newton's iteration asks of a vessel."""

    def load(self, position: Array) -> Array:
        """Loads without the lines at a position (6,) -> (6,) [N, N m]."""

    def stiffness(self, position: Array) -> Array:
        """-∂load/∂position (6, 6)."""

    def arm_matrix(self, position: Array, arm: Array) -> Array:
        """∂(fairlead)/∂position, (3, 6)."""

    def fairlead(self, position: Array, arm: Array) -> Array:
        """Fairlead in the solver's frame (3,) [m]."""

    def geometric(self, position: Array, arm: Array, force: Array) -> Array:
        """K_g of one fairlead under the force of its line on the vessel, (6, 6)."""

    def moved(self, position: Array, step: Array) -> Array:
        """The position after a step (6,)."""


@dataclass
class State:
    """Positions of everything, and how the iteration went.

    shapes : node positions of each line, (N+1, 3) [m]; position : vessel, (6,) [m, rad];
    end_forces : force of each line on its supports, end b then end a, (6,) [N].
    """

    shapes: list[Array]
    position: Array
    end_forces: list[Array] = field(default_factory=list)
    iterations: int = 0
    residual: float = np.inf
    converged: bool = False


def equilibrium(
    lines: Sequence[LineModel], state: State, loads: Sequence[Array], body: Body | None, tolerance: float,
    max_iterations: int, on_iteration: Callable[[int, float], None] | None = None,
) -> State:  # fmt: skip
    """Static equilibrium from a starting state (S5, S6).

    loads : constant nodal loads of each line beyond its own forces, (N+1, 3) [N].
    tolerance : largest residual force as a share of the largest element tension; never asked below round-off.

    Raises NotConverged with what is largest and where.
    """
    shapes, position = [shape.copy() for shape in state.shapes], state.position.copy()
    ease, previous, worst, residual = 1.0, np.inf, "", np.inf
    for iteration in range(1, max_iterations + 1):
        steps = [
            newton_step(line.arrays, shape, load, ease * _transverse(line, shape))
            for line, shape, load in zip(lines, shapes, loads, strict=True)
        ]
        scale = _scale(lines, shapes)
        residual, worst = _residual(lines, steps, body, position, scale)
        if on_iteration:
            on_iteration(iteration, residual)
        if not np.isfinite(residual):
            break
        if residual < max(tolerance, _round_off(lines, shapes) / scale):
            forces = [_end_forces(step[0]) for step in steps]
            return State(shapes, position, forces, iteration, residual * scale, True)
        if np.isfinite(previous):  # λ follows the square of the residual: switched evolution relaxation
            ease = min(ease * min(max(residual / previous, 0.3), 3.0) ** 2, 1.0)
        previous = residual
        delta = _body_step(lines, steps, body, position)
        _advance(lines, shapes, steps, body, position, delta)
        position = body.moved(position, delta) if body is not None else position
    raise NotConverged(
        "statics",
        f"statics did not converge in {max_iterations} iterations: the largest residual is {residual:.2e} of the "
        f"largest tension, at {worst} (wanted {tolerance:.0e}).",
        "Check lengths and end points there, use shorter elements, a wider seabed transition, or more max_iterations.",
    )


def _transverse(line: LineModel, shape: Array) -> float:
    """The transverse stiffness of an element, the natural size of λ [N/m]."""
    mean = float(np.mean(np.abs(axial.tension(line.arrays, shape))))
    weight = float(np.sum(line.arrays.w_dry))
    return max(mean, 1e-3 * weight) / float(np.mean(line.arrays.L))


def _scale(lines: Sequence[LineModel], shapes: Sequence[Array]) -> float:
    tensions = [
        float(np.max(np.abs(axial.tension(line.arrays, shape)))) for line, shape in zip(lines, shapes, strict=True)
    ]
    weights = [float(np.max(line.arrays.w_dry)) for line in lines]
    return max([*tensions, *weights, 1.0])


def _round_off(lines: Sequence[LineModel], shapes: Sequence[Array]) -> float:
    """Force that the last bit of a node's position makes in the stiffest element [N]: no residual can be asked below."""
    largest = 0.0
    for line, shape in zip(lines, shapes, strict=True):
        bit = float(np.spacing(np.abs(shape).max()))
        largest = max(largest, 2.0 * bit * float(np.max(line.arrays.EA / line.arrays.L)))
    return largest


def _residual(lines, steps, body, position, scale):  # type: ignore[no-untyped-def]
    worst, where = 0.0, "the vessel"
    for line, (F, *_rest) in zip(lines, steps, strict=True):
        if F.shape[0] > 2:
            sizes = np.abs(F[1:-1]).max(axis=1)
            index = int(np.argmax(sizes))
            if not sizes[index] <= worst:
                worst, where = float(sizes[index]), f"line {line.name!r}, {line.node_arc[index + 1]:.4g} m from end a"
    if body is not None:
        load = body.load(position)
        for line, (F, *_rest) in zip(lines, steps, strict=True):
            load = load + line.multiplicity * vessel_coupling(line, body, position).T @ _end_forces(F)
        arm = 30.0 * max(sum(line.multiplicity for line in lines), 1)  # moments against a typical lever
        size = float(max(np.abs(load[:3]).max() / max(arm / 30.0, 1.0), np.abs(load[3:]).max() / arm))
        if not size <= worst:
            worst, where = size, "the vessel"
    return worst / scale, where


def _end_forces(F: Array) -> Array:
    return np.concatenate([F[-1], F[0]])


def vessel_coupling(line: LineModel, body: Body, position: Array) -> Array:
    """∂(end b, end a)/∂(vessel), (6, 6); zero rows where the end is not a fairlead (S7)."""
    G = np.zeros((6, 6))
    for row, end in enumerate(line.ends):
        if end.kind == "fairlead" and end.arm is not None:
            G[3 * row : 3 * row + 3] = body.arm_matrix(position, end.arm)
    return G


def _body_step(lines, steps, body, position):  # type: ignore[no-untyped-def]
    """The vessel's step with all lines condensed onto it (S8)."""
    if body is None:
        return np.zeros(6)
    J, r = body.stiffness(position), body.load(position)
    for line, (F, _y, _X, Kc, fc) in zip(lines, steps, strict=True):
        G = vessel_coupling(line, body, position)
        J = J + line.multiplicity * G.T @ Kc @ G
        r = r + line.multiplicity * G.T @ fc
        for row, end in enumerate(line.ends):
            if end.kind == "fairlead":
                force = _end_forces(F)[3 * row : 3 * row + 3]
                J = J + line.multiplicity * body.geometric(position, end.arm, force)
    size = np.sqrt(np.maximum(np.abs(np.diag(J)), 1e-12 * np.abs(J).max() + 1e-300))
    if np.linalg.cond(J / np.outer(size, size)) > 1e12:
        raise NotConverged(
            "statics", "the vessel is not held: its stiffness with all lines is singular.",
            "Moor it in every direction, or give hydrostatics.stiffness or line_coefficients.stiffness.",
        )  # fmt: skip
    return np.linalg.solve(J, r)


def _advance(lines, shapes, steps, body, position, delta):  # type: ignore[no-untyped-def]
    """Move all nodes by one step, shortened so that no node moves more than an element or 2 % of its line."""
    moves = []
    limit = 1.0
    for line, (_F, y, X, _Kc, _fc) in zip(lines, steps, strict=True):
        ends = vessel_coupling(line, body, position) @ delta if body is not None else np.zeros(6)
        move = y - X @ ends
        moves.append((move, ends))
        largest = float(np.abs(move).max(initial=0.0))
        most = max(line.length / line.arrays.L.size, 0.02 * line.length)
        if largest > most:
            limit = min(limit, most / largest)
    if body is not None and np.abs(delta[3:]).max() > 0.2:
        limit = min(limit, 0.2 / float(np.abs(delta[3:]).max()))
    delta *= limit
    moved = body.moved(position, delta) if body is not None else position
    for line, shape, (move, _ends) in zip(lines, shapes, moves, strict=True):
        shape[1:-1] += limit * move.reshape(-1, 3)
        for end, index in ((line.end_b, -1), (line.end_a, 0)):
            if end.kind == "fairlead" and body is not None:
                shape[index] = body.fairlead(moved, end.arm)
