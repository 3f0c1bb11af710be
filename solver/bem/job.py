"""A hydrodynamic job from hull to data set: what it will take, frequency after frequency, and the file in the end."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..outcome import CaseError, FieldError
from ..results.part import OnProgress, Progress
from .body import folded, mirror_planes, need_body
from .geometry import Hull
from .lid import lid_panels
from .output import assemble, drift_and_balance, to_netcdf
from .panels import component_areas, welded
from .quality import doubts, edges_of, measures
from .solve import FrequencySolver, Solved, Wet, lowest_frequency
from .spec import HydrodynamicJob
from .symmetry import Fundamental, fundamental

Array = np.ndarray
LID_FACTOR = 1.5
LID_START = 0.8  # of the first irregular frequency
FIRST_ZERO = 2.404826  # of the Bessel function J0
BASE_MB = 400.0  # of a worker with Capytaine and its tables, before any matrix
ENTRY_SECONDS, FINITE_DEPTH, FLOPS = 4.5e-7, 4.0, 5e9  # of a Green function in deep water; dearer in finite depth
BALANCE = 0.1  # of the scattered power: beyond it, energy is out of balance by more than a mesh should be


@dataclass(frozen=True)
class Estimate:
    """What a job will take."""

    panels: int
    lid_panels: int
    symmetry_planes: int
    memory_mb: float
    solutions: int
    seconds: float
    """Roughly, on one core."""

    def as_dict(self) -> dict[str, Any]:
        return {**vars(self), "memory_mb": round(self.memory_mb), "seconds": float(f"{self.seconds:.2g}")}


@dataclass(frozen=True)
class Made:
    """The file of a finished job in Capytaine's layout, its summary in plain JSON values, and its warnings."""

    payload: bytes
    summary: dict[str, Any]
    warnings: tuple[str, ...]


def wet(job: HydrodynamicJob, hull: Hull) -> Wet:
    """What will be solved: hull and lid cut down to what their planes of symmetry repeat."""
    centre = np.zeros(3) if job.body is None else np.array(job.body.centre_of_gravity)
    part = fundamental(hull.panels, hull.symmetry)
    lid = None
    if job.lid:
        size = job.lid_size or LID_FACTOR * float(hull.panels.edge_lengths.mean())
        lid = lid_panels(edges_of(hull.panels).water_line, size, part.planes)
    water, start = job.water, 0.0
    if lid is not None:
        areas = component_areas(welded(Fundamental(lid, part.planes).whole()))
        if areas.size == 0:  # slivers that collapse when they are welded
            lid = None
        else:
            start = LID_START * irregular_frequency(float(areas.max()), hull.draught, water.gravity)
    return Wet(part.part, lid, part.planes, centre, water.depth_m, water.density, water.gravity, start)


def irregular_frequency(area: float, draught: float, gravity: float) -> float:
    """Below the first irregular frequency [rad/s] of a hull with this water plane: that of a round column of its area.

    ω² = g k coth(k T) with k = 2.405 / R (H12): of all water planes of one area the circle's wave number is the least.
    """
    k = FIRST_ZERO / math.sqrt(area / math.pi)
    return math.sqrt(gravity * k / math.tanh(k * draught))


def estimate(job: HydrodynamicJob, shape: Wet) -> Estimate:
    """Panels, memory and number of solutions. Per unknown n of the part and c copies: S and K (c, n, n), and a system."""
    copies, n = 2 ** len(shape.planes), shape.unknowns
    headings = folded(job.beta(), mirror_planes(shape.planes, shape.centre))[0].size
    solutions = job.omega().size * (6 + headings) + (12 if job.limits else 0)
    memory = BASE_MB + 16.0 * n**2 * (2 * copies + 3) / 2**20
    lid = 0 if shape.lid is None else shape.lid.count * copies
    matrices = job.omega().size + (2 if job.limits else 0)
    entry = ENTRY_SECONDS * (1 if math.isinf(shape.depth) else FINITE_DEPTH)
    seconds = matrices * copies * (n**2 * entry + 8 / 3 * n**3 / FLOPS)
    return Estimate(shape.hull.count * copies, lid, len(shape.planes), memory, solutions, seconds)


