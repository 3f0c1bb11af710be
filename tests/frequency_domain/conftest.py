"""Hydrodynamic data of a small synthetic box, and the coupled case that uses them."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from solver.vessel.data import read_bytes
from tests.systems import Source, moored_box
from tests.vessel.synthetic import dataset, to_bytes


@pytest.fixture(scope="session")
def source(tmp_path_factory: pytest.TempPathFactory) -> Source:
    data = dataset()
    return Source(read_bytes(to_bytes(data, tmp_path_factory.mktemp("data")), "box.nc"))


@pytest.fixture(scope="session")
def mirrored(tmp_path_factory: pytest.TempPathFactory) -> Source:
    """The same box, symmetric about y = 0."""
    data = dataset()
    for name in ("Froude_Krylov_force", "diffraction_force"):
        force = data[name].values
        image = force[:, -np.arange(force.shape[1]) % force.shape[1]]
        data[name] = (data[name].dims, 0.5 * (force + image * np.array([1, -1, 1, -1, 1, -1])))
    return Source(read_bytes(to_bytes(data, tmp_path_factory.mktemp("data")), "box.nc"))


def sea(hs: float = 4.0, tp: float = 9.0, direction: float = 200.0) -> dict[str, Any]:
    return {"spectrum": "jonswap", "hs": hs, "tp": tp, "gamma": 2, "direction": f"{direction} deg"}


BANDS = {"wave": {"from": 0.3, "to": 1.5, "step": 0.08}, "low": {"to": 0.3, "step": 0.02}}


def coupled(seas: list[dict[str, Any]], elements: int = 8, lines: int = 3, **frequency: Any) -> dict[str, Any]:
    """The moored box in random waves, few strips."""
    hydrodynamics = {"data": "box.nc", "radiation": "constant", "frequency": 0.5}
    data = copy.deepcopy(moored_box(elements, lines, mean_drift="exclude", hydrodynamics=hydrodynamics))
    data["vessel"]["damping"] = {"linear": {"surge": 5e4, "sway": 8e4, "yaw": 1e7}}
    data["environment"]["seastates"] = seas
    data["analyses"] = {"frequency_domain": {**copy.deepcopy(BANDS), "tolerance": 1e-6, **frequency}}
    return data
