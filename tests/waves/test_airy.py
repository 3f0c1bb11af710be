"""Dispersion to round-off and Airy kinematics against the equations they solve, by finite differences."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.waves.dispersion import wave_number
from solver.waves.kinematics import acceleration, elevation, velocity

G = 9.807


@given(st.floats(1e-6, 100.0), st.floats(0.1, 1e4))
def test_wave_number_solves_the_dispersion_relation_to_round_off(omega, depth):
    k = wave_number(omega, depth, G)
    assert G * k * np.tanh(k * depth) == pytest.approx(omega**2, rel=4e-15)


def test_wave_number_in_its_limits():
    assert wave_number(0.0, 100.0, G) == 0.0
    assert wave_number(1.0, np.inf, G) == pytest.approx(1 / G, rel=1e-15)
    assert wave_number(2.0, 1e5, G) == pytest.approx(4 / G, rel=1e-15)
    assert wave_number(1e-5, 10.0, G) == pytest.approx(1e-5 / np.sqrt(G * 10), rel=1e-9)
    assert wave_number(np.ones((2, 3)), 50.0, G).shape == (2, 3)
    with pytest.raises(ValueError, match="depth"):
        wave_number(1.0, 0.0, G)


DEPTHS = [12.0, 100.0, 2000.0]


@pytest.mark.parametrize("depth", DEPTHS)
def test_the_flow_is_free_of_divergence_and_rotation(depth):
    omega, heading, h = np.array([0.3, 0.8, 1.5]), 0.7, 1e-3
    centre = np.array([13.0, -7.0, -0.4 * min(depth, 40.0)])
    grad = np.empty((3, 3, 3), complex)  # omega, derivative along, component
    for axis in range(3):
        step = h * np.eye(3)[axis]
        ahead, behind = (velocity(omega, heading, centre + sign * step, depth, G)[:, 0] for sign in (1, -1))
        grad[:, axis] = (ahead - behind) / (2 * h)
    size = np.abs(grad).max(axis=(1, 2))
    assert np.all(np.abs(np.trace(grad, axis1=1, axis2=2)) < 1e-6 * size)
    assert np.all(np.abs(grad - grad.transpose(0, 2, 1)).max(axis=(1, 2)) < 1e-6 * size)


@pytest.mark.parametrize("depth", DEPTHS)
def test_surface_and_bottom_conditions(depth):
    omega, heading = np.array([0.2, 0.6, 1.2]), 2.1
    point = np.array([[31.0, 8.0, 0.0]])
    eta = elevation(omega, heading, point, depth, G)[:, 0]
    u = velocity(omega, heading, point, depth, G)[:, 0]
    assert np.allclose(u[:, 2], 1j * omega * eta, rtol=1e-14)  # kinematic: w = d eta / dt
    k = wave_number(omega, depth, G)  # dynamic: i omega u = -g d eta / dx = i g k eta along the wave
    along = u[:, 0] * np.cos(heading) + u[:, 1] * np.sin(heading)
    assert np.allclose(omega * along, G * k * eta, rtol=1e-12)
    bottom = velocity(omega, heading, np.array([[31.0, 8.0, -depth]]), depth, G)[:, 0]
    assert np.all(np.abs(bottom[:, 2]) == 0.0)


def test_the_wave_travels_to_its_direction():
    """η = Re e^{i(ωt - k·x)}: a crest at the origin at t = 0 stands at +x a quarter period later for direction 0."""
    omega, depth = np.array([0.7]), 300.0
    x = (np.pi / 2) / wave_number(0.7, depth, G)
    eta = elevation(omega, 0.0, np.array([[x, 0.0, 0.0]]), depth, G)[0, 0]
    assert (eta * np.exp(1j * np.pi / 2)).real == pytest.approx(1.0, abs=1e-12)


def test_deep_limit_and_no_overflow():
    omega = np.array([0.5, 1.0, 3.0])
    points = np.array([[5.0, 2.0, -3.0], [0.0, 0.0, -60.0]])
    deep = velocity(omega, 0.4, points, np.inf, G)
    assert np.allclose(velocity(omega, 0.4, points, 3000.0, G), deep, rtol=1e-12)
    k = omega**2 / G
    expected = omega[:, None] * np.exp(k[:, None] * points[None, :, 2])
    assert np.allclose(np.abs(deep[..., 2]), expected, rtol=1e-13)
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        huge = velocity(np.array([0.0, 10.0, 31.3]), 0.0, np.array([[0, 0, -1000.0], [0, 0, -0.5]]), 1000.0, G)
    assert np.all(np.isfinite(huge))  # k d up to 1e5
    assert abs(huge[2, 0]).max() == 0.0


def test_zero_frequency_is_the_shallow_limit():
    slow = velocity(np.array([0.0, 1e-5]), 0.0, np.array([[0, 0, -3.0]]), 20.0, G)
    assert slow[0, 0, 0] == pytest.approx(np.sqrt(G / 20.0), rel=1e-12)
    assert slow[1, 0, 0] == pytest.approx(slow[0, 0, 0], rel=1e-6)


def test_nothing_above_the_water_and_acceleration():
    omega = np.array([0.9])
    points = np.array([[1.0, 1.0, 0.01], [1.0, 1.0, 0.0], [1.0, 1.0, -200.0]])
    u = velocity(omega, 0.3, points, 100.0, G)
    assert np.all(u[0, 0] == 0)
    assert np.all(u[0, 1] != 0)
    assert np.array_equal(u[0, 2], velocity(omega, 0.3, np.array([[1.0, 1.0, -100.0]]), 100.0, G)[0, 0])
    assert np.array_equal(acceleration(omega, 0.3, points, 100.0, G), 0.9j * u)
