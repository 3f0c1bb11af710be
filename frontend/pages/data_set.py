"""One set of hydrodynamic data: what it is, where it is doubtful, and its coefficients as curves."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ALL, ClientsideFunction, Dash, Input, Output, State, dcc, html, no_update

from frontend.client import Client, attempt, client
from frontend.components.cards import grid, picture
from frontend.components.links import page_path
from frontend.components.messages import refusal
from frontend.components.options import bar, option_id
from frontend.components.shell import notice
from frontend.components.tables import facts, table
from frontend.figures import hydrodynamics as figures
from frontend.format import DOFS, MISSING, moment, number

SIGNS = {"ok": "ok", "warning": "doubtful", "skipped": "not checked"}


def layout(data_set_id: str = "", **query: Any) -> Any:
    """`/data/{id}?row=&heading=` opens exactly what was on the screen."""
    options = {name: query[name] for name in ("row", "heading") if query.get(name)}
    return dmc.Stack(
        [
            dcc.Store(id="data-set-id", data=data_set_id),
            dcc.Store(id="data-set-options", data=options),
            dcc.Store(id="data-set-drawn"),
            dcc.Store(id="data-set-address"),
            dcc.Link("All hydrodynamic data", href=page_path("/data"), className="sd-back"),
            html.Div(dmc.Skeleton(h=120), id="data-set-head"),
            html.Div(dmc.Skeleton(h=300), id="data-set-body"),
        ],
        id="data-set-page",
        gap="md",
    )


def register(app: Dash) -> None:
    app.callback(Output("data-set-head", "children"), Input("data-set-id", "data"))(head)
    app.callback(
        Output("data-set-body", "children"), Output("data-set-drawn", "data"), Input("data-set-options", "data"),
        State("data-set-id", "data"),
    )(body)  # fmt: skip
    app.callback(
        Output("data-set-options", "data"), Input({"type": "data-option", "name": ALL}, "value"),
        State({"type": "data-option", "name": ALL}, "id"), State("data-set-options", "data"),
        State("data-set-drawn", "data"), prevent_initial_call=True,
    )(choose)  # fmt: skip
    app.clientside_callback(
        ClientsideFunction("slowdrift", "compareAddress"), Output("data-set-address", "data"),
        Input("data-set-drawn", "id"), Input("data-set-options", "data"),
    )  # fmt: skip
    app.callback(
        Output("location", "pathname", allow_duplicate=True),
        Output("notices", "sendNotifications", allow_duplicate=True),
        Input("data-set-delete", "n_clicks"), State("data-set-id", "data"), prevent_initial_call=True,
    )(delete)  # fmt: skip


def head(data_set_id: str) -> Any:
    found, error = attempt(lambda: client().get(f"/data-sets/{data_set_id}"))
    if error:
        return refusal(error)
    title = dmc.Group(
        [
            dmc.Title(f"{found['name']}, version {found['version']}", order=1),
            dmc.Button("Delete", id="data-set-delete", variant="default", size="xs"),
        ],
        justify="space-between",
    )
    return dmc.Stack(
        [title, dmc.SimpleGrid([described(found), checked(found)], cols={"base": 1, "lg": 2}, spacing="xl")], gap="sm"
    )


def described(found: dict[str, Any]) -> Any:
    about = found["summary"]
    band, depth = about.get("frequencies") or {}, about.get("depth")
    ends = [name for name in ("zero", "infinite") if about.get(f"has_{name}_frequency")]
    origin = about.get("provenance") or {}
    rows = [
        ("Frequencies", f"{band.get('count')} from {number(band.get('from'))} to {number(band.get('to'))} rad/s"
         + (f", with {' and '.join(ends)} frequency" if ends else "")),
        ("Headings", _headings(about)),
        ("Mean drift, QTF", f"{'yes' if about.get('mean_drift') else 'no'}, {'yes' if about.get('qtf') else 'no'}"),
        ("Displaced volume", f"{number(about['displaced_volume'], 5)} m³" if about.get("displaced_volume") else MISSING),
        ("Reference point", ", ".join(number(v) for v in about.get("reference_point") or []) or MISSING),
        ("Water", f"{number(about.get('density'), 5)} kg/m³, {number(about.get('gravity'), 5)} m/s², "
         + (f"{number(depth)} m deep" if depth else "infinitely deep")),
        ("Format", str(origin.get("format") or MISSING)),
        ("Stored", f"{moment(found['created_at'])}, {number(found['size'] / 1e6)} MB"),
        ("SHA-256", found["content_hash"]),
    ]  # fmt: skip
    rows += [("Assumed", sentence) for sentence in origin.get("assumed") or []]
    return dmc.Box([dmc.Title("What it is", order=4, mb=6), facts(rows)])


def _headings(about: dict[str, Any]) -> str:
    found = about.get("headings_deg") or []
    return f"{len(found)}, {number(found[0])} to {number(found[-1])} deg" if found else MISSING


def checked(found: dict[str, Any]) -> Any:
    """Every check with what it says; the doubtful first."""
    order = {"warning": 0, "ok": 1, "skipped": 2}
    checks = sorted(found.get("checks") or [], key=lambda check: order.get(check["state"], 3))
    alerts = [
        dmc.Alert(check["message"], title=check["name"].replace("_", " ").capitalize(), color="yellow", variant="light")
        for check in checks
        if check["state"] == "warning"
    ]
    rows = [
        [check["name"].replace("_", " "), SIGNS.get(check["state"], check["state"]), number(check["value"]),
         number(check["threshold"])]
        for check in checks
    ]  # fmt: skip
    listed = table("Quality", ["Check", "", "value", "threshold"], rows, min_width=360)
    return dmc.Stack([listed, *alerts], gap="sm")


def choose(
    values: list[Any], ids: list[dict[str, str]], options: dict[str, Any] | None, drawn: dict[str, Any] | None
) -> Any:
    picked = {made["name"]: value for made, value in zip(ids, values, strict=True) if value is not None}
    return no_update if all((drawn or {}).get(n) == v for n, v in picked.items()) else {**(options or {}), **picked}


def body(options: dict[str, Any] | None, data_set_id: str) -> tuple[Any, Any]:
    options = options or {}
    found, error = attempt(lambda: client().get(f"/data-sets/{data_set_id}"))
    if error:
        return None, no_update  # the head says it
    headings = [f"{value:g}" for value in found["summary"].get("headings_deg") or []]
    row = options.get("row") if options.get("row") in ("diagonal", *DOFS) else "diagonal"
    heading = options.get("heading") if options.get("heading") in headings else (headings[0] if headings else None)
    controls = [_select("row", "Added mass and damping", [("diagonal", "each motion with itself"),
                        *((dof, f"{dof} with the others") for dof in DOFS)], row or "diagonal")]  # fmt: skip
    if heading is not None:
        controls.append(_select("heading", "Heading", [(h, f"{h} deg") for h in headings], heading))
    drawn, error = attempt(lambda: pictures(client(), data_set_id, found["summary"], row or "diagonal", heading))
    shown = refusal(error) if error else grid(drawn)
    return dmc.Stack([bar(*controls), shown]), {"row": row, "heading": heading}


def _select(name: str, label: str, choices: list[tuple[str, str]], chosen: str) -> dmc.Select:
    data = [{"value": value, "label": text} for value, text in choices]
    return dmc.Select(
        id=option_id(name, "data"), label=label, data=data, value=chosen, allowDeselect=False, w=240,
        searchable=len(data) > 12,
    )  # fmt: skip


def pictures(rest: Client, data_set_id: str, about: dict[str, Any], row: str, heading: str | None) -> list[Any]:
    """Raises ApiError."""
    made = []
    for quantity, title in (("added_mass", "Added mass"), ("damping", "Radiation damping")):
        params = {} if row == "diagonal" else {"i": DOFS.index(row)}
        found = rest.get(f"/data-sets/{data_set_id}/coefficients", quantity=quantity, **params)
        for rotation in (False, True):
            figure = figures.coefficients(found, row, rotation)
            if figure:
                kind = "rotations" if rotation else "translations"
                made.append(picture(f"{title}, {kind}", figure, f"{quantity}-{kind}"))
    if heading is not None:
        found = rest.get(f"/data-sets/{data_set_id}/coefficients", quantity="excitation", heading=heading)
        for rotation, kind in ((False, "forces"), (True, "moments")):
            made.append(
                picture(f"Excitation, {kind}, {heading} deg", figures.excitation(found, rotation), f"excitation-{kind}")
            )
        if about.get("mean_drift"):
            found = rest.get(f"/data-sets/{data_set_id}/coefficients", quantity="mean_drift", heading=heading)
            for rotation, kind in ((False, "forces"), (True, "yaw moment")):
                figure = figures.drift(found, rotation)
                if figure:
                    made.append(picture(f"Mean drift, {kind}, {heading} deg", figure, f"drift-{kind}"))
    if about.get("qtf"):
        for index in (0, 2, 4):
            found = rest.get(f"/data-sets/{data_set_id}/coefficients", quantity="qtf", i=index)
            figure = figures.qtf(found)
            if figure:
                made.append(picture(f"Difference-frequency QTF, {DOFS[index]}", figure, f"qtf-{index}"))
    return made


def delete(clicks: int | None, data_set_id: str) -> tuple[Any, Any]:
    if not clicks:
        return no_update, no_update
    _, error = attempt(lambda: client().delete(f"/data-sets/{data_set_id}"))
    if error:
        return no_update, notice("Not deleted", error.text, "red")
    return page_path("/data"), notice("Deleted")
