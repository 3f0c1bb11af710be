"""Loads, or on a first start compiles, the kernels by solving a tiny case, so that no measured time holds compilation."""

from __future__ import annotations

import time

from .analyses import natural_modes
from .case import parse_case
from .case.analysis import TimeDomain
from .frequency_domain.solve import solve_frequency_domain
from .model.build import build
from .statics.solve import solve_statics
from .time_domain.ensemble import march_ensemble

_warm: dict[str, float] = {}
TINY = {
    "slowdrift": 1,
    "name": "warm-up",
    "environment": {"depth": 50, "seastates": [{"spectrum": "jonswap", "hs": 1, "tp": 8, "direction": "0 deg"}]},
    "line_types": {"t": {"diameter": 0.1, "mass": 50, "EA": 1e8, "EI": 1e3}},
    "lines": {
        "l": {
            "segments": [{"type": "t", "length": 60, "elements": 6}],
            "end_a": {"pinned": [0, 0, -50]},
            "end_b": {"pinned": [30, 0, -1]},
        }
    },
    "analyses": {"frequency_domain": {"wave": {"from": 0.4, "to": 1.2, "step": 0.1}, "low": {"to": 0.2, "step": 0.1}}},
}


def warm_up() -> float:
    """Load, or on a first start compile, the kernels of all but the time domain; seconds, 0 when done already."""
    if "frequency" in _warm:
        return 0.0
    started = time.perf_counter()
    model = build(parse_case(TINY), None)
    static = solve_statics(model)
    spec = model.case.analyses.frequency_domain
    assert spec is not None
    natural_modes(model, static, solve_frequency_domain(model, static, spec), 2)
    _warm["frequency"] = time.perf_counter() - started
    return _warm["frequency"]


def warm_up_time_domain() -> float:
    """As `warm_up`, for the march of the time domain."""
    if "time" in _warm:
        return 0.0
    started = time.perf_counter()
    model = build(parse_case(TINY), None)
    spec = TimeDomain(step=0.1, build_up=0.2, duration=8.0, output_step=0.1)
    march_ensemble(model, solve_statics(model), spec, [1])
    _warm["time"] = time.perf_counter() - started
    return _warm["time"]
