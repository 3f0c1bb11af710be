"""What comes into the editor from files: hydrodynamic data, uploaded by the browser straight to REST."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, dcc, html

from frontend.components.editor import complaint


def layout() -> Any:
    return html.Div(
        [
            dcc.Store(id="data-set-added"),
            dmc.Button("Upload hydrodynamic data", id="data-set-upload", variant="default"),
            html.Div(id="data-set-message"),
        ]
    )


def register(app: Dash) -> None:
    app.clientside_callback(
        ClientsideFunction("slowdrift", "upload"),
        Output("new-page", "data-upload"),
        Input("data-set-upload", "n_clicks"),
        prevent_initial_call=True,
    )
    app.callback(Output("data-set-message", "children"), Input("data-set-added", "data"), prevent_initial_call=True)(
        uploaded
    )


def uploaded(added: dict[str, Any] | None) -> Any:
    """`added` is what the browser's upload came to: the data set or a problem."""
    if not added:
        return None
    if added.get("problem"):
        return complaint(added["problem"].get("title", "Not uploaded"), added["problem"].get("detail", ""))
    words = f"{added.get('name')} is ready; name it under Vessel, hydrodynamics."
    return dmc.Alert(words, color="green", variant="light", mb="xs")
