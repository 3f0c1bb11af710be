"""Quality checks on data as people have them: rounding noise, conjugated forces, headings turned round."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from solver.vessel.quality import quality, quality_warnings
from solver.vessel.radiation import make_radiation, misfit, retardation
from solver.vessel.scale import FLOOR, arm, floors

from .test_quality import consistent, of, with_pairs


def with_noise(data, dofs=(5,), size=1e-10, seed=0):
    """The body with coefficients of some degrees of freedom, and their couplings, replaced by noise."""
    rng, tables = np.random.default_rng(seed), {}
    for name in ("added_mass", "damping"):
        table = np.array(getattr(data, name))
        peak = np.sqrt(np.diagonal(np.abs(table), axis1=1, axis2=2).max(axis=0))
        noise = size * np.outer(*2 * [np.repeat([peak[:3].max(), peak[3:].max()], 3)]) * rng.normal(size=table.shape)
        table[:, dofs, :], table[:, :, dofs] = noise[:, dofs, :], noise[:, :, dofs]
        tables[name] = table
    force = np.array(data.excitation)
    force[..., dofs] = size * np.abs(force[..., 2]).max() * rng.normal(size=force[..., dofs].shape)
    tables["excitation"] = force
    infinite = np.array(data.added_mass_infinite)
    for dof in dofs:
        infinite[dof] = infinite[:, dof] = 0.0
    return dataclasses.replace(data, added_mass_infinite=infinite, **tables)


@pytest.mark.parametrize("dofs", [(5,), (3, 4), (0, 1, 5)])
@pytest.mark.parametrize("seed", range(2))
def test_rounding_noise_is_not_judged(dofs, seed):
    data = with_noise(consistent(), dofs, seed=seed)
    assert quality_warnings(data, 0.0, np.inf) == ()
    assert all(check.value is None or check.value < 1.0 for check in quality(data))
    kernel, _ = retardation(data)
    assert not any({i, j} & set(dofs) for _, i, j in misfit(kernel, data, 0.0, np.inf))


def test_noise_beside_a_diagonal_that_is_exactly_zero():
    """A buoy's yaw: zeros on the diagonal, rounding in the couplings. The share was 1.67e+291 %."""
    data = with_noise(consistent())
    for table in (data.added_mass, data.damping):
        table[:, 5, 5] = 0.0
    assert of(data, "reciprocity").state == "ok"
    assert of(data, "damping").state == "ok"
    stiffness = np.diag([0.0, 0.0, 2e7, 0.0, 0.0, 0.0])
    stiffness[3, 4] = 1e-9
    assert of(dataclasses.replace(data, hydrostatic_stiffness=stiffness), "stiffness").state == "ok"


def test_what_is_small_and_no_noise_is_judged():
    """Yaw a thousandth of its size: every fault in it is found as before."""
    data = consistent()
    small = np.ones((6, 6))
    small[5] = small[:, 5] = np.sqrt(1e-3)
    small[5, 5] = 1e-3
    made = dataclasses.replace(
        data, added_mass=data.added_mass * small, damping=data.damping * small,
        added_mass_infinite=data.added_mass_infinite * small, excitation=data.excitation * np.sqrt(np.diag(small)),
    )  # fmt: skip
    assert quality_warnings(made, 0.0, np.inf) == ()
    spiked = made.damping.copy()
    spiked[30, 5, 5] += 0.2 * spiked[:, 5, 5].max()
    found = of(dataclasses.replace(made, damping=spiked), "spikes")
    assert found.state == "warning"
    assert "damping of yaw" in found.message
    negative = made.damping.copy()
    negative[:, 5, 5] *= -1
    assert "yaw is negative" in of(dataclasses.replace(made, damping=negative), "damping").message


def test_drift_that_vanishes_by_symmetry_is_not_compared():
    data = with_pairs(consistent())
    drift, pairs = data.mean_drift.copy(), data.qtf.values.copy()
    rng = np.random.default_rng(1)
    drift[..., 5] = 1e-6 * rng.normal(size=drift[..., 5].shape)
    noise = 1e-6 * rng.normal(size=pairs[..., 5].shape)
    pairs[..., 5] = noise + noise.transpose(0, 2, 1)
    made = dataclasses.replace(data, mean_drift=drift, qtf=dataclasses.replace(data.qtf, values=pairs))
    assert of(made, "qtf-diagonal").value < 1e-12


def test_the_floor_by_hand():
    """Forces of 4, moments of 900 with a length of 10 m: 900 counts as 90 of a force."""
    assert floors(np.array([4.0, 1.0, 0.0, 900.0, 0.0, 0.0]), 10.0) == pytest.approx(
        FLOOR * np.array([90.0] * 3 + [900.0] * 3)
    )
    data = consistent()
    data.added_mass[:] = np.diag([1.0, 4.0, 2.0, 36.0, 1.0, 100.0])
    assert arm(data) == 5.0


def test_a_case_with_noise_gets_no_warning_of_its_retardation():
    from solver.case.vessel import Hydrodynamics

    choice = Hydrodynamics(data="x", radiation="cummins")
    plain, noisy = (make_radiation(choice, data, 0.0, 0.1, 1.5) for data in (consistent(), with_noise(consistent())))
    assert plain.warnings == noisy.warnings == ()
    assert noisy.misfit < 0.02


# --- phase and heading


def test_a_long_wave_pushes_with_the_acceleration_of_the_water():
    found = of(consistent(), "phase")
    assert found.state == "ok"
    assert found.value == pytest.approx(-1.0)


@pytest.mark.parametrize("depth", [np.inf, 40.0])
@pytest.mark.parametrize("count", [36, 7])
def test_conjugated_forces_and_headings_turned_round_are_told(depth, count):
    data = consistent(depth, count=count)
    conjugated = of(dataclasses.replace(data, excitation=data.excitation.conj()), "phase")
    turned = (
        of(dataclasses.replace(data, headings=(data.headings + np.pi) % (2 * np.pi)), "phase") if count == 36 else None
    )
    for found in (conjugated, turned):
        if found is not None:
            assert found.state == "warning"
            assert found.value == pytest.approx(1.0)
            assert "correlation of -1 over the headings (threshold 0.5)" in found.message


@pytest.mark.parametrize(("chosen", "dof"), [([0], 0), ([9], 1), ([4, 5], 0)])
def test_few_headings_suffice(chosen, dof):
    data = consistent()
    few = dataclasses.replace(data, headings=data.headings[chosen], excitation=data.excitation[:, chosen])
    assert of(few, "phase").value == pytest.approx(-1.0)
    assert of(dataclasses.replace(few, excitation=few.excitation.conj()), "phase").state == "warning"
    still = few.excitation.copy()
    still[..., :2] = 0.0
    assert of(dataclasses.replace(few, excitation=still), "phase").state == "skipped"


def test_mirrored_headings_correlate_with_nothing():
    """Headings counted clockwise: surge fits, sway is turned round."""
    data = consistent()
    mirrored = dataclasses.replace(data, excitation=data.excitation * np.array([1, -1, 1, 1, 1, 1]))
    found = of(mirrored, "phase")
    assert found.state == "warning"
    assert found.value == pytest.approx(0.0, abs=1e-9)


def test_short_waves_are_no_proof():
    found = of(consistent(omega=np.arange(1.0, 3.01, 0.05)), "phase")
    assert found.state == "skipped"
    assert "no long wave" in found.message
