"""Runs, and both domains of each, side by side: numbers with differences in percent, spectra, tension along a line."""

from __future__ import annotations

from functools import partial
from typing import Any

import dash_mantine_components as dmc
from dash import ALL, ClientsideFunction, Dash, Input, Output, State, dcc, html, no_update

from frontend.client import attempt, client
from frontend.comparison import BANDS, Row, differences, rows
from frontend.components.attributes import hyphened
from frontend.components.cards import grid, picture
from frontend.components.links import page_path
from frontend.components.messages import refusal
from frontend.components.options import bar, pick, pick_line
from frontend.components.tables import table
from frontend.errors import ApiError
from frontend.figures.base import axis_values
from frontend.figures.compare import Curve, along, spectra_of
from frontend.figures.spectra import border
from frontend.format import DOFS, MISSING, moment, number, percent
from frontend.pages import run_head
from frontend.panels.overview import domains_table
from frontend.results import Results

MOST = 6  # runs; more would be a tangle
OFFERED = 100  # newest finished runs in the list
BOTH = (("frequency", "Frequency domain"), ("time", "Time domain"), ("both", "Both"))
ALONG = (
    ("tension", "static tension", "static"),
    ("tension_std_wf", "σ WF of tension", "dynamic"),
    ("tension_std_lf", "σ LF of tension", "dynamic"),
    ("bending_moment_std", "σ of bending moment", "dynamic"),
)


def layout(runs: str = "", **query: Any) -> Any:
    """`/compare?runs=A,B&line=&domain=` opens exactly what was on the screen."""
    chosen = [run for run in runs.split(",") if run][:MOST]
    options = {name: query[name] for name in ("line", "domain") if query.get(name)}
    return dmc.Stack(
        [
            dcc.Store(id="compare-options", data=options),
            dcc.Store(id="compare-drawn"),
            dcc.Store(id="compare-address"),
            dmc.Group(
                [dmc.Title("Compare", order=1), dmc.Group(run_head.sharing("compare"), gap="xs")], justify="space-between"
            ),
            dmc.MultiSelect(
                id="compare-runs", label=f"Runs, two to {MOST}; the first is what the others are compared with",
                data=[{"value": run, "label": run[:8]} for run in chosen], value=chosen, maxValues=MOST, searchable=True,
                clearable=True, placeholder="Choose finished runs", nothingFoundMessage="No finished run of that name",
            ),
            html.Div(dmc.Text("One run shows its two domains on one axis.", c="dimmed"), id="compare-panel"),
        ],
        id="compare-page",
        gap="md",
    )  # fmt: skip


def register(app: Dash) -> None:
    run_head.register_sharing(app, "compare")
    app.callback(
        Output("compare-runs", "data"), Input("compare-page", "id"), State("compare-runs", "value")
    )(offer)  # fmt: skip
    app.callback(
        Output("compare-panel", "children"),
        Output("compare-drawn", "data"),
        Input("compare-runs", "value"),
        Input("compare-options", "data"),
    )(panel)
    app.callback(
        Output("compare-options", "data"),
        Input({"type": "compare-option", "name": ALL}, "value"),
        State({"type": "compare-option", "name": ALL}, "id"),
        State("compare-options", "data"),
        State("compare-drawn", "data"),
        prevent_initial_call=True,
    )(choose)
    app.clientside_callback(
        ClientsideFunction("slowdrift", "compareAddress"),
        Output("compare-address", "data"),
        Input("compare-runs", "value"),
        Input("compare-options", "data"),
    )


def label(run: dict[str, Any]) -> str:
    return f"{run.get('name') or run.get('case_name') or 'Run'} · {moment(run.get('created_at'))[:16]}"


def offer(_page: str, chosen: list[str] | None) -> Any:
    """The newest finished runs, and those chosen already."""
    page, error = attempt(lambda: client().get("/runs", limit=OFFERED, state="succeeded"))
    if error and not chosen:
        return no_update
    items = {run["id"]: run for run in (page or {}).get("items") or []}  # behind a share link: only those it opens
    for run_id in chosen or []:
        if run_id not in items:
            found, _ = attempt(partial(client().get, f"/runs/{run_id}"))
            items[run_id] = found or {"id": run_id, "case_name": f"{run_id[:8]} (not found)"}
    return [{"value": run["id"], "label": label(run)} for run in items.values()]


