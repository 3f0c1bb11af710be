"""Whether the steps were short enough for what happened in them: warnings, or a refusal (docs/theory.md, T15-T17)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from ..case.analysis import TimeDomain
from ..kernels.arrays import Watch
from ..model.line import LineModel
from .block import Run

Array = np.ndarray
#: largest second difference of an element's tension from step to step, as a share of its range
KINK_WARNED, KINK_REFUSED = 0.05, 0.3
#: the same where a line that was slack tightens again, which bends tension whatever the step; above it, tension jumps up
#: and down by most of its range from one step to the next
SNATCH_REFUSED = 1.5
#: largest change in a step of the bed's force on a node that strikes it, as a share of that force's range, or of half the
#: line's largest range of tension where that is more
BLOW_REFUSED = 0.06
BLOW = 0.125  # of the line's largest range of tension, and …
HEAVY = 2.5  # … times the node's weight in water: more is a blow, less is lying and lifting
#: error of water velocities at the instantaneous position, as a share of their σ
REACH_WARNED, REACH_REFUSED = 1e-3, 1e-2
MOVES = 0.05  # of the largest range on the line: elements with less are not judged
STILL = 1e-4  # of the largest tension: a line whose range is less does not move


TOLERANCE = float(TimeDomain.model_fields["tolerance"].default)


def is_loose(tolerance: float) -> bool:
    """Whether a tolerance is looser than the default, so that residuals may look like kinks."""
    return tolerance > TOLERANCE * (1 + 1e-9)


class Seen(NamedTuple):
    """Of every line and seed, (…, L, S): extremes and kinks of tension, the bed's forces, how far nodes went."""

    lowest: Array
    highest: Array
    kink: Array
    bed: Array
    reach: Array

    @classmethod
    def of(cls, watch: Watch, lines: int) -> Seen:
        """What a block watched."""
        lowest, highest = by_line(watch.range, lines)
        return cls(lowest, highest, *(by_line(part, lines) for part in (watch.kink, watch.bed, watch.reach)))


def by_line(values: Array, lines: int) -> Array:
    """Lanes (…, Q) as (…, L, S): lines, then seeds."""
    return np.moveaxis(values.reshape(*values.shape[:-1], -1, lines), -2, -1)


@dataclass(frozen=True)
class Finding:
    """One thing that speaks against the step. place : arc length from end a, or the distance gone for `reach` [m]."""

    line: str
    what: Literal["kink", "snatch", "blow", "reach"]
    value: float
    place: float

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)

    @property
    def severity(self) -> float:
        """The value over the limit above which it is refused."""
        limits = {"kink": KINK_REFUSED, "blow": BLOW_REFUSED, "reach": REACH_REFUSED, "snatch": SNATCH_REFUSED}
        return self.value / limits[self.what]

    def fact(self, h: float) -> str:
        """What was found, with the value and the limits."""
        if self.what == "reach":
            return (
                f"line {self.line!r}: a node in waves went {self.place:.3g} m from its static position, where water "
                f"velocities at the instantaneous position are wrong by up to {100 * self.value:.3g} % of their σ "
                f"(refused above {100 * REACH_REFUSED:g} %)"
            )
        where = f"line {self.line!r}, {self.place:.4g} m from end a"
        if self.what == "blow":
            return (
                f"{where}: the node strikes the seabed, whose force on it changes by {100 * self.value:.3g} % of its range "
                f"in a step of {h:g} s (refused above {100 * BLOW_REFUSED:g} %)"
            )
        if self.what == "snatch":
            return (
                f"{where}: the line was slack, and as it tightens tension bends by {100 * self.value:.3g} % of its range "
                f"within a step of {h:g} s (smooth below {100 * KINK_WARNED:g} %, refused above {100 * SNATCH_REFUSED:g} %)"
            )
        return (
            f"{where}: within a step of {h:g} s tension bends by {100 * self.value:.3g} % of its range (smooth below "
            f"{100 * KINK_WARNED:g} %, refused above {100 * KINK_REFUSED:g} %)"
        )

    def sentence(self, h: float, tolerance: float = TOLERANCE) -> str:
        """The fact with what to do about it, for a result that stands. tolerance : the case's."""
        first = (
            f"the default tolerance, {TOLERANCE:g} instead of {tolerance:g}, then with " if is_loose(tolerance) else ""
        )
        advice = {
            "kink": f"; compare with {first}half the step",
            "snatch": "; the largest tension after it can be wrong by tens of per cent: compare with half the step, or use a "
            "wider seabed transition",
            "reach": "; compare with wave_kinematics: mean",
            "blow": "; peaks after such blows vary by several per cent from step to step: compare with half the step, or "
            "use a softer or damped seabed",
        }
        return self.fact(h) + advice[self.what]


