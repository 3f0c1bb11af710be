"""Static equilibrium: Newton's iteration with the tension as a second unknown; where it stalls, soft lines first.

Equations (S5), (S6) and (S13)-(S15); why this way: docs/decisions/0054-statics-globalisation.md.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..case import DOF
from ..kernels.line import LineArrays
from ..model.line import LineModel
from ..outcome import NotConverged
from .assembly import ARM, Assembly, Body, State, Step, end_forces, vessel_coupling

__all__ = ["State", "equilibrium", "vessel_coupling"]

Array = np.ndarray
ATTEMPT = 100  # iterations of one attempt of Newton's, at most
PATIENCE = 15  # iterations in which its residual must fall to a tenth
NEAR = 0.02  # longest move, as a share of what is allowed, below which the matrix holds compression
RELAX = 300  # iterations of the search with soft lines, at most
STRETCH = (1.0 / 30.0, 1.0 / 1000.0, 0.0)  # strain under its own weight that a soft line may have, in turn
FIRST_DAMPING = 0.1  # λ over T/L from a first shape
NEXT_DAMPINGS = (0.0, 0.01)  # and from the end of a search, in turn: slack lines on a bed settle without
OVERSHOOT, SHORTENINGS = 0.3, 20  # work against the forces at a step's end over that at its start, and tries
LOAD_STEPS = 200  # iterations after which the load is no longer raised in steps
SMALLEST, BETWEEN = 1.0 / 128.0, 1e-5  # step of the load, and residual wanted on the way
UNSTABLE = -1e-6  # lowest stiffness of the vessel over its own coordinates' below which an equilibrium is unstable
RELAXED = 1e-3  # residual at which the soft system is near enough to its equilibrium


@dataclass
class Point:
    """Where the iteration stands.

    shapes (N+1, 3) [m] and position (6,); mixed : tension that each element would have after the linear step [N].
    """

    shapes: list[Array]
    position: Array
    mixed: list[Array]
    iterations: int = 0
    residual: float = np.inf
    worst: str = "the vessel"


def equilibrium(
    lines: Sequence[LineModel], state: State, loads: Sequence[Array], body: Body | None, tolerance: float,
    max_iterations: int, on_iteration: Callable[[int, float], None] | None = None,
) -> State:  # fmt: skip
    """Static equilibrium from a starting state (S5, S6).

    loads : constant nodal loads of each line beyond its own forces, (N+1, 3) [N].
    tolerance : largest residual force as a share of the largest element tension; never asked below round-off.

    Newton's iteration first; where it does not settle, from a former equilibrium in steps of the load (S16), then by a
    line search on soft lines (S15). Raises NotConverged with what is largest and where.
    """
    system = Assembly(lines, loads, body)
    start = Point([shape.copy() for shape in state.shapes], state.position.copy(), [])
    start.mixed = list(state.tensions) or _even_tension(system, start.shapes)
    damping = 0.0 if state.tensions else FIRST_DAMPING
    tell = on_iteration or (lambda _iteration, _residual: None)
    found, point = newton(system, start, tolerance, min(ATTEMPT, max_iterations), damping, tell)
    if found is None and state.tensions and body is not None:
        found, point = by_load(system, _counted(start, point), tolerance, min(LOAD_STEPS, max_iterations), tell)
    if found is None:
        weights = _strength(system, state.tensions)
        found, point = by_stiffness(system, _counted(start, point), weights, tolerance, max_iterations, tell)
    if found is None:
        raise NotConverged(
            "statics",
            f"statics did not converge in {point.iterations} iterations: the largest residual is {point.residual:.2e} of "
            f"the largest tension, at {point.worst} (wanted {tolerance:.0e}).",
            "Check lengths and end points there, use shorter elements, a wider seabed transition, or more max_iterations.",
        )
    return _stable(system, found, tolerance, max_iterations, tell)


def _counted(at: Point, after: Point) -> Point:
    """A former point, with the iterations that were made since and where they ended."""
    return replace(at, iterations=after.iterations, residual=after.residual, worst=after.worst)


def by_load(
    system: Assembly, start: Point, tolerance: float, most: int, tell: Callable[[int, float], None]
) -> tuple[State | None, Point]:
    """From the equilibrium of other loads, in steps of the difference between them and ours (S16)."""
    nodal = system.nodal(start.shapes)
    vessel = system.body_load(nodal, start.position)
    reached, step, point = 0.0, 0.25, start
    while step > SMALLEST and point.iterations < most:
        share = min(reached + step, 1.0)
        rest = 1.0 - share
        loads = [load - rest * force for load, force in zip(system.loads, nodal, strict=True)]
        # the ends' own forces stay with the vessel, whose part of the difference is `vessel`
        for load, whole in zip(loads, system.loads, strict=True):
            load[0], load[-1] = whole[0], whole[-1]
        part = replace(system, loads=loads, extra=-rest * vessel)
        wanted = tolerance if share == 1.0 else max(tolerance, BETWEEN)
        found, after = newton(part, point, wanted, min(ATTEMPT, most - point.iterations), 0.0, tell)
        if found is None:
            step, point = 0.5 * step, _counted(point, after)
            continue
        if share == 1.0:
            return found, after
        reached, step, point = share, 2.0 * step, replace(after, mixed=found.tensions)
    return None, point


def by_stiffness(
    system: Assembly, start: Point, weights: Sequence[float], tolerance: float, most: int,
    tell: Callable[[int, float], None],
) -> tuple[State | None, Point]:  # fmt: skip
    """By a line search on soft lines, and Newton's iteration from its end, with ever stiffer lines (S15)."""
    point = start
    for stretch in STRETCH:
        left = most - point.iterations
        if left <= 0:
            break
        near = relax(system, point, weights, stretch, min(RELAX, left), tell, RELAXED if stretch > 0.0 else BETWEEN)
        after = near
        for damping in NEXT_DAMPINGS:
            left = min(ATTEMPT, most - after.iterations)
            found, after = newton(system, _counted(near, after), tolerance, left, damping, tell)
            if found is not None:
                return found, after
        point = _counted(near, after)  # the next search goes on from where this one ended
    return None, point


