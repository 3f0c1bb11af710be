"""Small systems that the solver's tests share: a hanging riser, a moored box, dense matrices."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from solver.case import Case, parse_case
from solver.kernels.line import HALF
from solver.model.build import Model, build
from solver.statics.solve import StaticState, solve_statics
from solver.vessel.data import HydrodynamicData

EXAMPLES = Path(__file__).parents[1] / "examples"
STIFFNESS = [[0.0] * 6 for _ in range(6)]
for _i, _k in ((2, 1.2e7), (3, 4.0e8), (4, 3.6e9)):
    STIFFNESS[_i][_i] = _k


def example(name: str) -> dict[str, Any]:
    """The plain data of an example."""
    data: dict[str, Any] = yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text())
    return data


def riser(elements: int = 68, **environment: Any) -> dict[str, Any]:
    """The example riser, statics only, with another number of elements and other surroundings."""
    data = example("hanging-riser-case1")
    data["lines"]["riser"]["segments"][0]["elements"] = elements
    del data["lines"]["riser"]["end_b"]["motion"]
    data["analyses"] = {"statics": {}}
    data["environment"].update(environment)
    return data


def span(length: float, a: Any, b: Any, elements: int = 20, depth: float = 100.0, **kind: Any) -> dict[str, Any]:
    """One uniform line between two pinned ends."""
    wire = {"diameter": 0.1, "mass": 50.0, "EA": 5e8, "EI": 0.0, **kind}
    return {
        "slowdrift": 1, "name": "span", "environment": {"depth": depth, "water": {"density": 1000, "gravity": 9.807}},
        "line_types": {"wire": wire},
        "lines": {"line": {"segments": [{"type": "wire", "length": length, "elements": elements}],
                           "end_a": {"pinned": list(a)}, "end_b": {"pinned": list(b)}}},
        "analyses": {"statics": {}},
    }  # fmt: skip


def moored_box(elements: int = 10, lines: int = 4, **vessel: Any) -> dict[str, Any]:
    """A box with `lines` catenary lines in 120 m of water, symmetric about its axes, without hydrodynamic data."""
    found: dict[str, Any] = {}
    for k in range(lines):
        angle = 360.0 * (k + 0.5) / lines
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        found[f"line-{k}"] = {
            "segments": [{"type": "chain", "length": 420.0, "elements": elements}],
            "end_a": {"anchor": {"azimuth": f"{angle} deg", "radius": 380.0}},
            "end_b": {"fairlead": [25.0 * np.sign(c), 9.0 * np.sign(s), -4.0]},
            "multiplicity": 2,
        }
    return {
        "slowdrift": 1, "name": "box", "environment": {"depth": 120, "seabed": {"node_stiffness": 2e4, "transition": 0.5}},
        "vessel": {"mass": 7.4e6, "centre_of_gravity": [0, 0, 2],
                   "radii_of_gyration": [8, 16, 16],
                   "hydrostatics": {"stiffness": STIFFNESS}, **vessel},
        "line_types": {"chain": {"diameter": 0.12, "mass": 140.0, "EA": 6e8, "EI": 2e4,
                                 "drag": {"normal": 1.2, "tangential": 0.2},
                                 "added_mass": {"normal": 1.0, "tangential": 0.1}}},
        "lines": found, "analyses": {"statics": {}},
    }  # fmt: skip


class Source:
    """A data source that opens one set of data whatever the name."""

    def __init__(self, data: HydrodynamicData):
        self.data = data

    def open(self, _reference: str) -> HydrodynamicData:
        return self.data


def solved(data: dict[str, Any], source: Any = None) -> tuple[Model, StaticState]:
    """Model and static state of plain data."""
    model = build(parse_case(data), source)
    return model, solve_statics(model)


def case_of(data: dict[str, Any], **changes: Any) -> Case:
    """A case from plain data with top-level keys replaced."""
    return parse_case({**copy.deepcopy(data), **changes})


def dense(band: np.ndarray) -> np.ndarray:
    """A banded matrix (n, 2·HALF+1) as a full one."""
    size = band.shape[0]
    out = np.zeros((size, size))
    for i in range(size):
        low, high = max(0, i - HALF), min(size, i + HALF + 1)
        out[i, low:high] = band[i, HALF + low - i : HALF + high - i]
    return out


def blocks(parts: np.ndarray) -> np.ndarray:
    """Nodal blocks (N+1, 3, 3) as a full matrix."""
    size = 3 * parts.shape[0]
    out = np.zeros((size, size), dtype=parts.dtype)
    for i, part in enumerate(parts):
        out[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = part
    return out


def order(sizes: Any, errors: Any) -> float:
    """Slope of log error over log size."""
    return float(np.polyfit(np.log(np.asarray(sizes, float)), np.log(np.abs(np.asarray(errors, float))), 1)[0])
