"""Added mass and damping: reciprocity, passivity, Kramers-Kronig, spacing and spikes (Q1)-(Q5)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..data import HydrodynamicData
from ..radiation import Retardation, misfit, retardation
from ..scale import arm, floors
from .judgement import Array, Check, judge, pair, percent, skipped

ASYMMETRY = 0.02  # of √(ii·jj)
NEGATIVE = 0.01  # of the largest scaled damping
CAUSALITY = 0.05  # of the peak of the pair
COARSE = 0.10  # of the peak: what a point differs by from its neighbours' line
SPIKE = 0.05
ALONE = 6.0  # times the median of the neighbourhood


def radiation_checks(data: HydrodynamicData) -> Iterator[Check]:
    yield _reciprocity(data)
    yield _passivity(data)
    yield from _shape(data)


def _reciprocity(data: HydrodynamicData) -> Check:
    """(Q1)"""
    worst, text = 0.0, "added mass and damping are symmetric"
    for what, table in (("added mass", data.added_mass), ("damping", data.damping)):
        peak = np.sqrt(np.abs(np.diagonal(table, axis1=1, axis2=2)).max(axis=0))
        peak = np.maximum(peak, np.sqrt(floors(peak**2, arm(data) ** 2)))
        scale = np.maximum(np.outer(peak, peak), 1e-300)
        gap = np.abs(table - table.transpose(0, 2, 1)) / scale
        if gap.max() > worst:
            w, i, j = np.unravel_index(int(gap.argmax()), gap.shape)
            worst = float(gap.max())
            text = (
                f"{what} of {pair(min(i, j), max(i, j))} differs from its transpose by {percent(worst)} of √(ii·jj) at "
                f"{data.omega[w]:.4g} rad/s (threshold {percent(ASYMMETRY)})"
            )
    return judge(
        "reciprocity",
        worst,
        ASYMMETRY,
        f"{data.name}: {text}",
        f"{data.name}: {text}; the mean is taken; refine the mesh",
    )


def _passivity(data: HydrodynamicData) -> Check:
    """(Q2)"""
    damping = 0.5 * (data.damping + data.damping.transpose(0, 2, 1))
    diagonal = np.diagonal(damping, axis1=1, axis2=2)
    if not np.any(diagonal > 0):
        return skipped("damping", f"{data.name}: there is no damping on the diagonal at any frequency")
    peak = np.abs(diagonal).max(axis=0)
    size = np.sqrt(np.maximum(peak, floors(peak, arm(data) ** 2)))
    scaled = damping / np.outer(size, size)
    least = np.linalg.eigvalsh(scaled)[:, 0]
    w = int(least.argmin())
    diagonal = np.diagonal(scaled, axis1=1, axis2=2)
    dof = int(diagonal[w].argmin())
    where = f"{pair(dof, dof)} is negative" if diagonal[w, dof] < -NEGATIVE else "some motion is negative"
    text = (
        f"damping of {where} at {data.omega[w]:.4g} rad/s: the least eigenvalue is {percent(float(least[w]))} of the peaks"
        f" (threshold -{percent(NEGATIVE)})"
    )
    good = f"{data.name}: damping takes energy out at every frequency (least eigenvalue {percent(float(least[w]))})"
    bad = f"{data.name}: {text}: an irregular frequency, or wrong signs; compute with a lid or a finer mesh"
    return judge("damping", max(-float(least[w]), 0.0), NEGATIVE, good, bad)


def causality(data: HydrodynamicData, high: float) -> Check:
    """(Q3) A(ω) from B(ω) by Kramers and Kronig, up to `high` [rad/s] and over the lower 0.7 of the frequencies."""
    data = data.symmetric()
    if data.omega.size < 8:
        return skipped("kramers-kronig", f"{data.name}: {data.omega.size} frequencies are too few to relate A and B")
    kernel, _ = retardation(data)
    own = Retardation(kernel.times, kernel.kernel, kernel.added_mass_infinite)
    found = misfit(own, data, float(data.omega[0]), min(high, 0.7 * float(data.omega[-1])))
    worst = max(
        ((value, i, j) for (what, i, j), value in found.items() if what == "added mass" and i == j), default=None
    )
    if worst is None:
        return skipped("kramers-kronig", f"{data.name}: there is no added mass to compare")
    value, i, j = worst
    limit = "the file's" if data.added_mass_infinite is not None else "a fitted"
    text = (
        f"added mass of {pair(i, j)} differs by {percent(value)} of its peak from what the damping and {limit} added mass "
        f"at infinite frequency give by Kramers and Kronig (threshold {percent(CAUSALITY)})"
    )
    bad = (
        f"{data.name}: {text}; the data end at {data.omega[-1]:.4g} rad/s: compute higher and finer frequencies, the limit "
        f"at infinite frequency, or look for irregular frequencies"
    )
    return judge("kramers-kronig", value, CAUSALITY, f"{data.name}: {text}", bad)


def _shape(data: HydrodynamicData) -> Iterator[Check]:
    """(Q4), (Q5)"""
    if data.omega.size < 5:
        yield skipped("spacing", f"{data.name}: {data.omega.size} frequencies are too few to judge their spacing")
        yield skipped("spikes", f"{data.name}: {data.omega.size} frequencies are too few to find spikes")
        return
    curves = []
    for what, table in (("added mass", data.added_mass), ("damping", data.damping)):
        peak = np.abs(np.diagonal(table, axis1=1, axis2=2)).max(axis=0)
        for i in np.flatnonzero(peak > floors(peak, arm(data) ** 2)):
            curves.append((f"{what} of {pair(i, i)}", table[:, i, i]))
    coarse, spike = (0.0, "", 0.0), (0.0, "", 0.0)
    for name, values in curves:
        gap = off_the_line(data.omega, values)
        alone = isolated(gap)
        for found, mask in ((coarse, ~alone), (spike, alone)):
            part = np.where(mask, np.abs(gap), 0.0)
            at = int(part.argmax())
            if part[at] > found[0]:
                entry = (float(part[at]), name, float(data.omega[at + 1]))
                coarse, spike = (entry, spike) if found is coarse else (coarse, entry)
    yield _spacing(data, coarse)
    yield _spike(data, spike)


def off_the_line(omega: Array, values: Array) -> Array:
    """Each inner value less that of the straight line between its neighbours, over the largest: (W - 2,)."""
    weight = (omega[1:-1] - omega[:-2]) / (omega[2:] - omega[:-2])
    middle = (1 - weight) * values[:-2] + weight * values[2:]
    return np.asarray((values[1:-1] - middle) / max(float(np.abs(values).max()), 1e-300))


def isolated(gap: Array) -> Array:
    """Where a gap stands alone: far above its neighbourhood, and the other way from both neighbours."""
    size = np.abs(gap)
    wide = np.pad(size, 6, mode="reflect") if size.size > 6 else np.pad(size, 6, mode="edge")
    around = np.array([np.median(np.delete(wide[k : k + 13], [5, 6, 7])) for k in range(size.size)])
    before, after = np.concatenate([[0.0], gap[:-1]]), np.concatenate([gap[1:], [0.0]])
    return np.asarray((size > ALONE * around) & (gap * before <= 0) & (gap * after <= 0))


def _spacing(data: HydrodynamicData, found: tuple[float, str, float]) -> Check:
    value, name, omega = found
    step = float(np.interp(omega, data.omega[:-1], np.diff(data.omega)))
    text = (
        f"{name} bends by {percent(value)} of its peak within one step of {step:.3g} rad/s near {omega:.4g} rad/s "
        f"(threshold {percent(COARSE)})"
    )
    return judge(
        "spacing", value, COARSE, f"{data.name}: {text}",
        f"{data.name}: {text}: the peak may be missed between frequencies; compute steps of about "
        f"{step * np.sqrt(COARSE / max(value, COARSE)):.2g} rad/s there",
    )  # fmt: skip


def _spike(data: HydrodynamicData, found: tuple[float, str, float]) -> Check:
    value, name, omega = found
    if not name:
        return judge("spikes", 0.0, SPIKE, f"{data.name}: no value stands out from its neighbours", "")
    text = (
        f"{name} at {omega:.4g} rad/s stands out from its neighbours by {percent(value)} of the peak "
        f"(threshold {percent(SPIKE)})"
    )
    return judge(
        "spikes", value, SPIKE, f"{data.name}: {text}",
        f"{data.name}: {text}: an irregular frequency or a sharp resonance; compute with a lid, or finer frequencies there",
    )  # fmt: skip
