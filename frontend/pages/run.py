"""One run: its state as it goes, and, when it has ended, what came out, tab by tab."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ALL, ClientsideFunction, Dash, Input, Output, State, dcc, html, no_update

from frontend import panels
from frontend.client import attempt, client
from frontend.components import messages
from frontend.components.links import button_link, page_path
from frontend.components.shell import notice
from frontend.errors import ApiError
from frontend.pages import run_head
from frontend.panels import history
from frontend.results import Results
from frontend.theme import FINAL

OPTIONS = ("line", "scale", "response", "seed", "motion", "from", "to")


def layout(run_id: str = "", tab: str = "overview", **query: Any) -> Any:
    """`/runs/{run_id}?tab=&line=&scale=&response=&seed=&motion=` opens exactly what was on the screen."""
    options = {name: query[name] for name in OPTIONS if query.get(name)}
    return dmc.Stack(
        [
            dcc.Store(id="run-id", data=run_id),
            dcc.Store(id="run-live"),
            dcc.Store(id="run-phase"),
            dcc.Store(id="run-options", data=options),
            dcc.Store(id="run-drawn"),
            dcc.Store(id="run-address"),
            html.Div([run_head.layout(run_id), html.Div(id="run-messages")]),
            dmc.Tabs(
                [
                    dmc.TabsList(id="run-tab-list", children=tab_list([])),
                    *(dmc.TabsPanel([], value=panel.key) for panel in panels.PANELS),  # what the tabs' ARIA refers to
                ],
                id="run-tabs",
                value=panels.find(tab).key,
                keepMounted=True,
                className="sd-tabs",
            ),
            html.Div(dmc.Skeleton(h=240), id="run-panel", role="tabpanel"),
        ],
        id="run-page",
        gap="md",
    )


def tab_list(shown: list[panels.Panel]) -> list[dmc.TabsTab]:
    return [dmc.TabsTab(panel.label, value=panel.key) for panel in shown or panels.PANELS[:1]]


def register(app: Dash) -> None:
    live = ClientsideFunction
    app.clientside_callback(
        live("slowdrift", "openRun"),
        Output("run-page", "data-live"),
        Input("run-id", "data"),
    )
    app.clientside_callback(
        live("slowdrift", "paintRun"),
        Output("run-badge", "children"),
        Output("run-badge", "className"),
        Output("run-progress", "value"),
        Output("run-progress-text", "children"),
        Output("run-progress-box", "style"),
        Output("run-cancel", "style"),
        Output("run-phase", "data"),
        Input("run-live", "data"),
        State("run-phase", "data"),
        prevent_initial_call=True,
    )
    app.clientside_callback(
        live("slowdrift", "address"),
        Output("run-address", "data"),
        Input("run-tabs", "value"),
        Input("run-options", "data"),
    )
    app.callback(
        Output("run-title", "children"),
        Output("run-facts", "children"),
        Output("run-actions", "children"),
        Output("run-messages", "children"),
        Output("run-tab-list", "children"),
        Input("run-phase", "data"),
        State("run-id", "data"),
        prevent_initial_call=True,
    )(head)
    app.callback(
        Output("run-panel", "children"),
        Output("run-drawn", "data"),
        Input("run-tabs", "value"),
        Input("run-options", "data"),
        Input("run-phase", "data"),
        State("run-id", "data"),
        prevent_initial_call=True,
    )(panel)
    app.callback(
        Output("run-options", "data"),
        Input({"type": "run-option", "name": ALL}, "value"),
        State({"type": "run-option", "name": ALL}, "id"),
        State("run-options", "data"),
        State("run-drawn", "data"),
        prevent_initial_call=True,
    )(choose)
    history.register(app)
    run_head.register_sharing(app, "run")
    app.clientside_callback(
        live("slowdrift", "zoomed"),
        Output("run-page", "data-zoom"),
        Input({"type": "history", "name": ALL}, "relayoutData"),
        State("run-tabs", "value"),
        State("run-options", "data"),
        prevent_initial_call=True,
    )
    app.callback(
        Output("notices", "sendNotifications", allow_duplicate=True),
        Input("run-cancel", "n_clicks"),
        State("run-id", "data"),
        prevent_initial_call=True,
    )(cancel)
    app.callback(
        Output("location", "pathname", allow_duplicate=True),
        Output("notices", "sendNotifications", allow_duplicate=True),
        Input("run-again", "n_clicks"),
        State("run-id", "data"),
        prevent_initial_call=True,
    )(again)


def head(phase: str | None, run_id: str) -> tuple[Any, ...]:
    """Everything above the tabs, and which tabs there are."""
    if not phase:
        return (no_update,) * 5
    results = Results(client(), run_id)
    made, error = attempt(lambda: _head(results))
    return _missing(error) if error else made


def _head(results: Results) -> tuple[Any, ...]:
    run = results.run
    done = run["state"] in FINAL
    summary = results.summary if done else {}
    tabs = panels.available(results) if done else [panels.find("overview"), panels.find("case")]
    return (
        run.get("name") or run.get("case_name") or "Run",
        run_head.facts(run),
        run_head.actions(run, bool(summary)),
        run_head.told(run, summary),
        tab_list(tabs),
    )


def _missing(error: ApiError) -> tuple[Any, ...]:
    title = "No such run" if error.status == 404 else "Run"
    return title, "", button_link("All runs", "/", kind="default"), messages.refusal(error), []


def panel(tab: str, options: dict[str, Any] | None, phase: str | None, run_id: str) -> tuple[Any, Any]:
    """The tab on the screen (only its channels are fetched), and the choices it was drawn with."""
    if not phase or phase == "missing":
        return (None if phase else no_update), no_update
    if phase not in FINAL and tab != "case":
        return dmc.Text("Results appear here when the run has ended.", c="dimmed", py="xl"), no_update
    results = Results(client(), run_id, options or {})

    def draw() -> Any:
        chosen = panels.find(tab)
        return (chosen if chosen.applies(results) else panels.PANELS[0]).render(results)

    drawn, error = attempt(draw)
    return (messages.refusal(error) if error else drawn), results.used


def choose(
    values: list[Any], ids: list[dict[str, str]], options: dict[str, Any] | None, drawn: dict[str, Any] | None
) -> Any:
    """A reader's choice. Controls also report as a panel comes on the screen, with what is drawn: no change."""
    picked = {made["name"]: value for made, value in zip(ids, values, strict=True) if value is not None}
    if all((drawn or {}).get(name) == value for name, value in picked.items()):
        return no_update
    return {**(options or {}), **picked}


def cancel(clicks: int | None, run_id: str) -> Any:
    if not clicks:
        return no_update
    _, error = attempt(lambda: client().post(f"/runs/{run_id}/cancel"))
    return notice("Not cancelled", error.text, "red") if error else notice("Cancelling", "The run stops shortly.")


def again(clicks: int | None, run_id: str) -> tuple[Any, Any]:
    """The same case, data and analyses once more, as a new run."""
    if not clicks:
        return no_update, no_update

    made, error = attempt(lambda: client().post(f"/runs/{run_id}/rerun", {}))
    if error:
        return no_update, notice("Not started", error.text, "red")
    return page_path(f"/runs/{made['id']}"), no_update
