"""Lines at the surface: a wet share that is smooth whichever way an element lies."""

from __future__ import annotations

import numpy as np
import pytest

from solver.forces.weight import wet_half
from tests.systems import solved, span

D = 0.3


def test_a_flat_piece_goes_under_over_its_own_thickness() -> None:
    z = np.linspace(-0.3, 0.3, 241)
    share = np.array([wet_half(h, h, D)[0] for h in z])
    np.testing.assert_allclose(share, np.clip(0.5 - z / D, 0.0, 1.0), atol=1e-12)


def test_a_steep_piece_is_cut_where_its_axis_is() -> None:
    for top in np.linspace(-3.0, 3.0, 61):
        low, high = top - 1.0, top
        expected = min(max(-low / (high - low), 0.0), 1.0)
        assert wet_half(low, low + 2.0, D)[0] == pytest.approx(expected, abs=1e-12)


def test_derivatives_are_the_differences() -> None:
    rng = np.random.default_rng(4)
    for node, other in rng.uniform(-0.5, 0.5, (200, 2)):
        _, own, far = wet_half(node, other, D)
        step = 1e-7
        ups = wet_half(node + step, other, D)[0] - wet_half(node - step, other, D)[0]
        fars = wet_half(node, other + step, D)[0] - wet_half(node, other - step, D)[0]
        if abs(abs(node - other) / 2 - D) > 1e-3:  # the kink where thickness begins to count
            assert own == pytest.approx(ups / (2 * step), abs=1e-5)
            assert far == pytest.approx(fars / (2 * step), abs=1e-5)


@pytest.mark.parametrize("density", [300.0, 500.0, 800.0])
def test_a_line_floats_at_the_draft_of_its_weight(density: float) -> None:
    """Stretched between two points at the surface: its middle lies where half its section, or more or less, is wet."""
    data = span(
        200.0, (0, 0, 0.0), (199.9, 0, 0.0), 40, 100.0, mass=density * np.pi / 4 * D**2, diameter=D, EA=1e7, EI=0.0
    )
    _, static = solved(data)
    z = static.state.shapes[0][10:31, 2]
    np.testing.assert_allclose(z, D * (0.5 - density / 1000.0), atol=2e-3)
