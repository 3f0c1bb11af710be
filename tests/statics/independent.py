"""Equilibrium checked without the solver's kernels: forces of docs/theory.md written anew, on the shapes that were found.

Element constants come from the case; from the solver come shapes, vessel position, found lengths and anchors, the bed's
transition, the vessel's hydrostatic stiffness and its constant loads.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from solver.case.case import Case
from solver.model.build import Model
from solver.model.line import LineModel
from solver.statics.solve import StaticState

Array = np.ndarray


def residuals(model: Model, static: StaticState) -> dict[str, float]:
    """Largest residuals as shares of what acts.

    nodes : force on an inner node over the largest tension of all lines (round-off of positions taken off); vessel : force and
    moment / 30 m over the sum of line tensions and constant loads; fairleads : distance from node to fairlead [m].
    """
    case, position, tension, worst = model.case, static.state.position, [], 0.0
    loads = np.zeros(6)
    turn = Rotation.from_rotvec(position[3:])
    apart = 0.0
    for line, x in zip(static.lines, static.state.shapes, strict=True):
        F, T, bit = nodal_forces(case, model.frame, line, x)
        tension.append(float(np.abs(T).max()))
        worst = max(worst, float(np.abs(F[1:-1]).max()) - bit)
        for end, node in ((line.end_a, 0), (line.end_b, -1)):
            if end.kind == "fairlead":
                arm = turn.apply(end.arm)
                apart = max(apart, float(np.abs(static.body.cg + position[:3] + arm - x[node]).max()))
                loads += line.multiplicity * np.concatenate([F[node], np.cross(arm, F[node])])
    out = {"nodes": worst / max(*tension, 1.0), "fairleads": apart}
    if static.body is not None:
        out["vessel"] = _vessel(model, static, loads) / (sum(tension) + float(np.abs(static.body.constant[:3]).max()))
    return out


def impossible(data: dict[str, Any]) -> str | None:
    """The line whose wanted pretension no radius of the anchor gives, proved from the plain case; None where there is none.

    The elastic catenary with its anchor straight below the fairlead has the least tension there: the weight of what hangs
    (docs/theory.md, S17). The stretch is taken at the wanted tension all along, which shortens what hangs.
    """
    water, depth = data["environment"]["water"], data["environment"]["depth"]
    for name, line in data["lines"].items():
        wanted = line["end_a"]["anchor"].get("pretension")
        kinds = [data["line_types"][segment["type"]] for segment in line["segments"]]
        area = [0.25 * np.pi * kind["diameter"] ** 2 for kind in kinds]
        weight = [water["gravity"] * (kind["mass"] - water["density"] * A) for kind, A in zip(kinds, area, strict=True)]
        floats = any(one["line"] == name for one in data["attachments"]) or min(weight) < 0.0
        if wanted is None or floats or any(segment["length"] == "find" for segment in line["segments"]):
            continue
        left = (depth + line["end_b"]["fairlead"][2]) / (1.0 + wanted / min(kind["EA"] for kind in kinds))
        hung = 0.0
        for segment, w in zip(reversed(line["segments"]), reversed(weight), strict=True):
            part = min(segment["length"], left)
            hung, left = hung + w * part, left - part
        if hung > wanted:
            return str(name)
    return None


def _vessel(model: Model, static: StaticState, lines: Array) -> float:
    """Residual on the vessel [N]: constant loads, drift, lines, and hydrostatics turned with the yaw."""
    s = static.state.position
    R = np.zeros((6, 6))
    R[:3, :3] = R[3:, 3:] = Rotation.from_euler("z", s[5]).as_matrix()
    K = R @ (static.body.hydrostatic + static.body.extra) @ R.T
    r = static.body.constant + model.mean_drift(float(s[5])) + lines - K @ s
    return float(max(np.abs(r[:3]).max(), np.abs(r[3:]).max() / 30.0))


def nodal_forces(case: Case, frame: float, line: LineModel, x: Array) -> tuple[Array, Array, float]:
    """Forces on the nodes (N+1, 3) [N], element tensions (N,) [N], and what the last bits of positions can make [N]."""
    e = _elements(case, line)
    d = np.diff(x, axis=0)
    length = np.sqrt(np.einsum("ij,ij->i", d, d))
    t = d / length[:, None]
    T = _tension(case, e, length)
    F = np.zeros_like(x)
    F[:-1] += T[:, None] * t
    F[1:] -= T[:, None] * t
    F += _bending(e, t, length)
    wet_a, wet_b = _wet(x[:-1, 2], x[1:, 2], e["D"]), _wet(x[1:, 2], x[:-1, 2], e["D"])
    F[:-1, 2] += 0.5 * (wet_a * e["lift"] - e["weight"])
    F[1:, 2] += 0.5 * (wet_b * e["lift"] - e["weight"])
    V = _current(case, frame, x[:, 2])
    F[:-1] += wet_a[:, None] * _drag(case, e, V[:-1], t)
    F[1:] += wet_b[:, None] * _drag(case, e, V[1:], t)
    F += _attachments(case, line, e, x, V)
    F[:, 2] += _bed(case, e, x[:, 2])
    return F, T, float(8.0 * np.spacing(np.abs(x).max()) * (e["EA"] / e["L"]).max())


def _elements(case: Case, line: LineModel) -> dict[str, Array]:
    """Constants of the elements from the case; the length of a segment marked `find` is the solver's."""
    keys: dict[str, list[float]] = {name: [] for name in ("L", "EA", "EI", "D", "m", "cn", "ct", "pushes")}
    known = sum(float(s.length) for s in line.spec.segments if s.length != "find")
    for segment in line.spec.segments:
        kind = case.line_types[segment.type]
        length = line.length - known if segment.length == "find" else float(segment.length)
        count = segment.elements or int(np.ceil(length / segment.element_length - 1e-9))
        row: Any = (length / count, kind.EA, kind.EI, kind.diameter, kind.mass, kind.drag.normal, kind.drag.tangential,
                    float(kind.compression == "allowed"))  # fmt: skip
        for name, value in zip(keys, row, strict=True):
            keys[name] += [value] * count
    e = {name: np.array(values, float) for name, values in keys.items()}
    water = case.environment.water
    e["weight"] = e["m"] * water.gravity * e["L"]
    e["lift"] = water.density * water.gravity * 0.25 * np.pi * e["D"] ** 2 * e["L"]
    return e


