"""Random moored systems for the sweep of statics: seeded, over the ranges of ordinary moorings.

Each system is a vessel with 4 to 16 lines of one family in 30 to 3000 m of water. Depth, axial stiffness factor (0.1 to
10) and size are drawn evenly in their logarithm; current (0 to 2 m/s), significant wave height (0.1 to 16 m), directions
and shares evenly; the family, both trims and both ways of placing anchors take turns.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from solver.vessel.data import FileSource, HydrodynamicData

KINDS = ("catenary", "taut", "semi-taut", "lazy wave", "steep wave", "buoys")
EXAMPLES = Path(__file__).parents[1] / "examples"
BARGE, BARGE_LENGTH, BARGE_BREADTH = "barge-240x46x10.nc", 240.0, 46.0
RHO, G = 1025.0, 9.80665
Data = dict[str, Any]


def system(index: int, seed: int = 1) -> Data:
    """The case of one system of the sweep, plain data."""
    rng = np.random.default_rng([seed, index])
    kind = KINDS[index % len(KINDS)]
    depth = _log(rng, 30.0, 3000.0)
    factor = _log(rng, 0.1, 10.0)
    length = float(np.clip(_log(rng, 60.0, 320.0) * (depth / 300.0) ** 0.15, 50.0, 350.0))
    hs = float(rng.uniform(0.1, 16.0))
    types = _line_types(rng, length / BARGE_LENGTH, factor)
    lines, attachments = _lines(rng, kind, depth, length, types, pretension=(index // len(KINDS)) % 2 == 0)
    speed = float(rng.uniform(0.0, 2.0))
    return {
        "slowdrift": 1, "name": f"{kind} {index}",
        "environment": {
            "depth": depth, "water": {"density": RHO, "gravity": G},
            "seastates": [{"spectrum": "jonswap", "hs": hs, "tp": 4.0 * math.sqrt(hs) + 3.0, "gamma": 3.3,
                           "direction": _degrees(rng)}],
            "current": {"depths": [0, depth], "speeds": [speed, speed * float(rng.uniform(0.0, 1.0))],
                        "direction": _degrees(rng)},
        },
        "vessel": _vessel(length, "balanced" if (index // (2 * len(KINDS))) % 2 == 0 else "as_given"),
        "line_types": types, "lines": lines, "attachments": attachments, "analyses": {"statics": {}},
    }  # fmt: skip


def kind_of(index: int) -> str:
    return KINDS[index % len(KINDS)]


class ScaledBarge:
    """Data source: the bundled barge, brought to another length by Froude's law."""

    def __init__(self, case: Data):
        name = case["vessel"]["hydrodynamics"]["data"]
        self.scale = float(name.split("-")[1]) / BARGE_LENGTH

    def open(self, _reference: str) -> HydrodynamicData:
        s, data = self.scale, _barge()
        force = np.array([1.0, 1.0, 1.0, s, s, s])
        second = np.outer(force, force)
        return replace(
            data, omega=data.omega / math.sqrt(s), added_mass=data.added_mass * s**3 * second,
            damping=data.damping * s**2.5 * second, excitation=data.excitation * s**2 * force,
            added_mass_zero=data.added_mass_zero * s**3 * second,
            added_mass_infinite=data.added_mass_infinite * s**3 * second, excitation_zero=data.excitation_zero * s**2 * force,
            mean_drift=data.mean_drift * s * force, hydrostatic_stiffness=data.hydrostatic_stiffness * s**2 * second,
            displaced_volume=data.displaced_volume * s**3, centre_of_buoyancy=data.centre_of_buoyancy * s,
            centre_of_mass=data.centre_of_mass * s, reference_point=data.reference_point * s,
        )  # fmt: skip


@cache
def _barge() -> HydrodynamicData:
    return FileSource(EXAMPLES).open(BARGE)


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _degrees(rng: np.random.Generator) -> str:
    return f"{rng.uniform(0.0, 360.0):.2f} deg"


