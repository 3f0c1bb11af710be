"""Tension and bending along the lines: dynamic of one line by band, static and dynamic of all lines together."""

from __future__ import annotations

from typing import Any

from frontend.components.cards import grid, picture
from frontend.components.options import bar, pick_line
from frontend.figures.lines import bands_along, domains_along, lines_along
from frontend.results import Results

BANDS = {"tension_std_wf": "wf", "tension_std_lf": "lf", "tension_std": "total"}
# channel, its name in a picture ({measure}: σ in a random sea, amplitude in a regular one), drawn from zero
TOGETHER = (
    ("frequency/line/{line}/tension_amplitude", "{measure} of tension", True),
    ("frequency/line/{line}/tension_std", "{measure} of tension, all lines", True),
    ("static/line/{line}/tension", "static tension", False),
    ("static/line/{line}/bending_moment", "static bending moment", False),
    ("frequency/line/{line}/bending_moment_std", "{measure} of bending moment", True),
    ("frequency/line/{line}/curvature_std", "{measure} of curvature", True),
)
MOST = 12  # lines drawn together; more would be a tangle


def applies(results: Results) -> bool:
    return bool(results.lines)


def render(results: Results) -> list[Any]:
    drawn = []
    line = results.option("line", results.lines)
    found = results.channels(f"frequency/line/{line}/{quantity}" for quantity in BANDS)
    bands = {BANDS[name.rsplit("/", 1)[1]]: channel for name, channel in found.items()}
    if bands:
        drawn.append(picture(f"σ of tension, {line}", bands_along("σ of tension", bands), "tension-std-bands"))
    both = domains(results, line) if line else None
    if both:
        drawn.append(both)
    harmonic = any(name.endswith("/tension_amplitude") for name in results.names)
    for pattern, named, zero in TOGETHER:
        channels = results.per_line(pattern)
        if not channels or (len(channels) < 2 and pattern.endswith("/tension_std")):
            continue
        title = named.format(measure="amplitude" if harmonic else "σ")
        kept = dict(list(channels.items())[:MOST])
        note = f"The first {MOST} of {len(channels)} lines." if len(channels) > MOST else None
        drawn.append(picture(_sentence(title), lines_along(title.split(",")[0], kept, zero), pattern, note))
    controls = [bar(pick_line(results.lines, line))] if (bands or both) and len(results.lines) > 1 else []
    return [*controls, grid(drawn)]


def domains(results: Results, line: str) -> Any:
    """Both domains' dynamic tension in one picture; None without a time domain."""
    frequency, time = f"frequency/line/{line}", f"time/line/{line}"
    regular = f"{time}/tension_first_harmonic" in results.names
    wanted = (
        {
            f"{frequency}/tension_amplitude": "frequency domain",
            f"{time}/tension_first_harmonic": "time domain, first harmonic",
        }
        if regular
        else {f"{frequency}/tension_std_wf": "frequency domain", f"{time}/tension_std_wf": results.time_domain}
    )
    found = results.channels(wanted)
    curves = {words: found[name] for name, words in wanted.items() if name in found}
    if not any(name.startswith("time/") for name in found):
        return None
    if regular:
        ends = results.channels([f"{time}/tension_max", f"{time}/tension_min"])
        if len(ends) == 2:
            high, low = ends.values()
            half = [0.5 * (a - b) for a, b in zip(high["values"], low["values"], strict=True)]
            curves["time domain, half the range"] = high | {"values": half}
    title = "amplitude of tension" if regular else "σ WF of tension"
    return picture(f"{_sentence(title)}, {line}, domains side by side", domains_along(title, curves), "domains")


def _sentence(title: str) -> str:
    return title[0].upper() + title[1:] if title[0].isascii() else title
