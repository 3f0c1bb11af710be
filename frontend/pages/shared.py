"""What a share link opens: a run or a comparison as it was on the screen, for whoever has the link."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, dcc, html

from frontend.components.messages import empty
from frontend.format import moment
from frontend.pages import compare, run


def layout(token: str = "", **_: Any) -> Any:
    return html.Div(
        [
            dcc.Store(id="shared-token", data=token),
            dcc.Store(id="shared-held"),
            html.Div(id="shared-head"),
            html.Div(dmc.Skeleton(h=240), id="shared-body"),
        ],
        className="sd-shared",
    )


def register(app: Dash) -> None:
    app.clientside_callback(
        ClientsideFunction("slowdrift", "opened"), Output("shared-held", "data"), Input("shared-token", "data")
    )
    app.callback(
        Output("shared-head", "children"),
        Output("shared-body", "children"),
        Input("shared-held", "data"),
        prevent_initial_call=True,
    )(show)


def show(held: dict[str, Any] | None) -> tuple[Any, Any]:
    """`held` is what `GET /shared/{token}` said, with the choices in the page's own address."""
    if not held or held.get("missing"):
        return None, empty("This link opens nothing", "It was revoked, it has expired, or it was copied in part.")
    ids = [str(one["id"]) for one in held.get("runs") or []]
    view = {**(held.get("view") or {}), **(held.get("query") or {})}
    view = {
        key: value for key, value in view.items() if isinstance(value, str) and key not in ("runs", "run_id", "token")
    }
    until = f", until {moment(held['expires_at'])}" if held.get("expires_at") else ""
    head = dmc.Text(
        f"“{held.get('title') or 'Results'}”, shared {moment(held.get('created_at'))}{until}.",
        size="sm",
        c="dimmed",
        mb="xs",
    )
    if not ids:
        return head, empty("Its runs are gone", "They were deleted.")
    return head, run.layout(ids[0], **view) if len(ids) == 1 else compare.layout(",".join(ids), **view)
