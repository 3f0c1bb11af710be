"""One contract over every line force: exact tangents, and invariance when everything turns about the vertical."""

from __future__ import annotations

import numpy as np
import pytest

from solver.forces import REGISTRY
from solver.kernels.line import HALF, WIDTH, LineArrays

N = 7
RNG = np.random.default_rng(7)


def _line(turn: float = 0.0) -> LineArrays:
    """Unlike segments, an attachment, a sheared current that turns with the case."""
    rng = np.random.default_rng(3)
    L = rng.uniform(2.0, 5.0, N)
    EI = rng.uniform(1e3, 5e4, N)
    kb = np.zeros(N + 1)
    kb[1:-1] = 2.0 / (L[:-1] / EI[:-1] + L[1:] / EI[1:])
    point = np.zeros(N + 1)
    point[3] = 1.0
    top = np.zeros(N + 1)
    top[[3, N]] = 1.0
    c, s = np.cos(turn), np.sin(turn)
    velocity = np.array([[0.2, 0.5, 0.0], [0.9, -0.3, 0.0], [1.4, 0.2, 0.0]]) @ np.array(
        [[c, s, 0], [-s, c, 0], [0, 0, 1]]
    )
    return LineArrays(
        L=L, EA=rng.uniform(1e6, 1e7, N), limit=np.array([0.0, 0.0, 0.1, 1e-3, 0.0, np.inf, 0.3]),
        knee=np.array([1e-2, 0.1, 1e-2, 1e-3, 0.3, 1e-2, 0.2]),
        kb=kb, EI=EI, D=rng.uniform(0.1, 0.4, N), w_dry=rng.uniform(1e3, 2e3, N),
        b_wet=rng.uniform(1e2, 9e2, N), cdn=rng.uniform(50, 200, N), cdt=rng.uniform(5, 20, N), mw=rng.uniform(20, 90, N),
        can=rng.uniform(0.5, 1.5, N), cat=rng.uniform(0.0, 0.5, N), node_mass=rng.uniform(100, 300, N + 1),
        point_weight=900.0 * point, point_lift=600.0 * top,
        point_radius=np.full(N + 1, 3.0), point_drag=800.0 * point, point_mw=100.0 * point, point_ca=0.5 * point,
        a1=rng.uniform(2e4, 4e4, N + 1), a2=rng.uniform(1.5, 2.5, N + 1), bed=-18.0 - rng.uniform(0.0, 0.2, N + 1),
        depth=-18.0, contact=np.array([900.0, 0.6, 0.3]),
        current_z=np.array([-30.0, -9.1, 5.0]), current_v=np.ascontiguousarray(velocity),
    )  # fmt: skip


def _state() -> tuple[np.ndarray, ...]:
    """A bent line in space from the seabed through the surface, moving, in moving water."""
    rng = np.random.default_rng(11)
    x = np.cumsum(rng.uniform(0.5, 3.0, (N + 1, 3)), axis=0)
    x[:, 2] = np.linspace(-18.6, 1.7, N + 1) + rng.uniform(-0.3, 0.3, N + 1)
    return x, *(rng.uniform(-1.5, 1.5, (N + 1, 3)) for _ in range(3))


def _dense(band: np.ndarray) -> np.ndarray:
    size = band.shape[0]
    out = np.zeros((size, size))
    for i in range(size):
        for j in range(max(0, i - HALF), min(size, i + HALF + 1)):
            out[i, j] = band[i, HALF + j - i]
    return out


def _force(module, line, x, v, u, a):
    out = np.zeros_like(x)
    module.force(line, x, v, u, a, out)
    return out.ravel()


