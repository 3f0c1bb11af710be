"""Lines condensed to their ends and the coupled response, against dense matrices assembled here."""

from __future__ import annotations

import numpy as np
import pytest

from solver.case import parse_case
from solver.frequency_domain.drivers import driver
from solver.frequency_domain.linearise import DragState, linearise
from solver.frequency_domain.response import respond
from solver.frequency_domain.solve import _Position, solve_frequency_domain
from solver.frequency_domain.transfer import solve_line
from solver.kernels.band import LANES, eliminate_lanes, multiply, solve_real
from solver.kernels.line import HALF, WIDTH
from solver.model.build import build
from solver.model.linear import line_geometry
from solver.statics.solve import solve_statics
from solver.vessel.drift import Drift, drift_spectrum
from tests.frequency_domain.conftest import coupled, sea
from tests.systems import blocks, dense, solved, span

RNG = np.random.default_rng(5)


def _band(n: int, half: int, rng: np.random.Generator) -> np.ndarray:
    band = rng.normal(size=(n, WIDTH))
    for i in range(n):
        for q in range(WIDTH):
            j = i + q - HALF
            if not 0 <= j < n or abs(q - HALF) > half:
                band[i, q] = 0.0
    band[:, HALF] += 4 * half + 4
    return band


@pytest.mark.parametrize("n", [1, 2, 5, 9, 30])
def test_real_bands_solve_and_multiply(n: int) -> None:
    band, rhs = _band(n, HALF, RNG), RNG.normal(size=(n, 3))
    full, x = dense(band), rhs.copy()
    np.testing.assert_allclose(multiply(band, rhs), full @ rhs, atol=1e-12 * 40)
    solve_real(band.copy(), x)
    np.testing.assert_allclose(full @ x, rhs, atol=1e-11)


@pytest.mark.parametrize("half", [5, HALF])
@pytest.mark.parametrize("late", [0, 3])
@pytest.mark.parametrize("n", [6, 9, 12, 36])
def test_lanes_solve_as_numpy_does(n: int, half: int, late: int) -> None:
    real = np.stack([_band(n, half, RNG) for _ in range(LANES)], axis=-1)
    imag = np.stack([_band(n, half, RNG) for _ in range(LANES)], axis=-1)
    rr, ri = RNG.normal(size=(2, n, 5, LANES))
    rr[: n - 6, :late] = ri[: n - 6, :late] = 0.0
    expected = np.empty((n, 5, LANES), dtype=complex)
    for lane in range(LANES):
        full = dense(real[..., lane]) + 1j * dense(imag[..., lane])
        expected[..., lane] = np.linalg.solve(full, rr[..., lane] + 1j * ri[..., lane])
    eliminate_lanes(real.copy(), imag.copy(), rr, ri, half, late)
    np.testing.assert_allclose(rr + 1j * ri, expected, atol=1e-11)


@pytest.mark.parametrize("ends", [0, 3, 6])
@pytest.mark.parametrize("EI", [0.0, 4e4])
@pytest.mark.parametrize("elements", [3, 14])
def test_a_condensed_line_is_the_dense_one(ends: int, EI: float, elements: int) -> None:
    data = span(170, (0, 10, -55), (80, 50, -5), elements, EI=EI, drag={"normal": 1.1, "tangential": 0.3},
                added_mass={"normal": 1.0, "tangential": 0.2})  # fmt: skip
    data["environment"]["current"] = {"depths": [0, 80], "speeds": [1.0, 0.2], "direction": "60 deg"}
    _, static = solved(data)
    g = line_geometry(static.lines[0], static.state.shapes[0])
    n = g.x.shape[0]
    damping = RNG.normal(size=(n, 3, 3)) * 200 + 500 * np.eye(3)
    omega = np.linspace(0.1, 2.3, 2 * LANES)
    u = RNG.normal(size=(2, n, 3, omega.size)) + 1j * RNG.normal(size=(2, n, 3, omega.size))
    Xr, Xi, Zr, Zi, Lr, Li = solve_line(g.K, g.M, damping, g.C, omega, u.real.copy(), u.imag.copy(), ends, g.half)
    K, M, B, C = dense(g.K), blocks(g.M), blocks(damping), blocks(g.C)
    inner, end = np.arange(3, 3 * n - 3), np.r_[np.arange(3 * n - 3, 3 * n), np.arange(3)]
    for w, o in enumerate(omega):
        D = K - o**2 * M + 1j * o * B
        load = (B + 1j * o * C) @ u[..., w].reshape(2, -1).T
        X = np.linalg.solve(D[np.ix_(inner, inner)], D[np.ix_(inner, end)])
        Y = np.linalg.solve(D[np.ix_(inner, inner)], load[inner])
        Z = D[np.ix_(end, end)] - D[np.ix_(end, inner)] @ X
        L = load[end] - D[np.ix_(end, inner)] @ Y
        found = Xr[..., w] + 1j * Xi[..., w]
        np.testing.assert_allclose(found[:, :ends], X[:, :ends], atol=1e-9 * np.abs(X).max())
        np.testing.assert_allclose(found[:, ends:], Y, atol=1e-9 * np.abs(Y).max())
        np.testing.assert_allclose((Zr + 1j * Zi)[..., w], Z[:ends, :ends], atol=1e-9 * np.abs(Z).max())
        np.testing.assert_allclose((Lr + 1j * Li)[..., w], L, atol=1e-9 * np.abs(L).max())


