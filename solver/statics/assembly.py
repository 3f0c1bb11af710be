"""Lines and the vessel they hold, as one system of equations: residual, linear step, move (docs/theory.md, S5-S8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ..forces import axial
from ..kernels.line import LineArrays
from ..model.line import LineModel
from ..model.system import forces, newton_step
from ..outcome import NotConverged

Array = np.ndarray
ARM = 30.0  # m: lever that makes a moment comparable with a force
NUDGE = 3.0  # m: motion that leaves an unstable equilibrium
MOST_TURN = 0.2  # rad: largest rotation of one step


class Body(Protocol):
    """What the iteration asks of a vessel."""

    def load(self, position: Array) -> Array:
        """Loads without the lines at a position (6,) -> (6,) [N, N m]."""

    def stiffness(self, position: Array) -> Array:
        """-∂load/∂position (6, 6)."""

    def arm_matrix(self, position: Array, arm: Array) -> Array:
        """∂(fairlead)/∂position of arms (..., 3): (..., 3, 6)."""

    def fairlead(self, position: Array, arm: Array) -> Array:
        """Fairleads in the solver's frame (..., 3) [m]."""

    def geometric(self, position: Array, arm: Array, force: Array) -> Array:
        """K_g of fairleads under the forces (..., 3) of their lines on the vessel, (..., 6, 6)."""

    def moved(self, position: Array, step: Array) -> Array:
        """The position after a step (6,)."""


@dataclass
class State:
    """Positions of everything, and how the iteration went.

    shapes : node positions of each line, (N+1, 3) [m]; position : vessel, (6,) [m, rad];
    end_forces : force of each line on its supports, end b then end a, (6,) [N]; tensions : of its elements (N,) [N], to
    start with where the shapes are not yet in equilibrium; unstable : the motion in which the vessel would leave it.
    """

    shapes: list[Array]
    position: Array
    end_forces: list[Array] = field(default_factory=list)
    iterations: int = 0
    residual: float = np.inf
    converged: bool = False
    tensions: list[Array] = field(default_factory=list)
    unstable: str = ""


@dataclass(frozen=True)
class Step:
    """One linearised step and where it stands.

    residual : largest residual as a share of the largest tension, at `worst`; nodal : forces on the nodes of each line
    (N+1, 3) [N]; moves : steps of their inner nodes (N-1, 3) [m]; delta : step of the vessel (6,) [m, rad];
    size : longest move over the longest that is allowed.
    """

    residual: float
    worst: str
    nodal: list[Array]
    moves: list[Array]
    delta: Array
    size: float

    @property
    def limit(self) -> float:
        """Share of the step that keeps every move within what is allowed."""
        return min(1.0, 1.0 / self.size) if self.size > 0.0 else 1.0


