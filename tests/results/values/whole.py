"""The whole summary of a scene's linear analyses: its parts, line types and provenance."""

from __future__ import annotations

from typing import Any

import numpy as np

from .compare import Close, Holds
from .linear import Raw, frequency, jonswap, statics
from .modes import equivalent, modes
from .scenes import Linear

Array = np.ndarray


def summary(scene: Linear) -> dict[str, Any]:
    raw = Raw(scene)
    asked = list(scene.case.analyses.requested())
    out: dict[str, Any] = {
        "case": scene.case.name, "analyses": asked, "line_types": line_types(raw), "failures": {}, "compile_time": 1.25,
        "warnings": Holds(lambda said: all(isinstance(one, str) for one in said) and len(set(said)) == len(said)),
        "provenance": provenance(raw), "statics": statics(raw), "frequency_domain": frequency(raw),
    }  # fmt: skip
    if raw.modes is not None:
        out["modes"], out["line_coefficients"] = modes(raw), equivalent(raw)
    return out


def line_types(raw: Raw) -> dict[str, Any]:
    out = {}
    for name, kind in raw.case.line_types.items():
        volume, weight = raw.per_metre(kind)
        out[name] = {
            "diameter": kind.diameter, "drag_diameter": kind.diameter, "mass": kind.mass, "volume": volume,
            "weight_in_water": weight, "EA": kind.EA,
        }  # fmt: skip
        if kind.breaking_load is not None:
            out[name]["breaking_load"] = kind.breaking_load
    return out


def provenance(raw: Raw) -> dict[str, Any]:
    case = raw.case
    out: dict[str, Any] = {
        "case_hash": Holds(lambda text: isinstance(text, str) and len(text) == 64 and set(text) <= set("0123456789abcdef")),
        "solver_version": Holds(lambda text: isinstance(text, str) and bool(text)), "seeds": [],
    }  # fmt: skip
    if case.analyses.time_domain is not None:
        first = case.analyses.time_domain.first_seed
        out["seeds"] = [first + k for k in range(case.analyses.time_domain.seeds)]
    if raw.solved.model.data is not None:
        out["data_hash"] = raw.solved.model.data.content_hash
    seas = case.environment.random
    if seas:
        band = case.analyses.frequency_domain.wave
        omega = np.linspace(band.from_, band.to, 200_001)
        inside = [
            4 * np.sqrt(np.trapezoid(jonswap(omega, sea.hs, 2 * np.pi / sea.peak_period, sea.gamma), omega))
            for sea in seas
        ]
        out["seastates"] = [
            {"hs": Close(sea.hs, 1e-5), "hs_in_band": Close(value, 1e-5), "tp": sea.peak_period}
            for sea, value in zip(seas, inside, strict=True)
        ]
        out["hs_in_band"] = Close(np.sqrt(np.sum(np.square(inside))), 1e-5)
        out["tp"] = seas[0].peak_period
    return out