def check(job: HydrodynamicJob, hull: Hull, shape: Wet, memory_mb: float) -> None:
    """Refuse what cannot be computed well or fits not. Raises CaseError with the remedy."""
    need_body(job)
    errors = []
    lowest = lowest_frequency(job.water.depth_m, job.water.gravity)
    omega = job.omega()
    if omega.size and omega[0] < lowest:
        message = f"{omega[0]:.4g} rad/s; allowed in {job.water.depth_m:g} m of water: at least {lowest:.3g} rad/s"
        errors.append(FieldError(("frequencies",), message, f"{omega[0]:g}"))
    if edges_of(hull.panels).turned:
        message = "neighbouring panels disagree on which side is out; make the mesh's normals consistent"
        errors.append(FieldError(("geometry",), message))
    if hull.draught >= job.water.depth_m:
        message = f"{job.water.depth_m:g} m; allowed: more than the draught of {hull.draught:g} m"
        errors.append(FieldError(("water", "depth"), message))
    needed = estimate(job, shape)
    if needed.memory_mb > memory_mb:
        share = math.sqrt(max(memory_mb - BASE_MB, 1.0) / (needed.memory_mb - BASE_MB))
        message = (
            f"{needed.panels + needed.lid_panels} panels with {needed.symmetry_planes} planes of symmetry need about "
            f"{needed.memory_mb:.0f} MB; allowed: {memory_mb:.0f} MB, about {share * (needed.panels + needed.lid_panels):.0f} "
            "panels; use larger panels, a mesh with a plane of symmetry, or no lid"
        )
        errors.append(FieldError(("geometry",), message))
    if errors:
        raise CaseError(errors)


def compute(
    job: HydrodynamicJob, hull: Hull, checkpoint: bytes | None = None, on_progress: OnProgress | None = None
) -> Made:
    """Solve every frequency and make the file. `on_progress` is called several times a second and may raise Cancelled."""
    shape = wet(job, hull)
    planes = mirror_planes(shape.planes, shape.centre)
    headings, fold = folded(job.beta(), planes)
    frequencies = [*([0.0] if job.limits else []), *job.omega().tolist(), *([math.inf] if job.limits else [])]
    done = _restored(checkpoint)
    solver = FrequencySolver(shape, headings)
    for index in range(len(done), len(frequencies)):
        omega = frequencies[index]
        note = f"{index + 1} of {len(frequencies)}, {omega:.4g} rad/s"

        def on_share(share: float, words: str, index: int = index, note: str = note) -> None:
            if on_progress is not None:
                at = (index + share) / len(frequencies)
                on_progress(Progress(min(at, 0.999), f"{note}: {words}", lambda: stored(done)))

        done.append(solver.solve(omega, on_share))
    return _finish(job, hull, shape, done, (headings, fold))


def _finish(job: HydrodynamicJob, hull: Hull, shape: Wet, done: list[Solved], fold: Any) -> Made:
    headings, places = fold
    drift, balance = drift_and_balance(job, hull, shape, done, headings)
    payload = to_netcdf(assemble(job, hull, shape, done, places, drift), job)
    found = measures(hull, job)
    warnings = [item.message for item in doubts(hull, job, found)] + _balance_warnings(balance)
    if job.limits and math.isfinite(job.water.depth_m):
        lowest = lowest_frequency(job.water.depth_m, job.water.gravity)
        warnings.append(
            f"zero frequency in finite depth is that of {lowest:.3g} rad/s, the lowest that can be computed; heave added "
            "mass grows on below it with the logarithm of the frequency"
        )
    summary = {"quality": found, "estimate": estimate(job, shape).as_dict(), "energy": balance}
    return Made(payload, summary, tuple(warnings))


def _balance_warnings(balance: dict[str, list[float]]) -> list[str]:
    """The power that a fixed hull takes from the waves must be what it scatters."""
    worst, at = max(zip(balance["imbalance"], balance["omega"], strict=True), default=(0.0, 0.0))
    if worst <= BALANCE:
        return []
    return [
        f"at {at:.4g} rad/s the fixed hull scatters {100 * worst:.1f} % more or less power than it takes from the waves "
        f"(threshold {100 * BALANCE:.0f} %); use smaller panels, or a lid against irregular frequencies"
    ]


# --- checkpoints

_FIELDS = ("added_mass", "damping", "froude_krylov", "diffraction", "waves")


def stored(done: Sequence[Solved]) -> bytes:
    """Solved frequencies as an .npz, to go on from."""
    arrays = {
        f"{index}/{name}": getattr(item, name)
        for index, item in enumerate(done)
        for name in _FIELDS
        if getattr(item, name) is not None
    }
    header = json.dumps([item.omega if math.isfinite(item.omega) else "inf" for item in done]).encode()
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, header=np.frombuffer(header, np.uint8), **arrays)
    return buffer.getvalue()


def _restored(checkpoint: bytes | None) -> list[Solved]:
    if not checkpoint:
        return []
    with np.load(io.BytesIO(checkpoint), allow_pickle=False) as kept:
        omegas = json.loads(kept["header"].tobytes())
        return [Solved(float(omega), **_fields(kept, index)) for index, omega in enumerate(omegas)]


def _fields(kept: Any, index: int) -> dict[str, Any]:
    return {name: kept[f"{index}/{name}"] for name in _FIELDS if f"{index}/{name}" in kept.files}