# --- vessel and lines in one dense system


class Dense:
    """Everything in one system: interior nodes of all lines, then the vessel's six, ends tied by elimination."""

    def __init__(self, position: _Position, damping: list[np.ndarray]):
        self.geometries, self.couplings = position.geometries, position.couplings
        self.damping = damping
        sizes = [g.x.size - 6 for g in self.geometries]
        self.total = sum(sizes)
        self.T = []
        for g, G, first in zip(self.geometries, self.couplings, np.cumsum([0, *sizes[:-1]]), strict=True):
            T = np.zeros((g.x.size, self.total + 6))
            for i in range(3, g.x.size - 3):
                T[i, first + i - 3] = 1.0
            T[-3:, self.total :] = G[:3]
            T[:3, self.total :] = G[3:]
            self.T.append(T)

    def solve(self, omega: float, own: np.ndarray, load: np.ndarray, water: list[np.ndarray]) -> np.ndarray:
        """All coordinates (size, R) under a load on the vessel (6, R) and water velocities (nodes·3, R) of each line."""
        D = np.zeros((self.total + 6,) * 2, dtype=complex)
        F = np.zeros((self.total + 6, load.shape[1]), dtype=complex)
        D[self.total :, self.total :] = own
        F[self.total :] = load
        for g, T, B, u in zip(self.geometries, self.T, self.damping, water, strict=True):
            line = dense(g.K) - omega**2 * blocks(g.M) + 1j * omega * blocks(B)
            D += g.line.multiplicity * T.T @ line @ T
            if u.size:
                F += g.line.multiplicity * T.T @ ((blocks(B) + 1j * omega * blocks(g.C)) @ u)
        return np.linalg.solve(D, F)


def _position(data, source):  # type: ignore[no-untyped-def]
    model = build(parse_case(data), source)
    static = solve_statics(model)
    spec = model.case.analyses.frequency_domain
    return model, _Position(model, static, driver(model, static, spec))


