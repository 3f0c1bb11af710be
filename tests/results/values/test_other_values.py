"""Values that need a case of their own: the catalogue's numbers, and σ of the linear system in the waves of the seeds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.analyses import seeds_in_linear_system
from solver.case import parse_case
from solver.results.line_types import line_types_summary
from solver.time_domain.block import timing
from solver.time_domain.sea import VesselLoads, components
from tests.frequency_domain.conftest import sea
from tests.systems import Source
from tests.time_domain.systems import timed

from .linear import DOFS
from .scenes import Linear, moored

Array = np.ndarray
STEP = 0.05  # rad/s: of the waves in time, of the strips and of the difference frequencies


def test_what_the_catalogue_gave() -> None:
    """R4 studless chain of 120 mm: mass 19.9 d² t/m, breaking load 0.0274 d² (44 - 0.08 d) kN with d in mm."""
    from tests.case.test_catalogue import made

    case = made({"catalogue": "chain-R4-studless", "diameter": 0.12, "EA": 5e8})
    (kind,) = line_types_summary(case).values()
    catalogue = kind["catalogue"]
    assert catalogue["name"] == "chain-R4-studless"
    assert set(catalogue["values"]) == set(catalogue["values"]) - {"EA"}  # given here, so not taken
    load = catalogue["values"]["breaking_load"]
    assert load["value"] == pytest.approx(0.0274 * 120**2 * (44 - 0.08 * 120) * 1e3, rel=1e-6)
    assert load["unit"] == "N"
    assert "d" in load["formula"]
    assert load["source"]
    assert load["status"] in ("verified", "unverified")
    assert kind["breaking_load"] == load["value"]
    mass = catalogue["values"]["mass"]
    assert mass["value"] == kind["mass"] == pytest.approx(19.9e3 * 0.12**2, rel=0.01)
    assert mass["unit"] == "kg/m"


def on_one_grid(drift: str) -> dict[str, Any]:
    """Wave components on the middles of the strips, and difference frequencies on those of the low band."""
    data = moored([sea(4.0, 9.0, 200.0), sea(2.0, 13.0, 150.0)])
    data["vessel"]["hydrodynamics"]["drift"] = drift
    band = {"from": 6.5 * STEP, "to": 24.5 * STEP, "step": STEP}
    data["analyses"]["frequency_domain"] |= {"wave": band, "low": {"to": 0.3, "step": STEP}}
    return timed(data, step=0.1, build_up=0, duration=20, output_step=0.2, seeds=3, wave_step=STEP)


@pytest.mark.parametrize("drift", ["none", "newman"])
def test_sigma_in_the_same_waves(drift: str, source: Source) -> None:
    """Σ ½|Σ_r H_r a_r|² over the components and, of slow drift, over the difference frequencies, mean of the seeds."""
    case = parse_case(on_one_grid(drift))
    solved = Linear.of(on_one_grid(drift) | {"analyses": {**on_one_grid(drift)["analyses"]}}, source).solved
    result, model = solved.frequency, solved.model
    spec = case.analyses.time_domain
    assert result is not None
    assert spec is not None
    found = seeds_in_linear_system(model, solved.static, result)
    waves = components(model, spec, timing(spec).duration)
    assert waves is not None
    strips = result.driver.wave.strips
    np.testing.assert_allclose(waves.omega, strips.omega[: strips.count], rtol=1e-9)
    H = result.wave.vessel[:, :, : strips.count]
    loads = VesselLoads(model, waves, float(solved.static.position[5]), float(spec.step))
    variance = {"wf": np.zeros(6), "lf": np.zeros(6)}
    for seed in range(spec.seeds):
        amplitude = waves.amplitudes(spec.first_seed + seed, spec.amplitudes == "random")
        motion = np.einsum("rkw,rw->kw", H, amplitude)
        variance["wf"] += 0.5 * np.sum(np.abs(motion) ** 2, axis=1) / spec.seeds
        if drift != "none":
            slow, border = _slow(result, model, solved.static, loads.difference(amplitude)[1:])
            variance["lf"] += 0.5 * np.sum(np.abs(slow[:border]) ** 2, axis=0) / spec.seeds
    for band in ("wf", "lf"):
        np.testing.assert_allclose([found[band][dof] for dof in DOFS], np.sqrt(variance[band]), rtol=1e-6, atol=1e-12)
    if drift != "none":
        assert min(variance["lf"][[0, 1, 5]]) > 0


def _slow(result: Any, model: Any, static: Any, differences: Array) -> tuple[Array, int]:
    """Slow motion (K, 6) of the difference forces by the dynamic stiffness of vessel and lines; strips below the border."""
    strips = result.driver.low.strips
    own = result.driver.own(model, result.static, strips.omega, result.linear.vessel)
    whole = own + result.low.condensed
    count = strips.count
    motion = [np.linalg.solve(whole[k], 2.0 * differences[k]) for k in range(count)]
    return np.array(motion), count
