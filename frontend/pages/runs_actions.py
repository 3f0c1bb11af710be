"""What a row of the grid can be told: cancel, delete, rerun, name and tag."""

from __future__ import annotations

from typing import Any

from dash import Dash, Input, Output, State, ctx, no_update

from frontend.client import attempt, client
from frontend.components.links import page_path
from frontend.components.messages import refusal
from frontend.components.shell import notice


def register(app: Dash) -> None:
    app.callback(
        Output("runs-asked", "data"),
        Output("runs-confirm", "opened"),
        Output("runs-rename", "opened"),
        Output("location", "href", allow_duplicate=True),
        Output("notices", "sendNotifications", allow_duplicate=True),
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
    app.callback(
        Output("runs-name", "value"),
        Output("runs-tags", "value"),
        Output("runs-keep-results", "checked"),
        Input("runs-rename", "opened"),
        State("runs-asked", "data"),
        prevent_initial_call=True,
    )(present)
    app.callback(
        Output("runs-rename", "opened", allow_duplicate=True),
        Output("runs-refresh", "data", allow_duplicate=True),
        Output("runs-rename-error", "children"),
        Input("runs-save", "n_clicks"),
        State("runs-name", "value"),
        State("runs-tags", "value"),
        State("runs-keep-results", "checked"),
        State("runs-asked", "data"),
        State("runs-refresh", "data"),
        prevent_initial_call=True,
    )(save)


def act(clicked: dict[str, Any] | None) -> tuple[Any, ...]:
    """A row's button: cancel and rerun at once, delete only after a question."""
    value = (clicked or {}).get("value") or {}
    action, run_id = value.get("action"), value.get("id")
    if action in ("delete", "rename"):
        return run_id, action == "delete", action == "rename", no_update, no_update
    if action == "cancel":
        _, error = attempt(lambda: client().post(f"/runs/{run_id}/cancel"))
        text = notice("Not cancelled", error.text, "red") if error else notice("Cancelling", "The run stops shortly.")
        return no_update, no_update, no_update, no_update, text
    if action == "rerun":
        made, error = attempt(lambda: client().post(f"/runs/{run_id}/rerun", {}))
        if error:
            return no_update, no_update, no_update, no_update, notice("Not started", error.text, "red")
        return no_update, no_update, no_update, page_path(f"/runs/{made['id']}"), no_update
    return (no_update,) * 5


def delete(_delete: int | None, _keep: int | None, run_id: str | None, refresh: int) -> tuple[Any, ...]:
    if ctx.triggered_id != "runs-delete" or not run_id:
        return False, no_update, no_update
    _, error = attempt(lambda: client().delete(f"/runs/{run_id}"))
    if error:
        return False, no_update, notice("Not deleted", error.text, "red")
    return False, refresh + 1, notice("Run deleted")


def present(opened: bool, run_id: str | None) -> tuple[Any, ...]:
    """The run's name, tags and pin as they are."""
    run, error = attempt(lambda: client().get(f"/runs/{run_id}")) if opened and run_id else (None, None)
    if error or not run:
        return no_update, no_update, no_update
    return run.get("name") or "", run.get("tags") or [], bool(run.get("pinned"))


def save(
    clicks: int | None, name: str, tags: list[str] | None, pinned: bool, run_id: str | None, refresh: int
) -> tuple[Any, ...]:
    if not clicks or not run_id:
        return no_update, no_update, no_update
    change = {"name": name or "", "tags": tags or [], "pinned": bool(pinned)}
    _, error = attempt(lambda: client().patch(f"/runs/{run_id}", change))
    return (no_update, no_update, refusal(error)) if error else (False, refresh + 1, None)
