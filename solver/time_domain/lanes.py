"""Model and static position → the arrays of the march: lanes of line × seed, vessel, memory (T4-T6)."""

from __future__ import annotations

import numpy as np

from ..kernels import lanes as row
from ..kernels.arrays import Body, Lines, Memory, State, Watch, Work
from ..model.build import Model
from ..model.line import LineModel, current_profile, harmonic_omega
from ..statics.solve import StaticState
from ..vessel.radiation import Retardation
from ..vessel.rigid import turned

Array = np.ndarray
MEMORY_STEP = 0.2  # s between samples of the memory
FAR_BELOW = -1e9  # level of the bed under padding nodes [m]


def padded_shapes(static: StaticState) -> list[Array]:
    """Static shapes brought to one number of nodes: padding lies below end a, a metre apart, and never moves."""
    most = max(shape.shape[0] for shape in static.state.shapes)
    out = []
    for shape in static.state.shapes:
        gap = most - shape.shape[0]
        extra = shape[0] - np.arange(gap, 0, -1)[:, None] * np.array([0.0, 0.0, 1.0])
        out.append(np.ascontiguousarray(np.concatenate([extra, shape])))
    return out


def _elements(line: LineModel, gap: int) -> Array:
    a = line.arrays
    out = np.zeros((a.L.size + gap, row.ELEMENT_ROWS))
    out[:gap, row.EL] = out[:gap, row.KNEE] = 1.0
    out[:gap, row.LIMIT] = np.inf
    rest = out[gap:]
    for column, values in (
        (row.EL, a.L), (row.EA, a.EA), (row.CDN, a.cdn), (row.CDT, a.cdt), (row.MW, a.mw), (row.CAN, a.can),
        (row.CAT, a.cat), (row.W_DRY, a.w_dry), (row.B_WET, a.b_wet), (row.KB, a.kb[:-1]),
        (row.DIAMETER, a.D), (row.LIMIT, a.limit), (row.KNEE, a.knee),
    ):  # fmt: skip
        rest[:, column] = values
    return out


def _nodes(line: LineModel, gap: int) -> Array:
    a = line.arrays
    out = np.zeros((a.L.size + 1 + gap, row.NODE_ROWS))
    out[:gap, row.MASS] = 1.0
    out[:gap, row.POINT_R] = 1.0
    out[:gap, row.A2] = 1.0
    out[:gap, row.BED] = FAR_BELOW
    rest = out[gap:]
    for column, values in (
        (row.MASS, a.node_mass), (row.A1, a.a1), (row.POINT_W, a.point_weight), (row.POINT_D, a.point_drag),
        (row.POINT_M, a.point_mw), (row.POINT_CA, a.point_ca), (row.POINT_L, a.point_lift),
        (row.POINT_R, a.point_radius), (row.A2, a.a2), (row.BED, a.bed),
    ):  # fmt: skip
        rest[:, column] = values
    rest[:, row.BED_C] = np.where(a.a1 > 0.0, a.contact[0], 0.0)
    return out


def make_lines(model: Model, static: StaticState, seeds: int, first_wave: int) -> Lines:
    """Constants of all lanes of a block of seeds."""
    lines, shapes = static.lines, padded_shapes(static)
    P, Q = shapes[0].shape[0], seeds * len(lines)
    gaps = [P - line.nodes for line in lines]
    tile = lambda parts: np.ascontiguousarray(np.tile(np.stack(parts, axis=-1), seeds))  # noqa: E731
    free = []
    for gap in gaps:
        one = np.ones(P)
        one[: gap + 1] = 0.0
        one[-1] = 0.0
        free.append(one)
    heights, velocities = current_profile(model.case, model.frame)
    current = [np.stack([np.interp(x[:, 2], heights, velocities[:, p]) for p in range(3)], axis=1) for x in shapes]
    phasors = [
        np.concatenate([end.phasor if end.phasor is not None else np.zeros(3, dtype=complex) for end in line.ends])
        for line in lines
    ]
    arms = [
        line.end_b.arm if line.end_b.kind == "fairlead" and line.end_b.arm is not None else np.zeros(3)
        for line in lines
    ]
    if static.body is not None:
        arms = [static.body.turned_arm(static.position, arm) for arm in arms]
    arrays = lines[0].arrays
    return Lines(
        C=tile([_elements(line, gap) for line, gap in zip(lines, gaps, strict=True)]),
        D=tile([_nodes(line, gap) for line, gap in zip(lines, gaps, strict=True)]),
        free=tile(free), current=tile(current), friction=arrays.contact[1:].copy(), depth=float(arrays.depth),
        kind=np.array([line.end_b.kind == "fairlead" for line in lines] * seeds).astype(np.int64), arm=tile(arms),
        number=np.array([float(line.multiplicity) for line in lines] * seeds),
        phasor=tile([np.stack([p.real, p.imag]) for p in phasors]), omega=np.array([harmonic_omega(model.case) or 0.0]),
        bottom=np.array(gaps * seeds, dtype=np.int64), lines=len(lines), first_wave=first_wave if Q else 0,
    )  # fmt: skip


