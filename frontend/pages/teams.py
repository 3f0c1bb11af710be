"""Teams: who is in them and as what, invitations by link, projects, and who did what."""

from __future__ import annotations

from functools import partial
from typing import Any

import dash_mantine_components as dmc
from dash import ALL, Dash, Input, Output, State, ctx, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components.links import page_path
from frontend.components.messages import refusal
from frontend.components.shell import notice
from frontend.components.tables import table
from frontend.errors import ApiError
from frontend.format import moment
from frontend.pages.account import once

ROLES = ("viewer", "editor", "owner")
AUDIT = 50


def layout(team: str = "", **_: Any) -> Any:
    """`/teams?team=ID`."""
    return dmc.Stack(
        [
            dcc.Store(id="team-asked", data=team),
            dcc.Store(id="team-changed", data=0),
            dcc.Link("Account", href=page_path("/account"), className="sd-back"),
            dmc.Title("Teams", order=1),
            dmc.Group(
                [
                    dmc.Select(id="team-chosen", label="Team", data=[], allowDeselect=False, w=320),
                    dmc.TextInput(id="team-new", label="New team", placeholder="name", w=220),
                    dmc.Button("Make the team", id="team-make", variant="default"),
                ],
                align="flex-end",
            ),
            html.Div(id="team-message"),
            html.Div(dmc.Skeleton(h=200), id="team-body"),
        ],
        id="teams-page", gap="md",
    )  # fmt: skip


def register(app: Dash) -> None:
    changed = Output("team-changed", "data", allow_duplicate=True)
    message = Output("team-message", "children", allow_duplicate=True)
    app.callback(
        Output("team-chosen", "data"), Output("team-chosen", "value"), Output("team-message", "children"),
        Input("teams-page", "id"), Input("team-changed", "data"), State("team-asked", "data"),
        State("team-chosen", "value"),
    )(offer)  # fmt: skip
    app.callback(
        Output("team-body", "children"), Input("team-chosen", "value"), Input("team-changed", "data"),
        State("team-chosen", "data"), prevent_initial_call=True,
    )(show)  # fmt: skip
    app.callback(
        message, changed, Input("team-make", "n_clicks"), State("team-new", "value"), State("team-changed", "data"),
        prevent_initial_call=True,
    )(make)  # fmt: skip
    app.callback(
        Output("notices", "sendNotifications", allow_duplicate=True), changed,
        Input({"type": "member-role", "id": ALL}, "value"), State({"type": "member-role", "id": ALL}, "id"),
        State("team-chosen", "value"), State("team-roles", "data"), State("team-changed", "data"),
        prevent_initial_call=True,
    )(promote)  # fmt: skip
    app.callback(
        Output("notices", "sendNotifications", allow_duplicate=True), changed,
        Input({"type": "team-remove", "what": ALL, "id": ALL}, "n_clicks"), State("team-chosen", "value"),
        State("team-changed", "data"), prevent_initial_call=True,
    )(remove)  # fmt: skip
    app.callback(
        message, changed, Input("team-invite", "n_clicks"), State("invite-role", "value"), State("invite-email", "value"),
        State("team-chosen", "value"), State("team-changed", "data"), prevent_initial_call=True,
    )(invite)  # fmt: skip
    app.callback(
        message, changed, Input("project-make", "n_clicks"), State("project-new", "value"), State("team-chosen", "value"),
        State("team-changed", "data"), prevent_initial_call=True,
    )(make_project)  # fmt: skip


def offer(_page: str, _changed: int, asked: str, chosen: str | None) -> tuple[Any, Any, Any]:
    found, error = attempt(lambda: client().get("/teams"))
    if error:
        return no_update, no_update, refusal(error)
    data = [{"value": item["id"], "label": f"{item['name']} ({item['role']})"} for item in found["items"]]
    known = [item["value"] for item in data]
    kept = next((team for team in (chosen, asked) if team in known), known[0] if known else None)
    return data, kept, no_update


def show(team: str | None, _changed: int, offered: list[dict[str, str]]) -> Any:
    if not team:
        return dmc.Text("You are in no team. An owner invites by a link.", c="dimmed")
    label = next((item["label"] for item in offered if item["value"] == team), "")
    owner = label.endswith("(owner)")

    def whole() -> list[Any]:
        rest = client()
        parts = [members(rest.get(f"/teams/{team}/members")["items"], owner)]
        homes = [home for home in rest.get("/projects")["items"] if home["team_id"] == team]
        parts.append(projects(homes, owner))
        if homes:
            parts.append(limits(rest.get("/quota", project=homes[0]["project_id"])))
        if owner:
            parts.append(invitations(rest.get(f"/teams/{team}/invitations")["items"]))
            parts.append(audit(rest.get(f"/teams/{team}/audit", limit=AUDIT)["items"]))
        return parts

    made, error = attempt(whole)
    return refusal(error) if error else dmc.Stack(made, gap="xl")


def _roles(name: Any, chosen: str, label: str) -> dmc.Select:
    return dmc.Select(
        id=name, data=list(ROLES), value=chosen, allowDeselect=False, w=120, size="xs", label=label or None
    )


