"""Boundary elements against published and closed-form values: within 2 %.

Hemisphere: A. Hulme, The wave forces acting on a floating hemisphere undergoing forced periodic oscillations,
J. Fluid Mech. 121 (1982) 443-463, tables 1 and 2: added mass and damping over 2/3 π ρ a³ (ω).
Vertical cylinder: R. C. MacCamy and R. A. Fuchs, Beach Erosion Board TM 69 (1954); its mean drift: T. H. Havelock,
The pressure of water waves upon a fixed obstacle, Proc. R. Soc. A 175 (1940) 409-421.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import h1vp

from solver.bem import parse_job, prepare
from solver.bem.body import motions
from solver.bem.drift import mean_drift
from solver.bem.job import wet
from solver.bem.solve import FrequencySolver, Wet

from .shapes import hemisphere_quarter, need_capytaine

need_capytaine()
RHO, G = 1000.0, 9.81
UNIT = RHO * 2 * math.pi / 3
HULME = {  # Ka: heave A, B; surge A, B
    0.2: (0.7938, 0.2793, 0.5515, 0.0082),
    0.4: (0.6452, 0.3410, 0.6175, 0.0557),
    0.6: (0.5381, 0.3271, 0.6586, 0.1516),
    0.8: (0.4698, 0.2899, 0.6421, 0.2653),
    1.0: (0.4284, 0.2484, 0.5740, 0.3535),
    1.4: (0.3924, 0.1756, 0.4038, 0.4060),
}


def nothing(share: float, words: str) -> None: ...


@pytest.fixture(scope="module")
def sphere() -> FrequencySolver:
    quarter = hemisphere_quarter(12)  # 576 panels
    return FrequencySolver(Wet(quarter, None, ("x", "y"), np.zeros(3), math.inf, RHO, G), np.zeros(1))


@pytest.mark.parametrize("ka", HULME)
def test_hemisphere_added_mass_and_damping(sphere: FrequencySolver, ka: float) -> None:
    omega = math.sqrt(G * ka)
    found = sphere.solve(omega, nothing)
    mine = [value / UNIT for dof in (2, 0) for value in (found.added_mass[dof, dof], found.damping[dof, dof] / omega)]
    assert mine == pytest.approx(HULME[ka], rel=0.02)


def test_hemisphere_at_the_ends_of_the_axis(sphere: FrequencySolver) -> None:
    """Surge at zero and heave at infinite frequency: half the displaced mass, as for a sphere in unbounded water."""
    assert sphere.solve(0.0, nothing).added_mass[0, 0] / UNIT == pytest.approx(0.5, rel=5e-3)
    assert sphere.solve(0.0, nothing).added_mass[2, 2] / UNIT == pytest.approx(0.8310, rel=5e-3)  # Hulme
    assert sphere.solve(math.inf, nothing).added_mass[2, 2] / UNIT == pytest.approx(0.5, rel=5e-3)
    assert sphere.solve(math.inf, nothing).added_mass[0, 0] / UNIT == pytest.approx(0.2732, rel=0.02)  # Hulme


def test_hemisphere_converges_with_the_square_of_the_panel_size() -> None:
    errors = []
    for n in (4, 8):
        solver = FrequencySolver(
            Wet(hemisphere_quarter(n), None, ("x", "y"), np.zeros(3), math.inf, RHO, G), np.zeros(1)
        )
        errors.append(abs(solver.solve(math.sqrt(G * 0.4), nothing).added_mass[2, 2] / UNIT / 0.6452 - 1))
    assert math.log2(errors[0] / errors[1]) > 1.5


def havelock(ka: float) -> float:
    """Mean force on a fixed vertical cylinder in deep water over ρ g a² R: 4 over π² (ka)³ times the sum over m."""
    m = np.arange(35)
    orders = [np.abs(h1vp(order, ka)) ** 2 for order in (m, m + 1)]
    terms = (1 - m * (m + 1) / ka**2) ** 2 / (orders[0] * orders[1])
    return float(4 / (math.pi**2 * ka**3) * np.nansum(terms))


def test_havelocks_sum_tends_to_that_of_short_waves() -> None:
    """A wall turns waves back by their angle: 1/2 ρ g a² ∫ sin³ = 2/3 ρ g a² R."""
    assert havelock(20.0) == pytest.approx(2 / 3, rel=0.02)


@pytest.mark.parametrize("ka", [0.6, 1.0, 1.5])
def test_cylinder_excitation_and_mean_drift(ka: float) -> None:
    """A fixed column so deep that its lower end feels nothing."""
    radius = 10.0
    deep = radius * 4.0 / ka
    job = parse_job(
        {
            "geometry": {"hull": {"kind": "spar", "profile": [{"depth": d, "diameter": 20} for d in (0, deep)]},
                         "panel_size": 2.0},
            "water": {"density": RHO, "gravity": G},
            "lid": False,
        },
        compute=False,
    )  # fmt: skip
    shape = wet(job, prepare(job, lambda _: (b"", "")))
    k = ka / radius
    omega = math.sqrt(G * k)
    found = FrequencySolver(shape, np.zeros(1)).solve(omega, nothing)
    assert found.froude_krylov is not None
    assert found.diffraction is not None
    assert found.waves is not None
    surge = abs(found.froude_krylov[0, 0] + found.diffraction[0, 0])
    # ∫ e^{kz} dz over the column of the 4 ρ g / (k |H1'(ka)|) of each unit of its length
    each = 4 * RHO * G / (k * abs(h1vp(1, ka)))
    assert surge == pytest.approx(each * (1 - math.exp(-k * deep)) / k, rel=0.02)
    drift = mean_drift(found.waves[:, 6:], np.zeros(1), omega, k, math.inf, RHO, G)[0]
    assert drift[0] == pytest.approx(havelock(ka) * RHO * G * radius, rel=0.02)
    assert drift[1:] == pytest.approx([0, 0], abs=1e-6 * drift[0])


def test_mean_drift_of_a_free_hemisphere_in_short_and_long_waves(sphere: FrequencySolver) -> None:
    """Free, it follows long waves and scatters nothing; in short ones it lies still: its drift is the fixed one's."""
    inertia = UNIT * np.diag([1.0, 1.0, 1.0, 0.4, 0.4, 0.4])
    stiffness = np.diag([0, 0, RHO * G * math.pi, 1.0, 1.0, 0])
    ratio = {}
    for ka in (0.05, 3.0):
        omega = math.sqrt(G * ka)
        found = sphere.solve(omega, nothing)
        force = found.froude_krylov + found.diffraction  # type: ignore[operator]
        x = motions(omega, found.added_mass, found.damping, force, inertia, stiffness, np.zeros(6))
        waves = found.waves
        assert waves is not None
        free, fixed = (
            mean_drift(each, np.zeros(1), omega, ka, math.inf, RHO, G)[0, 0]
            for each in (waves[:, 6:] + waves[:, :6] @ x.T, waves[:, 6:])
        )
        ratio[ka] = free / fixed
        if ka == 0.05:
            assert free < 1e-3 * RHO * G
    assert ratio[0.05] < 0.1
    assert ratio[3.0] == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