def make_body(model: Model, static: StaticState, seeds: int) -> Body:
    """The vessel about its static position."""
    points = np.stack([shape[-1] for shape in static.state.shapes], axis=-1)
    points = np.ascontiguousarray(np.tile(points, seeds))
    zero = np.zeros((6, 6))
    if model.vessel is None or static.body is None:
        return Body(np.eye(6), zero, np.zeros(6), zero, zero, np.zeros(6), points, False, False)
    body, vessel, yaw = static.body, model.vessel, float(static.position[5])
    geometric, steady = np.zeros((6, 6)), np.zeros(6)
    for line, forces in zip(static.lines, static.state.end_forces, strict=True):
        if line.end_b.kind == "fairlead" and line.end_b.arm is not None:
            arm, force = line.end_b.arm, forces[:3]
            geometric += line.multiplicity * body.geometric(static.position, arm, force)
            steady -= line.multiplicity * body.arm_matrix(static.position, arm).T @ force
    added, damping = vessel.radiation.added_mass, vessel.radiation.damping
    turn = lambda matrix: turned(matrix, yaw)  # noqa: E731
    return Body(
        turn(vessel.mass + vessel.extra_inertia + added), turn(damping + vessel.damping + vessel.extra_damping),
        vessel.quadratic.astype(float), body.stiffness(static.position), 0.5 * (geometric + geometric.T), steady, points,
        body.finite, True,
    )  # fmt: skip


def make_memory(model: Model, static: StaticState, step: float) -> Memory:
    """Weights of past velocities: K(t) against velocities that are linear between samples (T6)."""
    kernel = model.vessel.radiation.retardation if model.vessel is not None else None
    if kernel is None:
        return Memory(np.zeros((12, 0)), np.zeros((6, 6)), 1)
    kernel = kernel.turned(float(static.position[5]))
    every = max(round(MEMORY_STEP / step), 1)
    weights, ahead, newest = _weights(kernel, every * step)
    rows = np.concatenate([np.moveaxis(part, 0, 1).reshape(6, -1) for part in (weights, ahead)])
    return Memory(np.ascontiguousarray(rows), newest, every)


def _weights(kernel: Retardation, dt: float, fine: int = 8) -> tuple[Array, Array, Array]:
    """The weights of (T6) for samples dt apart, from K at `fine` points of each interval.

    Returns ∫K(τ) hat_j(τ) dτ for samples at τ = j·dt, (J, 6, 6); the same from the end of the first interval on, for
    samples one interval later; and the mean of K over the first interval (6, 6), so that the three are one integral of K
    for a constant velocity at any time between samples.
    """
    J = int(np.ceil(kernel.times[-1] / dt)) + 1
    tau = (np.arange(J * fine) + 0.5) * dt / fine
    K = kernel.at(tau).reshape(J, fine, 6, 6) * (dt / fine)
    up = ((np.arange(fine) + 0.5) / fine)[None, :, None, None]
    falling, rising = (K * (1 - up)).sum(axis=1), (K * up).sum(axis=1)
    weights = falling.copy()
    weights[1:] += rising[:-1]
    ahead = np.zeros_like(weights)
    ahead[:-1] = falling[1:]
    ahead[1:] += rising[1:]
    return np.ascontiguousarray(weights), np.ascontiguousarray(ahead), np.ascontiguousarray(K[0].sum(axis=0) / dt)


def make_state(static: StaticState, seeds: int, samples: int) -> State:
    """At rest in the static position."""
    x = np.ascontiguousarray(np.tile(np.stack(padded_shapes(static), axis=-1), seeds))
    box = lambda: np.zeros_like(x)  # noqa: E731
    six = lambda: np.zeros((seeds, 6))  # noqa: E731
    return State(
        x, box(), box(), box(), six(), six(), six(), six(), np.zeros((seeds, samples)), np.zeros((2, seeds, 6))
    )  # fmt: skip


def make_watch(nodes: int, lanes: int) -> Watch:
    """Nothing seen yet."""
    none = lambda *shape: np.full((*shape, lanes), np.nan)  # noqa: E731
    unseen = lambda n: np.stack([np.full((n, lanes), np.inf), np.full((n, lanes), -np.inf)])  # noqa: E731
    bed = np.concatenate([unseen(nodes), none(1, nodes), np.zeros((1, nodes, lanes))])
    elements = lambda: np.zeros((nodes - 1, lanes))  # noqa: E731
    return Watch(unseen(nodes - 1), elements(), none(2, nodes - 1), elements(), bed, unseen(4), np.zeros(lanes))


def make_work(state: State, rows: int, first_wave: int) -> Work:
    """Scratch arrays of a block. rows : of the water table, 6 where it is the water itself."""
    P, _, Q = state.x.shape
    S = state.s.shape[0]
    box = lambda: np.zeros((P, 3, Q))  # noqa: E731
    six = lambda: np.zeros((S, 6))  # noqa: E731
    water = np.zeros((max(P - first_wave, 0), 6, Q))
    terms = water if rows == 6 else np.zeros((water.shape[0], rows, Q))
    return Work(
        np.zeros((3 * P, row.BAND, Q)), np.zeros((3 * P, Q)), box(), box(), box(), box(), box(), np.zeros((P - 1, 3, Q)),
        np.zeros((P - 1, Q)), np.ones((P, 2, Q)), terms, water, np.zeros((S, 6, 6)), six(), six(), six(), six(), six(),
    )  # fmt: skip