def _vessel(length: float, trim: str) -> Data:
    scale = length / BARGE_LENGTH
    return {
        "mass": RHO * 110400.0 * scale**3, "centre_of_gravity": [0.0, 0.0, 5.0 * scale],
        "radii_of_gyration": [26.0 * scale, 60.0 * scale, 60.0 * scale], "trim": trim,
        "hydrodynamics": {"data": f"barge-{length}", "radiation": "constant", "frequency": 0.8},
    }  # fmt: skip


def _line_types(rng: np.random.Generator, scale: float, factor: float) -> Data:
    """Chain, wire, polyester and riser in sizes that suit the vessel; d is the nominal diameter [m].

    Mass, stiffness and strength over d² are makers' usual values: studless chain R4, spiral strand, polyester.
    """
    d = 0.05 + 0.1 * scale * float(rng.uniform(0.6, 1.2))
    bending = float(rng.uniform()) < 0.5
    wire, rope, pipe = 0.9 * d, 1.6 * d, float(rng.uniform(0.2, 0.4))
    return {
        "chain": {"diameter": 1.8 * d, "mass": 19.9e3 * d**2, "EA": 8.54e10 * d**2 * factor,
                  "drag": {"normal": 1.3, "tangential": 0.6}, "breaking_load": 9.0e8 * d**2},
        "wire": {"diameter": wire, "mass": 5.3e3 * wire**2, "EA": 9.0e10 * wire**2 * factor,
                 "EI": 2.0e8 * wire**4 if bending else 0.0, "drag": {"normal": 1.2}},
        "polyester": {"diameter": rope, "mass": 870.0 * rope**2, "EA": 4.0e9 * rope**2 * factor,
                      "drag": {"normal": 1.2, "tangential": 0.05}},
        "riser": {"diameter": pipe, "mass": 0.25 * math.pi * pipe**2 * RHO * float(rng.uniform(1.3, 2.0)),
                  "EA": 5.0e9 * pipe**2 * factor, "EI": 2.0e6 * pipe**4 * (10.0 if bending else 1.0),
                  "drag": {"normal": 1.1, "tangential": 0.05}},
    }  # fmt: skip


