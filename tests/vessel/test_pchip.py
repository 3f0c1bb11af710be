"""PCHIP against SciPy's, to round-off, and what makes it shape-preserving."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.interpolate import PchipInterpolator

from solver.vessel.data.pchip import pchip

STEPS = st.integers(2, 12).flatmap(lambda n: arrays(float, n - 1, elements=st.floats(0.01, 3.0)))
LEVELS = st.one_of(st.floats(-1e9, 1e9), st.sampled_from([0.0, 1.0, -1.0, 1e-300, 1e9]))


@given(st.data(), STEPS)
def test_it_is_scipys(draw, steps):
    nodes = 0.1 + np.concatenate([[0.0], np.cumsum(steps)])
    values = draw.draw(arrays(float, (nodes.size, 2, 3), elements=LEVELS))
    at = np.concatenate([nodes, 0.5 * (nodes[1:] + nodes[:-1]), np.linspace(nodes[0], nodes[-1], 57)])
    with np.errstate(over="ignore"):  # SciPy's own, of values near the smallest numbers
        theirs = PchipInterpolator(nodes, values, axis=0)(at)
    ours = pchip(nodes, values, at)
    assert ours.shape == (at.size, 2, 3)
    assert np.all(np.abs(ours - theirs) <= 2e-13 * np.abs(values).max(axis=0) + 1e-300)
    assert np.array_equal(pchip(nodes, values[:, 0, 0], at), ours[:, 0, 0])


@given(st.data(), STEPS)
def test_it_passes_the_nodes_and_stays_between_them(draw, steps):
    nodes = np.concatenate([[0.0], np.cumsum(steps)])
    values = draw.draw(arrays(float, nodes.size, elements=st.floats(-1e6, 1e6)))
    size = np.abs(values).max() + 1e-12
    assert np.abs(pchip(nodes, values, nodes) - values).max() <= 1e-13 * size
    share = np.linspace(0, 1, 9)
    inside = pchip(nodes, values, (nodes[:-1, None] + share * np.diff(nodes)[:, None]).ravel()).reshape(-1, 9)
    low, high = np.minimum(values[1:], values[:-1]), np.maximum(values[1:], values[:-1])
    assert np.all(inside >= low[:, None] - 1e-12 * size)
    assert np.all(inside <= high[:, None] + 1e-12 * size)


def test_no_frequencies_give_no_values():
    assert pchip(np.array([0.0, 1.0]), np.ones((2, 6)), np.zeros(0)).shape == (0, 6)
