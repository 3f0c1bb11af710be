"""Home: the runs of the project, newest first, one server-side page at a time, live."""

from __future__ import annotations

from typing import Any

import dash_ag_grid as dag
import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, State, ctx, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components.attributes import hyphened
from frontend.components.links import button_link
from frontend.components.messages import empty, refusal
from frontend.components.shell import notice
from frontend.theme import STATE_COLOUR

PAGE_SIZE = 25
ALL = "all"
COLUMNS: list[dict[str, Any]] = [
    {"field": "case_name", "headerName": "Run", "cellRenderer": "RunLink", "flex": 2, "minWidth": 120,
     "cellClass": "sd-wrap"},
    {"field": "state", "headerName": "State", "cellRenderer": "RunState", "width": 190, "minWidth": 110},
    {"field": "analyses", "headerName": "Analyses", "valueFormatter": {"function": "runAnalyses(params)"},
     "flex": 2, "minWidth": 200, "sortable": False},
    {"field": "created_at", "headerName": "Created", "valueFormatter": {"function": "runMoment(params)"},
     "width": 185},
    {"colId": "duration", "headerName": "Duration", "valueGetter": {"function": "runSeconds(params)"},
     "valueFormatter": {"function": "runDuration(params)"}, "width": 120},
    {"colId": "action", "headerName": "", "cellRenderer": "RunAction", "width": 96, "minWidth": 80,
     "sortable": False,
     "resizable": False},
]  # fmt: skip


def layout(**_: Any) -> Any:
    states = [{"value": ALL, "label": "All states"}] + [{"value": s, "label": s} for s in STATE_COLOUR]
    return dmc.Stack(
        [
            dcc.Store(id="runs-refresh", data=0),
            dcc.Store(id="runs-trail", data=[None]),
            dcc.Store(id="runs-asked"),
            dmc.Group(
                [
                    dmc.Title("Runs", order=1),
                    dmc.Group(
                        [
                            dmc.Select(
                                id="runs-state", data=states, value=ALL, allowDeselect=False, w=140,
                                **hyphened(aria_label="State"),
                            ),
                            button_link("New run", "/new"),
                        ],
                        gap="sm",
                    ),
                ],
                justify="space-between",
            ),
            html.Div(
                [
                    html.Div(id="runs-error"),
                    html.Div(id="runs-empty"),
                    html.Div(_grid(), id="runs-box", style={"display": "none"}),
                ]
            ),
            _confirm(),
        ],
        id="runs-page",
        gap="md",
    )  # fmt: skip


def _grid() -> list[Any]:
    grid = dag.AgGrid(
        id="runs-grid",
        rowData=[],
        columnDefs=COLUMNS,
        getRowId="params.data.id",
        defaultColDef={"sortable": True, "resizable": True, "suppressMovable": True},
        dashGridOptions={
            "domLayout": "autoHeight",
            "rowHeight": 46,
            "theme": {"function": "runsTheme(themeQuartz)"},
            "suppressCellFocus": False,
            "animateRows": False,
            "tooltipShowDelay": 300,
        },
        style={"width": "100%"},
    )
    pager = dmc.Group(
        [
            dmc.Text(id="runs-total", size="sm", c="dimmed"),
            dmc.Group(
                [
                    dmc.Button("Newer", id="runs-newer", variant="default", size="xs", disabled=True),
                    dmc.Button("Older", id="runs-older", variant="default", size="xs", disabled=True),
                ],
                gap="xs",
            ),
        ],
        justify="space-between",
        mt="sm",
    )
    return [grid, pager]


def _confirm() -> dmc.Modal:
    return dmc.Modal(
        [
            dmc.Text("Its results go with it. The case stays.", size="sm"),
            dmc.Group(
                [
                    dmc.Button("Keep", id="runs-keep", variant="default"),
                    dmc.Button("Delete", id="runs-delete", color="red"),
                ],
                justify="flex-end",
                mt="md",
            ),
        ],
        id="runs-confirm",
        title="Delete this run?",
        centered=True,
    )


