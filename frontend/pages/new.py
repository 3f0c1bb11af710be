"""Write a case: a guided form and its YAML side by side, statics as you write; then run it."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, State, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components import editor
from frontend.components.attributes import hyphened
from frontend.components.messages import refusal
from frontend.editor import imports, preview
from frontend.format import moment

SAVED = 40  # newest saved cases offered as a start


def layout(case: str | None = None, run: str | None = None, **_: Any) -> Any:
    """`/new?case=ID` starts from a stored case, `/new?run=ID` from what a run computed (a study's run: with its changes)."""
    views = [
        {"value": value, "label": text} for value, text in (("form", "Form"), ("yaml", "YAML"), ("preview", "Preview"))
    ]
    return dmc.Stack(
        [
            dcc.Store(id="new-source", data=f"/runs/{run}/case" if run else f"/cases/{case}" if case else None),
            dcc.Store(id="examples"),
            dmc.Group([dmc.Title("New run", order=1), _actions()], justify="space-between"),
            _starts(),
            html.Div(id="new-message"),
            imports.message(),
            html.Div(
                dmc.SegmentedControl(
                    id="bench-view", data=views, value="form", fullWidth=True, **hyphened(aria_label="Show")
                ),
                className="sd-bench-switch",
            ),
            html.Div(
                [
                    html.Section(html.Div(id="case-form"), className="sd-bench-form", **hyphened(aria_label="Form")),
                    html.Section(_yaml_side(), className="sd-bench-yaml", **hyphened(aria_label="YAML")),
                    html.Div(preview.layout(), className="sd-bench-preview"),
                ],
                className="sd-bench",
                id="bench",
                **hyphened(data_view="form"),
            ),
        ],
        id="new-page",
        gap="sm",
    )


def _actions() -> dmc.Group:
    return dmc.Group(
        [
            dmc.Button("Check", id="case-check", variant="default"),
            dmc.Button("Run", id="case-run"),
        ],
        gap="xs",
    )


def _starts() -> dmc.Group:
    return dmc.Group(
        [
            dmc.Select(id="example", placeholder="Start from an example", data=[], w=250, **hyphened(aria_label="Example")),
            dmc.Select(
                id="saved-case", placeholder="… or from a saved case", data=[], w=280, searchable=True,
                **hyphened(aria_label="Saved case"),
            ),
            dmc.Button("Empty case", id="case-empty", variant="default"),
            imports.layout(),
        ],
        gap="xs",
    )  # fmt: skip


def _yaml_side() -> list[Any]:
    return [
        html.Div(id="case-answer", className="sd-answer", **hyphened(aria_live="polite")),
        editor.yaml_editor("case-text", "Case as YAML"),
        dmc.Text(
            "Kept in this browser, also when you reload or the server goes away. Ctrl+Enter runs.",
            size="xs",
            c="dimmed",
        ),
    ]


def register(app: Dash) -> None:
    live = ClientsideFunction
    app.callback(
        Output("examples", "data"),
        Output("example", "data"),
        Output("saved-case", "data"),
        Output("case-text", "value"),
        Output("new-message", "children"),
        Input("new-source", "data"),
    )(start)
    app.clientside_callback(
        live("slowdrift", "example"),
        Output("case-text", "value", allow_duplicate=True),
        Output("example", "value"),
        Input("example", "value"),
        State("examples", "data"),
        State("case-text", "value"),
        prevent_initial_call=True,
    )
    app.clientside_callback(
        live("slowdrift", "savedCase"),
        Output("saved-case", "value"),
        Input("saved-case", "value"),
        prevent_initial_call=True,
    )
    app.clientside_callback(
        live("slowdrift", "editor"), Output("new-page", "data-painted"), Input("case-text", "value")
    )
    app.clientside_callback(live("slowdrift", "answer"), Output("new-page", "data-answer"), Input("new-page", "id"))
    app.clientside_callback(live("slowdrift", "benchView"), Output("bench", "data-view"), Input("bench-view", "value"))
    for button, act, output, field in (
        ("case-run", "run", "new-page", "data-run"),
        ("case-check", "recheck", "new-page", "data-checked"),
        ("case-empty", "empty", "case-text", "value"),
    ):
        app.clientside_callback(
            live("slowdrift", act),
            Output(output, field, allow_duplicate=field == "value"),
            Input(button, "n_clicks"),
            prevent_initial_call=True,
        )
    imports.register(app)
    preview.register(app)


def start(source: str | None) -> tuple[Any, ...]:
    """Examples and saved cases to start from, and the stored case that was asked for."""
    listed, error = attempt(lambda: client().get("/examples"))
    if error:
        return no_update, no_update, no_update, no_update, refusal(error)
    texts = {item["name"]: item["yaml"] for item in listed}
    choices = [{"value": item["name"], "label": item.get("title") or item["name"]} for item in listed]
    saved, _ = attempt(lambda: client().get("/cases", limit=SAVED))
    cases = [
        {"value": item["id"], "label": f"{item['name']}, version {item['version']}, {moment(item['created_at'])[:10]}"}
        for item in (saved or {}).get("items") or []
    ]
    if not source:
        return texts, choices, cases, no_update, no_update
    stored, error = attempt(lambda: client().get(source))
    return texts, choices, cases, stored["yaml"] if stored else no_update, refusal(error) if error else no_update
