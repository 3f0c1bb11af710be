"""Modes and equivalent coefficients of a scene by Rayleigh's quotients and dense linear algebra."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.kernels.line import HALF

from .compare import Close
from .linear import DOFS, Raw

Array = np.ndarray


def mode_scales(raw: Raw) -> Array:
    """Largest displacement of a mode: nodes of all lines, translations of the vessel, its rotations at 100 m."""
    out = []
    for k, mode in enumerate(raw.modes.modes):
        sizes = [np.max(np.abs(shape[k])) for shape in raw.modes.shapes]
        if raw.case.vessel is not None:
            sizes += [*np.abs(mode.shape[-6:-3]), *(100 * np.abs(mode.shape[-3:]))]
        out.append(max(sizes))
    return np.array(out)


def _dense(g: Any) -> Array:
    size = g.x.size
    out = np.zeros((size, size))
    for i in range(size):
        for q in range(g.K.shape[1]):
            j = i + q - HALF
            if 0 <= j < size:
                out[i, j] = g.K[i, q]
    return out


def _vessel_at(raw: Raw, omega: float) -> tuple[Array, Array]:
    """Mass with added mass, and damping of the vessel alone, from its dynamic stiffness -ω²M + iωB."""
    quadratic = raw.frequency.linear.vessel
    dynamic = raw.solved.model.vessel.dynamic(np.array([omega]), float(raw.static.position[5]), quadratic)[0]
    return -dynamic.real / omega**2, dynamic.imag / omega


def own_stiffness(raw: Raw) -> tuple[Array, Array]:
    """The vessel's stiffness, and that of the pull of its lines under rotation by differences of the moment r × f."""
    body, position = raw.static.body, raw.static.position
    geometric = np.zeros((6, 6))
    if raw.case.vessel.fairlead_kinematics == "finite":
        for line in raw.static.lines:
            force = raw.static.state.end_forces[raw.names.index(line.name)]
            for row, end in ((0, line.end_b), (3, line.end_a)):
                if end.kind != "fairlead":
                    continue
                f, arm = force[row : row + 3], body.turned_arm(position, end.arm)
                for axis in range(3):
                    turn = np.eye(3)[axis]
                    geometric[3:, 3 + axis] -= line.multiplicity * np.cross(np.cross(turn, arm), f)
    return body.stiffness(position), geometric


def equivalent(raw: Raw) -> dict[str, Any]:
    """M, B, K of lines that follow the vessel quasi-statically: interior solved out of the dense stiffness."""
    M, B, K = (np.zeros((6, 6)) for _ in range(3))
    direct = np.zeros((6, 6))
    result = raw.frequency
    for g, damping, G in zip(result.geometries, result.linear.damping, result.couplings, strict=True):
        full, size = _dense(g), g.x.size
        ends = [*range(size - 3, size), 0, 1, 2]
        inner = list(range(3, size - 3))
        shape = np.zeros((size, 6))
        shape[ends] = np.eye(6)
        shape[inner] = -np.linalg.solve(full[np.ix_(inner, inner)], full[np.ix_(inner, ends)])
        own = shape.reshape(-1, 3, 6)
        n = g.line.multiplicity
        for out, blocks in ((M, g.M), (B, damping)):
            out += n * G.T @ sum(part.T @ block @ part for part, block in zip(own, blocks, strict=True)) @ G
        K += n * G.T @ (full @ shape)[ends] @ G
        direct += n * G.T @ full[np.ix_(ends, ends)] @ G
    stiffness, geometric = own_stiffness(raw)
    whole = stiffness + geometric + direct
    skew = np.abs(whole - whole.T).max() / 2 / np.abs(0.5 * (whole + whole.T)).max()
    return {"inertia": Close(M, 1e-6), "damping": Close(B, 1e-6), "stiffness": Close(K, 1e-5),
            "geometric": Close(geometric, 1e-6), "asymmetry_dropped": Close(skew, 0.02)}  # fmt: skip


def modes(raw: Raw) -> list[dict[str, Any]]:
    """Each mode from its shape alone: ω² = φᵀKφ/φᵀMφ, damping ratios φᵀBφ/(2ω φᵀMφ), shares of φᵀMφ."""
    stiffness, geometric = own_stiffness(raw)
    found = []
    for k, mode in enumerate(raw.modes.modes):
        s = mode.shape[-6:]
        own_mass, own_damping = _vessel_at(raw, mode.omega)
        vessel = s * (0.5 * (own_mass + own_mass.T) @ s)
        mass = damping = 0.0
        spring = s @ (stiffness + geometric) @ s
        for i, (g, drag) in enumerate(zip(raw.frequency.geometries, raw.frequency.linear.damping, strict=True)):
            y, n = raw.modes.shapes[i][k], g.line.multiplicity
            mass += n * sum(one @ block @ one for one, block in zip(y, g.M, strict=True))
            damping += n * sum(one @ block @ one for one, block in zip(y, drag, strict=True))
            spring += n * y.ravel() @ _dense(g) @ y.ravel()
        total = mass + vessel.sum()
        omega = np.sqrt(spring / total)
        found.append({
            "period": Close(2 * np.pi / omega, 1e-4), "damping_vessel": Close(s @ own_damping @ s / (2 * omega * total), 1e-3),
            "damping_lines": Close(damping / (2 * omega * total), 1e-3), "mass_lines": Close(mass / total, 1e-5),
            "label": "line" if mass > vessel.sum() else DOFS[int(np.argmax(vessel))],
        })  # fmt: skip
    return found
