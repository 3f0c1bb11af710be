"""The rigid body: mass, hydrostatics about any centre of gravity, buoyancy, the turn into earth axes, excitation."""

import dataclasses

import numpy as np
import pytest

from solver.case.environment import Environment
from solver.case.vessel import Vessel
from solver.outcome import CaseError, DataError
from solver.vessel.data import read_bytes
from solver.vessel.excitation import excitation
from solver.vessel.rigid import (
    about_cg,
    buoyancy_minus_weight,
    hydrostatic_stiffness,
    linear_damping,
    mass_matrix,
    turned,
    turned_force,
    turning,
    water_warnings,
)

from . import synthetic

SEA = Environment(depth=2000, water={"density": synthetic.RHO, "gravity": synthetic.G})


def vessel(**changes):
    plain = {
        "mass": synthetic.MASS, "centre_of_gravity": (0, 0, 2), "radii_of_gyration": (7, 16, 16),
        "hydrodynamics": {"data": "x.nc"},
    }  # fmt: skip
    return Vessel.model_validate({**plain, **changes})


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    return read_bytes(synthetic.to_bytes(synthetic.dataset(), tmp_path_factory.mktemp("rigid")), "hull.nc")


def test_mass_and_damping():
    mass = mass_matrix(vessel())
    assert np.allclose(np.diag(mass), synthetic.MASS * np.array([1, 1, 1, 49, 256, 256]))
    full = ((5.0, 0.1, 0.2), (0.1, 6.0, 0.3), (0.2, 0.3, 7.0))
    assert np.array_equal(mass_matrix(vessel(radii_of_gyration=None, inertia=full))[3:, 3:], full)
    for wrong in (
        ((5.0, 1.0, 0.2), (0.1, 6.0, 0.3), (0.2, 0.3, 7.0)),
        ((5, 0, 0), (0, 6, 0), (0, 0, 12)),
        ((-5, 0, 0), (0, 6, 0), (0, 0, 7)),
    ):
        with pytest.raises(CaseError, match=r"vessel\.inertia"):
            mass_matrix(vessel(radii_of_gyration=None, inertia=wrong))
    with pytest.raises(CaseError, match=r"vessel\.radii_of_gyration"):
        mass_matrix(vessel(radii_of_gyration=(10, 12, 40)))
    row = tuple(tuple(float(i == j) for j in range(6)) for i in range(6))
    damping = linear_damping(vessel(damping={"linear": {"sway": 3.5e5, "yaw": 2.0}, "linear_matrix": row}))
    assert np.array_equal(np.diag(damping), [1, 3.5e5 + 1, 1, 1, 1, 3])


@pytest.mark.parametrize("point", [(0.0, 0.0, 2.0), (0.0, 0.0, -1.0), (0.0, 0.0, 5.0)])
@pytest.mark.parametrize("reference", [(0.0, 0.0, 2.0), (4.0, -3.0, 1.0)])
def test_stiffness_is_the_box_formula_for_every_centre_of_gravity(data, point, reference):
    """K44 = ρg (I_xx + V (z_B - z_G)), whatever the file's reference and centre of mass and the mass of the case."""
    k = hydrostatic_stiffness(
        vessel(centre_of_gravity=point, mass=0.9 * synthetic.MASS), data.moved_to(np.array(reference))
    )
    area, volume = 60 * 20, 60 * 20 * 6
    lever = volume * (-3 - point[2])
    expected = (
        synthetic.RHO * synthetic.G * np.array([0, 0, area, area * 20**2 / 12 + lever, area * 60**2 / 12 + lever, 0])
    )
    assert np.allclose(k, np.diag(expected), rtol=1e-10, atol=1e-3)


def test_stiffness_of_the_case_comes_first_and_one_is_needed(data):
    own = tuple(tuple(float(10 * i + j) for j in range(6)) for i in range(6))
    assert np.array_equal(hydrostatic_stiffness(vessel(hydrostatics={"stiffness": own}), data), own)
    bare = dataclasses.replace(data, hydrostatic_stiffness=None)
    for nothing in (bare, None):
        with pytest.raises(CaseError, match=r"hydrostatics\.stiffness"):
            hydrostatic_stiffness(vessel(), nothing)
    no_volume = dataclasses.replace(data, displaced_volume=None)
    with pytest.raises(CaseError, match="displaced_volume"):
        hydrostatic_stiffness(vessel(centre_of_gravity=(0, 0, 4)), no_volume)
    assert hydrostatic_stiffness(vessel(), no_volume)[2, 2] > 0  # not needed at the file's own CG


def test_buoyancy_minus_weight(data):
    assert np.allclose(buoyancy_minus_weight(vessel(), data, SEA), 0.0, atol=1e-3)
    light = buoyancy_minus_weight(vessel(mass=0.9 * synthetic.MASS, centre_of_gravity=(1, -2, 2)), data, SEA)
    lift = synthetic.MASS * synthetic.G
    assert np.allclose(light, [0, 0, 0.1 * lift, 2 * lift, 1 * lift, 0])  # r x F, r from the CG to the buoyancy
    own = buoyancy_minus_weight(vessel(hydrostatics={"displaced_volume": 8000}), None, SEA)
    assert own[2] == pytest.approx(synthetic.RHO * synthetic.G * 8000 - lift)


def test_the_reference_of_the_case_stands_in_for_a_silent_file(data):
    silent = dataclasses.replace(data, reference_point=np.zeros(3), reference_known=False)
    moved = about_cg(silent, vessel(hydrodynamics={"data": "x.nc", "reference_point": (0, 0, 2)}))
    assert np.allclose(moved.added_mass, data.added_mass)
    assert about_cg(data, vessel()) is data


def test_water_of_the_data_and_of_the_case(data):
    assert water_warnings(data, SEA, 0.2) == ()
    fresh = Environment(depth=80, water={"density": 1000, "gravity": 9.807})
    texts = water_warnings(data, fresh, 0.2)
    assert len(texts) == 2
    assert "1025" in texts[0]
    assert "1000" in texts[0]
    assert "depth of inf m, the case has 80 m" in texts[1]


def test_turning():
    rng = np.random.default_rng(2)
    matrix, motion = rng.normal(size=(3, 6, 6)), rng.normal(size=6)
    r = turning(0.4)
    assert np.allclose(r @ r.T, np.eye(6))
    assert np.allclose(turned(turned(matrix, 0.4), -0.4), matrix)
    assert np.allclose(turned(matrix, 0.4) @ turned_force(motion, 0.4), turned_force(matrix @ motion, 0.4))
    surge = turned_force(np.eye(6)[0], np.pi / 2)
    assert np.allclose(surge, np.eye(6)[1])


def test_excitation_turns_with_everything(data):
    omega = np.array([0.3, 0.9])
    plain = excitation(data, omega, 1.0)
    assert np.allclose(plain, data.excitation_at(omega, 1.0))
    assert np.allclose(excitation(data, omega, 1.9, yaw=0.9), turned_force(plain, 0.9))
    with pytest.raises(DataError, match="above the highest frequency"):
        excitation(data, np.array([9.0]), 1.0)
