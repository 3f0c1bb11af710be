"""The answer first: how far the vessel moves, what the lines carry, which periods it has."""

from __future__ import annotations

import math
from typing import Any

import dash_mantine_components as dmc

from frontend.components.cards import figure_card
from frontend.components.tables import table
from frontend.format import DOFS, MISSING, dof_unit, number, percent, seconds
from frontend.results import Results

FIRST_MODES = 6


def applies(results: Results) -> bool:
    return True


def render(results: Results) -> list[Any]:
    summary = results.summary
    if not summary:
        return [dmc.Text("This run left no results. The case is under “Case and provenance”.", c="dimmed")]
    tables = [vessel_table(summary), lines_table(summary), modes_table(summary)]
    domains = domains_table(summary)  # too wide for half a page
    return [
        dmc.SimpleGrid(cards(summary), cols={"base": 2, "sm": 3, "lg": 5}, spacing="sm", mb="lg", className="sd-cards"),
        dmc.SimpleGrid([t for t in tables if t is not None], cols={"base": 1, "lg": 2}, spacing="xl"),
        *([dmc.Box(domains, mt="xl", maw=980)] if domains else []),
    ]


def _frequency_lines(summary: dict[str, Any]) -> dict[str, Any]:
    return (summary.get("frequency_domain") or {}).get("lines") or {}


def _static_lines(summary: dict[str, Any]) -> dict[str, Any]:
    return (summary.get("statics") or {}).get("lines") or {}


def _total(line: dict[str, Any]) -> list[float]:
    """Total σ of tension along a line: both bands are independent."""
    spread = line.get("tension_std") or {}
    wf, lf = spread.get("wf") or [], spread.get("lf") or []
    if not wf or not lf:
        return list(wf or lf)
    return [math.hypot(a, b) for a, b in zip(wf, lf, strict=False)]


def _peak(values: list[float] | None) -> tuple[float | None, int]:
    if not values:
        return None, 0
    index = max(range(len(values)), key=values.__getitem__)
    return values[index], index


def _kilo(value: float | None) -> str:
    return MISSING if value is None else number(value / 1e3)


def _kn(value: float | None) -> str:
    return f"{_kilo(value)} kN"


def _worst(lines: dict[str, Any], values: Any, with_ends: bool) -> tuple[float | None, str]:
    """The largest value over all lines, and where: line and arc length. with_ends : of tension itself, ends included."""
    best: tuple[float | None, str] = (None, "")
    for name, line in lines.items():
        peak, index = _peak(values(line))
        arc = line.get("arc_length") or []
        place = arc[index] if peak is not None and index < len(arc) else None
        if with_ends and line.get("largest"):
            peak, place = line["largest"]["tension"], line["largest"]["arc_length"]
        if peak is not None and (best[0] is None or peak > best[0]):
            best = (peak, f"{name}, {number(place)} m from end a" if place is not None else name)
    return best


def _largest_of(line: dict[str, Any], values: list[float] | None) -> list[float] | None:
    """The largest tension of a line with its ends, or what stands along it in an older summary."""
    return [line["largest"]["tension"]] if line.get("largest") else values


def cards(summary: dict[str, Any]) -> list[Any]:
    made = []
    position = ((summary.get("statics") or {}).get("vessel") or {}).get("position")
    if position:
        offset = f"{number(math.hypot(position[0], position[1]))} m"
        made.append(figure_card("Static offset", offset, "horizontal, from the design position"))
    static, dynamic = _static_lines(summary), _frequency_lines(summary)
    candidates = (
        ("Largest static tension", static, lambda line: line.get("tension"), True),
        ("Largest σ of tension", dynamic, _total, False),
        ("Largest tension amplitude", dynamic, lambda line: line.get("tension_amplitude"), False),
        ("Most probable max. tension", dynamic, lambda line: line.get("tension_most_probable_max"), True),
    )
    for label, lines, values, with_ends in candidates:
        value, where = _worst(lines, values, with_ends)
        if value is not None:
            made.append(figure_card(label, _kn(value), where))
    used = {name: line["utilisation"] for name, line in (dynamic or static).items() if line.get("utilisation")}
    if used:
        worst = max(used, key=used.__getitem__)
        made.append(figure_card("Largest utilisation", percent(used[worst]), f"{worst}, of the breaking load"))
    modes = summary.get("modes") or []
    if modes:
        first = max(modes, key=lambda mode: mode.get("period") or 0.0)
        made.append(figure_card("Longest natural period", f"{number(first['period'])} s", first.get("label", "")))
    return made


