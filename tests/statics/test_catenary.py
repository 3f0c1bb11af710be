"""The elastic catenary: against its own differential equation, its limits, and the discretised line against it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad, solve_bvp
from scipy.optimize import brentq

from solver.statics.catenary import Catenary, solve_catenary
from tests.systems import order, riser, solved, span

HANGING = [(100.0, 50.0, 170.0), (100.0, 0.0, 120.0), (10.0, 140.0, 170.0), (150.0, 60.0, 162.0), (100.0, 50.0, 111.0)]


def _found(*args, **kwargs) -> Catenary:  # type: ignore[no-untyped-def]
    found = solve_catenary(*args, **kwargs)
    assert found is not None
    return found


@pytest.mark.parametrize(("span_", "drop", "length"), HANGING)
@pytest.mark.parametrize("EA", [2e5, 5e8])
def test_the_closed_form_is_the_integral_of_the_tension(span_: float, drop: float, length: float, EA: float) -> None:
    w = 400.0
    line = _found(span_, drop, length, w, EA, seabed=False)
    H, low = line.horizontal, line.vertical - w * length

    def slope(s: float, which: int) -> float:
        V = low + w * s
        T = np.hypot(H, V)
        return float((1 + T / EA) * (H, V)[which] / T)

    for s in (0.3 * length, length):
        x, z = line.shape(np.array([s]))
        assert x[0] == pytest.approx(quad(slope, 0, s, args=(0,), epsabs=1e-11)[0], abs=1e-7 * length)
        assert z[0] == pytest.approx(quad(slope, 0, s, args=(1,), epsabs=1e-11)[0], abs=1e-7 * length)
    x, z = line.shape(np.array([length]))
    assert (x[0], z[0]) == pytest.approx((span_, drop), abs=2e-9 * length)


def test_a_grounded_line_is_flat_then_lifts_without_a_kink() -> None:
    line = _found(3000.0, 1990.0, 3900.0, 1300.0, 1e9, seabed=True)
    assert 100.0 < line.grounded < 1500.0
    arc = np.linspace(0.0, line.grounded, 50)
    x, z = line.shape(arc)
    assert np.all(z == 0.0)
    np.testing.assert_allclose(x, arc * (1 + line.horizontal / 1e9), rtol=1e-12)  # frictionless: all of it at H
    assert line.vertical == pytest.approx(1300.0 * (3900.0 - line.grounded), rel=1e-12)
    eps = 1e-3
    _, z = line.shape(np.array([line.grounded + eps]))
    assert 0 <= z[0] < 1e-6
    x, z = line.shape(np.array([3900.0]))
    assert (x[0], z[0]) == pytest.approx((3000.0, 1990.0), abs=1e-5)


def test_an_inextensible_line_is_the_textbook_catenary() -> None:
    """√(L² - h²) = 2a sinh(l/2a), H = w a."""
    l, h, L, w = 100.0, 50.0, 170.0, 400.0
    a = brentq(lambda a: 2 * a * np.sinh(l / (2 * a)) - np.sqrt(L**2 - h**2), 5, 500, xtol=1e-12)
    line = _found(l, h, L, w, 1e16, seabed=False)
    assert line.horizontal == pytest.approx(w * a, rel=1e-6)
    assert line.tension - np.hypot(line.horizontal, line.vertical - w * L) == pytest.approx(w * h, rel=1e-6)


def test_a_weightless_taut_line_is_a_spring() -> None:
    line = _found(80.0, 60.0, 99.0, 1e-4, 1e6, seabed=False)
    assert line.tension == pytest.approx(1e6 * (100.0 / 99.0 - 1.0), rel=1e-6)
    assert line.horizontal / line.tension == pytest.approx(0.8, rel=1e-6)


def test_paper_riser_reactions_from_the_catenary() -> None:
    """Low & Langley's Table 2, catenary theory: 47.14, 26.63, 45.72, 11.47 and 24.03 kN."""
    w = (165.0 - 1000.0 * np.pi * 0.396**2 / 4) * 9.807
    line = _found(100.0, 50.0, 170.0, w, 500e6, seabed=False)
    low = line.vertical - w * 170.0
    found = [line.tension, np.hypot(line.horizontal, low), line.vertical, line.horizontal, -low]
    np.testing.assert_allclose(np.array(found) / 1e3, [47.14, 26.63, 45.72, 11.47, 24.03], atol=0.01)