def members(items: list[dict[str, Any]], owner: bool) -> Any:
    rows = []
    for item in items:
        role = _roles({"type": "member-role", "id": item["user_id"]}, item["role"], "") if owner else item["role"]
        out = _remove("members", item["user_id"], "Remove") if owner else ""
        rows.append([item["name"] + (" (disabled)" if item["disabled"] else ""), item["email"], role, out])
    known = dcc.Store(id="team-roles", data={item["user_id"]: item["role"] for item in items})
    return html.Div([known, table("Members", ["Name", "e-mail", "role", ""], rows, min_width=520, words=True)])


def _remove(what: str, key: str, words: str) -> dmc.Button:
    return dmc.Button(words, id={"type": "team-remove", "what": what, "id": key}, size="compact-xs", variant="default")


def projects(homes: list[dict[str, Any]], owner: bool) -> Any:
    rows = [
        [home["project_name"], _remove("projects", home["project_id"], "Delete") if owner else ""] for home in homes
    ]
    form = dmc.Group(
        [dmc.TextInput(id="project-new", placeholder="name", w=220, **{"aria-label": "New project"}),
         dmc.Button("Make a project", id="project-make", variant="default")]
    )  # fmt: skip
    return dmc.Stack([table("Projects", ["Project", ""], rows, words=True), *([form] if owner else [])], gap="xs")


def limits(found: dict[str, Any]) -> Any:
    """What the team has and may have, what was refused of late, and who can change it."""
    rows = [
        [
            item["name"],
            f"{item['used']:,}",
            "no limit" if item["limit"] is None else f"{item['limit']:,}",
            "" if item["left"] is None else f"{item['left']:,}",
            item["setting"],
        ]
        for item in found["items"]
    ]
    refused = [[moment(item["at"]), item["detail"]] for item in found.get("refused", [])]
    note = f"The limits can be changed by {found['who']}." if found.get("who") else ""
    shown = [table("Limits", ["Of", "used", "limit", "left", "setting"], rows, min_width=520, note=note, words=True)]
    if refused:
        shown.append(table("Refused of late", ["When", "what"], refused, min_width=520, words=True))
    return dmc.Stack(shown, gap="xs")


def invitations(items: list[dict[str, Any]]) -> Any:
    rows = [
        [item["role"], item.get("email") or "whoever has the link", moment(item["expires_at"]),
         _remove("invitations", item["id"], "Withdraw")]
        for item in items
    ]  # fmt: skip
    form = dmc.Group(
        [_roles("invite-role", "viewer", "As"), dmc.TextInput(id="invite-email", label="Only for (e-mail)", size="xs", w=240),
         dmc.Button("Make a link", id="team-invite", size="xs")],
        align="flex-end",
    )  # fmt: skip
    listed = [table("", ["Role", "for", "until", ""], rows, min_width=480, words=True)] if rows else []
    return dmc.Stack([dmc.Title("Invitations", order=4), form, *listed], gap="xs")


def audit(items: list[dict[str, Any]]) -> Any:
    rows = [
        [
            moment(item["at"]),
            item["actor"],
            item["action"],
            " ".join(f"{k} {v}" for k, v in item["subject"].items())[:120],
        ]
        for item in items
    ]
    return table(
        "Who did what", ["When", "who", "what", "of"], rows, min_width=760, note=f"The newest {AUDIT}.", words=True
    )


def make(clicks: int | None, name: str | None, changed: int) -> tuple[Any, Any]:
    return _changing(clicks, changed, lambda: client().post("/teams", {"name": name or ""}))


def make_project(clicks: int | None, name: str | None, team: str, changed: int) -> tuple[Any, Any]:
    return _changing(clicks, changed, lambda: client().post(f"/teams/{team}/projects", {"name": name or ""}))


def _changing(clicks: int | None, changed: int, call: Any) -> tuple[Any, Any]:
    if not clicks:
        return no_update, no_update
    _, error = attempt(call)
    return (refusal(error), no_update) if error else (None, changed + 1)


def promote(
    roles: list[str], ids: list[dict[str, str]], team: str, before: dict[str, str] | None, changed: int
) -> tuple[Any, Any]:
    """Controls report as they come on the screen too: only another role is a change."""
    faults: list[ApiError] = []
    moved = [
        (made["id"], role) for made, role in zip(ids, roles, strict=True) if (before or {}).get(made["id"]) != role
    ]
    for user, role in moved:
        _, error = attempt(partial(client().put, f"/teams/{team}/members/{user}", {"role": role}))
        faults += [error] if error else []
    if not moved:
        return no_update, no_update
    if faults:
        return notice("Not changed", faults[0].text, "red"), changed + 1
    return notice("Role changed"), changed + 1


def remove(clicks: list[int | None], team: str, changed: int) -> tuple[Any, Any]:
    asked = ctx.triggered_id
    if not asked or not any(clicks):
        return no_update, no_update
    what, key = asked["what"], asked["id"]
    path = f"/projects/{key}" if what == "projects" else f"/teams/{team}/{what}/{key}"
    _, error = attempt(lambda: client().delete(path))
    return (notice("Not done", error.text, "red"), no_update) if error else (notice("Done"), changed + 1)


def invite(clicks: int | None, role: str, email: str | None, team: str, changed: int) -> tuple[Any, Any]:
    """The link is shown once."""
    if not clicks:
        return no_update, no_update
    body = {"role": role} | ({"email": email} if email else {})
    made, error = attempt(lambda: client().post(f"/teams/{team}/invitations", body))
    return (refusal(error), no_update) if error else (once("The link, shown this once", made["url"]), changed + 1)