@dataclass(frozen=True)
class Assembly:
    """Lines with constant nodal loads (N+1, 3) [N], and the vessel that holds their fairleads, if any.

    extra : constant load on the vessel beyond its own (6,) [N, N m].
    """

    lines: Sequence[LineModel]
    loads: Sequence[Array]
    body: Body | None
    extra: Array = field(default_factory=lambda: np.zeros(6))
    _known: dict[bytes, Array] = field(default_factory=dict, compare=False)

    @cached_property
    def numbers(self) -> Array:
        """How many real lines each line stands for (L,)."""
        return np.array([line.multiplicity for line in self.lines], dtype=float)

    @cached_property
    def fairleads(self) -> tuple[Array, Array]:
        """Arms of end b and end a of each line (L, 2, 3) [m], and which of these ends are on the vessel (L, 2)."""
        arms, on_vessel = np.zeros((len(self.lines), 2, 3)), np.zeros((len(self.lines), 2), dtype=bool)
        for index, line in enumerate(self.lines):
            for row, end in enumerate(line.ends):
                if self.body is not None and end.kind == "fairlead" and end.arm is not None:
                    arms[index, row], on_vessel[index, row] = end.arm, True
        return arms, on_vessel

    @cached_property
    def heaviest(self) -> float:
        """Dry weight of the heaviest element, at least 1 N [N]."""
        return max([1.0, *(float(np.max(line.arrays.w_dry)) for line in self.lines)])

    def with_arrays(self, arrays: Sequence[LineArrays]) -> Assembly:
        """The same system with other line constants."""
        lines = [replace(line, arrays=a) for line, a in zip(self.lines, arrays, strict=True)]
        return replace(self, lines=lines)

    def tensions(self, shapes: Sequence[Array]) -> list[Array]:
        """Axial force of the elements of each line [N]."""
        return [axial.tension(line.arrays, shape) for line, shape in zip(self.lines, shapes, strict=True)]

    def scale(self, shapes: Sequence[Array]) -> float:
        """The force that residuals are compared with [N]: the largest tension, at least an element's weight."""
        return max([*(float(np.abs(tension).max()) for tension in self.tensions(shapes)), self.heaviest])

    def round_off(self, shapes: Sequence[Array]) -> float:
        """Force that the last bit of a node's position makes in the stiffest element [N]: no residual is asked below."""
        largest = 0.0
        for line, shape in zip(self.lines, shapes, strict=True):
            bit = float(np.spacing(np.abs(shape).max()))
            largest = max(largest, 2.0 * bit * float(np.max(line.arrays.EA / line.arrays.L)))
        return largest

    def couplings(self, position: Array) -> Array:
        """G of all lines at a position of the vessel, (L, 6, 6); zeros without a vessel (S7)."""
        key = position.tobytes()
        if key not in self._known:
            self._known.clear()
            G = np.zeros((len(self.lines), 6, 6))
            if self.body is not None:
                arms, on_vessel = self.fairleads
                G[:] = (self.body.arm_matrix(position, arms) * on_vessel[..., None, None]).reshape(-1, 6, 6)
            self._known[key] = G
        return self._known[key]

    def nodal(self, shapes: Sequence[Array]) -> list[Array]:
        """Forces on the nodes of each line (N+1, 3) [N]."""
        still = [np.zeros_like(shape) for shape in shapes]
        return [
            forces(line.arrays, shape, zero, zero, zero) + load
            for line, shape, zero, load in zip(self.lines, shapes, still, self.loads, strict=True)
        ]

    def body_load(self, nodal: Sequence[Array], position: Array) -> Array:
        """r(s): all loads on the vessel (6,) [N, N m], zeros without one (S5)."""
        if self.body is None:
            return np.zeros(6)
        pulls = np.einsum("l,lji,lj->i", self.numbers, self.couplings(position), _at_ends(nodal))
        return self.body.load(position) + self.extra + pulls

    def residual(self, nodal: Sequence[Array], position: Array) -> tuple[float, str]:
        """Largest residual force [N] and where it is (S5)."""
        worst, where = 0.0, "the vessel"
        inner = np.abs(np.concatenate([np.zeros((0, 3)), *(force[1:-1] for force in nodal)])).max(axis=1, initial=0.0)
        if inner.size:
            at = int(np.argmax(inner))  # the first that is not a number, where there is one
            worst, where = float(inner[at]), self._place(at)
        if self.body is not None:
            load = self.body_load(nodal, position)
            size = float(max(np.abs(load[:3]).max(), np.abs(load[3:]).max() / ARM)) * self._largest_share(nodal)
            if not size <= worst:
                worst, where = size, "the vessel"
        return worst, where

    def _largest_share(self, nodal: Sequence[Array]) -> float:
        """The largest force of a fairlead over the sum of all: as a share of the one, a load is a share of the sum."""
        _, on_vessel = self.fairleads
        sizes = np.linalg.norm(_at_ends(nodal).reshape(-1, 2, 3), axis=2) * on_vessel
        total = float(self.numbers @ sizes.sum(axis=1))
        return float(sizes.max(initial=0.0)) / total if total > 0.0 else 1.0

    def _place(self, at: int) -> str:
        """The line and arc length of an inner node, counted through all lines."""
        for line in self.lines:
            if at < line.nodes - 2:
                return f"line {line.name!r}, {line.node_arc[at + 1]:.4g} m from end a"
            at -= line.nodes - 2
        raise IndexError(at)

    def step(
        self,
        shapes: Sequence[Array],
        position: Array,
        mixed: Sequence[Array],
        damping: Sequence[float],
        held: float = 0.0,
    ) -> Step:
        """Newton's step of everything (S6, S8).

        mixed : tension of the elements of each line [N] that stiffens them across; damping : λ of each line [N/m];
        held : λ of the vessel, as a share of its own stiffness.
        """
        try:
            solved = [
                newton_step(line.arrays, shape, load, lam, tension)
                for line, shape, load, lam, tension in zip(self.lines, shapes, self.loads, damping, mixed, strict=True)
            ]
        except ZeroDivisionError:  # two nodes at one point, or a pivot of zero
            return Step(np.inf, "a line", [], [], np.zeros(6), np.nan)
        nodal = [one[0] for one in solved]
        residual, worst = self.residual(nodal, position)
        delta = self._body_step(solved, position, held)
        moves, size = [], float(np.abs(delta[3:]).max()) / MOST_TURN
        for line, (_F, y, X, _Kc, _fc), at_ends in zip(
            self.lines, solved, self.couplings(position) @ delta, strict=True
        ):
            move = y - X @ at_ends if self.body is not None else y
            moves.append(move.reshape(-1, 3))
            most = max(line.length / line.arrays.L.size, 0.02 * line.length)
            size = max(size, float(np.abs(move).max(initial=0.0)) / most)
        return Step(residual / self.scale(shapes), worst, nodal, moves, delta, size)

    def _body_step(self, solved: Sequence[Any], position: Array, held: float) -> Array:
        """The vessel's step with all lines condensed onto it (S8)."""
        J, r = self._vessel(solved, position)
        if not (np.all(np.isfinite(J)) and np.all(np.isfinite(r))):
            return np.full(6, np.nan)
        if self.body is None:
            return np.zeros(6)
        size = np.sqrt(np.maximum(np.abs(np.diag(J)), 1e-12 * np.abs(J).max() + 1e-300))
        J = J + held * np.diag(size**2)
        if np.linalg.cond(J / np.outer(size, size)) > 1e12:
            raise NotConverged(
                "statics", "the vessel is not held: its stiffness with all lines is singular.",
                "Moor it in every direction, or give hydrostatics.stiffness or line_coefficients.stiffness.",
            )  # fmt: skip
        return np.linalg.solve(J, r)

    def _vessel(self, solved: Sequence[Any], position: Array) -> tuple[Array, Array]:
        """Stiffness (6, 6) and load (6,) of the vessel with all lines condensed onto it (S8)."""
        if self.body is None:
            return np.zeros((6, 6)), np.zeros(6)
        G, m = self.couplings(position), self.numbers
        Kc = np.array([one[3] for one in solved]).reshape(-1, 6, 6)
        fc = np.array([one[4] for one in solved]).reshape(-1, 6)
        at_ends = _at_ends([one[0] for one in solved]).reshape(-1, 2, 3)
        arms, on_vessel = self.fairleads
        J = self.body.stiffness(position) + np.einsum("l,lij->ij", m, G.swapaxes(1, 2) @ Kc @ G)
        J = J + np.einsum("l,le,leij->ij", m, on_vessel, self.body.geometric(position, arms, at_ends))
        return J, self.body.load(position) + self.extra + np.einsum("l,lji,lj->i", m, G, fc)

    def weakest(self, shapes: Sequence[Array], position: Array) -> tuple[float, Array]:
        """Lowest eigenvalue of the vessel's stiffness, each coordinate over its own, and that motion (6,) [m, rad].

        Negative: the equilibrium is unstable. Infinite without a vessel.
        """
        if self.body is None:
            return np.inf, np.zeros(6)
        solved = [
            newton_step(line.arrays, shape, load, 0.0, tension)
            for line, shape, load, tension in zip(self.lines, shapes, self.loads, self.tensions(shapes), strict=True)
        ]
        J, _ = self._vessel(solved, position)
        size = np.sqrt(np.maximum(np.abs(np.diag(J)), 1e-300))
        values, vectors = np.linalg.eigh(0.5 * (J + J.T) / np.outer(size, size))
        motion = vectors[:, 0] / size
        return float(values[0]), motion / max(np.abs(motion[:3]).max() / NUDGE, np.abs(motion[3:]).max() / NUDGE * ARM)

    def moved(self, shapes: Sequence[Array], position: Array, step: Step, share: float) -> tuple[list[Array], Array]:
        """Shapes and vessel position after a share of a step."""
        place = self.body.moved(position, share * step.delta) if self.body is not None else position
        out = [shape.copy() for shape in shapes]
        for new, move in zip(out, step.moves, strict=True):
            new[1:-1] += share * move
        if self.body is not None:
            arms, on_vessel = self.fairleads
            points = self.body.fairlead(place, arms)
            for index, row in np.argwhere(on_vessel):
                out[index][-1 if row == 0 else 0] = points[index, row]
        return out, place

    def work(self, nodal: Sequence[Array], position: Array, step: Step) -> float:
        """Work that the residual forces do along a step [N m] (S14)."""
        total = float(self.body_load(nodal, position) @ step.delta)
        for number, force, move in zip(self.numbers, nodal, step.moves, strict=True):
            total += number * float(np.vdot(force[1:-1], move))
        return total


def _at_ends(nodal: Sequence[Array]) -> Array:
    """The end forces of all lines (L, 6) [N]."""
    return np.array([end_forces(force) for force in nodal]).reshape(-1, 6)


def end_forces(nodal: Array) -> Array:
    """Forces on the supports from nodal forces (N+1, 3): end b, then end a, (6,) [N]."""
    return np.concatenate([nodal[-1], nodal[0]])


def vessel_coupling(line: LineModel, body: Body, position: Array) -> Array:
    """∂(end b, end a)/∂(vessel), (6, 6); zero rows where the end is not a fairlead (S7)."""
    G = np.zeros((6, 6))
    for row, end in enumerate(line.ends):
        if end.kind == "fairlead" and end.arm is not None:
            G[3 * row : 3 * row + 3] = body.arm_matrix(position, end.arm)
    return G
