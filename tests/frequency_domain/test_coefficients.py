"""Equivalent linear drag against quadrature of its definition, and its limits."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from solver.forces import drag
from solver.frequency_domain.coefficients import drag_blocks, harmonic, random, vector
from solver.kernels.line import WIDTH
from solver.model.linear import line_geometry
from tests.systems import dense, solved, span

CASES = [
    (0.0, 1.0),
    (0.3, 1.0),
    (-0.3, 1.0),
    (1.0, 0.2),
    (-2.0, 0.5),
    (0.99, 1.0),
    (1.01, 1.0),
    (5.0, 1e-2),
    (1e-3, 3.0),
]


@pytest.mark.parametrize(("V", "sigma"), CASES)
def test_random_is_the_least_squares_fit_over_the_gaussian(V: float, sigma: float) -> None:
    def density(r: float) -> float:
        return float(np.exp(-0.5 * (r / sigma) ** 2) / (sigma * np.sqrt(2 * np.pi)))

    def mean(f) -> float:  # type: ignore[no-untyped-def]
        points = [p for p in (-V,) if abs(p) < 12 * sigma]
        return float(
            quad(lambda r: f(r) * density(r), -12 * sigma, 12 * sigma, points=points, limit=400, epsabs=1e-13)[0]
        )

    beta, gamma = random(V, sigma)
    assert beta == pytest.approx(mean(lambda r: abs(V + r) * (V + r) * r) / sigma**2, rel=1e-8)
    assert gamma == pytest.approx(mean(lambda r: abs(V + r) * (V + r)), rel=1e-8, abs=1e-12)


@pytest.mark.parametrize(("V", "a"), CASES)
def test_harmonic_is_the_first_fourier_term_over_the_cycle(V: float, a: float) -> None:
    turns = [np.arccos(np.clip(-V / a, -1, 1))]

    def cycle(f) -> float:  # type: ignore[no-untyped-def]
        return float(quad(f, 0, np.pi, points=turns, limit=200, epsabs=1e-14)[0]) / np.pi

    beta, gamma = harmonic(V, a)
    first = cycle(lambda p: abs(V + a * np.cos(p)) * (V + a * np.cos(p)) * np.cos(p)) * 2
    assert beta * a == pytest.approx(first, rel=1e-8)
    assert gamma == pytest.approx(cycle(lambda p: abs(V + a * np.cos(p)) * (V + a * np.cos(p))), rel=1e-8, abs=1e-12)


def test_limits_without_and_with_much_current() -> None:
    assert random(0.0, 0.7) == pytest.approx((np.sqrt(8 / np.pi) * 0.7, 0.0))
    assert harmonic(0.0, 0.7) == pytest.approx((8 / (3 * np.pi) * 0.7, 0.0))
    for law in (random, harmonic):
        for V in (2.0, -2.0):
            assert law(V, 0.0) == pytest.approx((2 * abs(V), V * abs(V)))
            assert law(V, 1e-9) == pytest.approx((2 * abs(V), V * abs(V)))
    beta, gamma = random(100.0, 1.0)
    assert (beta, gamma) == pytest.approx((200.0, 100.0**2 + 1.0), rel=1e-12)
    beta, gamma = harmonic(-100.0, 1.0)
    assert (beta, gamma) == pytest.approx((200.0, -(100.0**2) - 0.5), rel=1e-12)


def test_both_are_odd_and_continuous_where_the_flow_ceases_to_turn() -> None:
    for law in (random, harmonic):
        assert law(-0.4, 0.9) == pytest.approx((law(0.4, 0.9)[0], -law(0.4, 0.9)[1]), rel=1e-12)
    below, above = harmonic(1 - 1e-9, 1.0), harmonic(1 + 1e-9, 1.0)
    np.testing.assert_allclose(below, above, rtol=1e-7)


# --- the vector form

VECTORS = [
    # V, principal sigmas, angle
    ((0.0, 0.0), (1.0, 1.0), 0.0), ((0.0, 0.0), (1.0, 0.3), 0.6), ((0.8, -0.5), (1.0, 0.3), 0.6),
    ((2.0, 1.0), (0.3, 0.2), -1.0),
    ((0.1, 0.0), (0.5, 0.05), 1.2), ((3.0, -1.0), (0.05, 0.02), 0.4), ((0.4, 0.4), (0.6, 0.6), 0.3),
]  # fmt: skip


def _covariance(s, angle):  # type: ignore[no-untyped-def]
    c, n = np.cos(angle), np.sin(angle)
    R = np.array([[c, -n], [n, c]])
    return R @ np.diag(np.square(s)) @ R.T


def _vector(V, C, is_random=True):  # type: ignore[no-untyped-def]
    B, g = np.zeros((2, 2)), np.zeros(2)
    vector(V[0], V[1], C[0, 0], C[0, 1], C[1, 1], is_random, B, g)
    return B, g


def _by_quadrature(V, C):  # type: ignore[no-untyped-def]
    """E[f rᵀ] C⁻¹ and E[f], f = |V+r|(V+r), in polar coordinates about the kink at r = -V: angle by trapezia."""
    inverse = np.linalg.inv(C)
    reach = np.linalg.norm(V) + 10 * np.sqrt(np.linalg.eigvalsh(C)[-1])
    x, w = np.polynomial.legendre.leggauss(40)
    edges = np.linspace(0, reach, 60)
    rho = np.concatenate([0.5 * (b - a) * x + 0.5 * (a + b) for a, b in pairwise(edges)])
    weight = np.concatenate([0.5 * (b - a) * w for a, b in pairwise(edges)])
    phi = 2 * np.pi * np.arange(1200) / 1200
    U = np.stack([rho[:, None] * np.cos(phi), rho[:, None] * np.sin(phi)])
    r = U - np.asarray(V)[:, None, None]
    density = np.exp(-0.5 * np.einsum("aij,ab,bij->ij", r, inverse, r)) / (2 * np.pi * np.sqrt(np.linalg.det(C)))
    measure = density * (rho * weight)[:, None] * (2 * np.pi / 1200)
    f = rho[:, None] * U
    return np.einsum("aij,bij,ij->ab", f, r, measure) @ inverse, np.einsum("aij,ij->a", f, measure)


@pytest.mark.parametrize(("V", "s", "angle"), VECTORS)
def test_vector_random_is_the_least_squares_fit_in_the_plane(V, s, angle) -> None:  # type: ignore[no-untyped-def]
    C = _covariance(s, angle)
    B, g = _vector(V, C)
    B_, g_ = _by_quadrature(V, C)
    np.testing.assert_allclose(B, B_, atol=1e-6 * np.abs(B_).max())
    np.testing.assert_allclose(g, g_, atol=1e-6 * max(np.abs(g_).max(), np.abs(B_).max() * s[0]))


@pytest.mark.parametrize("V", [(0.0, 0.0), (0.5, 0.0), (0.5, 0.9), (3.0, 0.0)])
def test_vector_on_a_straight_path_is_the_scalar_one_along_it(V) -> None:  # type: ignore[no-untyped-def]
    """Motion and current on one line: the scalar formula along it. The floor under the thin side costs below 0.2 %."""
    C = np.diag([0.49, 0.0])
    for is_random in (True, False):
        B, g = _vector((V[0], 0.0), C, is_random)
        beta, gamma = random(V[0], 0.7) if is_random else harmonic(V[0], np.sqrt(2) * 0.7)
        assert B[0, 0] == pytest.approx(beta, rel=2e-3)
        assert g[0] == pytest.approx(gamma, rel=2e-3, abs=1e-12)
        assert abs(B[0, 1]) + abs(g[1]) < 1e-9


@pytest.mark.parametrize(("V", "s", "angle"), VECTORS)
@pytest.mark.parametrize("is_random", [True, False])
def test_vector_is_frame_invariant(V, s, angle, is_random) -> None:  # type: ignore[no-untyped-def]
    a = 0.77
    R = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    C = _covariance(s, angle)
    B, g = _vector(V, C, is_random)
    B_, g_ = _vector(R @ np.asarray(V), R @ C @ R.T, is_random)
    np.testing.assert_allclose(B_, R @ B @ R.T, atol=1e-7 * np.abs(B).max())
    np.testing.assert_allclose(g_, R @ g, atol=1e-7 * np.abs(B).max())


@pytest.mark.parametrize("s", [(1e-4, 1e-4), (1e-4, 0.0), (1e-4, 3e-5), (0.0, 0.0)])
@pytest.mark.parametrize("is_random", [True, False])
def test_small_motion_in_a_current_gives_the_tangent_of_the_drag(s, is_random) -> None:  # type: ignore[no-untyped-def]
    """∂(|V|V)/∂V = |V| I + V Vᵀ/|V|, the part across the current included, acting on the motion there is."""
    V = np.array([0.8, 0.6])
    C = _covariance(s, 0.3)
    B, g = _vector(V, C, is_random)
    exact = np.linalg.norm(V) * np.eye(2) + np.outer(V, V) / np.linalg.norm(V)
    along = np.array([np.cos(0.3), np.sin(0.3)])
    np.testing.assert_allclose(B @ along, exact @ along, atol=2e-3)
    if s[1] > 0 or s[0] == 0:
        np.testing.assert_allclose(B, exact, atol=2e-3)
    np.testing.assert_allclose(g, np.linalg.norm(V) * V, atol=2e-3)


@pytest.mark.parametrize("a", [(1.0, 0.7), (1.0, 0.2), (0.4, 0.3), (1.0, 0.0)])
@pytest.mark.parametrize("V", [(0.0, 0.0), (0.6, 0.0), (0.5, 0.8)])
def test_vector_harmonic_gives_the_whole_first_harmonic_on_an_ellipse(a, V) -> None:  # type: ignore[no-untyped-def]
    phi = 2 * np.pi * np.arange(20000) / 20000
    r = np.stack([a[0] * np.cos(phi), a[1] * np.sin(phi)])
    U = np.asarray(V)[:, None] + r
    f = np.linalg.norm(U, axis=0) * U
    B, g = _vector(V, np.diag(np.square(a)) / 2, False)
    lin = B @ r
    for basis in (np.cos(phi), np.sin(phi)):
        if a[1] == 0 and basis[0] < 0.5:
            continue
        np.testing.assert_allclose((lin * basis).mean(axis=1), (f * basis).mean(axis=1), atol=1e-4)
    np.testing.assert_allclose(g, f.mean(axis=1), atol=1e-4)


# --- assembled over a line


@pytest.mark.parametrize("is_random", [True, False])
def test_blocks_of_a_still_line_in_a_current_are_the_tangent_of_its_drag(is_random: bool) -> None:
    """σ → 0 with the vector form: B_L = -∂F/∂ẋ of the exact force, node by node, attachment included."""
    data = span(170, (0, 0, -55), (80, 50, -5), 12, drag={"normal": 1.1, "tangential": 0.3})
    data["environment"]["current"] = {"depths": [0, 80], "speeds": [1.3, 0.4], "direction": "20 deg"}
    data["attachments"] = [{"line": "line", "arc_length": 60, "mass": 3000, "volume": 0.5, "drag_area": 2.0}]
    _, static = solved(data)
    line, x = static.lines[0], static.state.shapes[0]
    g = line_geometry(line, x)
    K, B = np.zeros((x.size, WIDTH)), np.zeros((x.size, WIDTH))
    still = np.zeros_like(x)
    drag.tangent(line.arrays, x, still, still, K, B)
    exact = dense(B)
    found, mean = drag_blocks(line.arrays, x, g.wet, np.zeros((x.shape[0], 6)), g.plane, is_random, True)
    force = np.zeros_like(x)
    drag.force(line.arrays, x, still, still, still, force)
    for i in range(x.shape[0]):
        np.testing.assert_allclose(
            found[i], exact[3 * i : 3 * i + 3, 3 * i : 3 * i + 3], atol=1e-9 * np.abs(exact).max()
        )
    np.testing.assert_allclose(mean, force, atol=1e-9 * np.abs(force).max())
