"""One study: how far it is, its results as curves over what it varies, and as a table."""

from __future__ import annotations

from typing import Any

import dash_ag_grid as dag
import dash_mantine_components as dmc
from dash import ALL, ClientsideFunction, Dash, Input, Output, State, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components.attributes import hyphened
from frontend.components.cards import picture
from frontend.components.links import button_link, page_path, rest
from frontend.components.messages import refusal
from frontend.components.options import option_id
from frontend.components.shell import notice
from frontend.figures.compare import study_curves
from frontend.format import seconds
from frontend.pointers import magnitude, said
from frontend.study_table import Table, fetch, header, quantity, unit

FINAL = ("succeeded", "failed", "cancelled")


def layout(study_id: str = "", **query: Any) -> Any:
    """`/studies/{study_id}?x=&y=` opens exactly what was on the screen."""
    options = {name: query[name] for name in ("x", "y") if query.get(name)}
    return dmc.Stack(
        [
            dcc.Store(id="study-id", data=study_id),
            dcc.Store(id="study-options", data=options),
            dcc.Store(id="study-drawn"),
            dcc.Store(id="study-done", data=-1),
            dcc.Store(id="study-address"),
            dcc.Interval(id="study-tick", interval=2000),
            html.Div(dmc.Skeleton(h=90), id="study-head", **hyphened(aria_live="polite")),
            html.Div(id="study-body"),
        ],
        id="study-page",
        gap="md",
    )


def register(app: Dash) -> None:
    app.callback(
        Output("study-head", "children"), Output("study-done", "data"), Output("study-tick", "disabled"),
        Input("study-tick", "n_intervals"), State("study-id", "data"), State("study-done", "data"),
    )(head)  # fmt: skip
    app.callback(
        Output("study-body", "children"), Output("study-drawn", "data"),
        Input("study-done", "data"), Input("study-options", "data"), State("study-id", "data"),
        prevent_initial_call=True,
    )(body)  # fmt: skip
    app.callback(
        Output("study-options", "data"), Input({"type": "study-option", "name": ALL}, "value"),
        State({"type": "study-option", "name": ALL}, "id"), State("study-options", "data"), State("study-drawn", "data"),
        prevent_initial_call=True,
    )(choose)  # fmt: skip
    app.clientside_callback(
        ClientsideFunction("slowdrift", "compareAddress"), Output("study-address", "data"),
        Input("study-drawn", "id"), Input("study-options", "data"),
    )  # fmt: skip
    app.callback(
        Output("notices", "sendNotifications", allow_duplicate=True), Input("study-cancel", "n_clicks"),
        State("study-id", "data"), prevent_initial_call=True,
    )(cancel)  # fmt: skip


