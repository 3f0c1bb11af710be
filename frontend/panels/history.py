"""The time domain: a history that shows more of itself where one looks closer, and the extremes of every line."""

from __future__ import annotations

import math
from typing import Any

import dash_mantine_components as dmc
from dash import MATCH, ClientsideFunction, Dash, Input, Output, Patch, State, dcc, no_update

from frontend.client import attempt, client
from frontend.components.cards import picture
from frontend.components.options import bar, pick_response, pick_seed
from frontend.components.tables import table
from frontend.figures.base import axis_values, scaled
from frontend.figures.history import history, seen
from frontend.format import DOFS, MISSING, number, seconds
from frontend.panels import extremes
from frontend.results import Results

POINTS = 2000
LINE = "line:"  # a response is a direction of the vessel, or this and the name of a line
NOTE = "Drag over a stretch of time to see it in detail; a double click shows all of it."
HEAD = (
    "Line", "end b, min.", "end b, max.", "least element", "largest element", "end a, max.", "anchor, up, max.",
    "on the bed, min.",
)  # fmt: skip


def applies(results: Results) -> bool:
    return bool(results.summary.get("time_domain")) and bool(responses(results))


def responses(results: Results) -> dict[str, str]:
    """What there is a history of, and its channel."""
    found = {dof: f"time/vessel/{dof}" for dof in DOFS}
    found |= {f"{LINE}{line}": f"time/line/{line}/end_b_tension" for line in results.lines}
    return {key: name for key, name in found.items() if name in results.names}


def said(response: str) -> str:
    return f"tension at end b, {response.removeprefix(LINE)}" if response.startswith(LINE) else response


def seeds(summary: dict[str, Any]) -> list[str]:
    return [str(seed) for seed in (summary.get("provenance") or {}).get("seeds") or []]


def render(results: Results) -> list[Any]:
    offered = responses(results)
    response = results.option("response", offered) or ""
    seed = results.option("seed", seeds(results.summary))
    span = stretch(results.options)
    view = {"from": span[0], "to": span[1]} if span else {}
    channel = results.channels([offered[response]], points=POINTS, seed=seed, **view)[offered[response]]
    whole = f"{said(response)}, seed {seed}" if seed else said(response)
    drawn = history(channel, said(response).split(",")[0], span=span)
    key = f"{offered[response]}?{seed or ''}"
    card = picture(whole[0].upper() + whole[1:], drawn, key, NOTE, "history")
    controls = [pick_response([(key, said(key)) for key in offered], response)]
    controls += [pick_seed(seeds(results.summary), seed)] if seed else []
    table_of_extremes = extremes_table(results.summary["time_domain"])
    return [
        bar(*controls),
        dmc.Stack(
            [
                dcc.Store(id={"type": "history-look", "name": key}),
                card,
                dmc.Text(told(results.summary), size="sm", c="dimmed"),
                *([table_of_extremes] if table_of_extremes else []),
                *extremes.render(results, response.removeprefix(LINE)),
            ]
        ),
    ]


def stretch(options: dict[str, Any]) -> tuple[float, float] | None:
    """The stretch of time that the address asks for; None for all of it, or for what is none."""
    try:
        low, high = float(options["from"]), float(options["to"])
    except (KeyError, TypeError, ValueError):
        return None
    return (low, high) if math.isfinite(low) and math.isfinite(high) and low < high else None


def told(summary: dict[str, Any]) -> str:
    """How long and how often it was computed."""
    made = summary["time_domain"]
    count = made.get("realisations") or 1
    parts = [f"{count} seed{'s' if count != 1 else ''} of {seconds(made.get('duration'))}"]
    if made.get("build_up"):
        parts[0] += f" after {seconds(made['build_up'])} of build-up"
    if made.get("time_step"):
        parts.append(f"time step {made['time_step']:g} s")
    if made.get("wall_time") is not None:
        parts.append(f"computed in {seconds(made['wall_time'])}")
    return ", ".join(parts) + "."


def extremes_table(made: dict[str, Any]) -> Any:
    """Per line, over all seeds and all time after the build-up: forces in kN, lengths in m."""
    rows = []
    for name, line in (made.get("lines") or {}).items():
        end_b, end_a = line.get("end_b_tension") or {}, line.get("end_a_tension") or {}
        low, high = line.get("tension_min") or [], line.get("tension_max") or []
        forces = (
            end_b.get("min"), end_b.get("max"), min(low, default=None), max(high, default=None), end_a.get("max"),
            (line.get("anchor_vertical") or {}).get("max"),
        )  # fmt: skip
        bed = (line.get("grounded_length") or {}).get("min")
        shown = [MISSING if value is None else number(value / 1e3, 4) for value in forces]
        rows.append([name, *shown, MISSING if bed is None else number(bed, 4)])
    if not rows:
        return None
    words = (
        "Of all seeds. End b, end a: the force on the support. Elements: their axial force, the least and largest along "
        "the line. Anchor, up: largest vertical force of the line on its anchor, up positive."
    )
    return table("Extremes of tension [kN] and length on the bed [m]", HEAD, rows, min_width=760, note=words)


def register(app: Dash) -> None:
    app.clientside_callback(  # a change of size alone must not push aside the question for the finer curve
        ClientsideFunction("slowdrift", "looked"),
        Output({"type": "history-look", "name": MATCH}, "data"),
        Input({"type": "history", "name": MATCH}, "relayoutData"),
        prevent_initial_call=True,
    )
    app.callback(
        Output({"type": "history", "name": MATCH}, "figure"),
        Input({"type": "history-look", "name": MATCH}, "data"),
        State({"type": "history", "name": MATCH}, "id"),
        State("run-id", "data"),
        prevent_initial_call=True,
    )(closer)


def closer(change: dict[str, Any] | None, graph: dict[str, str], run_id: str) -> Any:
    """The stretch of time on the screen once more, from the server, as finely as the picture can show it."""
    span = seen(change)
    if span is None:
        return no_update
    name, _, seed = graph["name"].rpartition("?")
    params: dict[str, Any] = {"points": POINTS, "seed": seed or None}
    if not isinstance(span, str):
        params |= {"from": span[0], "to": span[1]}
    found, error = attempt(lambda: client().channels(run_id, [name], **params))
    channel = (found or {}).get(name)
    if error or not channel or not channel["axes"][0]["values"]:
        return no_update
    patch = Patch()
    patch["data"][0]["x"] = axis_values(channel)
    patch["data"][0]["y"] = scaled(channel)[0]
    whole = isinstance(span, str)
    patch["layout"]["xaxis"]["autorange"] = whole
    patch["layout"]["xaxis"]["range"] = None if whole else list(span)
    patch["layout"]["yaxis"]["autorange"] = True
    return patch
