"""Wave forces: Haskind's relation, limit and phase of long waves, headings and frequencies (Q6)-(Q10), (Q13)."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...waves.dispersion import wave_number
from ..data import HydrodynamicData
from ..data.interpolate import TURN, spans_circle
from ..scale import arm, floors
from .judgement import Array, Check, judge, pair, percent, skipped
from .radiation import off_the_line

HASKIND = 0.05  # of the peak of the damping
LONG_WAVE = 0.10  # of the hydrostatic stiffness
LONG = 0.15  # wave number times the size of the hull: what counts as a long wave
SHORT = 1.0  # wave number times the horizontal size: above it the phase of the force is no proof
IN_PHASE = 0.5  # correlation of the horizontal force with the water's acceleration
WIDE = math.radians(45.0)  # between headings
ROUGH = 0.16  # of the peak: a value less the line between its neighbours; a line to each errs by a quarter of it


def force_checks(data: HydrodynamicData) -> Iterator[Check]:
    yield _haskind(data)
    yield _headings(data)
    yield _excitation_spacing(data)
    yield _stiffness(data)


def group_velocity(omega: Array, k: Array, depth: float) -> Array:
    """dω/dk [m/s] of waves (W1)."""
    with np.errstate(over="ignore"):
        kd = np.minimum(k * depth, 300.0)
    return np.asarray(0.5 * omega / k * (1.0 + 2.0 * kd / np.sinh(2.0 * kd)))


def _haskind(data: HydrodynamicData) -> Check:
    """(Q6) B_ii = k/(8πρg c_g) ∫|X_i|² dβ, where the headings resolve the integral.

    It ties frequencies, headings, forces and damping together, so that a wrong ULEN or density shows.
    """
    if not spans_circle(data.headings) or data.headings.size < 4:
        return skipped(
            "haskind", f"{data.name}: the headings do not go round the circle, which Haskind's relation needs"
        )
    k = np.asarray(wave_number(data.omega, data.depth, data.gravity))
    factor = k / (8 * math.pi * data.density * data.gravity * group_velocity(data.omega, k, data.depth))
    width = 0.5 * (np.roll(data.headings, -1) - np.roll(data.headings, 1)) % math.pi
    power = np.abs(data.excitation) ** 2
    whole = factor[:, None] * np.einsum("h,whi->wi", width, power)
    half = factor[:, None] * np.einsum("h,whi->wi", _every_other(data.headings), power)
    damping = np.diagonal(data.damping, axis1=1, axis2=2)
    peak = damping.max(axis=0)
    active = peak > 1e-4 * np.array([*[peak[:3].max()] * 3, *[peak[3:].max()] * 3])
    resolved = np.abs(whole - half) <= 0.01 * np.maximum(peak, 1e-300)
    # a later agreement of both sums by chance is no proof: only frequencies below the first that is not resolved
    resolved = np.logical_and.accumulate(resolved, axis=0) & active
    seen = resolved & (np.maximum(damping, whole) > 0)
    if not seen.any() or max(float(np.where(seen, part, 0).max()) for part in (damping, whole)) == 0:
        return skipped("haskind", f"{data.name}: the headings are too few to integrate the forces over them")
    reach = np.where(seen, np.maximum(damping, whole), 0.0).max(axis=0)
    gap = np.where(seen, np.abs(whole - damping), 0.0) / np.maximum(np.maximum(reach, 0.05 * peak), 1e-300)
    w, i = np.unravel_index(int(gap.argmax()), gap.shape)
    text = (
        f"damping of {pair(i, i)} at {data.omega[w]:.4g} rad/s is {damping[w, i]:.4g}, Haskind's relation gives "
        f"{whole[w, i]:.4g} from the wave forces: {percent(gap[w, i])} of the peak (threshold {percent(HASKIND)})"
    )
    bad = (
        f"{data.name}: {text}; check ULEN, density and gravity, whether periods, frequencies or wave numbers are listed, "
        f"and the reference point; or refine the mesh"
    )
    return judge("haskind", float(gap[w, i]), HASKIND, f"{data.name}: {text}", bad)


def _every_other(headings: Array) -> Array:
    """Weights of the integral over every second heading, twice and averaged where they are odd in number."""
    weights = np.zeros(headings.size)
    for start in (0,) if headings.size % 2 == 0 else (0, 1):
        chosen = np.arange(start, headings.size, 2)
        angles = headings[chosen]
        gaps = np.diff(np.concatenate([angles, [angles[0] + TURN]]))
        weights[chosen] += 0.5 * (gaps + np.roll(gaps, 1)) / (1 if headings.size % 2 == 0 else 2)
    return weights


def long_waves(data: HydrodynamicData) -> Check:
    """(Q7) The heave force of the longest wave against C33."""
    stiffness = data.hydrostatic_stiffness
    if stiffness is None or stiffness[2, 2] <= 0:
        return skipped(
            "long-wave", f"{data.name}: no hydrostatic stiffness to compare the heave force of long waves with"
        )
    gyration = math.sqrt(abs(data.added_mass[0, 4, 4] / (data.added_mass[0, 2, 2] or 1.0)))  # of the water that moves
    length = max(math.sqrt(stiffness[2, 2] / (data.density * data.gravity)), 3.0 * gyration)
    k = float(np.asarray(wave_number(data.omega[:1], data.depth, data.gravity))[0])
    if k * length > LONG:
        return skipped(
            "long-wave", f"{data.name}: the lowest frequency, {data.omega[0]:.4g} rad/s, is no long wave for this hull"
        )
    force = float(np.abs(data.excitation[0, :, 2]).max())
    gap = abs(force / stiffness[2, 2] - 1.0)
    text = (
        f"the heave force at {data.omega[0]:.4g} rad/s is {force:.4g} N/m, the hydrostatic stiffness {stiffness[2, 2]:.4g} "
        f"N/m: {percent(gap)} apart (threshold {percent(LONG_WAVE)})"
    )
    bad = f"{data.name}: {text}; the files differ in ULEN, density or run"
    return judge("long-wave", gap, LONG_WAVE, f"{data.name}: {text}", bad)


def phase(data: HydrodynamicData) -> Check:
    """(Q13) The horizontal force of the longest wave against the acceleration of the water: phase and heading."""
    name = "phase"
    peak = np.abs(np.diagonal(data.added_mass, axis1=1, axis2=2)).max(axis=0)
    sides, plane = float(max(peak[0], peak[1])), data.hydrostatic_stiffness
    size = 3.0 * math.sqrt(float(peak[5]) / sides) if sides > 0 else 0.0
    if plane is not None:
        size = max(size, math.sqrt(max(float(plane[2, 2]), 0.0) / (data.density * data.gravity)))
    k = float(np.asarray(wave_number(data.omega[:1], data.depth, data.gravity))[0])
    if k * size > SHORT:
        return skipped(
            name, f"{data.name}: the lowest frequency, {data.omega[0]:.4g} rad/s, is no long wave for this hull"
        )
    force, heading = data.excitation[0, :, :2], data.headings
    along = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    least = floors(np.abs(data.excitation[0]).max(axis=0), arm(data))[:2]
    size2, share = np.sum(np.abs(force) ** 2, axis=0), np.sum(along**2, axis=0)
    seen = (np.abs(force).max(axis=0) > least) & (share > 1e-9)
    if not seen.any():
        return skipped(name, f"{data.name}: there is no horizontal wave force at the lowest frequency")
    each = np.sum(force.imag * along, axis=0)[seen] / np.sqrt(size2 * share)[seen]
    value = float(np.sum(each * share[seen]) / np.sum(share[seen]))
    text = (
        f"the horizontal wave force at {data.omega[0]:.4g} rad/s and the acceleration of the water have a correlation of "
        f"{value:.2g} over the headings (threshold {IN_PHASE:g})"
    )
    bad = (
        f"{data.name}: {text}; either the forces are in the time factor e^(-iωt), and their conjugates are wanted, or headings "
        f"are those that waves come from, and 180 deg have to be added"
    )
    return judge(name, -value, -IN_PHASE, f"{data.name}: {text}", bad)


def _headings(data: HydrodynamicData) -> Check:
    """(Q8)"""
    degrees = np.degrees(data.headings)
    if not spans_circle(data.headings):
        text = (
            f"{degrees.size} headings from {degrees[0]:.4g} to {degrees[-1]:.4g} deg do not go round the circle: waves "
            f"from elsewhere, or a vessel that yaws out of them, will be refused"
        )
        return Check("headings", "warning", f"{data.name}: {text}; compute the whole circle at steps of 45 deg or less")
    gaps = np.diff(np.concatenate([data.headings, [data.headings[0] + TURN]]))
    text = f"the headings are up to {math.degrees(gaps.max()):.4g} deg apart (threshold {math.degrees(WIDE):.4g} deg)"
    bad = f"{data.name}: {text}; forces between them are linear; compute finer headings"
    return judge("headings", float(gaps.max()), WIDE * (1 + 1e-9), f"{data.name}: {text}", bad)


def _excitation_spacing(data: HydrodynamicData) -> Check:
    """(Q9)"""
    name = "excitation-spacing"
    if data.omega.size < 5:
        return skipped(name, f"{data.name}: {data.omega.size} frequencies are too few to judge their spacing")
    worst = (0.0, 0, 0, 0)
    peak = np.abs(data.excitation).max(axis=(0, 1))
    least = floors(peak, arm(data))
    scale = np.maximum(np.maximum(peak, 0.01 * np.repeat(peak.reshape(2, 3).max(axis=1), 3)), least)
    for i in np.flatnonzero(peak > least):
        for h in range(data.headings.size):
            values = data.excitation[:, h, i]
            gap = np.abs(off_the_line(data.omega, values)) * np.abs(values).max() / scale[i]
            if gap.max() > worst[0]:
                worst = (float(gap.max()), int(gap.argmax()) + 1, h, int(i))
    value, w, h, mode = worst
    step = float(data.omega[min(w + 1, data.omega.size - 1)] - data.omega[w - 1]) / 2
    text = (
        f"the wave force of {pair(mode, mode)} at heading {np.degrees(data.headings[h]):.4g} deg bends by {percent(value)} of "
        f"its peak within one step of {step:.3g} rad/s near {data.omega[w]:.4g} rad/s (threshold {percent(ROUGH)})"
    )
    bad = f"{data.name}: {text}; forces between frequencies are linear: compute finer steps there"
    return judge(name, value, ROUGH, f"{data.name}: {text}", bad)


def _stiffness(data: HydrodynamicData) -> Check:
    """(Q10)"""
    matrix = data.hydrostatic_stiffness
    if matrix is None:
        return skipped("stiffness", f"{data.name}: there is no hydrostatic stiffness; the case must give it")
    block = matrix[2:5, 2:5]
    size = np.abs(np.diag(matrix))
    peak = np.sqrt(np.maximum(size, floors(size, arm(data) ** 2)))[2:5]
    gap = np.abs(block - block.T) / np.maximum(np.outer(peak, peak), 1e-300)
    i, j = np.unravel_index(int(gap.argmax()), gap.shape)
    text = (
        f"the hydrostatic stiffness of {pair(min(i, j) + 2, max(i, j) + 2)} differs from its transpose by "
        f"{percent(gap.max())} of √(ii·jj) (threshold 1 %)"
    )
    return judge("stiffness", float(gap.max()), 0.01, f"{data.name}: {text}", f"{data.name}: {text}; check the file")
