"""The lanes against `solver.forces`, against dense matrices and against differences of their own forces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.forces.inertia import blocks as mass_blocks
from solver.kernels import lanes
from solver.kernels.arrays import Work
from solver.kernels.elimination import backward, factor, forward
from solver.kernels.step import residual
from solver.kernels.tangent import tangent
from solver.model.build import Model, build
from solver.model.system import forces
from solver.statics.solve import StaticState, solve_statics
from solver.time_domain.lanes import make_lines, make_state, make_work, padded_shapes
from tests.systems import riser, span

Array = np.ndarray
DEPTH = 100.0
ATTACHMENTS = [
    {"line": "line", "arc_length": 30.0, "mass": 800.0, "volume": 0.2, "drag_area": 0.5, "added_mass": 0.5},
    {"line": "line", "arc_length": 90.0, "mass": 100.0, "volume": 1.5, "drag_area": 1.0, "added_mass": 0.5},
    {"line": "line", "arc_length": 110.0, "mass": 300.0, "volume": 0.3, "drag_area": 2.0, "added_mass": 0.7},
]


def _span(elements: int, **more: Any) -> dict[str, Any]:
    """A line from the bed to above the surface with everything on it."""
    data = span(150.0, (0, 0, -DEPTH), (70, 20, 15), elements, DEPTH, EA=2e7, EI=4e4, diameter=0.2,
                drag={"normal": 1.2, "tangential": 0.15}, added_mass={"normal": 1.0, "tangential": 0.2})  # fmt: skip
    data["environment"]["seabed"] = {
        "node_stiffness": 2e4,
        "transition": 0.5,
        "damping": 700.0,
        "friction": 0.6,
        "friction_speed": 0.3,
    }
    data["environment"]["current"] = {"depths": [0], "speeds": [0.8], "direction": "70 deg"}
    data["attachments"] = ATTACHMENTS
    data.update(more)
    return data


def _three_lines() -> dict[str, Any]:
    """Lines of 20, 9 and 14 elements, of unlike types and one of two segments: padding."""
    data = _span(20)
    rope = {"diameter": 0.15, "mass": 30.0, "EA": 4e6, "EI": 0.0, "drag": {"normal": 1.6, "tangential": 0.0}}
    data["line_types"]["rope"] = rope
    data["lines"]["short"] = {"segments": [{"type": "rope", "length": 120.0, "elements": 9}],
                              "end_a": {"pinned": [-60, 5, -90]}, "end_b": {"pinned": [-5, 0, 3]}}  # fmt: skip
    data["lines"]["mixed"] = {
        "segments": [{"type": "wire", "length": 60.0, "elements": 6}, {"type": "rope", "length": 70.0, "elements": 8}],
        "end_a": {"pinned": [0, -80, -DEPTH]}, "end_b": {"pinned": [0, -15, -2]},
    }  # fmt: skip
    return data


def _built(data: dict[str, Any]) -> tuple[Model, StaticState]:
    model = build(parse_case(data), None)
    return model, solve_statics(model)


class Moving:
    """Lines and a random state of motion about their static position, in moving water."""

    def __init__(self, data: dict[str, Any], seeds: int = 1, seed: int = 1, size: float = 0.4):
        self.model, self.static = _built(data)
        P = padded_shapes(self.static)[0].shape[0]
        self.lines = make_lines(self.model, self.static, seeds, 0)
        state = make_state(self.static, seeds, 0)
        self.work: Work = make_work(state, 6, 0)
        rng = np.random.default_rng(seed)
        shape = state.x.shape
        self.x = state.x + size * rng.normal(size=shape)
        self.v, self.a = rng.normal(size=shape), rng.normal(size=shape)
        self.work.water[:] = rng.normal(size=(P, 6, shape[2]))

    def residual(self, x: Array, v: Array, a: Array) -> Array:
        out = np.empty_like(x)
        residual(self.lines, self.work, x, v, a, out)
        return out

    def tangent(self, mass: float, damping: float) -> Array:
        A = np.zeros_like(self.work.A)
        lanes.elements(self.x, self.lines.C, self.work.t, self.work.length)
        tangent(
            self.x, self.v, self.lines.C, self.lines.D, self.work.t, self.work.length, self.lines.friction, self.work.wet,
            self.work.water, 0, self.lines.current, mass, damping, 0.0, A,
        )  # fmt: skip
        return A


def _reference(moving: Moving, lane: int) -> Array:
    """Forces of `solver.forces` less mass times acceleration on the nodes of one lane."""
    line = moving.static.lines[lane % len(moving.static.lines)]
    first = int(moving.lines.bottom[lane])
    cut = lambda values: np.ascontiguousarray(values[first:, :, lane])  # noqa: E731
    x, v, a = cut(moving.x), cut(moving.v), cut(moving.a)
    water = cut(moving.work.water)
    M, _ = mass_blocks(line.arrays, x)
    total = forces(line.arrays, x, v, np.ascontiguousarray(water[:, :3]), np.ascontiguousarray(water[:, 3:]))
    return total - np.einsum("ipq,iq->ip", M, a)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("data", [_span(24), riser(20), _three_lines()], ids=["everything", "riser", "three lines"])
def test_residual_is_the_sum_of_the_forces(data: dict[str, Any], seed: int) -> None:
    moving = Moving(data, 2, seed)
    found = moving.residual(moving.x, moving.v, moving.a)
    for lane in range(moving.x.shape[2]):
        expected = _reference(moving, lane)
        got = found[int(moving.lines.bottom[lane]) :, :, lane]
        np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_the_state_that_was_compared_has_everything_in_it() -> None:
    """Nodes on the bed, in the air and piercing; attachments below, above and across the surface; slack elements."""
    moving = Moving(_span(24), 2, 0)
    line, z = moving.static.lines[0], moving.x[:, 2]
    assert z.min() < -DEPTH
    assert z.max() > 5.0
    assert np.any((moving.work.wet > 0.05) & (moving.work.wet < 0.95)) or np.any(z[:-1] * z[1:] < 0)
    assert np.count_nonzero(line.arrays.point_drag) == 3
    assert np.any(np.linalg.norm(np.diff(moving.x, axis=0), axis=1) < line.arrays.L[:, None])


def test_current_is_that_of_the_static_height() -> None:
    """A profile over depth is taken at the mean position, as the waves are; `solver.forces` takes the node's own height."""
    data = _span(24)
    data["environment"]["current"] = {"depths": [0, 100], "speeds": [1.5, 0.2], "direction": "70 deg"}
    moving = Moving(data, 1, 0, 0.0)
    expected = _reference(moving, 0)
    found = moving.residual(moving.x, moving.v, moving.a)[..., 0]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def _full(band: Array) -> Array:
    """A lower band (rows, BAND) as a full symmetric matrix."""
    rows = band.shape[0]
    out = np.zeros((rows, rows))
    for d in range(lanes.BAND):
        for i in range(d, rows):
            out[i, i - d] = out[i - d, i] = band[i, d]
    return out