def test_barge_of_a_thousand_panels() -> None:
    """240 x 46 x 10 m: added mass over 1.1e8 kg of an independent computation, in its two or three digits, and the
    mean drift of the fixed barge in short waves from 4824 panels (both in docs/barge.md)."""
    job = parse_job(
        {
            "geometry": {"hull": {"kind": "barge", "length": 240, "breadth": 46, "draft": 10}, "panel_size": 4.4},
            "water": {"gravity": 9.807},
            "body": {"centre_of_gravity": [0, 0, 5], "radii_of_gyration": [26, 60, 60]},
        },
        compute=False,
    )
    shape = wet(job, prepare(job, lambda _: (b"", "")))
    headings = np.radians([0.0, 90.0])
    solver = FrequencySolver(shape, headings)
    expected = {0.2: (0.63, 4.0, 151), 0.4: (0.81, 2.26, 151), 0.6: (0.54, 1.65, 152), 0.8: (0.21, 1.68, 154)}
    for omega, values in expected.items():
        found = np.diag(solver.solve(omega, nothing).added_mass)[1:4] / 1.1e8
        assert found == pytest.approx(values, rel=0.02, abs=0.007), omega  # sway at 0.8 is known to 0.005 only
    waves = solver.solve(1.2, nothing).waves
    assert waves is not None
    drift = mean_drift(waves[:, 6:], headings, 1.2, 1.2**2 / 9.807, math.inf, 1025, 9.807)
    assert [drift[0, 0], drift[1, 1]] == pytest.approx([220e3, 1204e3], rel=0.02)