def _some_damping(position: _Position):  # type: ignore[no-untyped-def]
    state = DragState(
        [np.tile([0.5, 0.3, 0.2, 0.1, 0.0, 0.05], (g.x.shape[0], 1)) for g in position.geometries], np.zeros(6)
    )
    return linearise(position.geometries, state, np.zeros(6), True, False)


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
@pytest.mark.parametrize("between", [False, True])
def test_the_coupled_response_is_that_of_one_dense_system(kinematics: str, between: bool, source) -> None:  # type: ignore[no-untyped-def]
    data = coupled([sea(), sea(2.0, 7.0, 130.0)])
    data["vessel"]["fairlead_kinematics"] = kinematics
    data["vessel"]["constant_load"] = {"surge": 2e5, "yaw": 3e6}
    if between:
        data["lines"]["between"] = {"segments": [{"type": "chain", "length": 40, "elements": 5}],
                                    "end_a": {"fairlead": [-10, 9, -4]}, "end_b": {"fairlead": [12, 9, -4]}}  # fmt: skip
    model, position = _position(data, source)
    linear = _some_damping(position)
    whole = Dense(position, linear.damping)
    for band in (position.drive.wave, position.drive.low):
        assert band is not None
        omega = band.strips.omega
        own = position.drive.own(model, position.static, omega, linear.vessel)
        assert own is not None
        found = respond(position.geometries, linear.damping, position.couplings, own, band.strips, band.loads,
                        lambda g, Yr, Yi: Yr + 1j * Yi)  # fmt: skip
        covariance = [np.zeros((g.x.shape[0], 3, 3)) for g in position.geometries]
        assert band.loads.vessel is not None
        assert found.vessel is not None
        for w in range(band.strips.count):
            u = [(part.real + 1j * part.imag)[..., w] for part in band.loads.water]
            u = [part.reshape(part.shape[0], part[0].size if part.size else 0).T for part in u]
            q = whole.solve(omega[w], own[w], band.loads.vessel[:, :, w].T, u)
            np.testing.assert_allclose(found.vessel[:, :, w].T, q[-6:], atol=1e-9 * np.abs(q[-6:]).max())
            for i, (g, T) in enumerate(zip(position.geometries, whole.T, strict=True)):
                y = T @ q
                v = (u[i] if u[i].size else 0.0) - 1j * omega[w] * y
                v = v.reshape(-1, 3, v.shape[1])
                covariance[i] += np.einsum("ipr,iqr,r->ipq", v, v.conj(), band.loads.weight[:, w]).real
                t = np.diff(g.x, axis=0)
                t /= np.linalg.norm(t, axis=1)[:, None]
                tension = np.einsum("jp,jpr->jr", t, np.diff(y.reshape(-1, 3, y.shape[1]), axis=0))
                tension *= (g.line.arrays.EA / g.line.arrays.L)[:, None]
                np.testing.assert_allclose(found.tension[i][:, :, w].T, tension, atol=1e-8 * np.abs(tension).max())
        for mine, theirs in zip(covariance, found.covariance, strict=True):
            six = np.stack(
                [mine[:, 0, 0], mine[:, 1, 1], mine[:, 2, 2], mine[:, 0, 1], mine[:, 0, 2], mine[:, 1, 2]], axis=1
            )
            np.testing.assert_allclose(theirs, six, atol=1e-9 * np.abs(six).max())


def test_slow_variance_is_h_s_ff_h_adjoint(source) -> None:  # type: ignore[no-untyped-def]
    """σ² of slow velocities = Σ ω² (H S_FF Hᴴ) dω with the whole 6×6 force spectrum, not its factor."""
    data = coupled([sea(), sea(2.0, 7.0, 130.0)])
    model, position = _position(data, source)
    linear = _some_damping(position)
    whole = Dense(position, linear.damping)
    band = position.drive.low
    assert band is not None
    assert model.vessel is not None
    from solver.model.vessel import _random

    force = Drift(model.vessel.data, model.vessel.drift, float(position.static.position[5]))
    omega = band.strips.omega[: band.strips.count]
    S = drift_spectrum(omega, _random(model.wave_systems), force, *model.vessel.band)
    own = position.drive.own(model, position.static, omega, linear.vessel)
    assert own is not None
    vessel, node = np.zeros((6, 6)), np.zeros((3, 3))
    none = [np.zeros((0, 0)) for _ in position.geometries]
    for w, o in enumerate(omega):
        H = whole.solve(o, own[w], np.eye(6, dtype=complex), none)
        vessel += (H[-6:] @ S[w] @ H[-6:].conj().T).real * band.strips.widths[w]
        h = (whole.T[1] @ H)[12:15]
        node += (o**2 * h @ S[w] @ h.conj().T).real * band.strips.widths[w]
    _, low = position.respond(linear)
    assert low is not None
    assert low.vessel is not None
    found = np.einsum("rw,riw,rjw->ij", band.loads.weight, low.vessel, low.vessel.conj()).real
    np.testing.assert_allclose(found, vessel, atol=1e-8 * np.abs(vessel).max())
    c = low.covariance[1][4]
    np.testing.assert_allclose([c[0], c[1], c[2], c[3]], [node[0, 0], node[1, 1], node[2, 2], node[0, 1]], rtol=1e-7)


def test_frequencies_in_windows_give_the_same_answer(source, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    data = coupled([sea()])
    model = build(parse_case(data), source)
    static = solve_statics(model)
    whole = solve_frequency_domain(model, static, model.case.analyses.frequency_domain)  # type: ignore[arg-type]
    monkeypatch.setattr("solver.frequency_domain.response.MEMORY", 1.0)
    cut = solve_frequency_domain(model, static, model.case.analyses.frequency_domain)  # type: ignore[arg-type]
    np.testing.assert_allclose(cut.wave.vessel, whole.wave.vessel, rtol=1e-12)
    np.testing.assert_allclose(cut.wave.tension[0], whole.wave.tension[0], rtol=1e-9, atol=1e-6)
