"""Friction of the seabed in time: a line dragged along it against closed forms, and the energy it takes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.case import parse_case
from solver.model.build import build
from solver.time_domain.block import Block
from tests.systems import span
from tests.time_domain.systems import block_of, marched, timed

Array = np.ndarray
MU, SLOW = 0.6, 0.002
MASS, LENGTH, G = 80.0, 60.0, 9.807


def _dragged(mu: float = MU, **spec: Any) -> dict[str, Any]:
    """A chain that lies on the bed, drag-free, its end b pulled to and fro along it."""
    data = span(
        LENGTH, (0, 0, -50), (LENGTH * 1.0005, 0, -50), 12, 50.0, mass=MASS, diameter=0.01, EA=2e6, compression="allowed",
        drag={"normal": 0, "tangential": 0}, added_mass={"normal": 0, "tangential": 0},
    )  # fmt: skip
    data["lines"]["line"]["allow_stretch"] = True
    data["environment"]["seabed"] = {"node_stiffness": 4e4, "transition": 0.02, "damping": 4e3, "friction": mu,
                                     "friction_speed": SLOW}  # fmt: skip
    data["lines"]["line"]["end_b"]["motion"] = {"surge": {"amplitude": 1.0, "period": 60.0, "phase": "-90 deg"}}
    return timed(data, **{"step": 0.01, "build_up": 60.0, "duration": 60.0, "output_step": 0.1, **spec})


def _weight(block: Block) -> float:
    """Of one element in water [N]."""
    arrays = block.run.static.lines[0].arrays
    return float(arrays.w_dry[0] - arrays.b_wet[0])


def test_tension_falls_by_friction_along_a_dragged_line() -> None:
    """Sliding slowly towards the pull, each node takes μ times its weight: T_j+1 - T_j = μ w l."""
    data = _dragged()
    block = block_of(data)
    block.go(block.run.time.build_up + round(58.0 / 0.01))  # 13 s after the top turned outward
    weight = _weight(block)
    x, v = block.state.x[..., 0], block.state.v[..., 0]
    arrays = block.run.static.lines[0].arrays
    tension = arrays.EA * (np.linalg.norm(np.diff(x, axis=0), axis=1) / arrays.L - 1)
    slides = np.flatnonzero(v[1:-2, 0] > 5 * SLOW) + 1  # the last node hangs in part on the end
    assert slides.size >= 5
    share = v[slides, 0] / np.sqrt(v[slides, 0] ** 2 + SLOW**2)
    np.testing.assert_allclose(np.diff(tension)[slides - 1], MU * weight * share, rtol=0.02)


def test_friction_takes_the_work_of_the_end() -> None:
    """Over a period of steady motion the end's work is the friction's, node by node; without friction there is none."""
    works = []
    for mu in (MU, 0.0):
        block = block_of(_dragged(mu))
        h, arrays = block.run.time.h, block.run.static.lines[0].arrays
        block.go(block.run.time.build_up)
        work, rubbed, before = 0.0, 0.0, block.state.x[..., 0].copy()
        for _ in range(block.run.time.kept // 4):
            block.go(4)
            x, v = block.state.x[..., 0].copy(), block.state.v[..., 0]
            t = (x[-1] - x[-2]) / np.linalg.norm(x[-1] - x[-2])
            T = arrays.EA[-1] * (np.linalg.norm(x[-1] - x[-2]) / arrays.L[-1] - 1)
            work += T * float(t @ (x[-1] - before[-1]))
            N = arrays.a1 / (2 * arrays.a2) * np.logaddexp(0, -2 * arrays.a2 * (x[:, 2] - arrays.bed))
            rub = mu * N[1:-1] * v[1:-1, 0] ** 2 / np.sqrt(v[1:-1, 0] ** 2 + v[1:-1, 1] ** 2 + SLOW**2)
            rubbed += 4 * h * float(rub.sum())
            before = x
        works.append((work, rubbed))
    (work, rubbed), (free, _) = works
    assert rubbed > 1e3
    assert work == pytest.approx(rubbed, rel=0.05)
    assert abs(free) < 0.02 * work


def test_a_line_on_the_bed_creeps_below_the_friction_it_could_have() -> None:
    """v = v0 F / √((μN)² - F²) under a sideways force F of a third of μN: a current across the line."""
    data = _dragged(step=0.02, build_up=0.0, duration=10.0, output_step=0.02)
    del data["lines"]["line"]["end_b"]["motion"]
    data["line_types"]["wire"]["drag"] = {"normal": 1.0, "tangential": 0.0}
    block = block_of(data)
    weight = _weight(block)
    arrays = block.run.static.lines[0].arrays
    speed = np.sqrt(MU * weight / 3 / (2 * arrays.cdn[0]))
    block.setup.lines.current[:, 1] = speed
    block.go(25)
    mid = arrays.L.size // 2
    expected = SLOW / np.sqrt(8.0)
    assert block.state.v[mid, 1, 0] == pytest.approx(expected, rel=0.1)


def test_the_analyses_that_leave_friction_out_say_so() -> None:
    data = _dragged()
    data["analyses"] = {"statics": {}, "modes": {}, "frequency_domain": {}}
    said = [text for text in build(parse_case(data), None).warnings if "friction" in text]
    assert said == [
        "environment.seabed.friction acts in the time domain only: statics, frequency domain, modes leave it out"
    ]
    data["environment"]["seabed"]["friction"] = 0.0
    assert not [text for text in build(parse_case(data), None).warnings if "friction" in text]


def test_friction_changes_what_the_pulled_end_feels() -> None:
    """To and fro with friction: a loop of about twice the line's friction in height."""
    record, _ = marched(_dragged())
    block = block_of(_dragged())
    total = MU * _weight(block) * 11
    assert np.ptp(record.tension[:, -1, 0, 0]) > 1.2 * total