def _stable(system: Assembly, found: State, tolerance: float, most: int, tell: Callable[[int, float], None]) -> State:
    """A stable equilibrium beside one that is not, where there is one; else the one that was found."""
    lowest, motion = system.weakest(found.shapes, found.position)
    if lowest > UNSTABLE or system.body is None:
        return found
    dof = DOF[int(np.argmax(np.abs(motion) * np.repeat([1.0, ARM], 3)))]
    for sign in (1.0, -1.0) if dof in ("surge", "sway", "yaw") else ():  # a hull that capsizes has none beside it
        nudge = Step(0.0, "", [], [np.zeros_like(shape[1:-1]) for shape in found.shapes], sign * motion, 0.0)
        shapes, position = system.moved(found.shapes, found.position, nudge, 1.0)
        start = Point(shapes, position, found.tensions, found.iterations)
        near = relax(system, start, _strength(system, found.tensions), 0.0, RELAX, tell, BETWEEN)
        other, _ = newton(system, near, tolerance, min(ATTEMPT, most), 0.0, tell)
        if other is not None and system.weakest(other.shapes, other.position)[0] > UNSTABLE:
            return other
    return replace(found, unstable=dof)


def newton(
    system: Assembly, start: Point, tolerance: float, most: int, damping: float, tell: Callable[[int, float], None]
) -> tuple[State | None, Point]:
    """Newton's iteration in positions and tensions (S6, S13); the state where it converged, else None."""
    point, previous, seen = start, np.inf, []
    for _ in range(most):
        lam = [max(damping, 1e-9) * stiff for stiff in _transverse(system, point.mixed)]
        # compression softens an element across: Newton's matrix holds that near the end only, where it is exact
        mixed = point.mixed if previous < NEAR else [np.maximum(tension, 0.0) for tension in point.mixed]
        step = system.step(point.shapes, point.position, mixed, lam)
        point = replace(point, iterations=point.iterations + 1, residual=step.residual, worst=step.worst)
        tell(point.iterations, step.residual)
        seen.append(step.residual)
        if not (np.isfinite(step.residual) and np.isfinite(step.size)) or _stalled(seen):
            break
        scale = system.scale(point.shapes)
        if step.residual < max(tolerance, system.round_off(point.shapes) / scale):
            ends, tensions = [end_forces(force) for force in step.nodal], system.tensions(point.shapes)
            residual = step.residual * scale
            return State(point.shapes, point.position, ends, point.iterations, residual, True, tensions), point
        if 0.0 < previous < np.inf:
            damping = min(damping * min(max(step.size / previous, 0.1), 3.0) ** 2, 1.0)
        previous = step.size
        shapes, position = system.moved(point.shapes, point.position, step, step.limit)
        mixed = [
            _linear_tension(line, old, new) for line, old, new in zip(system.lines, point.shapes, shapes, strict=True)
        ]
        point = replace(point, shapes=shapes, position=position, mixed=mixed)
    return None, point


def _stalled(seen: Sequence[float]) -> bool:
    """Whether the residual has not fallen to a tenth in the last iterations."""
    return len(seen) > 2 * PATIENCE and min(seen[-PATIENCE:]) > 0.1 * min(seen[:-PATIENCE])