def _bed(case: Case, e: dict[str, Array], z: Array) -> Array:
    """L13, L19, L20: none at the held ends."""
    shared = lambda values: 0.5 * (np.append(values, 0.0) + np.append(0.0, values))  # noqa: E731
    seabed = case.environment.seabed
    area = shared(e["L"] * e["D"])
    a1 = area * (100e3 if seabed.soil is None else seabed.soil)
    if seabed.node_stiffness is not None:
        a1 = np.full(z.size, float(seabed.node_stiffness))
    resting = np.maximum(shared(e["weight"] - e["lift"]), 0.0) / a1
    own = np.maximum(resting, 0.5 * area / shared(e["L"]))
    transition = own if seabed.transition is None else np.full(z.size, float(seabed.transition))
    with np.errstate(divide="ignore"):
        lower = np.where(resting > 0, -0.5 * transition * np.log(1.0 - np.exp(-2.0 * resting / transition)), 0.0)
    height = z + case.environment.depth + lower
    force = 0.5 * a1 * transition * np.logaddexp(0.0, -2.0 * height / transition)
    force[[0, -1]] = 0.0
    return np.asarray(force)


def _tension(case: Case, e: dict[str, Array], length: Array) -> Array:
    """L17, L18."""
    strain = length / e["L"] - 1.0
    euler = np.where(e["pushes"] > 0, np.inf, np.pi**2 * e["EI"] / e["L"] ** 2)
    per_length = np.maximum(np.abs(e["weight"] - e["lift"]), 0.05 * e["weight"]) / e["L"]
    knee = np.minimum(0.25e-3 * per_length * min(case.environment.depth, e["L"].sum()) / e["EA"], 0.01)
    y = np.maximum(-strain - euler / e["EA"], 0.0)
    u = np.minimum(y / (2.0 * knee), 1.0)
    return e["EA"] * (strain + (1.0 - knee) * (y - knee * u * (2.0 - u)))


