"""Write a case as YAML, check it, run it. Errors stand beside the line they are about."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, State, ctx, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components import editor
from frontend.components.attributes import hyphened
from frontend.components.links import page_path
from frontend.components.messages import refusal
from frontend.components.tables import table
from frontend.errors import ApiError
from frontend.format import analysis_name, number


def layout(case: str | None = None, **_: Any) -> Any:
    """`/new?case=ID` starts from a stored case."""
    return dmc.Stack(
        [
            dcc.Store(id="new-source", data=case),
            dcc.Store(id="examples"),
            dcc.Store(id="case-settled"),
            dcc.Store(id="case-marks", data=[]),
            dcc.Store(id="data-set-added"),
            dmc.Title("New run", order=1),
            dmc.Grid(
                [
                    dmc.GridCol(_editor_side(), span={"base": 12, "lg": 8}),
                    dmc.GridCol(_answer_side(), span={"base": 12, "lg": 4}),
                ],
                gutter="lg",
            ),
        ],
        id="new-page",
        gap="sm",
    )


def _editor_side() -> list[Any]:
    return [
        dmc.Group(
            [
                dmc.Select(
                    id="example", placeholder="Start from an example", data=[], w=290, **hyphened(aria_label="Example")
                ),
                dmc.Group(
                    [
                        dmc.Button("Check", id="case-check", variant="default"),
                        dmc.Button("Run", id="case-run"),
                    ],
                    gap="xs",
                ),
            ],
            justify="space-between",
            mb="xs",
        ),
        editor.yaml_editor("case-text", "Case as YAML"),
        dmc.Text("Your text is kept in this browser, also when you reload or close the page.", size="xs", c="dimmed"),
    ]


def _answer_side() -> list[Any]:
    return [
        html.Div(_idle(), id="case-answer", **hyphened(aria_live="polite")),
        dmc.Divider(my="lg"),
        dmc.Group(
            [
                dmc.Title("Hydrodynamic data sets", order=4),
                dmc.Button("Upload", id="data-set-upload", variant="default", size="xs"),
            ],
            justify="space-between",
            mb="xs",
        ),
        html.Div(id="data-set-message"),
        html.Div(id="data-sets"),
    ]


def _idle() -> Any:
    return dmc.Text("The case is checked as you write.", c="dimmed", size="sm")


def register(app: Dash) -> None:
    app.callback(
        Output("examples", "data"),
        Output("example", "data"),
        Output("case-text", "value"),
        Output("case-answer", "children"),
        Input("new-source", "data"),
    )(start)
    app.clientside_callback(
        ClientsideFunction("slowdrift", "example"),
        Output("case-text", "value", allow_duplicate=True),
        Output("example", "value"),
        Input("example", "value"),
        State("examples", "data"),
        State("case-text", "value"),
        prevent_initial_call=True,
    )
    app.clientside_callback(
        ClientsideFunction("slowdrift", "editor"),
        Output("new-page", "data-painted"),
        Input("case-text", "value"),
        Input("case-marks", "data"),
    )
    app.callback(
        Output("case-answer", "children", allow_duplicate=True),
        Output("case-marks", "data"),
        Input("case-check", "n_clicks"),
        Input("case-settled", "data"),
        State("case-text", "value"),
        prevent_initial_call=True,
        running=[(Output("case-check", "loading"), True, False)],
    )(check)
    app.callback(
        Output("case-answer", "children", allow_duplicate=True),
        Output("case-marks", "data", allow_duplicate=True),
        Output("location", "pathname"),
        Input("case-run", "n_clicks"),
        State("case-text", "value"),
        prevent_initial_call=True,
        running=[(Output("case-run", "loading"), True, False)],
    )(run)
    app.clientside_callback(
        ClientsideFunction("slowdrift", "upload"),
        Output("new-page", "data-upload"),
        Input("data-set-upload", "n_clicks"),
        prevent_initial_call=True,
    )
    app.callback(
        Output("data-sets", "children"), Output("data-set-message", "children"), Input("data-set-added", "data")
    )(data_sets)


def start(source: str | None) -> tuple[Any, ...]:
    """Examples to choose from, and the stored case that was asked for."""
    listed, error = attempt(lambda: client().get("/examples"))
    if error:
        return no_update, no_update, no_update, refusal(error)
    listed = listed["items"] if isinstance(listed, dict) else listed
    texts = {item["name"]: item["yaml"] for item in listed}
    choices = [{"value": item["name"], "label": item.get("title") or item["name"]} for item in listed]
    if not source:
        return texts, choices, no_update, no_update
    stored, error = attempt(lambda: client().get(f"/cases/{source}"))
    return texts, choices, stored["yaml"] if stored else no_update, refusal(error) if error else no_update


def check(_clicks: int | None, settled: str | None, text: str | None) -> tuple[Any, Any]:
    text = (settled if ctx.triggered_id == "case-settled" else text) or ""
    if not text.strip():
        return _idle(), []
    made, error = attempt(lambda: client().post_yaml("/cases/check", text))
    return _wrong(error) if error else (_right(made), [])


def run(clicks: int | None, text: str | None) -> tuple[Any, ...]:
    """Store the case, start the run, go there."""
    if not clicks or not (text or "").strip():
        return (editor.complaint("There is nothing to run", "Choose an example or write a case."), [], no_update)

    def submit() -> str:
        case = client().post_yaml("/cases", text or "")
        return str(client().post("/runs", {"case_id": case["id"]})["id"])

    run_id, error = attempt(submit)
    return (*_wrong(error), no_update) if error else (no_update, no_update, page_path(f"/runs/{run_id}"))


def _wrong(error: ApiError) -> tuple[Any, list[dict[str, Any]]]:
    marks = [{"line": e.line, "message": e.message} for e in error.errors if e.line]
    return editor.problems(error), marks


def _right(made: dict[str, Any]) -> Any:
    names = ", ".join(analysis_name(name) for name in made.get("analyses") or [])
    noted = [dmc.ListItem(text) for text in made.get("warnings") or []]
    return dmc.Alert(
        [dmc.Text(f"Analyses: {names}.", size="sm"), *([dmc.List(noted, size="sm", mt="xs")] if noted else [])],
        title=f"“{made.get('name', 'The case')}” is ready to run",
        color="yellow" if noted else "green",
        variant="light",
        className="sd-ready",
    )


def data_sets(added: dict[str, Any] | None) -> tuple[Any, Any]:
    """What the project holds. `added` is what the browser's upload came to: the data set or a problem."""
    page, error = attempt(lambda: client().get("/data-sets"))
    if error:
        return refusal(error), None
    items = page["items"] if isinstance(page, dict) else page
    told = None
    if added and added.get("problem"):
        told = editor.complaint(added["problem"].get("title", "Not uploaded"), added["problem"].get("detail", ""))
    elif added:
        told = dmc.Alert(f"{added.get('name')} is ready to use.", color="green", variant="light", mb="xs")
    if not items:
        hint = "None yet. Upload a NetCDF file as Capytaine writes it, then name it in the case under hydrodynamics."
        return dmc.Text(hint, size="sm", c="dimmed"), told
    rows = [[dmc.Code(item["name"]), _size(item.get("size")), str(item.get("version", ""))] for item in items]
    return table("", ("Name, as in the case", "Size", "Version"), rows, min_width=240), told


def _size(size: int | None) -> str:
    return "–" if size is None else f"{number(size / 1e6)} MB" if size >= 1e6 else f"{number(size / 1e3)} kB"