COUNTS = [10, 20, 40, 80]


@pytest.mark.parametrize("EA", [5e6, 5e8])
def test_the_discretised_line_nears_the_catenary_with_second_order(EA: float) -> None:
    w = (50.0 - 1000 * np.pi * 0.1**2 / 4) * 9.807
    exact = _found(100.0, 50.0, 170.0, w, EA, seabed=False)
    forces, sags = [], []
    for count in COUNTS:
        _, static = solved(span(170.0, (0, 0, -55), (100, 0, -5), count, EA=EA))
        forces.append(abs(static.state.end_forces[0][0]) - exact.horizontal)
        x, z = exact.shape(static.lines[0].node_arc)
        sags.append(np.abs(static.state.shapes[0] - np.stack([x, 0 * x, z - 55.0], axis=1)).max())
    assert 1.8 < -order(COUNTS, forces) < 2.2
    assert 1.8 < -order(COUNTS, sags) < 2.2
    assert abs(forces[-1]) < 1e-3 * exact.horizontal


def test_with_bending_the_line_nears_the_stiff_beam_with_at_least_first_order() -> None:
    """The hinged beam with weight, integrated as a boundary value problem by collocation, independent of elements."""
    EI, EA, L = 120.8e3, 500e6, 170.0
    w = (165.0 - 1000.0 * np.pi * 0.396**2 / 4) * 9.807
    del EA  # stretch is 1e-4 of the length: the reference is inextensible, the line is made so too
    H, V, phi = _beam(EI, w, L)
    data = riser(136)
    data["line_types"]["riser"]["EA"] = "50000 MN"
    _, static = solved(data)
    top = static.state.end_forces[0][:3]
    assert -top[0] == pytest.approx(H, rel=1e-3)
    assert -top[2] == pytest.approx(V + w * L, rel=1e-3)
    d = np.diff(static.state.shapes[0], axis=0)
    start = np.arctan2(d[:, 2], d[:, 0])
    assert start[0] + 0.5 * (start[0] - start[1]) == pytest.approx(phi, abs=5e-3)


def _beam(EI: float, w: float, L: float) -> tuple[float, float, float]:
    """EI φ'' = H sin φ - V(s) cos φ, x' = cos φ, z' = sin φ, moments zero at both ends: (H, V at the foot, φ there)."""
    cat = _found(100.0, 50.0, L, w, 1e14, seabed=False)

    def f(s, y, p):  # type: ignore[no-untyped-def]
        H, V0 = p * 1e4
        return np.stack([y[1], (H * np.sin(y[0]) - (V0 + w * s) * np.cos(y[0])) / EI, np.cos(y[0]), np.sin(y[0])])

    def ends(a, b, p):  # type: ignore[no-untyped-def]
        return np.array([a[1], b[1], a[2], a[3], b[2] - 100.0, b[3] - 50.0])

    s = np.linspace(0, L, 400)
    x, z = cat.shape(s)
    phi = np.arctan2(np.gradient(z, s), np.gradient(x, s))
    start = np.stack([phi, np.gradient(phi, s), x, z])
    found = solve_bvp(
        f, ends, s, start, p=np.array([cat.horizontal, cat.vertical - w * L]) / 1e4, tol=1e-6, max_nodes=20000
    )
    assert found.success
    return float(found.p[0] * 1e4), float(found.p[1] * 1e4), float(found.y[0, 0])