def _bending(e: dict[str, Array], t: Array, length: Array) -> Array:
    """The moment at a node as couples of forces across the two elements (L3)."""
    F = np.zeros((t.shape[0] + 1, 3))
    for i in range(1, t.shape[0]):
        if e["EI"][i - 1] == 0.0 or e["EI"][i] == 0.0:
            continue
        axis = np.cross(t[i - 1], t[i])
        sine = float(np.linalg.norm(axis))
        if sine == 0.0:
            continue
        spring = 2.0 / (e["L"][i - 1] / e["EI"][i - 1] + e["L"][i] / e["EI"][i])
        moment = spring * np.arctan2(sine, float(t[i - 1] @ t[i])) * axis / sine
        before, after = np.cross(moment, t[i - 1]) / length[i - 1], np.cross(moment, t[i]) / length[i]
        F[i - 1] -= before
        F[i + 1] -= after
        F[i] += before + after
    return F


def _wet(z: Array, other: Array, D: Array) -> Array:
    """Wet share of the half elements at nodes of height z (L7)."""
    middle = 0.5 * (z + other)
    low, high = np.minimum(z, middle), np.maximum(z, middle)
    more = np.maximum(0.5 * (D - (high - low)), 0.0)
    return np.clip((more - low) / (high - low + 2.0 * more), 0.0, 1.0)


def _current(case: Case, frame: float, z: Array) -> Array:
    current = case.environment.current
    if current is None:
        return np.zeros((z.size, 3))
    speed = np.interp(-z, current.depths, current.speeds)
    angle = float(current.direction) - frame
    return speed[:, None] * np.array([np.cos(angle), np.sin(angle), 0.0])


def _drag(case: Case, e: dict[str, Array], V: Array, t: Array) -> Array:
    """Drag of half elements (L8)."""
    along = np.einsum("ij,ij->i", V, t)
    across = V - along[:, None] * t
    size = np.linalg.norm(across, axis=1)
    half = 0.25 * case.environment.water.density * e["L"] * e["D"]
    return (half * e["cn"] * size)[:, None] * across + (half * e["ct"] * np.abs(along) * along)[:, None] * t


def _attachments(case: Case, line: LineModel, e: dict[str, Array], x: Array, V: Array) -> Array:
    """Weight, buoyancy and drag of what hangs on the line (L6, L8), wet as a sphere goes under (L7)."""
    F = np.zeros_like(x)
    arc = np.append(0.0, np.cumsum(e["L"]))
    water = case.environment.water
    volume = np.zeros(x.shape[0])
    places = [int(np.argmin(np.abs(arc - item.arc_length))) for item in case.attachments]
    for item, i in zip(case.attachments, places, strict=True):
        volume[i] += item.volume if item.line == line.name else 0.0
    for item, i in zip(case.attachments, places, strict=True):
        if item.line != line.name:
            continue
        radius = max((0.75 * volume[i] / np.pi) ** (1 / 3), 1e-3)
        wet = float(np.clip(0.5 - 0.5 * x[i, 2] / radius, 0.0, 1.0))
        F[i, 2] += water.gravity * (wet * water.density * item.volume - item.mass)
        F[i] += wet * 0.5 * water.density * item.drag_area * np.linalg.norm(V[i]) * V[i]
    return F
