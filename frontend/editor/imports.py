"""What comes into the editor from files: hydrodynamic data and MoorDyn decks, sent by the browser straight to REST."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, dcc, html

from frontend.components.editor import complaint
from frontend.components.links import button_link

REPORT = (("missing", "To fill in"), ("assumed", "Assumed"), ("dropped", "Left out"), ("read", "Read"))


def layout() -> Any:
    return dmc.Group(
        [
            dcc.Store(id="data-set-added"),
            dcc.Store(id="deck-read"),
            dmc.Button("Import a MoorDyn deck", id="deck-import", variant="default"),
            dmc.Button("Upload hydrodynamic data", id="data-set-upload", variant="default"),
            button_link("From a hull or mesh", "/hull", kind="default"),
        ],
        gap="xs",
    )


def register(app: Dash) -> None:
    for button, act, field in (
        ("data-set-upload", "upload", "data-upload"),
        ("deck-import", "importDeck", "data-deck"),
    ):
        app.clientside_callback(
            ClientsideFunction("slowdrift", act),
            Output("new-page", field),
            Input(button, "n_clicks"),
            prevent_initial_call=True,
        )
    app.callback(Output("import-message", "children"), Input("data-set-added", "data"), prevent_initial_call=True)(
        uploaded
    )
    app.callback(
        Output("import-message", "children", allow_duplicate=True),
        Input("deck-read", "data"),
        prevent_initial_call=True,
    )(imported)


def message() -> Any:
    return html.Div(id="import-message", role="status")


def uploaded(added: dict[str, Any] | None) -> Any:
    """`added` is what the browser's upload came to: the data set or a problem."""
    if not added:
        return None
    if added.get("problem"):
        return _refused(added["problem"])
    words = f"{added.get('name')} is ready; name it under Vessel, hydrodynamics."
    return dmc.Alert(words, color="green", variant="light", mb="xs")


def imported(deck: dict[str, Any] | None) -> Any:
    """`deck` is what `POST /imports/moordyn` said, or a problem."""
    if not deck:
        return None
    if deck.get("problem"):
        return _refused(deck["problem"])
    report = deck.get("report") or {}
    parts = []
    for key, title in REPORT:
        if report.get(key):
            items = html.Ul([html.Li(str(words)) for words in report[key]])
            parts.append(html.Details([html.Summary(f"{title}: {len(report[key])}"), items], open=key == "missing"))
    whole = bool(deck.get("complete"))
    title = "The deck is in the editor" if whole else "The deck is in the editor; some of it is for you to fill in"
    return dmc.Alert(
        parts, title=title, color="green" if whole else "yellow", variant="light", mb="xs", withCloseButton=True
    )


def _refused(problem: dict[str, Any]) -> Any:
    faults = problem.get("errors") or []
    lines = [(f"line {one['line']}: " if one.get("line") else "") + str(one.get("message")) for one in faults[:8]]
    return complaint(problem.get("title", "Not read"), " ".join([problem.get("detail") or "", *lines]))