def suspect(run: Run, watch: Watch) -> bool:
    """Whether anything may be above an upper limit: a quick bound of what `observed` finds, for use after every stride."""
    with np.errstate(invalid="ignore"):
        spread = watch.range[1] - watch.range[0]
        most = spread.max(axis=0)
        kinks = watch.kink > KINK_REFUSED * np.maximum(spread, MOVES * most)
        blows = watch.bed[3] > 0.5 * BLOW_REFUSED * most
    missed = run.water.missed(float(watch.reach.max(initial=0.0))) if run.water is not None else 0.0
    return bool(kinks.any() or blows.any() or missed > REACH_REFUSED)


SHORTER = "Use a smaller step, a softer seabed with a wider transition, or look for a line that snaps slack there."
HEADS = {
    "kink": "the step is too long", "snatch": "the step is too long", "blow": "the step is too long",
    "reach": "nodes go too far for waves at the instantaneous position",
}  # fmt: skip
REMEDIES = {
    "kink": SHORTER, "snatch": SHORTER, "blow": SHORTER,
    "reach": "Use wave_kinematics: mean, or check the motion that carries the nodes so far.",
}  # fmt: skip


def observed(run: Run, seen: Seen) -> list[Finding]:
    """What is above a lower limit, the worst of each kind for every line."""
    out: list[Finding] = []
    for index, line in enumerate(run.static.lines):
        of_line = Seen(*(part[..., index, :] for part in seen))
        here = [*_kinks(line, of_line), *_blows(line, of_line)]
        if index in run.turned:  # the march counts it from its other end
            here = [replace(one, place=line.length - one.place) for one in here]
        out += [*here, *_reaches(run, line, of_line)]
    return out


def worst(found: list[dict[str, Any]]) -> list[Finding]:
    """The worst of each kind for every line, out of those of many chunks."""
    out: dict[tuple[str, str], Finding] = {}
    for one in (Finding(**values) for values in found):
        key = (one.line, one.what)
        if key not in out or one.value > out[key].value:
            out[key] = one
    return list(out.values())


def _kinks(line: LineModel, seen: Seen) -> Iterator[Finding]:
    """Second differences of tension against its range, element by element and seed by seed (T16).

    A seed in which the line gives way (L17) has them whatever the step, when it tightens again: a snatch, with its own limit.
    """
    gap = seen.kink.shape[0] - (line.nodes - 1)
    spread = seen.highest[gap:] - seen.lowest[gap:]
    judged = _moving(line, seen)[gap:]
    ratio = np.where(judged, seen.kink[gap:] / np.where(judged, spread, 1.0), 0.0)
    gave_way = np.any(seen.lowest[gap:] < -(line.arrays.limit * line.arrays.EA)[:, None], axis=0)
    kinds: tuple[tuple[Literal["kink", "snatch"], Array], ...] = (("kink", ~gave_way), ("snatch", gave_way))
    for what, seeds in kinds:
        worst_of = np.where(seeds, ratio, 0.0).max(axis=1)
        element = int(np.argmax(worst_of))
        if worst_of[element] > KINK_WARNED:
            yield Finding(line.name, what, float(worst_of[element]), float(line.element_arc[element]))


def _moving(line: LineModel, seen: Seen) -> Array:
    """Which elements of which seeds are judged, (N, S)."""
    gap = seen.kink.shape[0] - (line.nodes - 1)
    spread = np.where(np.isfinite(seen.highest), seen.highest - seen.lowest, 0.0)
    spread[:gap] = 0.0
    most = spread.max(axis=0)
    size = np.maximum(np.abs(seen.highest[gap:]), np.abs(seen.lowest[gap:])).max(axis=0)
    return np.asarray((spread > MOVES * most) & (most > STILL * size))


def _blows(line: LineModel, seen: Seen) -> Iterator[Finding]:
    """Changes of the bed's force on nodes that strike it, against that force's range (T17)."""
    gap = seen.bed.shape[1] - line.nodes
    least, most, _last, change = seen.bed[:, gap:]
    weight = np.zeros(line.nodes)
    half = 0.5 * (line.arrays.w_dry - line.arrays.b_wet)
    weight[:-1] += half
    weight[1:] += half
    spread = most - least
    tension = (seen.highest[gap:] - seen.lowest[gap:]).max(axis=0)
    struck = (spread > BLOW * tension) & (most > HEAVY * np.abs(weight)[:, None]) & _moving(line, seen).any(axis=0)
    struck[[0, -1]] = False
    ratio = np.where(struck, change / np.where(struck, np.maximum(spread, 0.5 * tension), 1.0), 0.0)
    node = int(np.argmax(ratio.max(axis=1)))
    if ratio[node].max() > 0.0:
        yield Finding(line.name, "blow", float(ratio[node].max()), float(line.node_arc[node]))


def _reaches(run: Run, line: LineModel, seen: Seen) -> Iterator[Finding]:
    """Error of the water's velocity where nodes went farthest (T15)."""
    reach = float(seen.reach.max(initial=0.0))
    missed = run.water.missed(reach) if run.water is not None else 0.0
    if missed > REACH_WARNED:
        yield Finding(line.name, "reach", missed, reach)