def relax(
    system: Assembly, start: Point, weights: Sequence[float], stretch: float, most: int,
    tell: Callable[[int, float], None], wanted: float = RELAXED,
) -> Point:  # fmt: skip
    """Towards the equilibrium of softer lines, each step searched along its length (S14, S15).

    weights : W of each line [N]; stretch : strain that it may give the line; 0 leaves the lines as they are;
    wanted : residual at which the search ends.
    """
    if stretch > 0.0:
        system = system.with_arrays([
            _softer(line.arrays, weight / stretch) for line, weight in zip(system.lines, weights, strict=True)
        ])  # fmt: skip
    sizes = [weight / float(np.mean(line.arrays.L)) for line, weight in zip(system.lines, weights, strict=True)]
    point, ease = start, 1e-2
    for _ in range(most):
        mixed = [np.maximum(tension, 0.0) for tension in system.tensions(point.shapes)]
        step = system.step(point.shapes, point.position, mixed, [ease * size for size in sizes], ease)
        point = Point(point.shapes, point.position, mixed, point.iterations + 1, step.residual, step.worst)
        tell(point.iterations, step.residual)
        if step.residual < wanted or not np.isfinite(step.size):
            break
        work = system.work(step.nodal, point.position, step)
        if work <= 0.0:  # against the forces: a nearer step follows them
            ease = 10.0 * max(ease, 1e-4)
            if ease > 1e8:
                break
            continue
        shapes, position, tries = search(system, point, step, work)
        if tries:
            ease = min(ease * 3.0 ** min(tries, 3), 100.0)
        elif step.limit > 0.5:
            ease *= 0.3
        point = Point(shapes, position, mixed, point.iterations, step.residual, step.worst)
    return point


def search(system: Assembly, point: Point, step: Step, work: float) -> tuple[list[Array], Array, int]:
    """The share of a step beyond which the forces would pull back, and how often it was shortened (S14)."""
    share, tries = step.limit, 0
    while True:
        shapes, position = system.moved(point.shapes, point.position, step, share)
        at_end = system.work(system.nodal(shapes), position, step)
        if at_end >= -OVERSHOOT * work or tries == SHORTENINGS:
            return shapes, position, tries
        share *= min(max(work / (work - at_end), 0.1), 0.7)
        tries += 1


def _softer(arrays: LineArrays, most: float) -> LineArrays:
    """The same line with EA at most `most` [N] and the compression that it carries as it was."""
    EA = np.minimum(arrays.EA, most)
    return arrays._replace(
        EA=EA, limit=arrays.limit * arrays.EA / EA, knee=np.minimum(arrays.knee * arrays.EA / EA, 0.01)
    )


def _transverse(system: Assembly, mixed: Sequence[Array]) -> list[float]:
    """The transverse stiffness of an element of each line, the natural size of λ [N/m]."""
    return [
        max(float(np.mean(np.maximum(tension, 0.0))), 1e-3 * float(np.sum(line.arrays.w_dry)))
        / float(np.mean(line.arrays.L))
        for line, tension in zip(system.lines, mixed, strict=True)
    ]


def _even_tension(system: Assembly, shapes: Sequence[Array]) -> list[Array]:
    """One tension along each line to start with [N]: the mean size of those that the first shape has."""
    means = [float(np.mean(np.abs(tension))) for tension in system.tensions(shapes)]
    weights = [1e-3 * float(np.sum(line.arrays.w_dry)) for line in system.lines]
    return [
        np.full(line.arrays.L.size, max(mean, weight))
        for line, mean, weight in zip(system.lines, means, weights, strict=True)
    ]


def _strength(system: Assembly, tensions: Sequence[Array]) -> list[float]:
    """W of each line [N]: its weight in water, sizes added up, or its mean tension in a former equilibrium (S15)."""
    out = []
    for line in system.lines:
        arrays = line.arrays
        own = float(np.sum(np.abs(arrays.w_dry - arrays.b_wet)))
        hung = float(np.sum(np.abs(arrays.point_weight - arrays.point_lift)))
        out.append(max(own, hung, 1e-3 * float(np.sum(arrays.w_dry))))
    return [max(weight, float(np.mean(tension))) for weight, tension in zip(out, tensions, strict=False)] or out


def _linear_tension(line: LineModel, old: Array, new: Array) -> Array:
    """Tension of the length that is linear in the step, (l + t·Δ - L) EA/L at the old l and t, (N,) [N] (S13).

    Compression beyond the Euler load is left out.
    """
    d = np.diff(old, axis=0)
    length = np.sqrt(np.sum(d * d, axis=1))
    length = length + np.sum(d * (np.diff(new, axis=0) - d), axis=1) / length
    strain = length / line.arrays.L - 1.0
    return line.arrays.EA * np.maximum(strain, -line.arrays.limit)
