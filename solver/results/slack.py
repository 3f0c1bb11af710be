"""Slack lines in the outcome: how long in the time domain, and where a linear answer does not hold (L17)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..forces import axial
from ..model.line import LineModel
from ..model.slack import push_limits, pushed, slack_elements
from .solved import Solved

if TYPE_CHECKING:
    from .time import TimeResult

Array = np.ndarray


def time_slack(result: TimeResult, name: str) -> dict[str, float]:
    """Share of the kept time, mean over the seeds, that the worst element is slack, and where it is.

    Where none ever is, the place is that of the least tension.
    """
    share = result.elements("slack", name).mean(axis=-1)
    least = result.elements("lowest", name).min(axis=-1)
    worst = int(np.argmax(share)) if share.max() > 0.0 else int(np.argmin(least))
    arc = result.head["lines"][result.line(name)[0]]["arc_length"]
    return {"share": float(share[worst]), "arc_length": float(arc[worst])}


def time_slack_warnings(result: TimeResult) -> list[str]:
    """Lines that go slack, and lines that push beyond their Euler load."""
    out = []
    for line in result.head["lines"]:
        name = line["name"]
        found = time_slack(result, name)
        least = result.elements("lowest", name).min(axis=-1)
        if found["share"] > 0.0 and any(load is None for load in line["push_limits"]):
            out.append(
                f"line {name!r}, {found['arc_length']:.4g} m from end a: the line is slack (axial force at most 0) for "
                f"{100 * found['share']:.3g} % of the time; when it tightens again the peak of tension may depend on the "
                "elements: compare with elements of half the length"
            )
        most = float(result.elements("highest", name).max())
        worst = pushed(line["push_limits"], least, most, line["arc_length"])
        if worst is not None:
            out.append(worst.sentence(name, "in the time domain"))
    return out


def linear_warnings(solved: Solved, lines: dict[str, Any]) -> list[str]:
    """Where the linear answer of the frequency domain does not hold. lines : the summary's `frequency_domain.lines`."""
    out = []
    for line, shape in zip(solved.lines, solved.static.state.shapes, strict=True):
        mean, own = axial.tension(line.arrays, shape), lines[line.name]
        if solved.is_random:
            hours = float(solved.frequency.spec.storm_duration) / 3600.0  # type: ignore[union-attr]
            swing, word = np.array(own["tension_most_probable_max"]) - mean, f"most probable maximum in {hours:.3g} h"
        else:
            swing, word = np.array(own["tension_amplitude"]), "amplitude"
        out += [*_static_slack(line, mean), *_goes_slack(line, mean, swing, word)]
        found = pushed(push_limits(line.arrays), mean - swing, float(mean.max()), line.element_arc.tolist())
        if found is not None:
            out.append(found.sentence(line.name, f"with the {word} of the frequency domain"))
    return out


def _static_slack(line: LineModel, mean: Array) -> list[str]:
    slack = slack_elements(line.arrays, mean)
    if not slack.any():
        return []
    places = line.element_arc[slack]
    return [
        f"line {line.name!r}: {int(slack.sum())} of {mean.size} elements, between {places.min():.4g} m and "
        f"{places.max():.4g} m from end a, are slack in static equilibrium; the linearised answer of the frequency domain "
        "does not hold for this line: use the time domain"
    ]


def _goes_slack(line: LineModel, mean: Array, swing: Array, word: str) -> list[str]:
    """Taut in the mean, and slack under the dynamic part: the element for which that is worst."""
    short = np.where((mean > 0.0) & np.isfinite(line.arrays.limit), swing - mean, -np.inf)
    worst = int(np.argmax(short))
    if not short[worst] > 0.0:
        return []
    return [
        f"line {line.name!r}, {line.element_arc[worst]:.4g} m from end a: the mean tension, {mean[worst] / 1e3:.3g} kN, is "
        f"below the {word} of its dynamic part, {swing[worst] / 1e3:.3g} kN; the line goes slack there, which the frequency "
        "domain does not see: use the time domain"
    ]