def choose(
    values: list[Any], ids: list[dict[str, str]], options: dict[str, Any] | None, drawn: dict[str, Any] | None
) -> Any:
    picked = {made["name"]: value for made, value in zip(ids, values, strict=True) if value is not None}
    if all((drawn or {}).get(name) == value for name, value in picked.items()):
        return no_update
    return {**(options or {}), **picked}


def panel(chosen: list[str] | None, options: dict[str, Any] | None) -> tuple[Any, Any]:
    if not chosen:
        return dmc.Text("Choose runs above. One run alone shows its two domains on one axis.", c="dimmed"), {}
    several = [Results(client(), run_id, options or {}) for run_id in chosen[:MOST]]
    drawn, error = attempt(lambda: compare(several))
    return (refusal(error) if error else drawn), several[0].used


def compare(several: list[Results]) -> Any:
    """Everything below the choice of runs. Raises ApiError when a run is not to be had."""
    for results in several:
        if results.run.get("state") != "succeeded" and not results.summary:
            raise ApiError(
                409, "Nothing to compare", f"{label(results.run)} has no results; it is {results.run['state']}."
            )
    names = short_names([results.run for results in several])
    lines = [line for line in several[0].lines if all(line in results.lines for results in several)]
    line = several[0].option("line", lines)
    timed = any(results.summary.get("time_domain") for results in several)
    domain = several[0].option("domain", [key for key, _ in BOTH]) if timed else "frequency"
    controls = [pick_line(lines, line, "compare")] if line else []
    controls += [pick("domain", "Curves from", BOTH, domain or "frequency", "compare")] if timed else []
    domains = ("frequency", "time") if domain == "both" else (domain or "frequency",)
    drawn = [*spectra(several, names, line, domains), *(lines_along(several, names, line, domains) if line else [])]
    parts = [legend(several, names), changed(several, names), bar(*controls), grid(drawn, wide=3)]
    parts += [domains_of(results, name) for results, name in zip(several, names, strict=True)]
    return dmc.Stack([*(part for part in parts if part is not None), *tables(several, names)], gap="lg")


def domains_of(results: Results, name: str) -> Any:
    """Both domains of one run in numbers; None where it has but one."""
    summary = results.summary
    if not (summary.get("time_domain") and summary.get("frequency_domain")):
        return None
    found = [domains_table(summary, f"{name}: σ of motion, domains side by side"), tension_domains(summary, name)]
    return dmc.SimpleGrid([one for one in found if one is not None], cols={"base": 1, "lg": 2}, spacing="xl")


def tension_domains(summary: dict[str, Any], name: str) -> Any:
    """σ of tension at the two ends of every line in both domains, kN, as the frequency domain's share of the other."""
    linear, timed = (summary[key].get("lines") or {} for key in ("frequency_domain", "time_domain"))
    body = []
    for line in linear:
        for band in BANDS:
            pair = [((found.get(line) or {}).get("tension_std") or {}).get(band) for found in (timed, linear)]
            if not all(pair):
                continue
            for end, index in (("end b", -1), ("end a", 0)):
                time, frequency = (values[index] for values in pair if values)
                share = percent(frequency / time) if time else MISSING
                body.append([f"{line} {end} {band.upper()}", number(time / 1e3), number(frequency / 1e3), share])
    head = ["End element [kN]", "time domain", "frequency domain", "FD/TD"]
    return table(f"{name}: σ of tension, domains side by side", head, body, min_width=480) if body else None


def short_names(runs: list[dict[str, Any]]) -> list[str]:
    """A to F with the run's name: a legend has little room."""
    named = [run.get("name") or run.get("case_name") or "run" for run in runs]
    return [f"{letter}: {name}" for letter, name in zip("ABCDEF", named, strict=False)]