def vessel_table(summary: dict[str, Any]) -> Any:
    """Static displacement and σ in both bands (or the amplitude in a regular wave), metres and degrees."""
    position = ((summary.get("statics") or {}).get("vessel") or {}).get("position")
    analysis = summary.get("frequency_domain") or {}
    spread = analysis.get("vessel_std") or {}
    amplitude = analysis.get("vessel_amplitude") or {}
    probable = (analysis.get("vessel_most_probable_max") or {}).get("combined") or {}
    columns: dict[str, dict[str, Any]] = {}
    if position:
        columns["static"] = dict(zip(DOFS, position, strict=True))
    if spread:
        wf, lf = spread.get("wf") or {}, spread.get("lf") or {}
        total = {dof: math.hypot(wf.get(dof) or 0.0, lf.get(dof) or 0.0) for dof in DOFS}
        columns |= {"σ WF": wf, "σ LF": lf, "σ total": total}
    columns |= {"amplitude": amplitude} if amplitude else {}
    columns |= {"probable max.": probable} if probable else {}
    if not columns:
        return None
    rows = []
    for dof in DOFS:
        unit, factor = dof_unit(dof)
        values = (column.get(dof) for column in columns.values())
        rows.append([f"{dof} [{unit}]", *(MISSING if v is None else number(v * factor) for v in values)])
    return table("Vessel motion", ["Motion", *columns], rows, min_width=420, note=_storm(summary, bool(probable)))


def domains_table(summary: dict[str, Any], caption: str = "σ of motion, domains side by side") -> Any:
    """σ of motion from both domains, side by side; None without a time domain."""
    time = summary.get("time_domain") or {}
    spread, error = time.get("vessel_std") or {}, time.get("vessel_std_error") or {}
    analysis = summary.get("frequency_domain") or {}
    linear = analysis.get("vessel_std") or {}
    same = (analysis.get("same_waves") or {}).get("vessel_std") or {}
    if not spread:
        return None
    head = ["Motion", "time domain"] + (["frequency domain", "FD/TD"] if linear else [])
    head += ["same waves", "same waves/TD"] if same else []
    rows = []
    for band in ("wf", "lf"):
        for dof in DOFS:
            unit, factor = dof_unit(dof)
            timed, wide = ((found.get(band) or {}).get(dof) for found in (spread, error))
            if timed is None:
                continue
            row = [
                f"{dof} {band.upper()} [{unit}]",
                _scattered(timed * factor, None if wide is None else wide * factor),
            ]
            for found in (linear, same):
                if found:
                    value = (found.get(band) or {}).get(dof)
                    row += [MISSING if value is None else number(value * factor), _share(value, timed)]
            rows.append(row)
    count = time.get("realisations") or 1
    words = f"{count} seed{'s' if count != 1 else ''} of {seconds(time.get('duration'))}; ± is the standard error."
    if same:
        words += " Same waves: the frequency domain's response to the very waves of these seeds."
    return table(caption, head, rows, min_width=680, note=words)


def _scattered(value: float, error: float | None) -> str:
    known = error is not None and math.isfinite(error) and error > 0
    return f"{number(value)} ± {number(error, 2)}" if known else number(value)


def _share(value: float | None, of: float) -> str:
    return percent(value / of) if value is not None and of > 1e-12 else MISSING


def _storm(summary: dict[str, Any], shown: bool) -> str | None:
    length = (summary.get("frequency_domain") or {}).get("storm_duration")
    if not shown or not length:
        return None
    return (
        f"Most probable maxima in {seconds(length)}: motions from the static position, tensions with the static part."
    )


def lines_table(summary: dict[str, Any]) -> Any:
    """Per line, the largest along it, in kN."""
    static, dynamic = _static_lines(summary), _frequency_lines(summary)
    names = list(dict.fromkeys([*static, *dynamic]))

    def along(lines: dict[str, Any], values: Any) -> list[float | None]:
        return [_peak(values(lines.get(name) or {}))[0] for name in names]

    columns = {
        "static": along(static, lambda line: _largest_of(line, line.get("tension"))),
        "σ WF": along(dynamic, lambda line: (line.get("tension_std") or {}).get("wf")),
        "σ LF": along(dynamic, lambda line: (line.get("tension_std") or {}).get("lf")),
        "σ total": along(dynamic, _total),
        "amplitude": along(dynamic, lambda line: line.get("tension_amplitude")),
        "probable max.": along(dynamic, lambda line: _largest_of(line, line.get("tension_most_probable_max"))),
    }
    columns = {title: values for title, values in columns.items() if any(v is not None for v in values)}
    if not columns:
        return None
    rows = [[name, *(_kilo(values[i]) for values in columns.values())] for i, name in enumerate(names)]
    several = max((line.get("multiplicity") or 1 for line in static.values()), default=1) > 1
    words = "Per single line; each name here stands for several equal lines." if several else None
    return table("Largest tension along each line [kN]", ["Line", *columns], rows, min_width=460, note=words)


def modes_table(summary: dict[str, Any]) -> Any:
    modes = summary.get("modes") or []
    if not modes:
        return None
    rows = [
        [f"{i}  {m.get('label', '')}", number(m.get("period"), 4), percent(m.get("damping_vessel")),
         percent(m.get("damping_lines"))]
        for i, m in enumerate(modes[:FIRST_MODES], start=1)
    ]  # fmt: skip
    return table("Natural periods", ["Mode", "period [s]", "damping, vessel", "damping, lines"], rows)
