"""One's own: name, project, password, keys for programs, links that share runs."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ALL, ClientsideFunction, Dash, Input, Output, State, ctx, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components.links import button_link
from frontend.components.messages import refusal
from frontend.components.shell import notice
from frontend.components.tables import table
from frontend.errors import ApiError
from frontend.format import moment

SCOPES = (("read", "read only"), ("submit", "read and submit"), ("admin", "everything you may do"))
DAYS = (("30", "30 days"), ("90", "90 days"), ("365", "a year"), ("never", "never"))


def layout(**_: Any) -> Any:
    return dmc.Stack(
        [
            dcc.Store(id="account-changed", data=0),
            dmc.Group(
                [
                    dmc.Title("Account", order=1),
                    dmc.Group(
                        [
                            button_link("Teams", "/teams", kind="default"),
                            dmc.Button("Sign out", id="sign-out", variant="default"),
                        ]
                    ),
                ],
                justify="space-between",
            ),
            html.Div(id="sign-out-fault", role="alert", className="sd-fault"),
            html.Div(id="account-message"),
            html.Div(dmc.Skeleton(h=200), id="account-body"),
        ],
        id="account-page", gap="md",
    )  # fmt: skip


def register(app: Dash) -> None:
    app.clientside_callback(
        ClientsideFunction("slowdrift", "signOut"), Output("sign-out-fault", "children"), Input("sign-out", "n_clicks"),
        State("prefix", "data"), prevent_initial_call=True,
    )  # fmt: skip
    app.callback(Output("account-body", "children"), Input("account-page", "id"), Input("account-changed", "data"))(
        show
    )
    app.callback(
        Output("account-message", "children"), Output("account-changed", "data"), Input("account-save", "n_clicks"),
        State("account-name", "value"), State("account-project", "value"), State("account-changed", "data"),
        prevent_initial_call=True,
    )(save)  # fmt: skip
    app.callback(
        Output("account-message", "children", allow_duplicate=True), Output("password-old", "value"),
        Output("password-new", "value"), Input("password-save", "n_clicks"), State("password-old", "value"),
        State("password-new", "value"), prevent_initial_call=True,
    )(password)  # fmt: skip
    app.callback(
        Output("account-message", "children", allow_duplicate=True),
        Output("account-changed", "data", allow_duplicate=True), Input("key-make", "n_clicks"), State("key-name", "value"),
        State("key-scope", "value"), State("key-days", "value"), State("account-changed", "data"),
        prevent_initial_call=True,
    )(make_key)  # fmt: skip
    app.callback(
        Output("notices", "sendNotifications", allow_duplicate=True),
        Output("account-changed", "data", allow_duplicate=True), Input({"type": "revoke", "what": ALL, "id": ALL}, "n_clicks"),
        State("account-changed", "data"), prevent_initial_call=True,
    )(revoke)  # fmt: skip


def show(_page: str, _changed: int) -> Any:
    def whole() -> Any:
        me = client().get("/me")
        if not me.get("user"):
            return alone(client().get("/shares", limit=100)["items"])
        return known(me, client().get("/keys")["items"], client().get("/shares", limit=100)["items"])

    made, error = attempt(whole)
    return refusal(error) if error else made


def alone(shares: list[dict[str, Any]]) -> Any:
    """A service without accounts."""
    text = (
        "This service has no accounts: only this machine can reach it, and whoever uses it may do everything. "
        "`slowdrift user add EMAIL` makes the first account."
    )
    return dmc.Stack([dmc.Alert(dcc.Markdown(text), title="No sign-in", color="gray", variant="light"), shared(shares)])


def known(me: dict[str, Any], keys: list[dict[str, Any]], shares: list[dict[str, Any]]) -> Any:
    return dmc.Stack(
        [
            dmc.SimpleGrid([profile(me), passwords()], cols={"base": 1, "md": 2}, spacing="xl"),
            keys_part(keys),
            shared(shares),
        ],
        gap="xl",
    )


def profile(me: dict[str, Any]) -> Any:
    homes = [
        {"value": home["project_id"], "label": f"{home['team_name']} / {home['project_name']} ({home['role']})"}
        for home in me["homes"]
    ]
    home = (me.get("home") or {}).get("project_id")
    return dmc.Stack(
        [
            dmc.Title("You", order=2, size="h4"),
            dmc.Text(me["user"]["email"], size="sm", c="dimmed"),
            dmc.TextInput(id="account-name", label="Name", value=me["user"]["name"]),
            dmc.Select(id="account-project", label="Project you work in", data=homes, value=home, allowDeselect=False),
            dmc.Group(dmc.Button("Save", id="account-save")),
        ],
        gap="xs",
    )


def passwords() -> Any:
    return dmc.Stack(
        [
            dmc.Title("Password", order=2, size="h4"),
            dmc.PasswordInput(id="password-old", label="Present password"),
            dmc.PasswordInput(id="password-new", label="New password", description="Your other sessions end."),
            dmc.Group(dmc.Button("Change the password", id="password-save", variant="default")),
        ],
        gap="xs",
    )


def keys_part(keys: list[dict[str, Any]]) -> Any:
    rows = [
        [key["name"], f"{key['start']}…", dict(SCOPES).get(key["scope"], key["scope"]), moment(key.get("last_used_at")),
         _until(key), _revoke("keys", key)]
        for key in keys
    ]  # fmt: skip
    form = dmc.Group(
        [
            dmc.TextInput(id="key-name", label="What it is for", placeholder="nightly study", w=220),
            _select("key-scope", "May", SCOPES, "read"),
            _select("key-days", "Ends after", DAYS, "90"),
            dmc.Button("Make a key", id="key-make"),
        ],
        align="flex-end",
    )
    head = ["Key", "begins", "may", "last used", "until", ""]
    listed = table("", head, rows, min_width=720, words=True) if rows else dmc.Text("None yet.", size="sm", c="dimmed")
    return dmc.Stack([dmc.Title("Keys for programs", order=2, size="h4"), form, listed], gap="xs")


def _select(name: str, label: str, choices: tuple[tuple[str, str], ...], chosen: str) -> dmc.Select:
    data = [{"value": value, "label": text} for value, text in choices]
    return dmc.Select(id=name, label=label, data=data, value=chosen, allowDeselect=False, w=180)


def _until(item: dict[str, Any]) -> str:
    if item.get("revoked_at"):
        return "revoked"
    return moment(item["expires_at"]) if item.get("expires_at") else "no end"


def _revoke(what: str, item: dict[str, Any]) -> Any:
    if item.get("revoked_at"):
        return ""
    return dmc.Button(
        "Revoke", id={"type": "revoke", "what": what, "id": item["id"]}, size="compact-xs", variant="default"
    )


def shared(shares: list[dict[str, Any]]) -> Any:
    rows = [
        [item.get("title") or "untitled", str(len(item.get("run_ids") or item.get("runs") or [])), moment(item["created_at"]),
         _until(item), _revoke("shares", item)]
        for item in shares
    ]  # fmt: skip
    listed = table("", ["Link", "runs", "made", "until", ""], rows, min_width=560, words=True) if rows else dmc.Text(
        "None yet. “Share” on a run's page makes one.", size="sm", c="dimmed"
    )  # fmt: skip
    return dmc.Stack([dmc.Title("Shared links", order=2, size="h4"), listed], gap="xs")


def save(clicks: int | None, name: str | None, project: str | None, changed: int) -> tuple[Any, Any]:
    if not clicks:
        return no_update, no_update
    body = {key: value for key, value in (("name", name), ("project_id", project)) if value}
    _, error = attempt(lambda: client().patch("/me", body))
    return (refusal(error), no_update) if error else (_done("Saved."), changed + 1)


def password(clicks: int | None, old: str | None, new: str | None) -> tuple[Any, Any, Any]:
    if not clicks:
        return no_update, no_update, no_update
    _, error = attempt(lambda: client().put("/me/password", {"old": old or "", "new": new or ""}))
    return (refusal(error), no_update, no_update) if error else (_done("The password is changed."), "", "")


def make_key(clicks: int | None, name: str | None, scope: str, days: str, changed: int) -> tuple[Any, Any]:
    """The key itself is shown once."""
    if not clicks:
        return no_update, no_update
    if not (name or "").strip():
        return refusal(ApiError(422, "Say what the key is for")), no_update
    body = {"name": name, "scope": scope, "expires_in_days": None if days == "never" else int(days)}
    made, error = attempt(lambda: client().post("/keys", body))
    if error:
        return refusal(error), no_update
    return once("The key, shown this once", made["token"]), changed + 1


def once(title: str, secret: str) -> dmc.Alert:
    """A secret with a button that copies it."""
    row = dmc.Group([dmc.Code(secret, className="sd-break"), dcc.Clipboard(content=secret, title="Copy")])
    return dmc.Alert(row, title=title, color="green", variant="light", withCloseButton=True)


def _done(text: str) -> dmc.Alert:
    return dmc.Alert(text, color="green", variant="light", withCloseButton=True)


def revoke(clicks: list[int | None], changed: int) -> tuple[Any, Any]:
    asked = ctx.triggered_id
    if not asked or not any(clicks):
        return no_update, no_update
    _, error = attempt(lambda: client().delete(f"/{asked['what']}/{asked['id']}"))
    if error:
        return notice("Not revoked", error.text, "red"), no_update
    return notice("Revoked"), changed + 1