def register(app: Dash) -> None:
    app.clientside_callback(
        ClientsideFunction("slowdrift", "openRuns"), Output("runs-page", "data-live"), Input("runs-page", "id")
    )
    app.clientside_callback(
        ClientsideFunction("slowdrift", "fitRuns"), Output("runs-page", "data-fit"), Input("runs-box", "style")
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
        Input("runs-state", "value"),
        Input("runs-newer", "n_clicks"),
        Input("runs-older", "n_clicks"),
        State("runs-trail", "data"),
    )(show)
    app.callback(
        Output("runs-asked", "data"),
        Output("runs-confirm", "opened"),
        Output("notices", "sendNotifications"),
        Input("runs-grid", "cellRendererData"),
        prevent_initial_call=True,
    )(act)
    app.callback(
        Output("runs-confirm", "opened", allow_duplicate=True),
        Output("runs-refresh", "data"),
        Output("notices", "sendNotifications", allow_duplicate=True),
        Input("runs-delete", "n_clicks"),
        Input("runs-keep", "n_clicks"),
        State("runs-asked", "data"),
        State("runs-refresh", "data"),
        prevent_initial_call=True,
    )(delete)


def show(_refresh: int, state: str, _newer: int | None, _older: int | None, trail: list[str | None]) -> tuple[Any, ...]:
    """One page. `trail` holds the cursors walked so far: the last one is this page's, and one more leads on."""
    asked = ctx.triggered_id
    if asked == "runs-state":
        trail = [None]
    elif asked == "runs-newer" and len(trail) > 2:
        trail = trail[:-2]
    elif asked != "runs-older" and len(trail) > 1:
        trail = trail[:-1]
    wanted = None if state == ALL else state
    page, error = attempt(lambda: client().get("/runs", limit=PAGE_SIZE, cursor=trail[-1], state=wanted))
    if error:
        return no_update, no_update, "", True, True, None, {"display": "none"}, refusal(error)
    items, following = page["items"], page.get("next_cursor")
    first = len(trail) == 1
    walked = [*trail, following]  # always one longer than the pages shown
    hint = None if items or not first else nothing(state)
    style = {"display": "none"} if hint else {}
    return items, walked, _count(page.get("total"), len(items)), first, following is None, hint, style, None


def _count(total: int | None, here: int) -> str:
    if total is None:
        return f"{here} runs"
    return f"{total} run{'s' if total != 1 else ''}" + (f", {here} on this page" if total > here else "")


def nothing(state: str) -> Any:
    if state != ALL:
        return dmc.Text(f"No run is {state}.", c="dimmed")
    return empty(
        "No runs yet",
        "A run computes one case: where the vessel settles, how it moves in waves and in slow drift, and what its "
        "mooring lines carry. Start from an example; it takes a few seconds.",
        button_link("Start from an example", "/new"),
    )


def act(clicked: dict[str, Any] | None) -> tuple[Any, ...]:
    """A row's button: cancel at once, delete only after a question."""
    value = (clicked or {}).get("value") or {}
    if value.get("action") == "delete":
        return value["id"], True, no_update
    if value.get("action") == "cancel":
        _, error = attempt(lambda: client().post(f"/runs/{value['id']}/cancel"))
        text = notice("Not cancelled", error.text, "red") if error else notice("Cancelling", "The run stops shortly.")
        return no_update, no_update, text
    return no_update, no_update, no_update


def delete(_delete: int | None, _keep: int | None, run_id: str | None, refresh: int) -> tuple[Any, ...]:
    if ctx.triggered_id != "runs-delete" or not run_id:
        return False, no_update, no_update
    _, error = attempt(lambda: client().delete(f"/runs/{run_id}"))
    if error:
        return False, no_update, notice("Not deleted", error.text, "red")
    return False, refresh + 1, notice("Run deleted")