def head(_tick: int | None, study_id: str, done: int) -> tuple[Any, Any, bool]:
    """Name, state and counts; results are drawn anew when more runs have ended and when all have."""
    found, error = attempt(lambda: client().get(f"/studies/{study_id}"))
    if error:
        return refusal(error), no_update, error.status in (401, 403, 404)
    ended = sum(found["counts"].get(state, 0) for state in FINAL)
    over = found["state"] != "active"
    counts = ", ".join(f"{number} {state}" for state, number in found["counts"].items() if number)
    left = f", about {seconds(found['eta_seconds'])} left" if found.get("eta_seconds") is not None and not over else ""
    controls: list[Any] = [
        html.A(text, href=rest(f"/studies/{study_id}/table?format={key}"), className="sd-button sd-button-default")
        for text, key in (("Table (CSV)", "csv"), ("Table (Parquet)", "parquet"))
    ]
    controls.append(button_link("Case", f"/new?case={found['case_id']}", kind="default"))
    if not over:
        controls.insert(0, dmc.Button("Cancel study", id="study-cancel", variant="default", size="xs"))
    badge = html.Span(found["state"], className=f"sd-badge sd-badge-{_badge(found)}")
    shown = html.Header(
        [
            dcc.Link("All studies", href=page_path("/studies"), className="sd-back"),
            dmc.Group(
                [
                    dmc.Group([dmc.Title(found["name"], order=1), badge]),
                    dmc.Group(controls, gap="xs"),
                ],
                justify="space-between",
            ),
            dmc.Text(f"{found['size']} runs: {counts}{left}", size="sm", c="dimmed"),
            dmc.Progress(
                value=100.0 * found["progress"], mt="xs", style={"display": "none"} if over else {},
                **hyphened(aria_label="Progress"),
            ),
        ]
    )  # fmt: skip
    enough = over or ended >= max(done, 0) + max(1, found["size"] // 10)
    return shown, (ended if enough and ended != done else no_update), over and ended == done


def _badge(found: dict[str, Any]) -> str:
    return "running" if found["state"] == "active" else str(found["state"])


def choose(
    values: list[Any], ids: list[dict[str, str]], options: dict[str, Any] | None, drawn: dict[str, Any] | None
) -> Any:
    picked = {made["name"]: value for made, value in zip(ids, values, strict=True) if value is not None}
    return no_update if all((drawn or {}).get(n) == v for n, v in picked.items()) else {**(options or {}), **picked}


def body(_done: int, options: dict[str, Any] | None, study_id: str) -> tuple[Any, Any]:
    found, error = attempt(lambda: fetch(client(), study_id))
    if error:
        return refusal(error), no_update
    options = options or {}
    x = _chosen(options.get("x"), found.pointers)
    y = _chosen(options.get("y"), found.results)
    drawn: list[Any] = []
    if x and y:
        drawn.append(
            dmc.Group([_select("x", "Over", found.pointers, x), _select("y", "Result", found.results, y)], gap="md")
        )
        drawn.append(curves(found, x, y))
    else:
        drawn.append(dmc.Text("Curves appear here when runs have ended.", c="dimmed"))
    return dmc.Stack([*drawn, listed(found)], gap="md"), {"x": x, "y": y}


def _chosen(asked: str | None, allowed: list[str]) -> str | None:
    return asked if asked in allowed else next(iter(allowed), None)


def _select(name: str, label: str, values: list[str], chosen: str) -> dmc.Select:
    data = [{"value": value, "label": quantity(value)} for value in values]
    return dmc.Select(
        id=option_id(name, "study"), label=label, data=data, value=chosen, allowDeselect=False, w=420,
        searchable=len(data) > 12,
    )  # fmt: skip


def curves(table: Table, x: str, y: str) -> Any:
    """One curve for each combination of the other values."""
    shown, factor = unit(y)
    others = [(said(p).rsplit(" › ", 1)[-1], table.column(p)) for p in table.pointers if p != x]
    groups: dict[str, list[tuple[float, float | None]]] = {}
    for row, (at, result) in enumerate(zip(table.column(x), table.column(y), strict=True)):
        place, value = magnitude(at), magnitude(result)
        if place is not None:
            name = ", ".join(f"{words} {values[row]}" for words, values in others) or quantity(y)
            groups.setdefault(name, []).append((place, None if value is None else value * factor))
    drawn = []
    for name, points in groups.items():
        points.sort(key=lambda point: point[0])
        drawn.append((name, [place for place, _ in points], [value for _, value in points]))
    figure = study_curves(drawn, said(x), f"{quantity(y)} [{shown}]")
    title = f"{quantity(y)} over {said(x)}"
    return picture(title[0].upper() + title[1:], figure, f"study-{x}-{y}")


def listed(table: Table) -> Any:
    """Every run, sortable; its number leads to it."""
    names = [name for name in table.columns if name != "run_id"]
    factors = [unit(name)[1] if name in table.results else None for name in names]
    columns = [table.column(name) for name in names]
    data = [
        {"run_id": run} | {f"c{i}": _shown(columns[i][row], factors[i]) for i in range(len(names))}
        for row, run in enumerate(table.column("run_id"))
    ]
    definitions: list[dict[str, Any]] = [
        {"field": f"c{i}", "headerName": header(name), "minWidth": 120, "wrapHeaderText": True, "autoHeaderHeight": True,
         **({"cellRenderer": "StudyRun", "minWidth": 90} if name == "index" else {}),
         **({"valueFormatter": {"function": "studyNumber(params)"}} if name in table.results else {})}
        for i, name in enumerate(names)
    ]  # fmt: skip
    return dag.AgGrid(
        id="study-grid",
        rowData=data,
        columnDefs=definitions,
        defaultColDef={"sortable": True, "resizable": True, "flex": 1},
        dashGridOptions={
            "pagination": True,
            "paginationPageSize": 25,
            "paginationPageSizeSelector": [25, 100],
            "domLayout": "autoHeight",
            "theme": {"function": "runsTheme(themeQuartz)"},
        },
        style={"width": "100%"},
    )


def _shown(value: Any, factor: float | None) -> Any:
    return value * factor if factor is not None and isinstance(value, int | float) else value


def cancel(clicks: int | None, study_id: str) -> Any:
    if not clicks:
        return no_update
    _, error = attempt(lambda: client().post(f"/studies/{study_id}/cancel"))
    return notice("Not cancelled", error.text, "red") if error else notice("Cancelling", "Its runs stop shortly.")
