"""Small systems in motion that the time-domain tests share."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from solver.case import parse_case
from solver.case.analysis import TimeDomain
from solver.model.build import Model, build
from solver.statics.solve import StaticState, solve_statics
from solver.time_domain.block import Block, Run, Timing
from solver.time_domain.ensemble import Record, march_ensemble
from tests.systems import example, span

Array = np.ndarray
ANGLE = 1.4  # Θ of the scheme, in time


def timed(data: dict[str, Any], **spec: Any) -> dict[str, Any]:
    """The case with these time-domain settings, times in seconds."""
    out = copy.deepcopy(data)
    out["analyses"]["time_domain"] = spec
    return out


def prepared(data: dict[str, Any], source: Any = None) -> tuple[Model, StaticState, TimeDomain]:
    model = build(parse_case(data), source)
    spec = model.case.analyses.time_domain
    assert spec is not None
    return model, solve_statics(model), spec


def marched(
    data: dict[str, Any], source: Any = None, seeds: tuple[int, ...] = (1,), threads: int = 1
) -> tuple[Record, Timing]:
    model, static, spec = prepared(data, source)
    return march_ensemble(model, static, spec, list(seeds), threads)


def block_of(data: dict[str, Any], source: Any = None, seeds: tuple[int, ...] = (1,)) -> Block:
    """A block about to march; a test may change its state first."""
    return Block(Run(*prepared(data, source)), list(seeds))


def riser(name: str, factor: float = 1.0, elements: int = 68, depth: float = 100.0, **spec: Any) -> dict[str, Any]:
    """The example riser, motion or wave multiplied by `factor`; eight periods of build-up, two kept, unless said."""
    data = example(f"hanging-riser-{name}")
    data["environment"]["depth"] = depth
    data["lines"]["riser"]["segments"][0]["elements"] = elements
    period = PERIODS[name]
    if name == "case1":
        data["lines"]["riser"]["end_b"]["motion"]["surge"]["amplitude"] = 10.0 * factor
    else:
        data["environment"]["seastates"][0]["height"] = 10.0 * factor
    data["analyses"] = {"frequency_domain": {"tolerance": 1e-7, "max_iterations": 300}}
    step = spec.get("step", 0.05)
    given = {"step": step, "build_up": 8 * period, "duration": 2 * period, "output_step": step, **spec}
    return timed(data, **given)


PERIODS = {"case1": 27.0, "case2": 10.0}


def string(elements: int = 10, stretch: float = 0.01, **kind: Any) -> dict[str, Any]:
    """A taut, neutrally buoyant, drag-free line between two points: its small motion is known exactly."""
    diameter = 0.2
    line = {"diameter": diameter, "mass": 1000.0 * np.pi / 4 * diameter**2, "EA": 1e6, "EI": 0.0,
            "drag": {"normal": 0, "tangential": 0}, "added_mass": {"normal": 0.0, "tangential": 0.0}, **kind}  # fmt: skip
    data = span(100.0 / (1 + stretch), (0, 0, -50), (100, 0, -50), elements, **line)
    data["lines"]["line"]["allow_stretch"] = True
    return data


def wilson(omega: float, ratio: float, h: float, x: float, steps: int) -> Array:
    """x at 0, h, 2h … of ẍ + 2ζωẋ + ω²x = 0 from rest at x by Wilson's relations, written out for one coordinate."""
    tau, v, a = ANGLE * h, 0.0, -omega * omega * x
    out = [x]
    for _ in range(steps):
        # residual at t + τ: (6Δ/τ² - 6v/τ - 2a) + 2ζω(3Δ/τ - 2v - τa/2) + ω²(x + Δ) = 0
        left = 6 / tau**2 + 6 * ratio * omega / tau + omega**2
        right = 6 * v / tau + 2 * a + 2 * ratio * omega * (2 * v + 0.5 * tau * a) - omega**2 * x
        change = ((6 / tau**2) * (right / left) - 6 * v / tau - 3 * a) / ANGLE
        x, v, a = x + h * v + h * h * (a / 2 + change / 6), v + h * (a + change / 2), a + change
        out.append(x)
    return np.array(out)


def damping_of_the_scheme(omega: float, h: float) -> tuple[float, float]:
    """Numerical damping ratio and relative growth of the period of an undamped oscillator (from the recursion's roots)."""
    columns = []
    for start in np.eye(3):
        x, v, a = start
        tau = ANGLE * h
        left = 6 / tau**2 + omega**2
        right = 6 * v / tau + 2 * a - omega**2 * x
        change = ((6 / tau**2) * (right / left) - 6 * v / tau - 3 * a) / ANGLE
        columns.append([x + h * v + h * h * (a / 2 + change / 6), v + h * (a + change / 2), a + change])
    roots = np.linalg.eigvals(np.array(columns).T)
    root = roots[np.argmax(np.abs(roots.imag))]
    decay, angle = -np.log(abs(root)), abs(np.angle(root))
    return float(decay / np.hypot(decay, angle)), float(omega * h / angle - 1)
