"""Linear responses against differences of the nonlinear laws: tension, bending, forces at the ends, turning fairleads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solver.case.analysis import LowBand, WaveBand
from solver.forces import axial, bending
from solver.frequency_domain.band import difference_strips, wave_strips
from solver.model.body import VesselBody
from tests.results.values.linear import Raw
from tests.results.values.linear_channels import stiffness_of_joints
from tests.results.values.scenes import Linear, calm, shaken
from tests.systems import Source

Array = np.ndarray
STEP = 1e-4  # m, the largest motion of a node for a difference


@pytest.fixture(scope="module", params=["shaken", "calm"])
def scene(request: pytest.FixtureRequest, source: Source) -> Linear:
    return Linear.of(shaken(), None) if request.param == "shaken" else Linear.of(calm(), source)


def _difference(law: Any, x: Array, y: Array) -> Array:
    """Change of a law of the nodes' positions per unit of a complex motion y (N+1, 3)."""
    size = STEP / max(np.abs(y).max(), 1e-12)
    return sum(
        unit * (law(x + size * part) - law(x - size * part)) / (2 * size) for unit, part in ((1, y.real), (1j, y.imag))
    )


def _motions(scene: Linear, index: int) -> list[tuple[int, Array]]:
    """Frequencies and motions of the nodes of a line under the first load: first, middle and last strip."""
    motion, count = scene.solved.frequency.wave.motion[index], scene.solved.omega_wave.size
    return [(k, motion[:, :, k]) for k in sorted({0, count // 2, count - 1})]


def test_tension_is_the_difference_of_the_stretch(scene: Linear) -> None:
    for index, line in enumerate(scene.solved.lines):
        x = scene.solved.static.state.shapes[index]
        for k, y in _motions(scene, index):
            expected = _difference(
                lambda nodes, a=line.arrays: a.EA * (np.linalg.norm(np.diff(nodes, axis=0), axis=1) / a.L - 1), x, y
            )
            found = scene.solved.frequency.wave.tension[index][0, :, k]
            np.testing.assert_allclose(found, expected, atol=1e-4 * np.abs(expected).max())


def test_bending_in_and_out_of_the_plane_is_the_difference_of_the_angle(scene: Linear) -> None:
    """kb times the change of the angle between two elements, in the vertical plane of the line and across it."""
    raw = Raw(scene)
    for index, name in enumerate(raw.names):
        x, kb = raw.shapes[name], stiffness_of_joints(raw, name)
        across = np.cross(x[-1] - x[0], [0.0, 0.0, 1.0])
        across /= np.linalg.norm(across)

        def turns(nodes: Array, across: Array = across) -> Array:
            t = np.diff(nodes, axis=0)
            flat = t - np.outer(t @ across, across)
            side = np.cross(across, [0.0, 0.0, 1.0])
            slope = np.unwrap(np.arctan2(flat[:, 2], flat @ side))
            return np.stack([np.diff(slope), np.diff(np.arcsin(t @ across / np.linalg.norm(t, axis=1)))])

        for k, y in _motions(scene, index):
            expected = kb * _difference(turns, x, y)
            found = scene.solved.frequency.wave.moment[index][0, :, 1:-1, k]
            for row, most in zip(range(2), (1e-3, 0.02), strict=True):
                size = max(np.abs(expected[row]).max(), 1e-3 * np.abs(expected).max())
                np.testing.assert_allclose(np.abs(found[row]), np.abs(expected[row]), atol=most * size)


def test_forces_at_the_ends_are_those_of_the_last_nodes(scene: Linear) -> None:
    """Change of the inner forces on an end's node, its mass times the acceleration, its drag and what the water does."""
    result = scene.solved.frequency
    for index, g in enumerate(result.geometries):
        a, rest = g.line.arrays, scene.solved.static.state.end_forces[index]

        def inner(nodes: Array, a: Any = a) -> Array:
            out, still = np.zeros_like(nodes), np.zeros_like(nodes)
            axial.force(a, nodes, still, still, still, out)
            bending.force(a, nodes, still, still, still, out)
            return out

        water = result.driver.wave.loads.water[index]
        for k, y in _motions(scene, index):
            omega, change = scene.solved.omega_wave[k], _difference(inner, g.x, y)
            for row, node in ((0, -1), (1, 0)):
                damping = result.linear.damping[index][node]
                force = change[node] + omega**2 * g.M[node] @ y[node] - 1j * omega * damping @ y[node]
                if water.real.shape[0]:
                    u = water.real[0, node, :, k] + 1j * water.imag[0, node, :, k]
                    force = force + damping @ u + 1j * omega * g.C[node] @ u
                static = rest[3 * row : 3 * row + 3]
                found, size = result.wave.ends[index][0, :, k], np.abs(force).max()
                assert found[row] == pytest.approx(static @ force / np.linalg.norm(static), abs=2e-3 * size)
                assert found[2 + row] == pytest.approx(force[2], abs=2e-3 * size)


@pytest.mark.parametrize("degrees", [20.0, 25.0, 30.0])
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.6, -0.3, 0.74), (-0.2, 0.97, 0.1)])
def test_a_fairlead_far_turned_moves_as_its_derivative_says(degrees: float, axis: tuple[float, ...]) -> None:
    """P and the moment r × f about the CG after a further small turn, by composing rotations."""
    unit = np.array(axis) / np.linalg.norm(axis)
    position = np.concatenate([[3.0, -2.0, 0.5], np.radians(degrees) * unit])
    arm, force = np.array([25.0, 9.0, -4.0]), np.array([1e5, -3e5, -2e5])
    body = VesselBody(np.array([1.0, 2.0, 3.0]), np.zeros((6, 6)), np.zeros((6, 6)), True)
    geometric = body.geometric(position, arm, force)
    for dof in range(6):
        change = 1e-5 * np.eye(6)[dof]
        ends = []
        for sign in (1, -1):
            turned = Rotation.from_rotvec(sign * change[3:]) * Rotation.from_rotvec(position[3:])
            moved = np.concatenate([position[:3] + sign * change[:3], turned.as_rotvec()])
            expected = body.cg + moved[:3] + turned.apply(arm)
            np.testing.assert_allclose(body.fairlead(moved, arm), expected, atol=1e-9)
            ends.append((body.fairlead(moved, arm), np.cross(turned.apply(arm), force)))
        (up, up_moment), (down, down_moment) = ends
        np.testing.assert_allclose((up - down) / 2e-5, body.arm_matrix(position, arm)[:, dof], atol=1e-7 * 30)
        np.testing.assert_allclose(-(up_moment - down_moment) / 2e-5, geometric[3:, dof], atol=1e-6 * 1e7)
    assert np.linalg.norm(body.fairlead(position, arm) - body.cg - position[:3] - arm) > 1.0  # it really is turned