def _random_band(rows: int, lanes_: int) -> Array:
    A = np.random.default_rng(0).normal(size=(rows, lanes.BAND, lanes_))
    A[:, 0] = 20.0 + np.abs(A[:, 0])
    for d in range(1, lanes.BAND):
        A[:d, d] = 0.0
    return A


def test_factor_and_substitution_solve_the_system() -> None:
    A = _random_band(21, 3)
    b = np.random.default_rng(1).normal(size=(21, 3))
    factored, x = A.copy(), b.copy()
    factor(factored, 0, 21)
    forward(factored, x, 0, 21)
    backward(factored, x, 0, 21)
    for q in range(3):
        np.testing.assert_allclose(x[:, q], np.linalg.solve(_full(A[..., q]), b[:, q]), rtol=1e-12, atol=1e-14)


def test_stopping_early_leaves_the_schur_complement_and_the_condensed_load() -> None:
    A = _random_band(18, 2)
    b = np.random.default_rng(1).normal(size=(18, 2))
    factored, x = A.copy(), b.copy()
    factor(factored, 0, 15)
    forward(factored, x, 0, 15)
    for q in range(2):
        full = _full(A[..., q])
        inner = np.linalg.solve(full[:15, :15], np.column_stack([full[:15, 15:], b[:15, q]]))
        schur = full[15:, 15:] - full[15:, :15] @ inner[:, :3]
        kept = np.array([[factored[15 + max(i, j), abs(i - j), q] for j in range(3)] for i in range(3)])
        np.testing.assert_allclose(kept, schur, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(x[15:, q], b[15:, q] - full[15:, :15] @ inner[:, 3], rtol=1e-12, atol=1e-12)


def test_lanes_do_not_touch_each_other() -> None:
    moving = Moving(_three_lines(), 3, 5)
    before = moving.residual(moving.x, moving.v, moving.a)
    x = moving.x.copy()
    x[..., 1] += 0.3
    after = moving.residual(x, moving.v, moving.a)
    same = [lane for lane in range(x.shape[2]) if lane != 1]
    np.testing.assert_array_equal(before[..., same], after[..., same])
    assert np.abs(before[..., 1] - after[..., 1]).max() > 1.0


def _differences(moving: Moving, mass: float, damping: float, h: float = 1e-6) -> Array:
    """-d(residual)/dx where velocities and accelerations follow x by the factors of the scheme, one lane."""
    size = moving.x[..., 0].size
    out = np.empty((size, size))
    for j in range(size):
        d = np.zeros(moving.x.shape)
        d.reshape(size, -1)[j, 0] = h
        up = moving.residual(moving.x + d, moving.v + damping * d, moving.a + mass * d)
        down = moving.residual(moving.x - d, moving.v - damping * d, moving.a - mass * d)
        out[:, j] = (down - up)[..., 0].ravel() / (2 * h)
    return out


def _taut(**line: Any) -> dict[str, Any]:
    """A line in tension everywhere and below the surface, straight but for its sag."""
    kind = {"mass": 60.0, "EA": 2e7, "EI": 0.0, "diameter": 0.2, "drag": {"normal": 1.2, "tangential": 0.15},
            "added_mass": {"normal": 1.0, "tangential": 0.2}, **line}  # fmt: skip
    data = span(95.0, (0, 0, -60.0), (80, 20, -10.0), 9, DEPTH, **kind)
    data["lines"]["line"]["allow_stretch"] = True
    return data


def test_newtons_matrix_is_the_derivative_where_nothing_is_left_out() -> None:
    """At rest and with no drag, a taut line without bending: mass and axial stiffness are exact."""
    moving = Moving(_taut(drag={"normal": 0.0, "tangential": 0.0}), 1, 0, 0.02)
    moving.work.water[:] = 0.0
    moving.v[:] = 0.0
    moving.a[:] = 0.0
    matrix = _full(moving.tangent(40.0, 10.0)[..., 0])
    expected = _differences(moving, 40.0, 10.0)
    np.testing.assert_allclose(matrix, expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())


def test_what_is_left_out_of_newtons_matrix_is_small() -> None:
    """With drag, bending, bed and moving water: a hundredth of the matrix, less the shorter the step."""
    moving = Moving(_taut(EI=3e3), 1, 0, 0.02)
    gaps = []
    for h in (0.1, 0.05):
        mass, damping = 6 / (1.4 * h) ** 2, 3 / (1.4 * h)
        matrix, expected = _full(moving.tangent(mass, damping)[..., 0]), _differences(moving, mass, damping)
        root = 1 / np.sqrt(np.diag(expected))
        gaps.append(np.abs(root[:, None] * (matrix - expected) * root).max())
    assert gaps[0] < 0.05
    assert gaps[1] < 0.7 * gaps[0]


def test_newtons_matrix_is_positive_whatever_the_state() -> None:
    """Slack elements and sharp bends included."""
    for seed in range(3):
        moving = Moving(_span(24), 1, seed, 1.0)
        assert np.linalg.eigvalsh(_full(moving.tangent(50.0, 10.0)[..., 0]))[0] > 0


def test_a_sharp_bend_is_seen_only_where_bending_acts() -> None:
    for EI, expected in ((4e4, True), (0.0, False)):
        moving = Moving(_taut(EI=EI), 1, 0, 0.0)
        moving.x[4] += np.array([0.0, 0.0, 25.0])[:, None]
        lanes.elements(moving.x, moving.lines.C, moving.work.t, moving.work.length)
        assert lanes.sharp(moving.x, moving.lines.C, moving.work.t) == expected


def test_angle_over_sine_is_a_series_good_to_75_degrees() -> None:
    angle = np.radians(np.linspace(0.1, 75.0, 200))
    found = np.array([lanes.over_sine(1.0 - np.cos(a)) for a in angle])
    np.testing.assert_allclose(found, angle / np.sin(angle), rtol=2e-8)


def test_a_node_that_rises_from_the_deep_leaves_the_water() -> None:
    """From any depth: its wet share is that of where it is."""
    data = _span(24)
    data["line_types"]["wire"]["EI"] = 0.0
    moving = Moving(data, 1, 3)
    deep = int(np.argmin(moving.x[1:-1, 2, 0])) + 1
    assert moving.x[deep, 2, 0] < -60.0
    moving.residual(moving.x, moving.v, moving.a)
    assert np.all(moving.work.wet[deep] == 1.0)
    moving.x[deep - 1 : deep + 2, 2] = 5.0
    moving.residual(moving.x, moving.v, moving.a)
    assert np.all(moving.work.wet[deep] == 0.0)
    np.testing.assert_allclose(
        moving.residual(moving.x, moving.v, moving.a)[..., 0], _reference(moving, 0), rtol=1e-9, atol=1e-3
    )
