"""Hydrodynamic data: what there is, and new data from files or from a hull."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, State, dcc, html

from frontend.client import attempt, client
from frontend.components.links import button_link, page_path
from frontend.components.messages import empty, refusal
from frontend.components.tables import table
from frontend.errors import ApiError, FieldError
from frontend.format import moment, number

PAGE = 100
# what WAMIT's files do not say: form field, label, placeholder
WAMIT = (
    ("length", "ULEN [m]", "1"),
    ("density", "Density [kg/m³]", "1025"),
    ("gravity", "Gravity [m/s²]", "9.80665"),
    ("depth", "Depth [m]", "infinite"),
    ("centre_of_mass", "Centre of mass [m]", "0, 0, 0"),
)


def layout(**_: Any) -> Any:
    return dmc.Stack(
        [
            dcc.Store(id="data-added"),
            dmc.Group([dmc.Title("Hydrodynamic data", order=1), button_link("From a hull", "/hull")], justify="space-between"),
            dmc.Text(
                "Added mass, damping, wave loads and drift of a vessel. Cases name such data under "
                "vessel, hydrodynamics, data.",
                c="dimmed", maw=720,
            ),
            html.Div(id="data-message"),
            _upload(),
            html.Div(dmc.Skeleton(h=160), id="data-list"),
        ],
        id="data-page",
        gap="md",
    )  # fmt: skip


def _upload() -> dmc.Paper:
    fields = [
        dmc.TextInput(id=f"wamit-{name}", label=label, placeholder=placeholder, w=150)
        for name, label, placeholder in WAMIT
    ]
    values = dmc.Select(
        id="wamit-values", label="Values are", w=170, value="nondimensional", allowDeselect=False,
        data=[{"value": v, "label": v} for v in ("nondimensional", "dimensional")],
    )  # fmt: skip
    return dmc.Paper(
        dmc.Stack(
            [
                dmc.Group(
                    [
                        dmc.TextInput(id="data-name", label="Name", placeholder="that of the file", w=260),
                        dmc.Button("Choose files and upload", id="data-upload"),
                    ],
                    align="flex-end",
                ),
                dmc.Text(
                    "A NetCDF file of Capytaine's, the files of one WAMIT set together (.1 .2 .3 .4 .8 .9 .12d .hst), or a "
                    "ZIP of either.",
                    size="sm", c="dimmed",
                ),
                html.Details(
                    [html.Summary("For WAMIT files: what they do not say themselves"), dmc.Group([values, *fields], mt="xs")]
                ),
            ],
            gap="xs",
        ),
        withBorder=True, p="md",
    )  # fmt: skip


def register(app: Dash) -> None:
    app.clientside_callback(
        ClientsideFunction("slowdrift", "uploadData"),
        Output("data-page", "data-upload"),
        Input("data-upload", "n_clicks"),
        State("data-name", "value"),
        State("wamit-values", "value"),
        *[State(f"wamit-{name}", "value") for name, _, _ in WAMIT],
        prevent_initial_call=True,
    )
    app.callback(
        Output("data-list", "children"),
        Output("data-message", "children"),
        Input("data-page", "id"),
        Input("data-added", "data"),
    )(show)


def show(_page: str, added: dict[str, Any] | None) -> tuple[Any, Any]:
    page, error = attempt(lambda: client().get("/data-sets", limit=PAGE))
    if error:
        return None, refusal(error)
    return listed(page["items"]), told(added)


def told(added: dict[str, Any] | None) -> Any:
    """What the browser's upload came to."""
    if not added:
        return None
    if added.get("problem"):
        problem = added["problem"]
        fields = [FieldError.from_json(entry) for entry in problem.get("errors") or [] if isinstance(entry, dict)]
        return refusal(ApiError(422, str(problem.get("title")), str(problem.get("detail") or ""), fields))
    link = dcc.Link("Look at it.", href=page_path(f"/data/{added.get('id')}"))
    return dmc.Alert(
        [f"{added.get('name')}, version {added.get('version')}, is stored. ", link], color="green", variant="light"
    )


def listed(items: list[dict[str, Any]]) -> Any:
    if not items:
        return empty("No hydrodynamic data yet", "Upload files above, or compute them from a hull's shape.")
    rows = []
    for item in items:
        about = item["summary"]
        band = about.get("frequencies") or {}
        drift = " and ".join(
            n for n, has in (("mean drift", about.get("mean_drift")), ("QTF", about.get("qtf"))) if has
        )
        rows.append(
            [dcc.Link(f"{item['name']}, version {item['version']}", href=page_path(f"/data/{item['id']}")),
             f"{band.get('count', '')}: {number(band.get('from'))} to {number(band.get('to'))}",
             str(len(about.get("headings_deg") or [])), drift or "none", str(len(about.get("warnings") or [])),
             moment(item["created_at"])]
        )  # fmt: skip
    head = ["Data", "frequencies [rad/s]", "headings", "drift", "warnings", "created"]
    note = f"The newest {PAGE}." if len(items) == PAGE else None
    return table("", head, rows, min_width=820, note=note, words=True)