@pytest.mark.parametrize("name", REGISTRY)
def test_tangents_are_the_differences_of_the_force(name: str) -> None:
    module, line, (x, v, u, a) = REGISTRY[name], _line(), _state()
    if name == "inertia":  # linearised about still water
        a = np.zeros_like(a)
    K, B = np.zeros((x.size, WIDTH)), np.zeros((x.size, WIDTH))
    module.tangent(line, x, v, u, K, B)
    for banded, which in ((K, 0), (B, 1)):
        numeric = np.empty((x.size, x.size))
        for j in range(x.size):
            step = np.zeros(x.size)
            step[j] = 1e-6
            ahead, behind = [x, v], [x, v]
            ahead[which] = ahead[which] + step.reshape(-1, 3)
            behind[which] = behind[which] - step.reshape(-1, 3)
            numeric[:, j] = -(_force(module, line, *ahead, u, a) - _force(module, line, *behind, u, a)) / 2e-6
        exact = _dense(banded)
        scale = max(np.abs(exact).max(), 1.0)
        np.testing.assert_allclose(exact, numeric, atol=3e-7 * scale)


@pytest.mark.parametrize("name", REGISTRY)
@pytest.mark.parametrize("turn", [0.7, 2.5])
def test_turning_everything_about_the_vertical_turns_the_force(name: str, turn: float) -> None:
    module, state = REGISTRY[name], _state()
    c, s = np.cos(turn), np.sin(turn)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    plain = _force(module, _line(), *state).reshape(-1, 3)
    turned = _force(module, _line(turn), *(part @ R.T for part in state)).reshape(-1, 3)
    np.testing.assert_allclose(turned, plain @ R.T, atol=1e-9 * np.abs(plain).max())
    assert np.abs(plain).max() > 0


@pytest.mark.parametrize("name", ["axial", "bending"])
def test_inner_forces_leave_no_net_load(name: str) -> None:
    line, (x, v, u, a) = _line(), _state()
    load = _force(REGISTRY[name], line, x, v, u, a).reshape(-1, 3)
    assert np.abs(load.sum(axis=0)).max() < 1e-8 * np.abs(load).max()
    assert np.abs(np.cross(x, load).sum(axis=0)).max() < 1e-7 * np.abs(load).max()


@pytest.mark.parametrize("angle", [0.0, 1e-7, 1e-4, 9e-3, 1.1e-2, 0.5, 2.5])
def test_bending_stays_exact_from_straight_to_sharply_bent(angle: float) -> None:
    line = _line()
    x = np.zeros((N + 1, 3))
    direction = 0.0
    for i in range(1, N + 1):
        direction += angle if i % 2 else -angle
        x[i] = x[i - 1] + line.L[i - 1] * np.array([np.cos(direction), 0.0, np.sin(direction)])
    still = np.zeros_like(x)
    K, B = np.zeros((x.size, WIDTH)), np.zeros((x.size, WIDTH))
    REGISTRY["bending"].tangent(line, x, still, still, K, B)
    numeric = np.empty((x.size, x.size))
    for j in range(x.size):
        step = np.zeros(x.size)
        step[j] = 1e-5
        ahead = _force(REGISTRY["bending"], line, x + step.reshape(-1, 3), still, still, still)
        behind = _force(REGISTRY["bending"], line, x - step.reshape(-1, 3), still, still, still)
        numeric[:, j] = -(ahead - behind) / 2e-5
    exact = _dense(K)
    np.testing.assert_allclose(exact, numeric, atol=2e-6 * np.abs(exact).max())
    moment = REGISTRY["bending"].moment(line, x)
    np.testing.assert_allclose(moment[1:-1], line.kb[1:-1] * angle, rtol=1e-6, atol=1e-9)


def test_seabed_force_has_the_stiffness_deep_and_vanishes_above() -> None:
    from solver.forces.seabed import contact

    depth, share = contact(-50.0, 2.0)
    assert depth == pytest.approx(50.0, abs=1e-12)
    assert share == pytest.approx(1.0, abs=1e-12)
    assert contact(5000.0, 2.0)[0] == 0.0
    # docs/theory.md L13 with the logarithm of the hyperbolic cosine, where it does not overflow
    a2, z = 2.0, 0.3
    assert contact(z, a2)[0] == pytest.approx(0.5 * (-z + (np.log(np.cosh(a2 * z)) + np.log(2)) / a2), rel=1e-12)
