"""What an element carries in compression: nothing, its Euler load, or anything (docs/theory.md, L17-L18)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.forces import axial
from solver.kernels.compression import SHARE, released
from solver.kernels.line import WIDTH, LineArrays
from solver.model.build import build
from tests.forces.test_contract import _dense, _force, _line
from tests.systems import example, span

STRAINS = [-0.7, -3.1e-3, -2e-3, -1.5e-3, -7e-4, -3e-4, -1e-5, 1e-5, 2e-3]
KINDS: dict[str, dict[str, Any]] = {
    "none": {},
    "stiff": {"EI": 5e4},
    "allowed": {"compression": "allowed"},
    "stiff, allowed": {"EI": 5e4, "compression": "allowed"},
    "neutral": {"mass": np.pi * 0.1**2 / 4 * 1000},
}


def _arrays(**kind: Any) -> LineArrays:
    return build(parse_case(span(150.0, (0, 0, -100), (70, 20, 0), **kind)), None).lines[0].arrays


def _tension(line: LineArrays, strain: Any) -> np.ndarray:
    """Axial force of the first element at many strains."""
    one = line._replace(**{name: getattr(line, name)[:1] for name in ("L", "EA", "limit", "knee")})
    shapes = [np.array([[0.0, 0, 0], [one.L[0] * (1.0 + e), 0, 0]]) for e in np.atleast_1d(strain)]
    return np.array([axial.tension(one, shape)[0] for shape in shapes])


@pytest.mark.parametrize("strain", STRAINS)
@pytest.mark.parametrize("limit", [0.0, 5e-4, np.inf])
def test_the_tangent_is_exact_from_taut_through_the_limit_to_slack(strain: float, limit: float) -> None:
    line = _line()._replace(limit=np.full(7, limit), knee=np.full(7, 8e-4))
    rng = np.random.default_rng(5)
    x = np.zeros((line.L.size + 1, 3))
    for j in range(line.L.size):
        direction = rng.normal(size=3)
        x[j + 1] = x[j] + line.L[j] * (1.0 + strain) * direction / np.linalg.norm(direction)
    still = np.zeros_like(x)
    K, B = np.zeros((x.size, WIDTH)), np.zeros((x.size, WIDTH))
    axial.tangent(line, x, still, still, K, B)
    numeric = np.empty((x.size, x.size))
    for j in range(x.size):
        step = np.zeros(x.size)
        step[j] = 1e-7
        ahead, behind = x + step.reshape(-1, 3), x - step.reshape(-1, 3)
        numeric[:, j] = -(_force(axial, line, ahead, *[still] * 3) - _force(axial, line, behind, *[still] * 3)) / 2e-7
    exact = _dense(K)
    np.testing.assert_allclose(exact, numeric, atol=2e-7 * line.EA.max())
    np.testing.assert_allclose(exact, exact.T, atol=1e-12 * line.EA.max())


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_an_element_that_does_not_push_is_the_old_spring(kind: dict[str, Any]) -> None:
    line = _arrays(**kind)
    strains = np.array([-1e-9, -0.5, -1e-3, 0.0]) if "compression" in kind else np.array([0.0, 1e-12, 1e-6, 1e-3, 0.2])
    for strain in strains:
        free, share = released(strain, line.limit[0], line.knee[0])
        assert (free, share) == (0.0, 1.0)
    lengths = line.L[0] * (1.0 + strains)
    assert np.all(_tension(line, strains) == line.EA[0] * (lengths - line.L[0]) / line.L[0])


@pytest.mark.parametrize("kind", ["none", "stiff", "neutral"])
def test_compression_ends_at_the_euler_load(kind: str) -> None:
    """Smooth, rising, and below by at most the stated share of weight × depth, the weight at least 1/20 of that in air."""
    line = _arrays(**KINDS[kind])
    euler = np.pi**2 * KINDS[kind].get("EI", 0.0) / line.L[0] ** 2
    dry, wet = line.w_dry[0] / line.L[0], (line.w_dry[0] - line.b_wet[0]) / line.L[0]
    extra = SHARE * max(abs(wet), 0.05 * dry) * 100.0
    start = euler / line.EA[0]
    near = start + line.knee[0] * np.linspace(-2.0, 4.0, 601)
    strains = -np.concatenate([near, np.geomspace(near[-1], 0.999, 400)[1:]])
    T = _tension(line, strains)
    assert np.all(np.diff(T) < 1e-15 * line.EA[0])  # but for the last bit
    assert np.all(np.diff(T[[0, 200, 400, -1]]) < 0)
    assert -euler - extra < T.min() < -euler - 0.4 * extra
    slope = np.diff(T[:601]) / np.diff(near)
    assert np.abs(np.diff(slope)).max() < 0.01 * line.EA[0]  # no corner
    assert -slope[0] == pytest.approx(line.EA[0], rel=1e-4)
    assert -slope[-1] < 1e-3 * line.EA[0]


def test_the_wire_of_the_fpso_carries_113_newton() -> None:
    """π² × 50 kN m² / (66 m)², where compression is not allowed: the design example."""
    data = example("fpso-2000m")
    data["line_types"]["wire"]["compression"] = "none"
    del data["vessel"], data["analyses"]
    line = data["lines"]["bow-port"]
    line["end_a"], line["end_b"] = {"pinned": [-2500, 0, -2000]}, {"pinned": [0, 0, 0]}
    data["lines"] = {"bow-port": line}
    data["analyses"] = {"statics": {}}
    arrays = build(parse_case(data), None).lines[0].arrays
    assert arrays.L[0] == pytest.approx(66.0)
    carried = -_tension(arrays, np.array([-0.05]))[0]
    assert 113.0 < carried < 113.3 + SHARE * 1300 * 2000
    assert arrays.limit[0] * arrays.EA[0] == pytest.approx(113.2, abs=0.1)


def test_going_slack_gives_back_what_stretching_stored() -> None:
    """From a strain of 1e-3 to half the length: ½EA ε² L comes back, less the work of the little that is carried."""
    line = _arrays()
    strains = np.concatenate([np.linspace(1e-3, -1e-3, 20001), np.linspace(-1e-3, -0.5, 2001)[1:]])
    change = np.trapezoid(_tension(line, strains), strains)
    assert 0.0 < change + 0.5 * line.EA[0] * 1e-6 < line.knee[0] * line.EA[0]
