"""The memory of radiation in time (T6): a constant velocity meets no force, a slow or fast sine that of A(ω) and B(ω)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.kernels.vessel import remember, vessel_residual
from solver.time_domain.lanes import make_memory
from solver.vessel.data import FileSource
from tests.systems import EXAMPLES, example
from tests.time_domain.systems import block_of, prepared, timed

Array = np.ndarray


def _block(step: float) -> Any:
    data = example("fpso-2000m-design")
    for line in data["lines"].values():
        line["segments"][0]["elements"] = 4
    data["analyses"] = {"statics": {}}
    return block_of(
        timed(data, step=step, build_up=0, duration=round(100.0 / step) * step, output_step=step), FileSource(EXAMPLES)
    )


def _memory_force(block: Any, velocity: Array, since: float) -> Array:
    """The memory force at a velocity (6,), `since` seconds after the last sample (6,)."""
    setup, work, out = block.setup, block.work, np.zeros((2, 6))
    work.svt[0], work.sat[0], work.st[0] = velocity, 0.0, 0.0
    none = setup.memory._replace(rows=np.zeros((12, 0)))
    for memory, row in ((setup.memory, out[0]), (none, out[1])):
        vessel_residual(setup.body, setup.sea, memory, block.state, work, 0, 0.0, since, 0.0, row)
    return out[1] - out[0]


@pytest.mark.parametrize("step", [0.04, 0.1, 0.25])
def test_constant_velocity_meets_no_memory_force_at_any_time_between_samples(step: float) -> None:
    block = _block(step)
    memory = block.setup.memory
    samples = memory.rows.shape[1] // 6
    velocity = np.array([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
    block.state.sv[0] = velocity
    for _ in range(samples):
        remember(memory, block.state, step)
    interval = memory.every * step
    scale = np.abs(memory.rows[:6]).reshape(6, samples, 6).sum(axis=1) @ velocity
    for since in np.linspace(0.0, interval, 5):
        force = _memory_force(block, velocity, float(since))
        assert np.abs(force / scale).max() < 2e-4, since


@pytest.mark.parametrize("step", [0.04, 0.1, 0.2])
@pytest.mark.parametrize("omega", [0.03, 0.3, 0.6])
def test_sinusoidal_velocity_meets_the_force_of_added_mass_and_damping(omega: float, step: float) -> None:
    """The first harmonic of the memory force of v = cos ωt is B(ω) and ω(A(ω) - A∞), at every step between samples."""
    block = _block(step)
    memory, kernel = block.setup.memory, block.run.model.vessel.radiation.retardation
    added, damping = kernel.transform(np.array([omega]))
    wanted = damping[0] + 1j * omega * (added[0] - kernel.added_mass_infinite)
    peak = np.abs(kernel.transform(np.linspace(0.02, 1.2, 60))[1]).max(axis=0)
    samples = memory.rows.shape[1] // 6
    steps = round(2 * np.pi / omega / step)
    t = step * np.arange(-samples * memory.every, steps)
    for dof in (0, 1, 2):
        forces = []
        block.state.past[:] = 0.0
        for k, time in enumerate(t):
            velocity = np.zeros(6)
            velocity[dof] = np.cos(omega * time)
            if k % memory.every == 0:
                block.state.sv[0] = velocity
                remember(memory, block.state, step)
            if time >= -0.5 * step:
                forces.append(_memory_force(block, velocity, (k % memory.every) * step)[dof])
        phase = np.exp(-1j * omega * t[-steps:])
        found = 2.0 * np.mean(np.array(forces[:steps]) * phase)
        assert abs(found - wanted[dof, dof]) < 0.01 * max(abs(wanted[dof, dof]), peak[dof, dof])


def test_memory_of_constant_radiation_is_empty() -> None:
    data = example("fpso-2000m-design")
    data["vessel"]["hydrodynamics"] |= {"radiation": "constant", "frequency": 0.34}
    data["analyses"] = {}
    model, static, _ = prepared(timed(data, step=0.1, build_up=0, duration=100, output_step=0.1), FileSource(EXAMPLES))
    assert make_memory(model, static, 0.1).rows.shape[1] == 0
