"""A chain in a tank, its top led round a circle: the experiment of Bergdahl et al. (2016) as a case.

L. Bergdahl, J. Palm, C. Eskilsson, J. Lindahl, "Dynamically scaled model experiment of a mooring cable", J. Mar. Sci.
Eng. 4 (2016) 5, doi 10.3390/jmse4010005, CC BY 4.0. Line properties: its Table 7; measured: its Table 8, the mean over
the cycles of the largest force at the upper end. Nothing is fitted to the measurement. The bed of the tank, concrete,
is softened to the default soil, on which the chain rests 2 mm deep.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.case import parse_case
from solver.run import run

RADII = (0.075, 0.100, 0.125, 0.150, 0.200)  # m
MEASURED = {
    1.25: (42.5, 46.8, 54.1, 60.4, 70.3), 1.50: (41.0, 45.3, 51.5, 59.0, 68.0), 2.00: (36.0, 39.5, 47.5, 54.1, 62.3),
    2.50: (31.1, 35.4, 42.5, 49.0, 57.3), 3.00: (29.5, 33.1, 39.3, 45.8, 54.0), 3.50: (27.8, 31.5, 37.5, 42.5, 50.1),
}  # fmt: skip
STEEL = 0.0022  # m, diameter of the bar: drag coefficients 2.5 across and 0.5 along refer to it
MASS, DENSITY = 0.0818, 7800.0  # kg/m, kg/m3


def chain(period: float, radius: float, elements: int = 66, step: float = 0.0025) -> dict[str, Any]:
    """The case for one period [s] and radius [m]: four cycles of build-up, three kept."""
    volume = MASS / DENSITY
    step = period / round(period / step)
    circle = {
        "surge": {"amplitude": radius, "period": period, "phase": "-90 deg"},
        "heave": {"amplitude": radius, "period": period, "phase": "0 deg"},
    }
    kind = {
        "diameter": float(np.sqrt(4 * volume / np.pi)), "drag_diameter": STEEL, "mass": MASS, "EA": 1e4,
        "drag": {"normal": 2.5, "tangential": 0.5 * np.pi}, "added_mass": {"normal": 3.8, "tangential": 0.0},
    }  # fmt: skip
    return {
        "slowdrift": 1, "name": "Chain in a tank",
        "environment": {"depth": 3.0, "water": {"density": 1000, "gravity": 9.80665}, "seabed": {"friction": 0.3}},
        "line_types": {"chain": kind},
        "lines": {"chain": {"segments": [{"type": "chain", "length": 33.0, "elements": elements}],
                            "end_a": {"pinned": [0, 0, -3.0]},
                            "end_b": {"pinned": [32.554, 0, 0.3], "motion": circle}}},
        "analyses": {"statics": {}, "time_domain": {"step": step, "build_up": 4 * period, "duration": 3 * period,
                                                    "output_step": step}},
    }  # fmt: skip


def cycle_maximum(period: float, radius: float, **settings: Any) -> float:
    """Mean over the kept cycles of the largest force at the upper end [N]."""
    result = run(parse_case(chain(period, radius, **settings)), None, threads=1)
    assert not result.failures, result.failures
    (history,) = (one.values[:, 0] for one in result.channels if one.name == "time/line/chain/end_b_tension")
    return float(np.mean([part.max() for part in np.array_split(history, 3)]))
