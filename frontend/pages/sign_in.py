"""The doors: signing in, and the page behind an invitation or a link to choose a password."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, State, dcc, html

from frontend.client import attempt, client
from frontend.components.messages import refusal
from frontend.format import moment

OIDC = {
    "expired": "The sign-in took too long, or was begun in another browser. Try again.",
    "refused": "The provider did not sign you in.",
    "failed": "The provider's answer could not be used. Try again; the service's log has the reason.",
    "unavailable": "The provider does not answer at present. Try again later, or sign in with a password.",
    "email": "The provider does not confirm your e-mail address. Confirm it there, then try again.",
    "unknown": "There is no account for you yet. An owner of a team invites you by e-mail address.",
    "disabled": "Your account is disabled. An administrator can enable it.",
    "other": "The account with your e-mail address belongs to somebody else at the provider. Ask an administrator.",
    "many": "Too many attempts. Try again in ten minutes.",
}
"""Why the service (api/routes/oidc.py) sent somebody back here."""


def layout(next: str = "", oidc: str = "", **_: Any) -> Any:
    """`/sign-in?next=ADDRESS` goes on to where one wanted to go; `oidc=REASON` tells why a provider's word did not do."""
    return dmc.Stack(
        [
            dcc.Store(id="sign-in-next", data=next),
            dmc.Title("Sign in", order=1),
            dmc.TextInput(id="sign-in-email", label="E-mail", autoComplete="username"),
            dmc.PasswordInput(id="sign-in-password", label="Password", n_submit=0, autoComplete="current-password"),
            html.Div(id="sign-in-fault", role="alert", className="sd-fault"),
            dmc.Group(dmc.Button("Sign in", id="sign-in")),
            html.Div(id="sign-in-provider"),
            html.Div(OIDC.get(oidc, ""), role="alert", className="sd-fault"),
            dmc.Text(
                "No account? An owner of your team invites you by a link. Forgotten the password? An administrator makes "
                "a link to choose a new one.",
                size="sm", c="dimmed",
            ),
        ],
        maw=420, gap="sm", mx="auto", mt="xl",
    )  # fmt: skip


def invitation(token: str = "", **_: Any) -> Any:
    """`/invitations/{token}`: join a team, or choose a password."""
    return dmc.Stack(
        [
            dcc.Store(id="invitation-token", data=token),
            html.Div(dmc.Skeleton(h=120), id="invitation"),
            html.Div(id="invitation-fault", role="alert", className="sd-fault"),
        ],
        maw=420, gap="sm", mx="auto", mt="xl",
    )  # fmt: skip


def register(app: Dash) -> None:
    app.clientside_callback(
        ClientsideFunction("slowdrift", "corner"), Output("account-corner", "children"), Input("location", "pathname"),
        State("prefix", "data"),
    )  # fmt: skip
    app.clientside_callback(
        ClientsideFunction("slowdrift", "signIn"), Output("sign-in-fault", "children"), Input("sign-in", "n_clicks"),
        Input("sign-in-password", "n_submit"), State("sign-in-email", "value"), State("sign-in-password", "value"),
        State("sign-in-next", "data"), State("prefix", "data"), prevent_initial_call=True,
    )  # fmt: skip
    app.clientside_callback(
        ClientsideFunction("slowdrift", "provider"), Output("sign-in-provider", "children"),
        Input("sign-in-next", "data"), State("prefix", "data"),
    )  # fmt: skip
    app.callback(Output("invitation", "children"), Input("invitation-token", "data"))(show)
    app.clientside_callback(
        ClientsideFunction("slowdrift", "accept"), Output("invitation-fault", "children"),
        Input("invitation-accept", "n_clicks"), State("invitation-token", "data"), State("invitation-email", "value"),
        State("invitation-name", "value"), State("invitation-password", "value"), State("prefix", "data"),
        prevent_initial_call=True,
    )  # fmt: skip


def show(token: str) -> Any:
    found, error = attempt(lambda: client().get(f"/invitations/{token}"))
    if error:
        return refusal(error)
    join = found["kind"] == "join"
    title = f"Join {found.get('team') or 'the team'}" if join else "Choose a password"
    said = f"As {found['role']}. " if join and found.get("role") else ""
    hidden = {} if join else {"display": "none"}
    return dmc.Stack(
        [
            dmc.Title(title, order=1),
            dmc.Text(f"{said}This link is good until {moment(found.get('expires_at'))}.", size="sm", c="dimmed"),
            dmc.TextInput(
                id="invitation-email", label="E-mail", value=found.get("email") or "",
                disabled=bool(found.get("email")), style=hidden,
            ),
            dmc.TextInput(id="invitation-name", label="Name", style=hidden),
            dmc.PasswordInput(
                id="invitation-password", label="Password",
                description="Ten characters or more. Leave it empty when you are signed in already." if join
                else "Ten characters or more.",
            ),
            dmc.Group(dmc.Button("Join" if join else "Set the password", id="invitation-accept")),
        ],
        gap="sm",
    )  # fmt: skip
