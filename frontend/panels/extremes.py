"""The largest tension of every seed: its distribution, and what it says beside the frequency domain's estimate."""

from __future__ import annotations

import math
from typing import Any

from frontend.components.cards import picture
from frontend.components.tables import table
from frontend.figures.extremes import fractile, gumbel, paper
from frontend.format import MISSING, number, percent, seconds
from frontend.results import Results

FEWEST = 3  # seeds below which a distribution says nothing
HEAD = ("Line", "seeds", "mean", "σ", "most probable", "90 %", "TD in the storm", "FD in the storm", "FD/TD")


def per_seed(results: Results) -> dict[str, list[float]]:
    """Largest reaction at end b of each seed, by line [kN]."""
    lines = (results.summary.get("time_domain") or {}).get("lines") or {}
    found = {name: [value / 1e3 for value in line.get("end_b_max_per_seed") or []] for name, line in lines.items()}
    return {name: values for name, values in found.items() if len(values) >= FEWEST and max(values) > min(values)}


def render(results: Results, response: str) -> list[Any]:
    """Nothing with fewer seeds than say something; `response` chooses the line drawn."""
    held = per_seed(results)
    if not held:
        return []
    line = response if response in held else next(iter(held))
    title = f"Largest tension at end b per seed, {line}"
    drawn = picture(title, paper(held[line], "largest tension", "kN"), f"extremes-{line}")
    return [distribution(results, held), drawn]


def distribution(results: Results, held: dict[str, list[float]]) -> Any:
    """Numbers of every line, beside the frequency domain's most probable maximum (its storm, its static part included)."""
    summary = results.summary
    linear = (summary.get("frequency_domain") or {}).get("lines") or {}
    record = (summary.get("time_domain") or {}).get("duration")
    storm = (summary.get("frequency_domain") or {}).get("storm_duration")
    rows = []
    for name, values in held.items():
        location, scale = gumbel(values)
        tops = (linear.get(name) or {}).get("tension_most_probable_max") or []
        probable = tops[-1] / 1e3 if tops else None
        mean = sum(values) / len(values)
        spread = (sum((value - mean) ** 2 for value in values) / (len(values) - 1)) ** 0.5
        longer = location + scale * math.log(storm / record) if storm and record else None
        beside = [MISSING if value is None else number(value, 4) for value in (longer, probable)]
        beside.append(percent(probable / longer) if probable and longer else MISSING)
        rows.append([name, str(len(values)), number(mean, 4), number(spread), number(location, 4),
                     number(fractile(location, scale, 0.9), 4), *beside])  # fmt: skip
    words = f"Of one record of {seconds(record)}: Gumbel's distribution by moments."
    if storm:
        words += (
            f" In the storm of {seconds(storm)}: the time domain's moved by σ√6/π ln(storm/record), which takes records for "
            "independent; the frequency domain's at the element next to end b."
        )
    return table("Distribution of the largest tension at end b [kN]", HEAD, rows, min_width=720, note=words)