def legend(several: list[Results], names: list[str]) -> Any:
    """Which run is which."""
    body = [
        [dcc.Link(name, href=page_path(f"/runs/{results.run_id}")), moment(results.run.get("created_at")),
         ", ".join(results.run.get("analyses") or []).replace("_", " ")]
        for name, results in zip(names, several, strict=True)
    ]  # fmt: skip
    return table("", ["Run", "created", "analyses"], body, min_width=520, words=True)


def changed(several: list[Results], names: list[str]) -> Any:
    """Where the cases differ; None for one run."""
    if len(several) < 2:
        return None
    found = differences([results.case for results in several])
    if not found:
        return dmc.Text("The cases are the same.", size="sm", c="dimmed")
    shown = [[path, *(_said(value) for value in values)] for path, values in found[:60]]
    note = f"The first 60 of {len(found)}; SI units and radians." if len(found) > 60 else "SI units and radians."
    return table("Where the cases differ", ["Value", *(name[0] for name in names)], shown, min_width=420, note=note)


def _said(value: Any) -> str:
    if value is None:
        return MISSING
    if isinstance(value, bool | str):
        return str(value)
    if isinstance(value, int | float):
        return f"{value:.6g}"
    return ", ".join(_said(part) for part in value) if isinstance(value, tuple | list) else str(value)


def _curves(several: list[Results], names: list[str], wanted: dict[str, str]) -> list[Curve]:
    """The channels that exist, by domain of `wanted`."""
    made = []
    for index, results in enumerate(several):
        found = results.channels(wanted.values())
        for domain, name in wanted.items():
            if name in found:
                said = f"{names[index]}, {domain} domain" if len(wanted) > 1 else names[index]
                made.append(Curve(said, index, domain, found[name]))
    return made


def spectra(several: list[Results], names: list[str], line: str | None, domains: tuple[str, ...]) -> list[Any]:
    drawn = []
    wanted = {f"vessel/{dof}": dof.capitalize() for dof in DOFS}
    if line:
        wanted[f"line/{line}/top_tension"] = f"Tension at end b, {line}"
    for path, title in wanted.items():
        channels = {d: f"{d}/{path}" if d == "frequency" else f"{d}/{path}_spectrum" for d in domains}
        curves = _curves(several, names, channels)
        if curves:
            at = border(several[0].case, axis_values(curves[0].channel))
            drawn.append(picture(title, spectra_of(curves, at), f"compare-{path}"))
    return drawn


def lines_along(several: list[Results], names: list[str], line: str, domains: tuple[str, ...]) -> list[Any]:
    drawn = []
    for quantity, title, kind in ALONG:
        wanted = {"static": "static"} if kind == "static" else {d: d for d in domains}
        channels = {d: f"{start}/line/{line}/{quantity}" for d, start in wanted.items()}
        if kind == "static":
            channels = {"frequency": channels["static"]}
        curves = _curves(several, names, channels)
        if curves:
            said = title[0].upper() + title[1:] if title[0].isascii() else title
            drawn.append(picture(f"{said}, {line}", along(title, curves), f"compare-along-{quantity}"))
    return drawn


def tables(several: list[Results], names: list[str]) -> list[Any]:
    """A table per group of numbers: the first run's, then each other's with its difference in percent."""
    found = rows([results.summary for results in several])
    letters = [name[0] for name in names]
    head = [letters[0], *(text for letter in letters[1:] for text in (letter, f"{letter} to {letters[0]}"))]
    made = []
    for group in dict.fromkeys(row.group for row in found):
        body = [_cells(row) for row in found if row.group == group]
        made.append(table(group, ["", *head], body, min_width=200 + 90 * len(head)))
    return [dmc.SimpleGrid(made, cols={"base": 1, "lg": 2}, spacing="xl")] if made else []


def _cells(row: Row) -> list[Any]:
    cells: list[Any] = [f"{row.name} [{row.unit}]", number(row.values[0])]
    for value, change in zip(row.values[1:], row.changes[1:], strict=True):
        cells += [number(value), _signed(change)]
    return cells


def _signed(change: float | None) -> Any:
    if change is None:
        return MISSING
    text = percent(change) if change <= 0 else f"+{percent(change)}"
    return dmc.Text(text, span=True, size="sm", fw=600 if abs(change) >= 0.05 else 400, **hyphened(aria_label=text))
