"""Home: the runs of the project, filtered, sorted and paged by the service, live."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, State, html, no_update

from frontend.client import attempt, client
from frontend.components.links import button_link
from frontend.components.messages import refusal
from frontend.pages import runs_actions, runs_grid


def layout(**query: Any) -> Any:
    """`/?q=&state=&tag=&since=&sort=&study=&pinned=` opens the list as it was."""
    chosen = {name: query[name] for name in runs_grid.FILTERS if query.get(name)}
    return dmc.Stack(
        [
            *runs_grid.stores(chosen),
            dmc.Group(
                [
                    dmc.Title("Runs", order=1),
                    dmc.Group(
                        [
                            dmc.Button("Compare", id="runs-compare", variant="default", disabled=True),
                            button_link("New run", "/new"),
                        ],
                        gap="sm",
                    ),
                ],
                justify="space-between",
            ),
            runs_grid.filter_bar(chosen),
            html.Div(
                [
                    html.Div(id="runs-error"),
                    html.Div(id="runs-empty"),
                    html.Div(runs_grid.grid(), id="runs-box", style={"display": "none"}),
                ]
            ),
            runs_grid.confirm(),
            runs_grid.rename(),
        ],
        id="runs-page",
        gap="md",
    )


def register(app: Dash) -> None:
    live = ClientsideFunction
    app.clientside_callback(live("slowdrift", "openRuns"), Output("runs-page", "data-live"), Input("runs-page", "id"))
    app.clientside_callback(live("slowdrift", "fitRuns"), Output("runs-page", "data-fit"), Input("runs-box", "style"))
    app.clientside_callback(
        live("slowdrift", "filters"),
        Output("runs-filters", "data"),
        *(Input(f"runs-{name}", prop) for name, prop in FIELDS),
        State("runs-filters", "data"),
        prevent_initial_call=True,
    )
    app.clientside_callback(
        live("slowdrift", "comparable"),
        Output("runs-compare", "disabled"),
        Output("runs-compare", "children"),
        Input("runs-grid", "selectedRows"),
        prevent_initial_call=True,
    )
    app.clientside_callback(
        live("slowdrift", "compareRuns"),
        Output("runs-page", "data-compare"),
        Input("runs-compare", "n_clicks"),
        State("runs-grid", "selectedRows"),
        State("prefix", "data"),
        prevent_initial_call=True,
    )
    app.clientside_callback(
        live("slowdrift", "turnPage"),
        Output("runs-at", "data"),
        Input("runs-newer", "n_clicks"),
        Input("runs-older", "n_clicks"),
        Input("runs-filters", "data"),
        State("runs-at", "data"),
        State("runs-trail", "data"),
        prevent_initial_call=True,
    )
    app.callback(
        Output("runs-grid", "rowData"),
        Output("runs-trail", "data"),
        Output("runs-total", "children"),
        Output("runs-newer", "disabled"),
        Output("runs-older", "disabled"),
        Output("runs-empty", "children"),
        Output("runs-box", "style"),
        Output("runs-error", "children"),
        Input("runs-refresh", "data"),
        Input("runs-filters", "data"),
        Input("runs-at", "data"),
        State("runs-trail", "data"),
    )(show)
    runs_actions.register(app)


# filter -> the property that holds it, in the order that assets/grid.js takes them
FIELDS = (
    ("q", "value"),
    ("state", "value"),
    ("tag", "value"),
    ("since", "value"),
    ("sort", "value"),
    ("pinned", "checked"),
)


def show(_refresh: int, chosen: dict[str, Any] | None, at: int, trail: list[str | None]) -> tuple[Any, ...]:
    """Page number `at`. `trail` holds the cursors of the pages walked so far, and of one more where there is one.

    The number is kept apart from what the service answers: an answer may be dropped for a newer question's, as when new
    runs come in while one turns the page.
    """
    here = [None] if at == 0 else trail[: at + 1]
    wanted = runs_grid.asked(chosen or {})
    page, error = attempt(
        lambda: client().get("/runs", limit=runs_grid.PAGE_SIZE, cursor=here[-1], total="true", **wanted)
    )
    if error:
        return no_update, no_update, "", True, True, None, {"display": "none"}, refusal(error)
    items, following = page["items"], page.get("next_cursor")
    first = len(here) == 1
    walked = [*here, following] if following else here
    hint = None if items or not first else runs_grid.nothing(chosen or {})
    style = {"display": "none"} if hint else {}
    return items, walked, runs_grid.count(page.get("total"), len(items)), first, following is None, hint, style, None