def _lines(
    rng: np.random.Generator, kind: str, depth: float, length: float, types: Data, pretension: bool
) -> tuple[Data, list[Data]]:
    """Lines spread over the circle, or in four groups; risers in a wave hang between mooring lines."""
    count = int(rng.integers(4, 17))
    spread = float(rng.uniform()) < 0.5
    first = float(rng.uniform(0.0, 360.0))
    waves = min(count // 2, count - 3) if "wave" in kind else 0
    moored = count - waves
    mooring = {"lazy wave": "catenary", "steep wave": "semi-taut", "buoys": "catenary"}.get(kind, kind)
    lines: Data = {}
    attachments: list[Data] = []
    shape = _mooring(rng, mooring, depth, types)
    for k in range(moored):
        name = f"m{k}"
        azimuth = (k + 0.5) * 360.0 / moored if spread else _grouped(k, moored)
        if float(rng.uniform()) < 0.15:  # not all lines are alike
            shape = _mooring(rng, mooring, depth, types)
        find = pretension and mooring != "catenary" and float(rng.uniform()) < 0.3
        lines[name] = _placed(shape, azimuth + float(rng.uniform(-5.0, 5.0)), length, pretension, find)
        if kind == "buoys":
            attachments += _attachments(rng, name, shape, depth, types)
    wave = _wave(rng, kind, depth, types) if waves else {}
    for k in range(waves):
        lines[f"r{k}"] = _placed(wave, first + k * 360.0 / waves, length, False)
    return lines, attachments


def _grouped(k: int, count: int) -> float:
    """Azimuth in one of four groups about the diagonals [deg]."""
    group, place = k % 4, k // 4
    in_group = (count - group + 3) // 4
    return 45.0 + 90.0 * group + 5.0 * (place - 0.5 * (in_group - 1))


def _placed(shape: Data, azimuth: float, length: float, pretension: bool, find: bool = False) -> Data:
    """One line with its fairlead on the hull's side where it leads out; find : the polyester's length is sought."""
    breadth = length * BARGE_BREADTH / BARGE_LENGTH
    c, s = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
    reach = min(0.45 * length / max(abs(c), 1e-9), 0.5 * breadth / max(abs(s), 1e-9))
    anchor: Data = {"azimuth": f"{azimuth % 360.0:.3f} deg"}
    if pretension and "pretension" in shape:
        anchor["pretension"] = shape["pretension"]
    else:
        anchor["radius"] = shape["radius"]
    segments = [dict(segment) for segment in shape["segments"]]
    if find:
        anchor["radius"] = shape["radius"]
        next(segment for segment in segments if segment["type"] == "polyester")["length"] = "find"
    return {
        "segments": segments, "end_a": {"anchor": anchor},
        "end_b": {"fairlead": [reach * c, reach * s, -0.06 * length]}, "allow_stretch": True,
    }  # fmt: skip


def _segment(kind: str, length: float, elements: int) -> Data:
    return {"type": kind, "length": length, "elements": elements}


def _wet(kind: Data) -> float:
    """Weight in water [N/m]."""
    return float(G * (kind["mass"] - RHO * 0.25 * math.pi * kind["diameter"] ** 2))


def _mooring(rng: np.random.Generator, kind: str, depth: float, types: Data) -> Data:
    return {"catenary": _catenary, "taut": _taut, "semi-taut": _semi_taut}[kind](rng, depth, types)


def _catenary(rng: np.random.Generator, depth: float, types: Data) -> Data:
    """Chain, or chain with wire above in deep water, some of it on the bed; H and lengths from the catenary."""
    h = depth  # of the fairlead, nearly
    a = _log(rng, 0.2, 1.5) * (1.0 + 60.0 / h)  # horizontal force over weight × depth
    hanging = h * math.sqrt(1.0 + 2.0 * a)
    w = _wet(types["chain"]) if h < 600.0 else _wet(types["wire"])
    grounded = h * float(rng.uniform(0.2, 1.0)) + 50.0
    if h < 600.0:
        segments = [_segment("chain", hanging + grounded, int(rng.integers(25, 70)))]
    else:
        segments = [_segment("chain", grounded, int(rng.integers(8, 20))),
                    _segment("wire", hanging, int(rng.integers(25, 50)))]  # fmt: skip
    flat = a * h * math.acosh(1.0 + 1.0 / a)
    return {"segments": segments, "pretension": w * h * (1.0 + a), "radius": flat + grounded}


def _taut(rng: np.random.Generator, depth: float, types: Data) -> Data:
    """Polyester with a chain at each end, straight but for its sag, tight by 5 to 15 % of the rope's strength."""
    angle = math.radians(float(rng.uniform(30.0, 50.0)))
    chord = depth / math.sin(angle)
    ends = float(rng.uniform(0.02, 0.06)) * chord
    rope = types["polyester"]
    T = float(rng.uniform(0.05, 0.15)) * 1.7e8 * rope["diameter"] ** 2 + 0.3 * _wet(types["chain"]) * ends
    T += _wet(rope) * depth + _wet(types["chain"]) * ends
    slack = 1.0 + T / rope["EA"]
    length = (chord - 2.0 * ends) / slack
    segments = [_segment("chain", ends, int(rng.integers(3, 8))), _segment("polyester", length, int(rng.integers(15, 35))),
                _segment("chain", ends, int(rng.integers(3, 8)))]  # fmt: skip
    return {"segments": segments, "pretension": T, "radius": chord * math.cos(angle)}


def _semi_taut(rng: np.random.Generator, depth: float, types: Data) -> Data:
    """Three to five segments, chain at both ends, 1 to 8 % longer than the chord."""
    count = int(rng.integers(3, 6))
    angle = math.radians(float(rng.uniform(15.0, 40.0)))
    chord = depth / math.sin(angle)
    length = chord * (1.0 + float(rng.uniform(0.01, 0.08)))
    kinds = {3: ["chain", "polyester", "chain"], 4: ["chain", "wire", "polyester", "chain"],
             5: ["chain", "polyester", "chain", "wire", "chain"]}[count]  # fmt: skip
    share = np.array([1.0 if kind == "chain" else 4.0 for kind in kinds]) * rng.uniform(0.7, 1.3, count)
    share /= share.sum()
    segments = [
        _segment(kind, float(part) * length, int(rng.integers(6, 20))) for kind, part in zip(kinds, share, strict=True)
    ]
    hung = sum(_wet(types[kind]) * float(part) for kind, part in zip(kinds, share, strict=True)) * length
    T = hung * float(rng.uniform(0.6, 1.5)) + 0.03 * types["chain"]["breaking_load"]
    return {"segments": segments, "pretension": T, "radius": chord * math.cos(angle)}


def _wave(rng: np.random.Generator, kind: str, depth: float, types: Data) -> Data:
    """A riser with a buoyant length: led along the bed (lazy), or up from its base (steep).

    The buoyant length lifts the riser below it and 0.2 to 0.5 of the depth of the riser above: its hog stays in the water.
    """
    lazy = kind == "lazy wave"
    low = depth * float(rng.uniform(0.6, 1.0) if lazy else rng.uniform(0.2, 0.35))
    hung = depth * float(rng.uniform(0.2, 0.35)) if lazy else low  # below the hog
    buoyant = depth * float(rng.uniform(0.2, 0.4))
    high = depth * float(rng.uniform(0.9, 1.2))
    lift = _wet(types["riser"]) * (hung + depth * float(rng.uniform(0.2, 0.35)))
    D, m = types["riser"]["diameter"], types["riser"]["mass"]  # lift = (buoyancy - mass) g, foam of 500 kg/m3
    area = (lift / (G * buoyant) + m - 500.0 * 0.25 * math.pi * D**2) / (RHO - 500.0)
    types["buoyant"] = {
        **types["riser"], "diameter": math.sqrt(4.0 * area / math.pi), "mass": m + 500.0 * (area - 0.25 * math.pi * D**2),
    }  # fmt: skip
    total = low + buoyant + high
    radius = math.sqrt((0.93 * total) ** 2 - depth**2) * float(rng.uniform(0.6, 0.95))
    counts = rng.integers(10, 25, 3)
    segments = [
        _segment(name, length, int(count))
        for name, length, count in zip(("riser", "buoyant", "riser"), (low, buoyant, high), counts, strict=True)
    ]
    return {"segments": segments, "radius": radius}


def _attachments(rng: np.random.Generator, name: str, shape: Data, depth: float, types: Data) -> list[Data]:
    """One or two of: a buoy that carries part of the hanging weight, a clump weight near the bed."""
    length = sum(segment["length"] for segment in shape["segments"])
    w = _wet(types["chain"]) if depth < 600.0 else _wet(types["wire"])
    lift = float(rng.uniform(0.1, 0.5)) * w * depth
    volume = lift / (0.8 * RHO * G)
    found = [{"line": name, "arc_length": length * float(rng.uniform(0.55, 0.8)), "volume": volume,
              "mass": 0.2 * RHO * volume, "drag_area": 0.5 * volume ** (2.0 / 3.0)}]  # fmt: skip
    if float(rng.uniform()) < 0.5:
        mass = float(rng.uniform(0.05, 0.3)) * w * depth / G
        found.append({"line": name, "arc_length": length * float(rng.uniform(0.25, 0.45)), "volume": mass / 7800.0,
                      "mass": mass, "drag_area": 0.0})  # fmt: skip
    return found