@pytest.mark.parametrize(("to", "step", "count"), [(0.3, 0.1, 3), (0.7, 0.1, 7), (0.3, 0.05, 6), (0.2, 0.2, 1)])
def test_strips_that_end_at_the_border_are_all_there(to: float, step: float, count: int) -> None:
    """0.3/0.1 is 2.9999999999999996: the third strip is not lost."""
    low = difference_strips(LowBand(to=to, step=step), to, step)
    assert (low.count, low.below) == (count, count)
    np.testing.assert_allclose(low.omega[:count], step * np.arange(1, count + 1))
    wave = wave_strips(WaveBand(**{"from": 0.2, "to": 0.2 + to, "step": step}), 0.0)
    assert (wave.count, wave.below) == (count, 0)
    assert wave.widths.sum() == pytest.approx(to)
    np.testing.assert_allclose(wave.omega[:count], 0.2 + step * (np.arange(count) + 0.5))


def test_a_border_at_an_edge_of_the_band_parts_nothing() -> None:
    """A border within round-off of either edge makes no strip of no width; all is low, or all is wave frequency."""
    band = WaveBand(**{"from": 0.2, "to": 0.5, "step": 0.1})
    for border, below in ((0.2, 0), (0.2 * (1 + 1e-10), 0), (0.5, 3), (0.5 * (1 - 1e-10), 3), (0.6, 3), (0.1, 0)):
        strips = wave_strips(band, border)
        assert (strips.count, strips.below) == (3, below), border
    inside = wave_strips(band, 0.3)
    assert (inside.count, inside.below) == (3, 1)
    padded = inside.pad(np.ones((2, 3)))
    assert padded.shape == (2, inside.omega.size)
    assert padded.sum() == 6.0
